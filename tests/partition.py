"""A model's motion in independent speeds, by partitioning its constraint matrix (6.4)."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
from registry import model_of
from spatial_twins import moved

from dalembert.model.graph.equations import Equations
from dalembert.model.graph.transformation import Transformation, speeds_by_partition


def independent_speeds(name: str) -> list[int]:
    """Speeds that can be independent at the start: the others carry the largest pivots."""
    model = model_of(name)
    e = model.equations
    jacobian = ca.Function("C", [e.t, e.y, e.p], [ca.densify(e.jacobian)])
    c = jacobian(0.0, model.start.y, model.nominal).full()
    dependent: list[int] = []
    for _ in range(e.constraint_count):
        size = np.linalg.norm(c, axis=0)
        size[list(e.massless)] *= 1e3  # a speed without mass is never independent
        k = int(np.argmax(size))
        dependent.append(k)
        along = c[:, k] / np.linalg.norm(c[:, k])
        c = c - np.outer(along, along @ c)
    return [k for k in range(e.speed_count) if k not in dependent]


@functools.cache
def partition(name: str) -> tuple[Equations, Transformation]:
    e = model_of(name).equations
    return e, speeds_by_partition(e, independent_speeds(name))


def general_state(e: Equations, seed: int, name: str) -> tuple:
    """``t, y, v, p`` near the start that satisfy nothing in particular."""
    model, rng = model_of(name), np.random.default_rng(seed)
    y = moved(model, model.start.y, 0.05 * rng.standard_normal(model.start.v.size))
    return 0.13, y, rng.standard_normal(e.speed_count), model.nominal


def evaluated(e: Equations, outputs: list, state) -> list[np.ndarray]:
    """Expressions of ``t, y, v, p`` at a state."""
    function = ca.Function("law", [e.t, e.y, e.v, e.p], [ca.densify(out) for out in outputs])
    return [out.full() for out in function.call(state)]
