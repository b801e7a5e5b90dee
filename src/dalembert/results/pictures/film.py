"""Films of saved runs: GIF by Pillow, MP4 by ffmpeg where it is installed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, FileError
from dalembert.files import atomic_path
from dalembert.report.packing import unpacked

MOST = 400
"""Frames of a film."""
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}


def write_film(
    page: dict[str, Any],
    path: Path,
    *,
    fps: int = 20,
    seconds: float = 5.0,
    width: int = 720,
    state: str | None = None,
) -> Path:
    """The motion that a page shows, as a film; a structure goes through its states or swings.

    Parameters
    ----------
    path : with the ending .gif or .mp4
    fps : frames a second
    seconds : how long the film runs, whatever the motion takes
    width : in pixels
    state : load case or mode of a structure that swings; all, one after the other, where they are
        instants of a motion, else the first

    Raises
    ------
    FileError
        Another ending, a writer that is not installed, or no such state.
    AnalysisError
        No outputs, or no positive rate, length or width.
    """
    from matplotlib import pyplot as plt
    from matplotlib.animation import FuncAnimation, writers

    if path.suffix not in WRITERS:
        raise FileError(f"{path}: a film ends in {' or '.join(WRITERS)}")
    writer = WRITERS[path.suffix]
    if not writers.is_available(writer):
        cure = "install it, or write a .gif"
        raise FileError(f"{path}: {writer} writes such films and is not installed; {cure}")
    if min(fps, seconds, width) <= 0:
        raise AnalysisError("a film needs positive fps, seconds and width")
    picture, frames = _picture(unpacked(page), int(np.clip(fps * seconds, 2, MOST)), state)
    figure = picture.ax.figure
    figure.set_dpi(width / figure.get_figwidth())
    film = FuncAnimation(figure, picture.show, frames=frames, interval=1000 / fps, blit=False)
    with atomic_path(path) as temporary:
        try:
            film.save(temporary, writer=writer, fps=fps, dpi=figure.dpi)
        finally:
            plt.close(figure)
    return path


def _picture(page: dict[str, Any], frames: int, state: str | None) -> tuple[Any, int]:
    """The mechanism at evenly spaced instants, or the structure, and how many these are."""
    from dalembert.results.pictures.picture import ScenePicture
    from dalembert.results.structural.moving import MovingStructure

    if page.get("kind", "mechanism") == "structure":
        moving = MovingStructure(page, frames, state)
        return moving, moving.count
    if state is not None:
        raise FileError("a motion has no states to choose from; leave state out")
    time = np.asarray(page["time"], dtype=float)
    if not time.size:
        raise AnalysisError("there is no output to film")
    count = min(frames, max(2, time.size))
    wanted = np.linspace(time[0], time[-1], count)
    keep = np.clip(np.searchsorted(time, wanted), 0, time.size - 1)
    bodies = [
        {key: _some(value, keep, time.size) for key, value in body.items()}
        for body in page["scene"]["bodies"]
    ]
    scene = page["scene"] | {"bodies": bodies}
    return ScenePicture(scene, page.get("kind") == "spatial", count, page["title"], None), count


def _some(value: Any, keep: np.ndarray, count: int) -> Any:
    """The chosen instants of a column; anything else as it is."""
    if not isinstance(value, list) or len(value) != count or isinstance(value[0], dict | str):
        return value
    return np.array(value, dtype=float)[keep]
