"""Springs and stops that explicit steps are too long for, told before a run.

An element with stiffness k and damping c along a coordinate s moves the mass ``1 / (∇s W ∇sᵀ)``, W
the inverse of M on the motions that C permits. Alone it swings by ``s̈ + (c/m) ṡ + (k/m) s = 0``; a
step of length h multiplies that by ``R(hz)``, z a root. One-sided elements count as touching.
"""

from __future__ import annotations

import math

import casadi as ca
import numpy as np

from dalembert.elements.base import Powers
from dalembert.elements.coordinates import rate_of
from dalembert.integrators.base import Integrator
from dalembert.model.assembly.assembled_state import AssembledState
from dalembert.model.model import Model
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.formulas.expression import free_symbols, stack
from dalembert.symbolic.once import once

SMALL = 200
"""Equations up to which a dense solve is faster."""
ALLOWED = math.log(100.0)
"""Growth of a disturbance during a run, as a logarithm, that nobody is warned of."""


def too_long_for(
    model: Model,
    state: AssembledState,
    p: np.ndarray,
    integrator: Integrator,
    step: float,
    duration: float,
) -> list[str]:
    """The spring or stop that blows up fastest with these steps, if one does."""
    if integrator.stability is None or integrator.implicit or integrator.adaptive:
        return []
    names, swings = _swings(model, state, p)

    def growth(swing: np.ndarray, h: float) -> float:
        roots = np.roots([1.0, *swing]).astype(complex)
        most = float(np.max(np.abs(integrator.stability(h * roots))))  # type: ignore[misc]
        return duration / h * math.log(max(most, 1e-300))

    found = [growth(swing, step) for swing in swings]
    if not found or not max(found) > ALLOWED:
        return []
    worst = int(np.argmax(found))
    low, high = 0.0, step
    for _ in range(60):
        middle = (low + high) / 2
        low, high = (middle, high) if growth(swings[worst], middle) <= ALLOWED else (low, middle)
    rate = np.sqrt(swings[worst][1])
    return [
        f"{names[worst]} alone swings at {rate:.3g} rad/s: {integrator.name} with steps of "
        f"{step:g} s multiplies that by {math.exp(min(found[worst], 700.0)):.2g} during the run; "
        f"use steps below {low:.3g} s, or an implicit integrator such as Radau()"
    ]


def _swings(model: Model, state: AssembledState, p: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Names, and ``(c/m, k/m)`` of every elastic element at a state."""
    names, function = _elastic(model)
    nothing: list[str] = []
    if function is None:
        return nothing, np.zeros((0, 2))
    found = function(0.0, state.y, state.v, p)
    slopes, both = found[0].full(), found[1].full()
    pushed = np.zeros((found[2].shape[0], slopes.shape[0]))
    pushed[: slopes.shape[1]] = slopes.T
    try:
        moved = _solved(found[2], pushed)[: slopes.shape[1]]
    except np.linalg.LinAlgError:  # singular: the run will say why
        return nothing, np.zeros((0, 2))
    both = both * np.sum(slopes * moved.T, axis=1)[:, None]
    good = np.isfinite(both).all(axis=1) & (both[:, 1] > 0)
    return [name for name, ok in zip(names, good, strict=True) if ok], both[good]


def _solved(matrix: ca.DM, rhs: np.ndarray) -> np.ndarray:
    if rhs.shape[0] <= SMALL:
        return np.linalg.solve(matrix.full(), rhs)
    return general_factors(matrix.sparse()).solve(rhs)


def _components(powers: Powers) -> Powers:
    """Each velocity with its effort."""
    return [
        pair
        for velocity, effort in powers
        for pair in zip(ca.vertsplit(velocity), ca.vertsplit(effort), strict=True)
    ]


@once
def _elastic(model: Model) -> tuple[list[str], ca.Function | None]:
    """Names of what stores energy; ``(t, y, v, p) → ∇s, [c k], [M Cᵀ; C 0]``."""
    e = model.all_equations
    known, places = free_symbols(ca.vertcat(e.t, e.y, e.v, e.p)), free_symbols(e.y)
    names, slopes, stiffness, damping = [], [], [], []
    for element in model.forces:
        if element.potential() is None:
            continue
        owners = element.parts() or model.coordinates

        def rate(s: ca.SX, owners=owners) -> ca.SX:
            return rate_of(s, owners, e.t)

        for u, q in _components(element.contact_powers(rate, model.scales.energy)):
            u, q = (model.at_ground(x) for x in (u, q))
            if not free_symbols(q) & places:  # as a weight: no derivative has to tell
                continue
            by_place, by_speed = (ca.sparsify(ca.jacobian(q, x)) for x in (e.y, e.v))
            if not by_place.nnz() or free_symbols(ca.vertcat(u, q)) - known:
                continue
            slope = ca.jacobian(u, e.v)
            size = ca.sumsqr(slope)
            names.append(element.name)
            slopes.append(slope)
            stiffness.append(-ca.dot(ca.mtimes(by_place, e.lift), slope) / size)
            damping.append(-ca.dot(by_speed, slope) / size)
    if not names:
        return names, None
    c = model.equations.jacobian
    saddle = ca.blockcat([[e.mass, c.T], [c, ca.SX(c.shape[0], c.shape[0])]])
    outputs = [ca.vertcat(*slopes), ca.horzcat(stack(damping), stack(stiffness)), saddle]
    return names, ca.Function("elastic", [e.t, e.y, e.v, e.p], outputs, {"cse": True})
