"""Progress of long runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

PATIENCE = 1.0
"""Time without a bar [s]: most runs are over by then."""
Reported = bool | Callable[[float], None]
"""True for a bar, or a function of the fraction done."""


@contextmanager
def progress_reporter(progress: Reported, text: str) -> Iterator[Callable[[float], None]]:
    """A function of the fraction done: the user's own, a bar on the terminal, or nothing."""
    if callable(progress) or not progress:
        yield progress or (lambda fraction: None)
        return
    from rich.console import Console
    from rich.progress import Progress

    # as on a terminal in notebooks too: their own bars need a package that may be missing
    with Progress(console=Console(stderr=True, force_jupyter=False), transient=True) as bar:
        task = bar.add_task(text, total=1.0, visible=False)
        begin = time.monotonic()

        def report(fraction: float) -> None:
            bar.update(task, completed=fraction, visible=time.monotonic() - begin > PATIENCE)

        yield report
