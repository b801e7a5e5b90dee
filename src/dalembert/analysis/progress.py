"""Progress of long runs."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress_reporter(
    progress: bool | Callable[[float], None], text: str
) -> Iterator[Callable[[float], None]]:
    """A function of the fraction done: the user's own, a bar on the terminal, or nothing."""
    if callable(progress):
        yield progress
    elif progress:
        from rich.progress import Progress

        with Progress(transient=True) as bar:
            task = bar.add_task(text, total=1.0)
            yield lambda fraction: bar.update(task, completed=fraction)
    else:
        yield lambda fraction: None
