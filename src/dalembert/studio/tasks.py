"""Design tasks of a session: one runs at a time, the last result of each section is kept."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from dalembert.errors import ModelError
from dalembert.studio.draft import digest
from dalembert.studio.task_process import RUNNING, TaskProcess, TaskState
from dalembert.studio.task_work import SECTIONS, TaskRequest


class Tasks:
    """Design tasks, each of the text with which it was started."""

    def __init__(self) -> None:
        self.report: Callable[[int], None] = lambda number: None
        """Called in a thread with the number of a task whose state has changed."""
        self._number = 0
        self._process: TaskProcess | None = None
        self.latest: dict[str, TaskState] = {}
        """Section → its last task."""

    @property
    def running(self) -> TaskState | None:
        """The task that runs."""
        state = self._process.state if self._process is not None else None
        return state if state is not None and state.status == RUNNING else None

    def start(self, section: Any, text: str, path: Path) -> TaskState:
        """Run the task of a section in a process of its own.

        Parameters
        ----------
        section : of the file
        text, path : of the model file

        Raises
        ------
        ModelError
            Unknown section, or another task runs.
        """
        if section not in SECTIONS:
            raise ModelError(f"there is no task {str(section)[:40]!r}")
        if self.running is not None:
            raise ModelError(f"the task [{self.running.section}] runs; stop it first")
        self._number += 1
        number, state = self._number, TaskState(self._number, section, digest(text))
        self.latest[section] = state
        request = TaskRequest(section, text, path)
        self._process = TaskProcess(request, state, lambda: self.report(number))
        return state

    def stop(self) -> None:
        """Stop the task that runs; it keeps its result so far."""
        if self.running is not None and self._process is not None:
            self._process.stop()

    def state(self, number: int) -> TaskState | None:
        """State of a task; None of an outdated one."""
        return next((state for state in self.latest.values() if state.number == number), None)

    def messages(self) -> list[dict[str, Any]]:
        """Messages about the last task of each section."""
        return [state.message() for state in self.latest.values()]

    def close(self) -> None:
        """Kill the process of the task that runs."""
        if self._process is not None:
            self._process.close()
