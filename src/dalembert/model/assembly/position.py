"""Positions that equations determine, as stages of an implicit function."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.equations import Equations
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
    """``r(y) = 0``, solved for the displacement from a position nearby; ``e.y`` follows.

    Parameters
    ----------
    near : SX (n_y,) position from which it is counted
    residual : SX of ``e.y`` and of what is unknown beside it, as many as there are displacements
    rows : natural sizes of the residual
    value : SX, the position found; ``near`` itself where that is the root already
    beside, beside_sizes : SX symbols of other unknowns with their natural sizes; their value is
        the last part of ``near``
    """
    beside = ca.SX(0, 1) if beside is None else beside
    columns = np.concatenate([e.scales.displacements, [] if beside_sizes is None else beside_sizes])
    place, rest = near[: e.coordinate_count], near[e.coordinate_count :]
    found = place if value is None else value
    if e.manifold.flat:
        unknown = ca.vertcat(e.y, beside)
        factor = QrFactor(ca.jacobian(residual, unknown), rows, columns)
        start = ca.vertcat(found, rest)
        return [Stage(unknown, residual, start, factor.solve, factor.solve_transposed)]
    delta = ca.SX.sym("delta", e.speed_count)
    unknown, there = ca.vertcat(delta, beside), e.manifold.retract(place, delta)
    moved = ca.substitute(residual, e.y, there)
    factor = QrFactor(ca.jacobian(moved, unknown), rows, columns)
    start = ca.vertcat(e.manifold.displacement(place, found), rest)
    return [
        Stage(unknown, moved, start, factor.solve, factor.solve_transposed),
        Stage(e.y, e.y - there, there, lambda rhs: rhs, lambda rhs: rhs),
    ]
