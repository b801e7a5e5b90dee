"""Functions of an equilibrium of a mechanism: Newton step, outputs, stiffness, adjoint."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.static_balance import CURVED, SKEW
from dalembert.analysis.equilibrium.statics_kernel import StaticsKernel, statics_kernel
from dalembert.analysis.live.checks import all_multipliers, check_data, residuals
from dalembert.analysis.live.obstacles import common_obstacle
from dalembert.analysis.live.rows import smooth_rows
from dalembert.analysis.live.small_motions import small_motions
from dalembert.analysis.live.start import closing, violation
from dalembert.analysis.requirements import listed_states
from dalembert.analysis.residual_check import MOTION
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row

NO_EQUILIBRIUM = "no equilibrium was found"
UNSTABLE = "the equilibrium is not stable, so that it is not isolated or not attained"


def obstacle(motion: Motion) -> str:
    """Reason why an equilibrium cannot be repeated outside of Python; empty if it can."""
    model = motion.model
    if not motion.status.success:
        return f"no equilibrium was found ({motion.status.outcome.value})"
    if model.equations.contacts:
        return "the mechanism has rigid contacts"
    if model.equations.slips:
        return "the equilibrium of rolling bodies depends on the path"
    if not motion.statistics["stable"]:
        return UNSTABLE
    return indifferent_obstacle(model) or common_obstacle(motion.analysis, model)


def indifferent_obstacle(model: Model) -> str:
    """Reason why states that an equilibrium leaves at their start cannot be followed, or ""."""
    kernel, starts = statics_kernel(model), model.closure.recipe.states
    indifferent = [k for k in model.equations.states if k not in kernel.states]
    p, place = model.equations.p, starts.guesses.place
    moving = [k for k in indifferent if k in starts.steady or ca.depends_on(place[k], p)]
    if not moving:
        return ""
    return f"{listed_states(model, moving)} keep values at the start that parameters change"


def equilibrium_functions(motion: Motion, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of an equilibrium.

    The page follows it from the parameters of the result.

    Parameters
    ----------
    motion : the equilibrium, without an ``obstacle``
    rows : outputs
    times : (1,) its instant [s]
    """
    kernel: StaticsKernel = motion.record.kernel
    analysis: Any = motion.analysis
    model, e = motion.model, kernel.equations
    expression, roots = smooth_rows(rows)
    near = kernel.near(motion.trajectory)[:, 0]
    tolerance = max(MOTION, analysis.tolerance)
    data: dict[str, Any] = {
        "kind": "equilibrium",
        "start": float(times[0]),
        "times": times,
        "anchor": {"p": motion.parameters[: e.p.numel()], "y": near},
        "relative": [k for k, row in enumerate(rows) if row.relative],
        "roots": roots,
        "unsolved": NO_EQUILIBRIUM,
        "stable": {
            "curved": CURVED,
            "skew": SKEW,
            "rows": e.constraint_count,
            "columns": e.speed_count,
            "force": model.scales.force,
            "unit": "N",
        },
        "check": check_data(model, [Level.POSITION], tolerance),
    }
    functions = _functions(kernel, expression)
    if not kernel.states:
        return LiveFunctions({**functions, "stiffness": _stiffness(kernel)}, data)
    motions, growth = small_motions(model)
    return LiveFunctions({**functions, **motions}, {**data, **growth})


def following(kernel: StaticsKernel) -> dict[str, ca.Function]:
    """Newton step and residual of an equilibrium ``[y; λ]``.

    ``closing`` is ``(t, x, p) → (x⁺, r)`` as for assembled positions, ``violation`` the residual of
    all constraint equations and of the balance of forces, both relative to their natural sizes.
    ``assembling`` and ``gaps`` are those of the position alone, which name an open joint.
    """
    model, configuration, e = kernel.model, kernel.configuration, kernel.equations
    whole = model.all_equations
    t, near, p = configuration.inputs
    sizes = np.concatenate([e.scales.efforts, e.scales.rows])
    stage, *retraction = configuration.stages
    at_start = [ca.densify(stage.residual), ca.densify(stage.solve(stage.residual))]
    value, correction = ca.substitute(at_start, [stage.unknown], [ca.densify(stage.value)])
    new = stage.value - correction
    position = new[: new.numel() - e.constraint_count]
    for stage_after in retraction:
        (position,) = ca.substitute([stage_after.value], [stage.unknown], [new])
    after = ca.vertcat(position, new[new.numel() - e.constraint_count :])
    rows = whole.scales.rows[: whole.constraints.numel()]
    open_rows = ca.vertcat(kernel.balance / e.scales.efforts, whole.constraints / rows)
    (rest,) = ca.substitute([open_rows], [ca.vertcat(e.y, e.multiplier)], [near])
    return {
        "closing": ca.Function("closing", [t, near, p], [after, value / sizes], {"cse": True}),
        "violation": ca.Function("violation", [t, near, p], [ca.densify(rest)], {"cse": True}),
        "assembling": closing(model.closure),
        "gaps": violation(model.closure),
    }


def _functions(kernel: StaticsKernel, expression: Any) -> dict[str, ca.Function]:
    model, e = kernel.model, kernel.equations
    measured = kernel.measured(expression)
    (at_rest,) = measured.outputs
    t, x = ca.MX.sym("t"), ca.MX.sym("x", e.coordinate_count + e.constraint_count)
    p, weights = ca.MX.sym("p", e.p.numel()), ca.MX.sym("w", at_rest.numel())
    slope = measured.adjoint(t, x, p, weights)[2]
    state, outputs = ca.vertcat(e.y, e.multiplier), ca.densify(at_rest)
    return {
        **following(kernel),
        "outputs": ca.Function("outputs", [e.t, state, e.p], [outputs], {"cse": True}),
        "outputs_adjoint": ca.Function("outputs_adjoint", [t, x, p, weights], [slope]),
        "residuals": residuals(model, _bodies(model)),
    }


def _stiffness(kernel: StaticsKernel) -> ca.Function:
    """``(t, x, p) → C, K`` in natural sizes."""
    e = kernel.equations
    t, p = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel())
    x = ca.MX.sym("x", e.coordinate_count + e.constraint_count)
    multiplier, unit = x[e.coordinate_count :], e.scales.displacements
    _, c, stiffness, _ = kernel.static(t, x[: e.coordinate_count], multiplier, p)
    scaled = [
        ca.mtimes(ca.mtimes(ca.diag(1 / e.scales.rows), c), ca.diag(unit)),
        ca.mtimes(ca.mtimes(ca.diag(unit), stiffness), ca.diag(unit)),
    ]
    return ca.Function("stiffness", [t, x, p], [ca.densify(m) for m in scaled])


def _bodies(model: Model) -> ca.Function:
    """``(t, x, p) → y, v, v̇, λ, work`` at rest."""
    e = model.equations
    t, x = ca.MX.sym("t"), ca.MX.sym("x", e.coordinate_count + e.constraint_count)
    p, still = ca.MX.sym("p", e.p.numel()), ca.MX.zeros(e.speed_count)
    multiplier = all_multipliers(model, x[e.coordinate_count :])
    outputs = [x[: e.coordinate_count], still, still, multiplier, ca.MX.zeros(2)]
    return ca.Function("bodies", [t, x, p], outputs)
