"""Pictures and animations of a motion with Matplotlib, for notebooks."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation

from dalembert.errors import AnalysisError
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.picture import Picture

SHORT = 5.0
"""Length of a film [s] for which no speed was asked."""


class Film(FuncAnimation):
    """Animation that notebooks show by themselves, with a player."""

    def _repr_html_(self) -> str:
        return self.to_jshtml()


def still(motion: LabelledRecording, time: float, ax: Any = None) -> Any:
    """The mechanism at the output nearest to a time; returns the axes."""
    _need_outputs(motion)
    k = int(np.argmin(np.abs(motion.time - time)))
    picture = Picture(motion, np.array([k]), ax)
    picture.show(0)
    return picture.ax


def animate(
    motion: LabelledRecording, *, fps: int = 20, speed: float | None = None, ax: Any = None
) -> Film:
    """Matplotlib animation; ``save`` writes it as a film.

    Parameters
    ----------
    fps : frames a second
    speed : times real time; by default what makes a film of five seconds at most
    """
    _need_outputs(motion)
    for name, value in (("fps", fps), ("speed", speed)):
        if value is not None and not 0 < value < np.inf:
            raise AnalysisError(f"{name} is {value!r:.60}; give a positive number")
    span = motion.time[-1] - motion.time[0]
    frames = int(np.clip(fps * (min(span, SHORT) if speed is None else span / speed), 2, 600))
    wanted = np.linspace(motion.time[0], motion.time[-1], frames)
    keep = np.clip(np.searchsorted(motion.time, wanted), 0, motion.time.size - 1)
    picture = Picture(motion, keep, ax)
    figure = picture.ax.figure
    film = Film(
        figure,
        picture.show,
        frames=frames,
        interval=1000 / fps,
        blit=not picture.spatial,
        cache_frame_data=False,
    )
    plt.close(figure)  # notebooks would show the still picture as well
    return film


def _need_outputs(motion: LabelledRecording) -> None:
    if not motion.time.size:
        raise AnalysisError(f"there is no output to draw: {motion.status}")
