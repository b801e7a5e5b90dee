"""Whether what an analysis has left satisfies the model's own equations at all."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import cached_property

import numpy as np

from dalembert.analysis.model_residuals import Gap, ModelResiduals
from dalembert.formulations.base import Level
from dalembert.model.model import Model
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status

EXACT = {Level.POSITION: 1e-6, Level.SPEED: 1e-6, Level.ACCELERATION: 1e-4}
"""Share of its terms by which a constraint that is held may be open; accelerations lose digits
near singular positions."""
MOTION = 1e-6
"""The same of an equation of motion."""


class ModelTruth:
    """A trajectory against the model's own equations, whatever has made it.

    Parameters
    ----------
    model : Model
    trajectory : of all bodies and multipliers
    p : (np,) parameters
    levels : those at which the constraints are equations of the analysis
    motion : share by which the equations of motion may be open; infinite where it has no forces
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

    def open_at(self, level: Level) -> tuple[Gap, float]:
        """The constraint that is violated most, and by how much it may be."""
        return self.residuals.of_level(level), EXACT[level]

    def cure(self, limit: float) -> str:
        """What to do about it."""
        return ""

    @cached_property
    def gaps(self) -> list[tuple[Gap, float]]:
        """Of each level and of the equations of motion, what is open, and what may be."""
        found = [self.open_at(level) for level in self.levels]
        if self.motion < np.inf:
            found.append((self.residuals.of_motion, self.motion))
        return found

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Why the analysis must not be called completed, if so."""
        for gap, limit in self.gaps:
            if not gap.share <= limit:
                text = f"{gap.text}, {gap.share:.2g} of the size of its terms{self.cure(limit)}"
                return Outcome.VIOLATED, text
        return None

    def judged(self, status: Status) -> Status:
        """How the analysis ended, where that is not refuted."""
        objection = self.objection if status.success else None
        if objection is None:
            return status
        outcome, message = objection
        return replace(status, outcome=outcome, message=message)
