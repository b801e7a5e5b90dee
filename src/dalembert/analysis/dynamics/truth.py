"""Whether what a run has left is a motion of the model at all."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.energy_balance import EnergyBalance
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.model_residuals import Gap, ModelResiduals
from dalembert.analysis.model_truth import ModelTruth
from dalembert.formulations.base import NONE, Level
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome

DRIFT, TOLD = 0.1, 1e-2
"""Where constraints are held nearly only: what is no motion of the mechanism, and what is told."""


class DynamicsTruth(ModelTruth):
    """Positions, speeds, accelerations, forces and energies of a run, against the model's own.

    Parameters
    ----------
    kernel, steps, trajectory : of the run
    p : (np,) parameters
    balance : largest error of the energy over the energy that took part
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        steps: Steps,
        trajectory: Trajectory,
        p: np.ndarray,
        balance: float,
    ):
        super().__init__(kernel.model, trajectory, p)
        self.kernel, self.steps, self.s, self.p = kernel, steps, trajectory, p
        self.balance = balance

    @cached_property
    def held(self) -> frozenset[Level]:
        """Levels at which all constraints are held, and not nearly so."""
        return held_levels(self.kernel)

    def open_at(self, level: Level) -> tuple[Gap, float]:
        if level in self.held:
            return super().open_at(level)
        return self.residuals.of_level(level, drifts=True), DRIFT

    def cure(self, limit: float) -> str:
        projection = ", or stabilization=Projection()" if limit == DRIFT else ""
        return f"; use a shorter step{projection}"

    @cached_property
    def energy(self) -> EnergyBalance:
        """With the start in front, where it is no output."""
        s, steps, model = self.s, self.steps, self.kernel.model
        energies, work, t = self.residuals.energies, s.work, s.t
        if t[0] != steps.t[0]:
            mode, first = steps.mode[:1] if steps.count else np.array([0]), steps.t[:1]
            found = self.kernel.mapped(lambda v: v.bodies, mode, first, steps.x[:, :1], self.p)
            y, v, a, multiplier = found
            start = Trajectory(first, y, v, a, multiplier, np.zeros((2, 1)))
            before = ModelResiduals(model, start, self.p).energies
            energies, work = np.hstack([before, energies]), np.hstack([start.work, work])
            t = np.append(first, t)
        return EnergyBalance(energies, work, t, model.scales.energy)

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Why the run must not be called completed, if so."""
        if violated := super().objection:
            return violated
        return self.energy.objection(self.balance, "use a shorter step, or another integrator")

    @property
    def doubts(self) -> list[str]:
        """What is no reason to refuse the run, but should be known."""
        found = [
            f"{gap.text}, {gap.share:.2g} of the size of its terms: nothing holds it there"
            for gap, limit in self.gaps
            if limit == DRIFT and TOLD < gap.share <= DRIFT
        ]
        return found + self.energy.doubts(self.balance)


def held_levels(kernel: DynamicsKernel) -> frozenset[Level]:
    """Levels at which a run holds all constraints, and not nearly so.

    What is left out as redundant follows from the others where the levels below are held.
    """
    first, stabilization = kernel.variants[0], kernel.stabilization
    fed_back = {Level.ACCELERATION} if stabilization.feedback else NONE
    held = (first.formulation.exact_levels - fed_back) | stabilization.exact_levels
    if not first.equations.dropped.numel():
        return held
    return frozenset(level for level in held if set(range(level)) <= held)
