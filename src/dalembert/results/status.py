"""How a run ended."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from dalembert.sparse.eigenvalues import CONVERGED


class Outcome(StrEnum):
    """Ways in which a run ends.

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
    residual : of what was returned: largest constraint violation, or what is left of equilibrium
        or of equations of motion, relative to the largest of their terms

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
