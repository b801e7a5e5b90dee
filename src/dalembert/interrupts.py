"""Ctrl-C: an exception during a search, a deferred signal while its result is completed.

Compiled code may swallow the ``KeyboardInterrupt`` that Python raises inside it, or raise another
exception instead, and an interrupt after the last iteration would discard a finished result. Tasks
therefore count the interrupt signals they receive: inside ``searching`` each of them ends as a
``KeyboardInterrupt``, after ``defer_ctrl_c`` the task completes its result. A second Ctrl-C always
ends at once.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from types import FrameType
from typing import ParamSpec, Protocol, TypeVar


class Interruptible(Protocol):
    """Result of a task that Ctrl-C may end early."""

    def interrupt(self) -> None:
        """Record that the task was interrupted."""


P = ParamSpec("P")
R = TypeVar("R", bound=Interruptible)


class CtrlC:
    """The interrupt signals received during a task.

    Attributes
    ----------
    count : signals received
    deferring : the first signal is counted only
    is_command : takes over the deferral of the task inside, so that there is no gap between them
    """

    def __init__(self, is_command: bool = False):
        self.count, self.deferring, self.is_command = 0, False, is_command
        self.holding = False

    @property
    def pressed(self) -> bool:
        """Whether a signal was received."""
        return self.count > 0

    @property
    def must_end(self) -> bool:
        """Whether the task may not go on: one signal during the search, two afterwards."""
        return self.count > int(self.deferring)


_active: list[CtrlC] = []


def _received(number: int, frame: FrameType | None) -> None:
    for signals in _active:
        signals.count += 1
    if not _active or (_active[-1].must_end and not _active[-1].holding):
        raise KeyboardInterrupt


@contextmanager
def ctrl_c(is_command: bool = False) -> Iterator[CtrlC]:
    """Count interrupt signals during a task.

    Signals are not counted outside of the main thread, nor where the program handles them itself.
    """
    current, signals = signal.getsignal(signal.SIGINT), CtrlC(is_command)
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or current not in (signal.default_int_handler, _received):
        yield signals
        return
    _active.append(signals)
    signal.signal(signal.SIGINT, _received)
    try:
        yield signals
    finally:
        if len(_active) > 1 and _active[-2].is_command:
            _active[-2].deferring |= signals.deferring
        _active.pop()
        signal.signal(signal.SIGINT, current)


def check_ctrl_c() -> None:
    """Raise ``KeyboardInterrupt`` if the innermost task has received a signal that ends it."""
    if _active and _active[-1].must_end:
        raise KeyboardInterrupt


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let a short change of several objects complete; a signal ends the task after it."""
    if not _active:
        yield
        return
    signals = _active[-1]
    signals.holding = True
    try:
        yield
    finally:
        signals.holding = False
    check_ctrl_c()


def defer_ctrl_c() -> None:
    """Let the innermost task complete its result: the first signal is counted only."""
    if _active:
        _active[-1].deferring = True


@contextmanager
def raising_ctrl_c() -> Iterator[None]:
    """Convert Ctrl-C to ``KeyboardInterrupt``, for any exception of compiled code."""
    try:
        yield
        check_ctrl_c()
    except Exception as error:
        if _active and _active[-1].pressed:
            raise KeyboardInterrupt from error
        raise


@contextmanager
def searching() -> Iterator[None]:
    """The search of the innermost task; once it is over, the first signal is deferred."""
    try:
        with raising_ctrl_c():
            yield
    finally:
        defer_ctrl_c()


def interruptible(task: Callable[P, R]) -> Callable[P, R]:
    """Decorator of tasks: counts signals during a task; its result reports any interrupt."""

    @wraps(task)
    def counted(*args: P.args, **kwargs: P.kwargs) -> R:
        with ctrl_c() as signals:
            result = task(*args, **kwargs)
            defer_ctrl_c()
            if signals.pressed:
                result.interrupt()
            return result

    return counted
