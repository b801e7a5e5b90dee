"""Agreement of the end of a motion with another one, at the tolerances that both promise."""

from __future__ import annotations

import numpy as np
from random_strategies import COORDINATES
from registry import FORMULATIONS

import dalembert as da

PRECISE = 1e-5
"""Of the size of the motion: largest difference between runs at tight tolerances."""
USUAL = 1e-3
"""The same for a run with default settings."""
INTEGRATORS = (
    da.DormandPrince(1e-10, 1e-11),
    da.DormandPrince853(1e-10, 1e-11),
    da.Radau(1e-9, 1e-11),
    da.BDF(1e-9, 1e-11),
    da.CVODES(1e-9, 1e-11),
)
COSTLY = ("NullSpace svd", "KKT")
"""Formulations whose graphs are large; taken less often."""


def precise_choices(rng: np.random.Generator) -> dict:
    """Random coordinates, formulation and integrator with tight tolerances."""
    name = str(rng.choice(list(FORMULATIONS)))
    if name in COSTLY and rng.random() < 0.7:
        name = "NullSpace"
    return {
        "coordinates": COORDINATES[rng.integers(len(COORDINATES))],
        "formulation": FORMULATIONS[name],
        "integrator": INTEGRATORS[rng.integers(len(INTEGRATORS))],
    }


def precise_motion(model: da.Model, duration: float, rng: np.random.Generator, tries: int = 20):
    """A motion by random strategies that can work together, and their names.

    Raises
    ------
    DalembertError
        The strategies can work together, and refuse the model.
    """
    for _ in range(tries):
        choices = precise_choices(rng)
        try:
            return da.solve_dynamics(model, duration, outputs=2, **choices), choices
        except da.UnsupportedError:
            continue
    return da.solve_dynamics(model, duration, outputs=2, integrator=INTEGRATORS[1]), {}


def apart(a: np.ndarray, b: np.ndarray, size: np.ndarray | float = 1.0) -> float:
    """Largest difference, relative to the size of the motion and of the numbers."""
    if a.shape != b.shape or not (np.isfinite(a).all() and np.isfinite(b).all()):
        return np.inf
    scale = np.maximum(size, np.maximum(np.abs(a), np.abs(b)).max(initial=0.0))
    return float((np.abs(a - b) / scale).max(initial=0.0))


def last_state(motion) -> tuple[np.ndarray, np.ndarray]:
    """Positions and speeds at the end."""
    return motion.trajectory.y[:, -1], motion.trajectory.v[:, -1]


def difference(first, second) -> float:
    """Of the ends of two motions of a model: positions or speeds, each relative to its size."""
    pairs = zip(last_state(first), last_state(second), strict=True)
    return max(apart(a, b) for a, b in pairs)
