"""The loop of all marches: steps from a source, changes of variant, and events inside steps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import UnsolvedPart
from dalembert.integrators.marching.checkpoints import Recorder
from dalembert.integrators.marching.steps import Crossing, Steps, Watch
from dalembert.interrupts import uninterrupted


@dataclass(frozen=True)
class Stretch:
    """Consecutive steps of a march.

    Attributes
    ----------
    ends : (k + 1,) times of the states [s]
    x : (n, k + 1) states, of which the first was the last one before
    t, h, corrected, mode : (k,) of the steps, as in ``Steps``
    """

    ends: np.ndarray
    x: np.ndarray
    t: np.ndarray
    h: np.ndarray
    corrected: np.ndarray
    mode: np.ndarray

    @classmethod
    def of(cls, time: float, x: np.ndarray, columns: np.ndarray, *steps: np.ndarray) -> Stretch:
        """Steps ``t, h, corrected, mode`` from a state with these results, while finite."""
        finite = np.isfinite(columns).all(axis=0)
        count = finite.size if finite.all() else int(np.argmin(finite))
        t, h, corrected, mode = (column[:count] for column in steps)
        ends = np.append(t, t[-1] + h[-1] if count else time)
        return cls(ends, np.column_stack([x, columns[:, :count]]), t, h, corrected, mode)

    @property
    def count(self) -> int:
        return self.h.size

    @property
    def steps(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """``t, h, corrected, mode``."""
        return self.t, self.h, self.corrected, self.mode

    def cut(self, count: int) -> Stretch:
        """The first ``count`` steps."""
        steps = (column[:count] for column in self.steps)
        return Stretch(self.ends[: count + 1], self.x[:, : count + 1], *steps)

    def across(self, crossing: Crossing) -> Stretch:
        """The steps up to a crossing, and those that replace the step across it."""
        before = self.cut(crossing.accepted)
        added = crossing.t, crossing.h, np.ones(crossing.t.size, bool), crossing.mode
        t, h, *more = (np.append(a, b) for a, b in zip(before.steps, added, strict=True))
        x = np.column_stack([before.x, crossing.x])
        return Stretch(np.append(t, t[-1] + h[-1]), x, t, h, *more)


class StepSource(ABC):
    """Steps of a march: prescribed ones, or attempts with error control.

    Attributes
    ----------
    start : time of the first state [s]
    mode : of the next steps
    rejected : number of steps taken in vain so far
    explained : whether the last failure has a complete explanation
    sampling : whether the last stretch is a sample, after which nothing is searched for
    """

    start: float
    mode: int
    rejected: int = 0
    explained: bool = False
    sampling: bool = False

    @property
    @abstractmethod
    def pending(self) -> bool:
        """Whether the end is not reached."""

    @property
    @abstractmethod
    def progress(self) -> float:
        """Completed fraction."""

    @abstractmethod
    def take(self, time: float, x: np.ndarray) -> tuple[Stretch, str]:
        """The next steps from a state, and why there are not more of them, or ``""``."""

    @abstractmethod
    def reject(self, accepted: int) -> None:
        """Discard the steps after the ``accepted`` first ones."""

    @abstractmethod
    def may_cross(self, reason: str) -> bool:
        """Whether to search for events, if the march will end for a reason or for none."""

    @abstractmethod
    def settle(
        self, stretch: Stretch, following: int, crossing: Crossing | None, failure: str
    ) -> str:
        """Continue after these steps in the mode ``following``; the reason to stop, or ``""``.

        ``failure`` is why the step after them is not possible, if it is not.
        """


def take_steps(source: StepSource, recorder: Recorder, watch: Watch) -> Steps:
    """Take steps until the end, a failure or a reason to stop; states are left to the recorder."""
    time, message, interrupted = source.start, "", False
    nothing = np.zeros(0)
    taken = [(nothing, nothing, nothing > 0, nothing.astype(int))]
    try:
        while source.pending and not message:
            stretch, failure = source.take(time, recorder.last)
            following, crossing = source.mode, None
            if stretch.count and not source.sampling:
                accepted, following, message = watch.switch(stretch.ends, stretch.x, source.mode)
                if message or accepted < stretch.count:
                    source.reject(accepted)
                    stretch, failure = stretch.cut(accepted), ""
            if not source.sampling and source.may_cross(message or failure):
                try:
                    crossing = watch.cross(stretch.ends, stretch.x, source.mode)
                except UnsolvedPart as unsolved:
                    stretch, failure = stretch.cut(unsolved.number), str(unsolved)
            if crossing is not None:
                stretch, message, failure = stretch.across(crossing), crossing.reason, ""
                following = source.mode if crossing.after is None else crossing.after
            failure = source.settle(stretch, following, crossing, failure)
            message = message or failure
            with uninterrupted():
                taken.append(stretch.steps)
                recorder.add(stretch.ends, stretch.x[:, 1:])
            time = float(stretch.ends[-1])
            if message:
                break
            watch.progress(source.progress)
            if stretch.count and watch.stop(stretch.ends, stretch.x, stretch.mode):
                break
    except KeyboardInterrupt:
        message, interrupted = "interrupted", True
    t, h, corrected, mode = (np.concatenate(column) for column in zip(*taken, strict=True))
    t = t if t.size else np.array([source.start])
    explained = source.explained and bool(message)
    steps = Steps(t, h, recorder.last, corrected, mode, source.rejected, message)
    return replace(steps, interrupted=interrupted, explained=explained)
