"""Assembly of a mechanism at other parameters, and the consistent start, as functions."""

from __future__ import annotations

import casadi as ca

from dalembert.analysis.live.start import closing
from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.implicit import ImplicitFunction

NO_STATES = ca.SX.sym("none", 0)
"""Argument of the states where a function has none."""


def start_closing(closure: Closure) -> ca.Function:
    """``(t, y, –, p) → (y⁺, r)``: a step of Newton's method towards the assembled position."""
    function = closing(closure)
    t, y, p = (ca.SX.sym(n, function.numel_in(k)) for k, n in enumerate("typ"))
    return ca.Function("closing", [t, y, NO_STATES, p], function.call([t, y, p]))


def start_rows(closure: Closure) -> list[str]:
    """Names of the equations of ``start_closing``."""
    recipe, names = closure.recipe, closure.guesses.speed_names
    joints = [f"{closure.owners[k][0].name}[{closure.owners[k][1]}]" for k in recipe.position_rows]
    conditions = [f"initial condition {k + 1}" for k in range(recipe.position_conditions.numel())]
    return [*joints, *conditions, *(f"initial {names[k]}" for k in recipe.positions.indices)]


def steady_closing(closure: Closure) -> ca.Function | None:
    """``(t, y, –, p) → (y⁺, r)`` towards steady states of first order; None without any."""
    states = closure.recipe.states
    if not states.steady:
        return None
    *before, steady = closure.recipe.initial_state.stages
    e = closure.recipe.equations
    start = closure.recipe.initial_state.inputs[1]
    outputs = [steady.value - steady.solve(steady.residual), steady.residual]
    outputs = ca.substitute(outputs, [steady.unknown], [ca.densify(steady.value)])
    inputs = [e.t, start, e.p]
    root, residual = ImplicitFunction("steady", inputs, before, outputs).function.call(inputs)
    moved = ca.SX(start)
    moved[states.steady] = root
    size = e.scales.coordinates[states.steady] / e.scales.time
    return ca.Function("steady", [e.t, start, NO_STATES, e.p], [moved, residual / size])


def start_of(model: Model, states: ImplicitFunction) -> ImplicitFunction:
    """``(t, y_start, p) → states`` at the start of a model.

    Parameters
    ----------
    states : ``(t, y, v, p)`` of the bodies → states, without stages
    """
    initial = model.initial_state
    t, y, v, p = states.inputs
    old, new = (
        ca.vertcat(t, y, v, p),
        ca.vertcat(initial.inputs[0], *initial.outputs, initial.inputs[2]),
    )
    outputs = ca.substitute([ca.vertcat(*states.outputs)], [old], [ca.densify(new)])
    return ImplicitFunction("start", initial.inputs, initial.stages, outputs)
