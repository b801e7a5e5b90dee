"""Position equations as stages of an implicit function."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.implicit import Stage


def position_stages(
    e: Equations,
    near: ca.SX,
    residual: ca.SX,
    rows: np.ndarray,
    value: ca.SX | None = None,
    beside: ca.SX | None = None,
    beside_sizes: np.ndarray | None = None,
) -> list[Stage]:
    """``r(y) = 0``, solved for the displacement from a nearby position; ``e.y`` follows.

    Parameters
    ----------
    near : SX (n_y,) reference position of the displacement
    residual : SX of ``e.y`` and of additional unknowns, as many as displacements and unknowns
    rows : natural sizes of the residual
    value : SX, the root; ``near`` by default
    beside, beside_sizes : SX symbols of additional unknowns with their natural sizes; their value
        is the last part of ``near``
    """
    beside = ca.SX(0, 1) if beside is None else beside
    columns = np.concatenate([e.scales.displacements, [] if beside_sizes is None else beside_sizes])
    place, rest = near[: e.coordinate_count], near[e.coordinate_count :]
    root = place if value is None else value
    if e.manifold.flat:
        unknown = ca.vertcat(e.y, beside)
        factor = QrFactor(ca.jacobian(residual, unknown), rows, columns)
        start = ca.vertcat(root, rest)
        return [Stage(unknown, residual, start, factor.solve, factor.solve_transposed)]
    delta = ca.SX.sym("delta", e.speed_count)
    unknown, there = ca.vertcat(delta, beside), e.manifold.retract(place, delta)
    residual_at = ca.substitute(residual, e.y, there)
    factor = QrFactor(ca.jacobian(residual_at, unknown), rows, columns)
    start = ca.vertcat(e.manifold.displacement(place, root), rest)
    return [
        Stage(unknown, residual_at, start, factor.solve, factor.solve_transposed),
        Stage(e.y, e.y - there, there, lambda rhs: rhs, lambda rhs: rhs),
    ]


def newton_step(
    name: str, inputs: list[ca.SX], stages: list[Stage], sizes: np.ndarray
) -> ca.Function:
    """``inputs → (y⁺, r)``: a step of Newton's method from the value of position stages.

    Parameters
    ----------
    inputs : SX symbols of the stages
    stages : of ``position_stages``
    sizes : natural sizes of the residual; ``r`` is the residual before the step relative to them
    """
    stage, *retraction = stages
    at_start = [ca.densify(stage.residual), ca.densify(stage.solve(stage.residual))]
    residual, correction = ca.substitute(at_start, [stage.unknown], [ca.densify(stage.value)])
    new = stage.value - correction
    for stage_after in retraction:
        (new,) = ca.substitute([stage_after.value], [stage.unknown], [new])
    return ca.Function(name, inputs, [ca.densify(new), residual / sizes], {"cse": True})
