"""Functions of modes of a mechanism for other parameters: state, linearisation, derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import statics_kernel
from dalembert.analysis.live.equilibrium_module import (
    NO_EQUILIBRIUM,
    UNSTABLE,
    following,
    indifferent_obstacle,
)
from dalembert.analysis.live.obstacles import common_obstacle, march_obstacle
from dalembert.analysis.live.small_motions import linear_functions
from dalembert.analysis.live.start import closing, violation
from dalembert.analysis.modes.linearization_kernel import LinearizationKernel
from dalembert.analysis.modes.linearized import Linearized
from dalembert.results.live import LiveFunctions
from dalembert.results.mechanism_modes import IMAG, REAL, MechanismModes
from dalembert.results.pictures.mode_scene import swing
from dalembert.results.sources import Row
from dalembert.symbolic.formulas.expression import stack
from dalembert.symbolic.formulas.oscillation import parts


def obstacle(modes: MechanismModes) -> str:
    """Reason why modes cannot be computed outside of Python; empty if they can."""
    state: Linearized = modes.record
    model = state.model
    if not modes.status.success:
        return f"the modes were not computed ({modes.status.outcome.value})"
    if state.origin is None:
        return "the modes are about the end of a motion"
    if not modes.numbers.size:
        return "the mechanism has no modes"
    if not np.array_equal(modes.numbers, np.arange(1, modes.numbers.size + 1)):
        return "the modes are a selection"
    if model.equations.contacts:
        return "the mechanism has rigid contacts"
    if model.equations.slips:
        return "the equilibrium of rolling bodies depends on the path"
    if not state.stable:
        return UNSTABLE
    if not at_rest(state):
        return march_obstacle(modes.analysis, model)
    return indifferent_obstacle(model) or common_obstacle(modes.analysis, model)


def at_rest(state: Linearized) -> bool:
    """Whether a state with an origin is an equilibrium."""
    assert state.near is not None
    whole = state.near.size > state.model.equations.coordinate_count
    return whole or state.origin is not state.kernel.assembled


def modes_functions(modes: MechanismModes, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
    """Functions and constants of modes.

    Parameters
    ----------
    modes : the modes that are repeated, without an ``obstacle``
    rows : outputs, expressions of eigenvalues and parameters; those of pictures are the last ones
    times : (K,) numbers of the modes
    """
    state: Linearized = modes.record
    analysis: Any = modes.analysis
    kernel, model = state.kernel, state.model
    e, origin = model.equations, state.origin
    assert origin is not None and state.near is not None
    rest = at_rest(state)
    start = (
        following(statics_kernel(model))
        if rest
        else {"closing": closing(model.closure), "violation": violation(model.closure)}
    )
    t, p = ca.MX.sym("t"), ca.MX.sym("p", e.p.numel())
    near, weights = ca.MX.sym("near", state.near.size), ca.MX.sym("w", state.x.size)
    small, x, q = state.small_motions, ca.MX.sym("x", state.x.size), ca.MX.sym("q", state.x.size)
    outputs = small.output_sizes
    a, b = ca.MX.sym("a", outputs[0]), ca.MX.sym("b", outputs[1])
    linear, sizes = linear_functions(kernel, origin, small)
    pulled = origin.adjoint(t, near, p, weights)[2]
    slopes = small.adjoint(t, x, p, q, a, b)[1:3]
    shown = [row for row in rows if not row.drawn]
    number, value, bars = ca.SX.sym("number"), ca.vertcat(REAL, IMAG), ca.SX.sym("w", len(shown))
    column = ca.densify(stack(row.sx for row in shown))
    back = [ca.densify(ca.jtimes(column, of, bars, True)) for of in (value, e.p)]
    functions = {
        **start,
        **linear,
        "state_adjoint": ca.Function("state_adjoint", [t, near, p, weights], [pulled]),
        "tangent_adjoint": ca.Function("tangent_adjoint", [t, x, p, q, a, b], list(slopes)),
        "outputs": ca.Function("outputs", [number, value, e.p], [column]),
        "outputs_adjoint": ca.Function("outputs_adjoint", [number, value, e.p, bars], back),
    }
    if len(shown) < len(rows):
        functions["pictures"] = pictures(kernel, rows[len(shown) :])
        functions["curvature"] = kernel.curvature
    anchor = (state.p, state.near) if rest else model.closure.anchor[:2]
    data: dict[str, Any] = {
        "kind": "modes",
        "start": state.time,
        "times": times,
        "anchor": {"p": anchor[0][: e.p.numel()], "y": anchor[1]},
        "relative": [],
        "roots": [],
        **sizes,
        "coordinates": kernel.e.coordinate_count,
        "name": analysis.display_name,
        "count": analysis.count,
    }
    return LiveFunctions(functions, data | ({"unsolved": NO_EQUILIBRIUM} if rest else {}))


def pictures(kernel: LinearizationKernel, rows: Sequence[Row]) -> ca.Function:
    """``(t, y, p, r, i, R, M, I) → rows`` of pictures of an oscillation."""
    e, bodies = kernel.e, kernel.model.all_equations
    column, vectors = stack(row.sx for row in rows), parts(e.coordinate_count)
    still = [ca.SX.zeros(part.numel()) for part in (bodies.v, bodies.a, bodies.transmitted)]
    inputs = [bodies.t, bodies.y, bodies.v, bodies.a, bodies.transmitted, bodies.p]
    formulas = ca.Function("formulas", [*inputs, *swing(kernel.model)], [column])
    rest, *swings = kernel.placing(e.t, e.y, e.p, *vectors)
    value = ca.densify(formulas(e.t, rest, *still, e.p, *swings))
    return ca.Function("pictures", [e.t, e.y, e.p, *vectors], [value], {"cse": True})
