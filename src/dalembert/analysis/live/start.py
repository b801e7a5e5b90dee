"""Start of a mechanism for other parameters: assembly by Newton's method, consistent speeds."""

from __future__ import annotations

import casadi as ca

from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.position import newton_step, position_stages


def closing(closure: Closure) -> ca.Function:
    """``(t, y, p) → (y⁺, r)``: a step of Newton's method and the residual before it.

    The equations are those of ``Recipe.position_equations``, whose root is the assembled position;
    ``r`` is relative to their natural sizes.
    """
    recipe = closure.recipe
    e = recipe.equations
    start = ca.SX.sym("y", e.coordinate_count)
    residual, sizes = recipe.position_equations
    if not residual.numel():
        return ca.Function("closing", [e.t, start, e.p], [start, ca.SX.zeros(1)])
    stages = position_stages(recipe.states.at_start, start, residual, sizes)
    return newton_step("closing", [e.t, start, e.p], stages, sizes)


def violation(closure: Closure) -> ca.Function:
    """``(t, y, p) → r`` of all constraint rows, relative to their natural sizes."""
    e = closure.all_equations
    sizes = e.scales.rows[: e.constraints.numel()]
    relative = ca.densify(e.constraints / sizes) if sizes.size else ca.SX.zeros(1)
    return ca.Function("violation", [e.t, e.y, e.p], [relative], {"cse": True})
