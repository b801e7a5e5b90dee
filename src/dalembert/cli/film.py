"""``dalembert film``: the motion of a result file as an animation, GIF or MP4."""

from __future__ import annotations

from pathlib import Path

from dalembert.cli.console import DONE, AsJson, print_json, print_line, wrong_input
from dalembert.cli.loading import print_warnings, refuse_replacing


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
    """Write the motion of a result file (.nc) as an animation, GIF or MP4.

    Parameters
    ----------
    results
        Result file written by 'dalembert run'.
    output
        File name, .gif or .mp4 (which needs ffmpeg); by default a GIF in the folder of the results.
    fps
        Frames per second.
    seconds
        Duration of the animation, independent of the duration of the motion.
    width
        Width in pixels.
    state
        Load case or mode of a structure that is animated; by default the first, or, for a motion,
        all of them in sequence.
    """
    import matplotlib

    matplotlib.use("Agg")
    from dalembert.results.files.store import load_results, report_of
    from dalembert.results.pictures.animation import write_film

    with wrong_input(), print_warnings():
        page = report_of(load_results(results))
        target = output or results.with_suffix(".gif")
        refuse_replacing(results, [target])
        write_film(page, target, fps=fps, seconds=seconds, width=width, state=state)
    if as_json:
        print_json({"ok": True, "files": [str(target)]})
    else:
        print_line(f"written {target}")
    return DONE
