"""Check of the result of an analysis by the residuals of the model's own equations."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np

from dalembert.analysis.model_residuals import ModelResiduals, Violation
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status

EXACT = {Level.POSITION: 1e-6, Level.SPEED: 1e-6, Level.ACCELERATION: 1e-4}
"""Upper limit of the residual of an enforced constraint, relative to its terms; accelerations lose
digits near singular positions."""
MOTION = 1e-6
"""Upper limit of the residual of an equation of motion, relative to its terms."""


class ResidualCheck:
    """Check of a trajectory by the model's own equations, independent of how it was computed.

    Parameters
    ----------
    model : Model
    trajectory : states of all bodies, and multipliers
    p : (np,) parameters
    levels : levels at which the analysis enforces the constraints
    motion : limit for the equations of motion; infinite where the trajectory has no forces
    """

    def __init__(
        self,
        model: Model,
        trajectory: Trajectory,
        p: np.ndarray,
        levels: Iterable[Level] = Level,
        motion: float = MOTION,
    ):
        self.residuals = ModelResiduals(model, trajectory, p)
        self.levels, self.motion = levels, motion

    def violation(self, level: Level) -> tuple[Violation, float]:
        """The largest violation of a constraint at a level, and its limit."""
        return self.residuals.of_level(level), EXACT[level]

    def cure(self, limit: float) -> str:
        """Remedy, for the message."""
        return ""

    @cached_property
    def violations(self) -> list[tuple[Violation, float]]:
        """Largest violation, and its limit, of each level and of the equations of motion."""
        violations = [self.violation(level) for level in self.levels]
        if self.motion < np.inf:
            violations.append((self.residuals.of_motion, self.motion))
        return violations

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Outcome and reason where the analysis does not count as completed; None otherwise."""
        for violation, limit in self.violations:
            if not violation.share <= limit:
                size = f"{violation.share:.2g} of the size of its terms"
                return Outcome.VIOLATED, f"{violation.text}, {size}{self.cure(limit)}"
        return None

    def verify(self, status: Status) -> Status:
        """The status, with outcome and message of the objection if there is one."""
        objection = self.objection if status.success else None
        if objection is None:
            return status
        outcome, message = objection
        return replace(status, outcome=outcome, message=message)
