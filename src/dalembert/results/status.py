"""How a run ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from dalembert.sparse.eigenvalues import CONVERGED


class Outcome(StrEnum):
    """Ways in which a run ends."""

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
    residual : of what was returned: largest constraint violation, or what is left of equilibrium
        or of equations of motion, relative to the largest of their terms
    """

    outcome: Outcome
    message: str
    time: float = 0.0
    residual: float = 0.0

    @property
    def success(self) -> bool:
        """The task was finished as asked; an event that terminates is asked for."""
        return self.outcome in (Outcome.COMPLETED, Outcome.TERMINATED)

    def __str__(self) -> str:
        return f"{self.outcome.value}: {self.message}" if self.message else self.outcome.value


def reached(time: float, residual: float) -> Status:
    """A run through time that went to its end."""
    return Status(Outcome.COMPLETED, f"reached t = {time:g} s", time, residual)


def stopped(time: float, residual: float) -> Status:
    """One that was interrupted."""
    return Status(Outcome.INTERRUPTED, f"stopped at t = {time:g} s", time, residual)


def unsolved(time: float, left: float, residual: float, cure: str = "") -> Status:
    """One that ended before a step whose equations Newton's method left open by so much."""
    text = (
        f"Newton's method did not converge at t = {time:.9g} s (relative residual {left:.3g}); use "
        f"a shorter step{cure}"
    )
    return Status(Outcome.NOT_CONVERGED, text, time, residual)


def eigenpairs_status(
    message: str, left: float, time: float = 0.0, residual: float | None = None
) -> Status:
    """Of modes, by what is left of the equation of the eigenpairs.

    Parameters
    ----------
    message : what was found
    left : relative residual of the eigenpairs
    time : [s]
    residual : that of the state they are about, told where the pairs are right; theirs by default
    """
    if not left < CONVERGED:
        return Status(Outcome.NOT_CONVERGED, f"residual {left:.3g}", time, left)
    return Status(Outcome.COMPLETED, message, time, left if residual is None else residual)
