"""Pictures, animations and films of a motion with Matplotlib."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation

from dalembert.errors import AnalysisError, FileError
from dalembert.files import atomic_path
from dalembert.options import is_number
from dalembert.report.packing import unpack
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.mesh_picture import MeshPicture
from dalembert.results.pictures.picture import Picture, ScenePicture
from dalembert.text.wording import unknown

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DEFAULT_LENGTH = 5.0
"""Length of an animation without a given speed [s]."""
COLUMNS = ("at_", "force_")
"""Prefixes of the columns of contacts in a scene."""


class Film(FuncAnimation):
    """Animation that notebooks display with a player."""

    def _repr_html_(self) -> str:
        return self.to_jshtml()


def still(motion: LabelledRecording, time: float, ax: Axes | None = None) -> Axes:
    """Draw the mechanism at the output nearest to a time; returns the axes."""
    _check_outputs(motion)
    if not is_number(time):
        raise AnalysisError(f"time is {time!r:.60}; give a number of seconds")
    k = int(np.argmin(np.abs(motion.time - time)))
    picture = Picture(motion, np.array([k]), ax)
    picture.show(0)
    return picture.ax


def animate(
    motion: LabelledRecording, *, fps: int = 20, speed: float | None = None, ax: Axes | None = None
) -> Film:
    """Matplotlib animation; ``save`` writes it as a film.

    Parameters
    ----------
    fps : frames a second
    speed : relative to real time; by default chosen for at most five seconds
    """
    _check_outputs(motion)
    for name, value in (("fps", fps), ("speed", speed)):
        if value is not None and not (is_number(value) and value > 0):
            raise AnalysisError(f"{name} is {value!r:.60}; give a positive number")
    span = motion.time[-1] - motion.time[0]
    frames = int(
        np.clip(fps * (min(span, DEFAULT_LENGTH) if speed is None else span / speed), 2, 600)
    )
    instants = np.linspace(motion.time[0], motion.time[-1], frames)
    keep = np.clip(np.searchsorted(motion.time, instants), 0, motion.time.size - 1)
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
    plt.close(figure)  # keeps notebooks from showing the still picture as well
    return film


def _check_outputs(motion: LabelledRecording) -> None:
    if not motion.time.size:
        raise AnalysisError(f"there is no output to draw: {motion.status}")


MAX_FRAMES = 400
"""Upper limit of frames of a film."""
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def write_film(
    page: dict[str, Any],
    path: Path,
    *,
    fps: int = 20,
    seconds: float = 5.0,
    width: int = 720,
    state: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> Path:
    """Write the motion of a page as a film; a structure shows its states or oscillates.

    Parameters
    ----------
    path : with the suffix .gif or .mp4
    fps : frames a second
    seconds : length of the film, independent of the motion
    width : in pixels
    state : load case or mode of a structure that oscillates; by default all instants of a motion,
        else the first state
    progress : called with the completed fraction

    Raises
    ------
    FileError
        Unknown suffix, a writer that is not installed, or an unknown state.
    AnalysisError
        No outputs, or no positive rate, length or width.
    """
    from matplotlib import pyplot as plt
    from matplotlib.animation import FuncAnimation, writers

    if path.suffix not in WRITERS:
        raise FileError(f"{path}: a film has the suffix {' or '.join(WRITERS)}")
    writer = WRITERS[path.suffix]
    if not writers.is_available(writer):
        cure = "install it, or write a .gif"
        raise FileError(f"{path}: {writer}, which writes such films, is not installed; {cure}")
    if min(fps, seconds, width) <= 0:
        raise AnalysisError("a film needs positive fps, seconds and width")
    picture, frames = _picture(unpack(page), int(np.clip(fps * seconds, 2, MAX_FRAMES)), state)
    figure = picture.ax.figure
    figure.set_dpi(width / figure.get_figwidth())
    film = FuncAnimation(figure, picture.show, frames=frames, interval=1000 / fps, blit=False)

    def drawn(frame: int, count: int) -> None:
        if progress is not None:
            progress((frame + 1) / frames)

    with atomic_path(path) as temporary:
        try:
            film.save(temporary, writer, fps, figure.dpi, progress_callback=drawn)
        finally:
            plt.close(figure)
    return path


STILLS = (".svg", ".png", ".pdf")
"""Suffixes of pictures."""


def write_still(
    page: dict[str, Any], path: Path, share: float = 0.0, *, dpi: int = 200, plain: bool = False
) -> Path:
    """Write an instant of the motion of a page, or a state of a structure, as a picture.

    Parameters
    ----------
    path : with the suffix .svg, .png or .pdf
    share : instant as a fraction of the motion
    dpi : dots per inch, of 6.4 × 4.8 inches
    plain : without axes, title and background

    Raises
    ------
    FileError
        Unknown suffix.
    AnalysisError
        No outputs.
    """
    if path.suffix not in STILLS:
        raise FileError(f"{path}: a picture has the suffix {', '.join(STILLS)}")
    frames = max(2, len(page.get("time", ())))
    picture, count = _picture(unpack(page), frames, None)
    picture.show(round(float(np.clip(share, 0, 1)) * (count - 1)))
    figure = picture.ax.figure
    with atomic_path(path) as temporary:
        try:
            if plain:
                picture.ax.set_axis_off()
                picture.ax.set_title("")
            figure.savefig(temporary, format=path.suffix[1:], dpi=dpi, transparent=plain)
        finally:
            plt.close(figure)
    return path


def _picture(page: dict[str, Any], frames: int, state: str | None) -> tuple[Any, int]:
    """Picture of a mechanism at equidistant instants or of a structure, and number of frames."""
    if page.get("kind", "mechanism") == "structure":
        return _structure(page, frames, state)
    if "states" in page:
        raise FileError("modes of a mechanism have no film; their page shows them")
    if state is not None:
        raise FileError("a motion has no states to choose from; leave state out")
    time = np.asarray(page["time"], dtype=float)
    if not time.size:
        raise AnalysisError("there is no output to film")
    count = min(frames, max(2, time.size))
    instants = np.linspace(time[0], time[-1], count)
    keep = np.clip(np.searchsorted(time, instants), 0, time.size - 1)
    bodies = [
        {key: _selected(value, keep, time.size) for key, value in body.items()}
        for body in page["scene"]["bodies"]
    ]
    joints = [
        {
            key: _selected(value, keep, time.size) if key.startswith(COLUMNS) else value
            for key, value in joint.items()
        }
        for joint in page["scene"]["joints"]
    ]
    scene = page["scene"] | {"bodies": bodies, "joints": joints}
    return ScenePicture(scene, page.get("kind") == "spatial", count, page["title"], None), count


def _structure(page: dict[str, Any], frames: int, state: str | None) -> tuple[Any, int]:
    """Picture of a structure in consecutive states, or oscillating in one state."""
    states = page["states"]
    names = [str(name) for name in states["names"]]
    if state is not None and state not in names:
        raise FileError(unknown("state", state, names))
    if not names:
        raise AnalysisError("there is no state to film")
    if len(states["times"]) > 1 and state is None:
        index = np.linspace(0, len(names) - 1, min(frames, len(names))).round().astype(int)
        shares = np.ones(len(index))
    else:
        index = np.full(frames, names.index(state) if state is not None else 0)
        shares = np.sin(2 * np.pi * np.arange(frames) / frames)
    scales = page["scene"]["mesh"]["scales"]
    moves = [(int(k), share * scales[k]) for k, share in zip(index, shares, strict=True)]
    titles = [" · ".join(part for part in (page["title"], names[k]) if part) for k in index]
    return MeshPicture(page["scene"], moves, symbols=False, titles=titles), len(index)


def _selected(value: Any, keep: np.ndarray, count: int) -> Any:
    """Selected instants of a column; other values unchanged."""
    if not isinstance(value, list) or len(value) != count or isinstance(value[0], dict | str):
        return value
    return np.array(value, dtype=float)[keep]
