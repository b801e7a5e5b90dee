"""Progress of long runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PATIENCE = 1.0
"""Delay before a bar appears [s]; most runs are shorter."""
Reported = bool | Callable[[float], None]
"""True for a progress bar, or a function of the completed fraction."""


@contextmanager
def progress_reporter(progress: Reported, text: str) -> Iterator[Callable[[float], None]]:
    """Callback for the completed fraction: the user's own, a bar on the terminal, or none."""
    if callable(progress) or not progress:
        yield progress or (lambda fraction: None)
        return
    from rich.console import Console
    from rich.progress import Progress

    # notebooks show the terminal bar, too: the bars of Jupyter need a further package
    with Progress(console=Console(stderr=True, force_jupyter=False), transient=True) as bar:
        task = bar.add_task(text, total=1.0, visible=False)
        begin = time.monotonic()

        def report(fraction: float) -> None:
            bar.update(task, completed=fraction, visible=time.monotonic() - begin > PATIENCE)

        yield report


def part_of(report: Callable[[float], None], begin: float, end: float) -> Callable[[float], None]:
    """Callback for the completed fraction of a part of a run.

    Parameters
    ----------
    report : for the fraction of the whole run
    begin, end : fractions of the whole run at the begin and at the end of the part
    """
    return lambda fraction: report(begin + (end - begin) * fraction)
