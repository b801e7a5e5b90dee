"""Corrections of states whose dependent speeds follow from the independent ones."""

from __future__ import annotations

import casadi as ca

from dalembert.formulations.base import Formulation, state_symbols
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.implicit import ImplicitFunction, Solver, Stage


def with_consistent_speeds(
    e: Equations, formulation: Formulation, correction: ImplicitFunction | None
) -> ImplicitFunction | None:
    """``(t, x, p) → x``: the formulation's consistent speeds, then the correction with them.

    If all speeds are states it is the correction itself. Positions are returned to their manifold,
    from which integration drifts.
    """
    if correction is None and not e.manifold.flat:
        settled = ca.vertcat(e.manifold.settled(e.y), state_symbols(e)[e.coordinate_count :])
        correction = ImplicitFunction("settled", [e.t, state_symbols(e), e.p], [], [settled])
    speeds = formulation.consistent_speeds(e)
    if speeds is None:
        return correction
    unknown = speeds.unknown

    def with_speeds(expression: ca.SX) -> ca.SX:
        return ca.substitute(expression, e.v, unknown)

    def with_speeds_in(solve: Solver) -> Solver:
        def solved(rhs: ca.SX) -> ca.SX:
            placeholder = ca.SX.sym("rhs", *rhs.shape)
            return ca.substitute(with_speeds(solve(placeholder)), placeholder, ca.densify(rhs))

        return solved

    stages, outputs = [speeds], [state_symbols(e)]
    if correction is not None:
        outputs = correction.outputs
        stages += [
            Stage(
                stage.unknown,
                with_speeds(stage.residual),
                with_speeds(stage.value),
                with_speeds_in(stage.solve),
                with_speeds_in(stage.solve_transposed),
            )
            for stage in correction.stages
        ]
    inputs = [e.t, state_symbols(e), e.p]
    return ImplicitFunction("consistent", inputs, stages, [with_speeds(out) for out in outputs])
