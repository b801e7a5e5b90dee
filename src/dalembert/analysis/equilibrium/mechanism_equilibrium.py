"""Equilibrium of a mechanism, near its assembled position.

``f(y, 0) − d(y, 0) − Cᵀ λ = 0``, ``Φ(y) = 0``. On the tangent space of the constraints this is
``r = Zᵀ f = 0``. Newton's method uses a positive definite modification of the tangent stiffness
``Zᵀ K Z``, so that it descends towards a stable position.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import ignored_contacts
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.equilibrium.stability import equilibrium_text, instability_warnings
from dalembert.analysis.equilibrium.static_balance import (
    StaticBalance,
    StaticsKernel,
    statics_kernel,
)
from dalembert.analysis.residual_check import MOTION, ResidualCheck
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.equations.newton import NewtonSettings, Solution, solve

MAX_ITERATIONS = 200
"""Default upper limit of Newton iterations."""
LEAVES = "the mechanism leaves it; other guesses of the positions lead to a stable one"


def equilibrium_settings(analysis: Any) -> NewtonSettings:
    """Settings of Newton's method for the fields of ``Equilibrium``."""
    limit = analysis.max_iterations or MAX_ITERATIONS
    return NewtonSettings(tolerance=analysis.tolerance, max_iterations=limit, slack=1.0)


@dataclass(frozen=True)
class EquilibriumRecord:
    """Record of an equilibrium for gradients."""

    kernel: StaticsKernel


class MechanismEquilibrium:
    """One search for an equilibrium.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    model : Model
    p : (np,) parameters
    """

    def __init__(self, analysis: Any, model: Model, p: np.ndarray):
        self.analysis, self.model, self.p = analysis, model, p
        self.kernel = statics_kernel(model)

    def execute(self, start: np.ndarray | None = None) -> Motion:
        """The equilibrium near the assembled position, or near the pose ``start``."""
        balance = StaticBalance(self.kernel, self.analysis.time, self.p)
        y = self.model.assemble(self.p, self.analysis.time).y
        if start is not None:
            moved = balance.onto_constraints(start)
            y = y if moved is None else moved
        return self.result(balance, solve(balance, y, equilibrium_settings(self.analysis)))

    def result(self, balance: StaticBalance, solution: Solution[np.ndarray]) -> Motion:
        """Motion with one instant."""
        n, forces = self.model.equations.speed_count, balance.residual(solution.x)
        residual = float(np.abs(forces.value).max(initial=0.0)) / self.model.scales.length
        stable = bool(np.all(forces.resistance > 0)) if forces.conservative else forces.stable
        text = equilibrium_text(residual, solution.iterations, stable, forces.conservative)
        outcome = Outcome.COMPLETED if solution.accepted else Outcome.NOT_CONVERGED
        status = Status(outcome, text, self.analysis.time, solution.residual)
        column = (-1, 1)
        trajectory = Trajectory(
            np.array([self.analysis.time]),
            solution.x.reshape(column),
            np.zeros((n, 1)),
            np.zeros((n, 1)),
            self.model.all_multipliers(forces.multiplier.reshape(column)),
            np.zeros((2, 1)),
        )
        tolerance = max(MOTION, self.analysis.tolerance)
        check = ResidualCheck(self.model, trajectory, self.p, [Level.POSITION], tolerance)
        return Motion(
            self.model,
            self.analysis,
            self.p,
            trajectory,
            check.verify(status),
            {"iterations": solution.iterations, "stable": stable, "residual [N or N m]": residual},
            warnings=[
                *instability_warnings(forces.negative if solution.accepted else 0, LEAVES),
                *ignored_contacts(self.model, trajectory, self.p),
                *elastic_warnings(self.model, trajectory, self.p),
            ],
            record=EquilibriumRecord(self.kernel),
        )
