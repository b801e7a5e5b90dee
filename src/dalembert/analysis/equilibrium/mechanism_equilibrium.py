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
from dalembert.analysis.equilibrium.growth import growth_rates
from dalembert.analysis.equilibrium.neutral_motion import neutral_warnings, unbalanced_text
from dalembert.analysis.equilibrium.stability import equilibrium_text, instability_warnings
from dalembert.analysis.equilibrium.static_balance import (
    Forces,
    StaticBalance,
)
from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel, statics_kernel
from dalembert.analysis.equilibrium.unsettled import refuse_endless, unsettled_text
from dalembert.analysis.requirements import listed_states
from dalembert.analysis.residual_check import MOTION, ResidualCheck
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import sampled_blocks
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.equations.newton import NewtonSettings, solve
from dalembert.text.wording import counted

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
    refuse_endless(kernel, balance.evaluate(y, balance.idle)[0][model.equations.speed_count :])
    iterations = analysis.max_iterations or MAX_ITERATIONS
    settings = NewtonSettings(tolerance=analysis.tolerance, max_iterations=iterations, slack=1.0)
    solution = solve(balance, y, settings)
    if kernel.states and not solution.accepted:
        balance = StaticBalance(kernel, time, p, damped=False)
        solution = solve(balance, y, settings)
    forces, n = balance.residual(solution.x), model.equations.speed_count
    residual = float(np.abs(forces.value).max(initial=0.0)) / model.scales.length
    if kernel.states:
        growing = np.zeros(0)
        if solution.accepted:
            growing = growth_rates(model, time, solution.x[None], p[None])
            growing = growing[growing > 0]
        stable = solution.accepted and not growing.size
        text = equilibrium_text(residual, solution.iterations, stable)
    else:
        growing = np.zeros(0)
        stable = bool(np.all(forces.resistance > 0)) if forces.conservative else forces.stable
        text = equilibrium_text(residual, solution.iterations, stable, forces.conservative)
    outcome = Outcome.COMPLETED if solution.accepted else Outcome.NOT_CONVERGED
    if not solution.accepted:
        text += unsettled_text(kernel) or unbalanced_text(model, forces)
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
            *(_stability_warnings(model, forces, growing) if solution.accepted else []),
            *indifferent_states(model, kernel),
            *ignored_contacts(model, trajectory, p),
            *elastic_warnings(model, trajectory, p),
        ],
        record=EquilibriumRecord(kernel),
    )


def indifferent_states(model: Model, kernel: StaticsKernel) -> list[str]:
    """Warning about states of first order that any position at rest leaves as they are."""
    states = [k for k in model.equations.states if k not in kernel.states]
    if not states:
        return []
    return [
        f"{listed_states(model, states)} keep their values at the start: every value is "
        "steady at rest, such as that of bristles"
    ]


def _stability_warnings(model: Model, forces: Forces, growing: np.ndarray) -> list[str]:
    """Warnings about growing motions, or directions of negative stiffness and of none."""
    if growing.size:
        advice = "Stepper.state_space" if sampled_blocks(model) else "linearize"
        return [
            f"the equilibrium is not stable: {counted(growing.size, 'motion')} of the bodies and "
            f"states grow with rates up to {growing.max():.3g} 1/s; see {advice}"
        ]
    if statics_kernel(model).states:
        return []
    return [*instability_warnings(forces.negative, LEAVES), *neutral_warnings(model, forces)]
