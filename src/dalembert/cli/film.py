"""``dalembert film``: the motion of a result file as GIF or MP4."""

from __future__ import annotations

from pathlib import Path

from dalembert.cli.console import DONE, AsJson, emit, tell, wrong_input
from dalembert.cli.loading import refuse_replacing, shown_warnings


def film(
    results: Path,
    /,
    *,
    output: Path | None = None,
    fps: int = 20,
    seconds: float = 5.0,
    width: int = 720,
    state: str | None = None,
    as_json: AsJson = False,
) -> int:
    """Write the motion of a result file (.nc) as a film, GIF or MP4.

    Parameters
    ----------
    results
        Result file written by 'dalembert run'.
    output
        Name of the film, .gif or .mp4 (which needs ffmpeg); by default a GIF beside the results.
    fps
        Frames a second.
    seconds
        How long the film runs, whatever the motion takes.
    width
        In pixels.
    state
        Load case or mode of a structure that swings; by default the first, or, of a motion, all of
        them one after the other.
    """
    import matplotlib

    matplotlib.use("Agg")
    from dalembert.results.files.store import load_results, report_of
    from dalembert.results.pictures.animation import write_film

    with wrong_input(), shown_warnings():
        page = report_of(load_results(results))
        made = output or results.with_suffix(".gif")
        refuse_replacing(results, [made])
        write_film(page, made, fps=fps, seconds=seconds, width=width, state=state)
    if as_json:
        emit({"ok": True, "files": [str(made)]})
    else:
        tell(f"written {made}")
    return DONE
