"""Status and warnings of a result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, overload

from dalembert.sparse.eigenvalues import CONVERGED


class Outcome(StrEnum):
    """Outcome of a run.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("ladder that is pulled away")
    >>> ladder = system.add(planar.Bar("ladder", length=5.0, angle=-0.9))
    >>> wall = system.add(planar.PinInSlot("wall", system.ground.center, ladder.start, axis=(0, 1)))
    >>> floor = system.add(planar.PinInSlot("floor", system.ground.center, ladder.end))
    >>> foot = system.add(planar.CoordinateDriver("foot", ladder.end, 3 + da.t))
    >>> motion = da.solve_kinematics(system.build(), 4.0, step=0.1)  # its length is 5
    >>> motion.status.outcome is da.Outcome.LOCKED, bool(1.8 < motion.time[-1] < 2.1)
    (True, True)
    """

    COMPLETED = "completed"
    TERMINATED = "terminated by an event"
    INTERRUPTED = "interrupted"
    NOT_ASSEMBLED = "cannot be assembled"
    REFUSED = "refused"
    LOCKED = "locked: no position satisfies the drivers"
    SINGULAR = "singular position"
    CHATTERING = "chattering"
    UNDECIDED = "contact forces undecided"
    DIVERGED = "diverged"
    NOT_CONVERGED = "not converged"
    VIOLATED = "violates the model's equations"
    UNBALANCED = "energy not balanced"


@dataclass(frozen=True)
class Status:
    """Outcome with the time reached and the residual that proves it.

    Attributes
    ----------
    outcome : Outcome
    message : one sentence with the numbers
    time : last time with a valid state [s]
    residual : of the returned result: maximum constraint violation, or residual of equilibrium
        or of the equations of motion, relative to their largest term

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> pan = system.add(planar.Particle("pan", mass=2.0, position=(0, -0.1)))
    >>> spring = planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0)
    >>> hung = system.add(spring)
    >>> status = da.solve_equilibrium(system.build()).status
    >>> isinstance(status, da.Status), status.success, status.outcome.name, status.residual < 1e-9
    (True, True, 'COMPLETED', True)
    """

    outcome: Outcome
    message: str
    time: float = 0.0
    residual: float = 0.0

    @property
    def success(self) -> bool:
        """Whether the run was completed or terminated by a requested event."""
        return self.outcome in (Outcome.COMPLETED, Outcome.TERMINATED)

    def __str__(self) -> str:
        return f"{self.outcome.value}: {self.message}" if self.message else self.outcome.value


def reached(time: float, residual: float) -> Status:
    """Status of a completed run over time."""
    return Status(Outcome.COMPLETED, f"reached t = {time:g} s", time, residual)


def stopped(time: float, residual: float) -> Status:
    """Status of an interrupted run."""
    return Status(Outcome.INTERRUPTED, f"stopped at t = {time:g} s", time, residual)


def unsolved(time: float, step_residual: float, residual: float, cure: str = "") -> Status:
    """Status of a run that stopped at a step whose Newton iteration did not converge."""
    text = (
        f"Newton's method did not converge at t = {time:.9g} s "
        f"(relative residual {step_residual:.3g}); use a shorter step{cure}"
    )
    return Status(Outcome.NOT_CONVERGED, text, time, residual)


def eigenpairs_status(
    message: str, pair_residual: float, time: float = 0.0, residual: float | None = None
) -> Status:
    """Status of modes, judged by the residual of their eigenpairs.

    Parameters
    ----------
    message : summary of the modes
    pair_residual : relative residual of the eigenpairs
    time : [s]
    residual : of the linearised state, reported if the pairs converged; by default of the pairs
    """
    if not pair_residual < CONVERGED:
        return Status(Outcome.NOT_CONVERGED, f"residual {pair_residual:.3g}", time, pair_residual)
    return Status(Outcome.COMPLETED, message, time, pair_residual if residual is None else residual)


class Warnings(Sequence[str]):
    """Texts of warnings, including deferred ones of expensive checks, which run on first access.

    Parameters
    ----------
    texts : immediate warnings
    deferred : function that returns further warnings

    Attributes
    ----------
    is_postponed : whether these texts lack the deferred ones, whose checks are made later or never
    """

    def __init__(self, texts: Iterable[str] = (), deferred: Callable[[], list[str]] | None = None):
        self._texts, self._deferred = list(texts), deferred
        self.is_postponed = False

    @property
    def texts(self) -> list[str]:
        """All texts."""
        if self._deferred is not None:
            deferred, self._deferred = self._deferred, None
            self._texts += deferred()
        return self._texts

    @property
    def noted(self) -> list[str]:
        """Texts of the checks that have been made."""
        return self._texts

    @property
    def is_complete(self) -> bool:
        """Whether all checks have been made."""
        return self._deferred is None and not self.is_postponed

    def postpone(self) -> Warnings:
        """The deferred warnings, which these texts no longer contain."""
        late, self._deferred = Warnings(deferred=self._deferred), None
        self.is_postponed = True
        return late

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> list[str]: ...

    def __getitem__(self, index: int | slice) -> str | list[str]:
        return self.texts[index]

    def __len__(self) -> int:
        return len(self.texts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self.texts == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self.texts)

    def __reduce__(self) -> tuple[Any, ...]:
        return Warnings, (self.texts,)
