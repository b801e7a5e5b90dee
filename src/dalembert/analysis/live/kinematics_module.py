"""Functions of a driven mechanism for other parameters: start, steps, outputs, adjoints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.kinematics.kernel import KinematicsKernel
from dalembert.analysis.kinematics.run import (
    LARGEST_TURN,
    REGULAR,
    SMALL_TURN,
    SMALLEST_FRACTION,
    TOLERANCE,
)
from dalembert.analysis.live.checks import all_multipliers, check_data, residuals
from dalembert.analysis.live.obstacles import march_obstacle
from dalembert.analysis.live.rows import smooth_rows
from dalembert.analysis.live.start import closing, violation
from dalembert.analysis.residual_check import MOTION
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row
from dalembert.symbolic.formulas.expression import Expression


def obstacle(motion: Motion) -> str:
    """Reason why a driven motion cannot be repeated outside of Python; empty if it can."""
    model = motion.model
    if not motion.status.success:
        return f"the motion was not completed ({motion.status.outcome.value})"
    if any(event.name == "branch point" for event in motion.events):
        return "the motion passes a branch point"
    if model.equations.contacts:
        return "the mechanism has rigid contacts"
    return march_obstacle(motion.analysis, model)


def kinematics_functions(motion: Motion, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of a driven motion, with forces if its analysis has them.

    Parameters
    ----------
    motion : the motion that is repeated, without an ``obstacle``
    rows : outputs; without forces those of reactions have no value
    times : (K,) their times [s]
    """
    kernel: KinematicsKernel = motion.record.kernel
    model, path = motion.model, np.union1d(motion.record.path.t, times)
    forces = bool(getattr(motion.analysis, "efforts", False))
    e = model.equations
    expression, roots = smooth_rows(rows)
    column = e.without_dropped(expression.sx)
    width = kernel.single.numel_in(0)
    x = ca.SX.sym("x", width)
    parts = ca.vertsplit(x[: width - 3], _ends(kernel))
    at_state = ca.substitute([column], [e.y, e.v, e.a, e.multiplier], parts)
    measured = kernel.measured(expression)
    t, p, state = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel()), ca.MX.sym("x", width)
    weights = ca.MX.sym("w", len(rows))
    slope = measured.adjoint(t, state[: e.coordinate_count], p, weights)[2]
    functions = {
        "closing": closing(model.closure),
        "violation": violation(model.closure),
        "step": _step(kernel),
        "outputs": ca.Function("outputs", [e.t, x, e.p], [ca.densify(at_state[0])], {"cse": True}),
        "outputs_adjoint": ca.Function("outputs_adjoint", [t, state, p, weights], [slope]),
        "residuals": residuals(model, _bodies(kernel, model, forces)),
    }
    work = [(k, *row.work) for k, row in enumerate(rows) if forces and any(row.work)]
    if work:
        functions |= _powers(kernel, x, parts)
    unknown = [
        k
        for k, row in enumerate(rows)
        if not forces and (any(row.work) or ca.depends_on(row.sx, e.multiplier))
    ]
    anchor_p, anchor_y = model.closure.anchor[:2]
    data: dict[str, Any] = {
        "kind": "kinematics",
        "start": float(path[0]),
        "times": times,
        "path": path,
        "places": np.searchsorted(path, times),
        "anchor": {"p": anchor_p, "y": anchor_y},
        "relative": [k for k, row in enumerate(rows) if row.relative],
        "roots": roots,
        "undetermined": unknown,
        "work": work,
        "limits": {
            "regular": REGULAR,
            "tolerance": TOLERANCE,
            "turn": LARGEST_TURN,
            "small": SMALL_TURN,
            "fraction": SMALLEST_FRACTION,
        },
        "check": check_data(model, Level, MOTION if forces else None),
    }
    return LiveFunctions(functions, data)


def _ends(kernel: KinematicsKernel) -> list[int]:
    """Ends of the parts ``y, v, v̇, λ`` of a column."""
    e = kernel.e
    sizes = [0, e.coordinate_count, e.speed_count, e.speed_count, e.constraint_count]
    return [int(end) for end in np.cumsum(sizes)]


def _step(kernel: KinematicsKernel) -> ca.Function:
    """A step with the largest displacement in it, in natural sizes."""
    e, single = kernel.e, kernel.single
    before, t, h, p = (ca.MX.sym(n, single.numel_in(k)) for k, n in enumerate("xthp"))
    after = single(before, t, h, p)
    y, z = ca.SX.sym("y", e.coordinate_count), ca.SX.sym("z", e.coordinate_count)
    lead = e.manifold.displacement(y, z) / e.scales.displacements
    moved = ca.Function("moved", [y, z], [ca.densify(ca.norm_inf(lead))])
    n = e.coordinate_count
    return ca.Function("step", [before, t, h, p], [after, moved(before[:n], after[:n])])


def _powers(kernel: KinematicsKernel, column: ca.SX, parts: list[ca.SX]) -> dict[str, ca.Function]:
    """Dissipated and input power of a column, and the adjoint by the parameters."""
    e = kernel.e
    (powers,) = ca.substitute([e.powers], [e.y, e.v, e.a, e.multiplier], parts)
    t, p = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel())
    x, weights = ca.MX.sym("x", column.numel()), ca.MX.sym("w", 2)
    measured = kernel.measured(Expression(e.powers))
    slope = measured.adjoint(t, x[: e.coordinate_count], p, weights)[2]
    inputs, outputs = [e.t, column, e.p], [ca.densify(powers)]
    return {
        "powers": ca.Function("powers", inputs, outputs, {"cse": True}),
        "powers_adjoint": ca.Function("powers_adjoint", [t, x, p, weights], [slope]),
    }


def _bodies(kernel: KinematicsKernel, model: Model, forces: bool) -> ca.Function:
    """``(t, x, p) → y, v, v̇, λ, work`` of all bodies and equations."""
    e, single = kernel.e, kernel.single
    t, x, p = ca.MX.sym("t"), ca.MX.sym("x", single.numel_in(0)), ca.MX.sym("p", e.p.numel())
    *state, multiplier = ca.vertsplit(x[: single.numel_in(0) - 3], _ends(kernel))
    whole = all_multipliers(model, multiplier if forces else ca.MX.zeros(multiplier.numel()))
    return ca.Function("bodies", [t, x, p], [*state, whole, ca.MX.zeros(2)])
