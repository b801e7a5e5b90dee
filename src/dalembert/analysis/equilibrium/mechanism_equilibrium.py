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
from dalembert.analysis.equilibrium.neutral_motion import neutral_warnings, unbalanced_text
from dalembert.analysis.equilibrium.stability import equilibrium_text, instability_warnings
from dalembert.analysis.equilibrium.static_balance import (
    Forces,
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
from dalembert.symbolic.equations.newton import NewtonSettings, solve

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


def mechanism_equilibrium(
    analysis: Any, model: Model, p: np.ndarray, start: np.ndarray | None = None
) -> Motion:
    """The equilibrium near the assembled position, or near the pose ``start``.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    """
    kernel, time = statics_kernel(model), analysis.time
    balance, y = StaticBalance(kernel, time, p), model.assemble(p, time).y
    if start is not None:
        moved = balance.onto_constraints(start)
        y = y if moved is None else moved
    iterations = analysis.max_iterations or MAX_ITERATIONS
    settings = NewtonSettings(tolerance=analysis.tolerance, max_iterations=iterations, slack=1.0)
    solution = solve(balance, y, settings)
    forces, n = balance.residual(solution.x), model.equations.speed_count
    residual = float(np.abs(forces.value).max(initial=0.0)) / model.scales.length
    stable = bool(np.all(forces.resistance > 0)) if forces.conservative else forces.stable
    text = equilibrium_text(residual, solution.iterations, stable, forces.conservative)
    outcome = Outcome.COMPLETED if solution.accepted else Outcome.NOT_CONVERGED
    if not solution.accepted:
        text += unbalanced_text(model, forces)
    column = (-1, 1)
    trajectory = Trajectory(
        np.array([time]),
        solution.x.reshape(column),
        np.zeros((n, 1)),
        np.zeros((n, 1)),
        model.all_multipliers(forces.multiplier.reshape(column)),
        np.zeros((2, 1)),
    )
    tolerance = max(MOTION, analysis.tolerance)
    check = ResidualCheck(model, trajectory, p, [Level.POSITION], tolerance)
    return Motion(
        model,
        analysis,
        p,
        trajectory,
        check.verify(Status(outcome, text, time, solution.residual)),
        {"iterations": solution.iterations, "stable": stable, "residual [N or N m]": residual},
        warnings=[
            *(_stability_warnings(model, forces) if solution.accepted else []),
            *ignored_contacts(model, trajectory, p),
            *elastic_warnings(model, trajectory, p),
        ],
        record=EquilibriumRecord(kernel),
    )


def _stability_warnings(model: Model, forces: Forces) -> list[str]:
    """Warnings about directions of negative stiffness and of none."""
    return [*instability_warnings(forces.negative, LEAVES), *neutral_warnings(model, forces)]
