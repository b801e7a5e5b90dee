"""A design task that runs beside the server: started, stopped, and reported to all pages."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any

from dalembert.studio.child import child_context
from dalembert.studio.task_work import STOP, Iteration, Outcome, TaskRequest, work

DOUBLE_CLICK = 1.0
"""Time after a stop in which a second one is the same one [s]."""
INTERVAL = 0.1
"""Least time between two reports [s]."""
MAX_HISTORY = 1000
"""Upper limit of the reported iterations."""
RUNNING, DONE, STOPPED, FAILED = "running", "done", "stopped", "failed"
ENDED_AT_ONCE = "ended at once, without its result so far"
ENDED = "the process of the task ended unexpectedly ({}); start it again"


@dataclass
class TaskState:
    """What pages show of a task.

    Attributes
    ----------
    number : of the task
    section : of the file
    digest : of the text with which it was started
    status : ``running``, ``done``, ``stopped`` or ``failed``
    stopping : whether it was stopped and completes its result
    fraction : completed part; None if it reports iterations
    history : number and objective of each iteration
    outcome : at the end
    """

    number: int
    section: str
    digest: str
    status: str = RUNNING
    stopping: bool = False
    fraction: float | None = None
    history: list[tuple[int, float]] = field(default_factory=list)
    outcome: Outcome = field(default_factory=Outcome)

    def message(self) -> dict[str, Any]:
        """The state as a message; the page has an address of its own."""
        outcome = self.outcome
        return {
            "kind": "task",
            "number": self.number,
            "section": self.section,
            "digest": self.digest,
            "status": self.status,
            "stopping": self.stopping,
            "fraction": self.fraction,
            "history": self.history,
            "text": outcome.sentence,
            "ok": outcome.ok,
            "page": f"task/{self.number}" if outcome.page else "",
            "designs": list(outcome.designs),
            "cards": list(outcome.cards),
        }


class TaskProcess:
    """A task in a process of its own.

    Parameters
    ----------
    request : the task
    state : that is updated
    report : called in a thread after a change of the state
    """

    def __init__(self, request: TaskRequest, state: TaskState, report: Callable[[], None]):
        self.state = state
        self._report = report
        self._reported = 0.0
        self._stopped: float | None = None
        context = child_context()
        self._connection, other = context.Pipe()
        self.process = context.Process(target=work, args=(other, request), daemon=True)
        self.process.start()
        other.close()
        threading.Thread(target=self._receive, daemon=True).start()

    def stop(self) -> None:
        """End the search and keep its result so far; a later call kills the process."""
        now = time.monotonic()
        if self._stopped is not None:
            if now - self._stopped > DOUBLE_CLICK:
                self.process.kill()
            return
        self._stopped = now
        with suppress(OSError):
            self._connection.send(STOP)
        self.state.stopping = True
        self._report()

    def close(self) -> None:
        """Kill the process."""
        self._stopped = time.monotonic()
        self.process.kill()

    def _receive(self) -> None:
        try:
            while True:
                message = self._connection.recv()
                if isinstance(message, Outcome):
                    break
                self._progress(message)
        except (EOFError, OSError):
            self.process.join(5.0)
            message = Outcome(sentence=self._reason())
        self._finish(message)

    def _reason(self) -> str:
        if self._stopped is not None:
            begun = self.state.history or self.state.fraction
            return ENDED_AT_ONCE if begun else "stopped; there was no result yet"
        code = self.process.exitcode or 0
        return ENDED.format(f"signal {-code}" if code < 0 else f"exit code {code}")

    def _progress(self, message: float | Iteration) -> None:
        state = self.state
        if isinstance(message, Iteration):
            state.history.append((message.number, message.value))
            del state.history[:-MAX_HISTORY]
        else:
            state.fraction = message
        now = time.monotonic()
        if now - self._reported > INTERVAL:
            self._reported = now
            self._report()

    def _finish(self, outcome: Outcome) -> None:
        self.state.stopping = False
        self.state.outcome = outcome
        ended = STOPPED if outcome.interrupted or self._stopped is not None else FAILED
        usable = bool(outcome.page) or outcome.ok
        self.state.status = DONE if usable and not outcome.interrupted else ended
        self._report()
        self._connection.close()
        self.process.join(5.0)
