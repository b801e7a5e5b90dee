"""Ball with an eccentric mass centre, spinning and gliding on a rigid table: equations in vectors.

``m s̈ = F − m g ẑ``, ``L̇ = a × F`` with ``a = R (α e − ẑ)`` and ``F = N (ẑ − μ v_A)``; N keeps the
ball on the table, ``ẑ·(s + a) = 0`` (Rauch-Wojciechowski and Rutstam, SIGMA 10, 2014, 017).
"""

from __future__ import annotations

import numpy as np
from numpy.linalg import norm
from scipy.integrate import solve_ivp

R, M, OFFSET, FRICTION, G = 0.02, 0.02, 0.3, 0.3, 9.82
AXIAL, ACROSS = 2 / 5 * M * R**2, 131 / 350 * M * R**2
UP = np.array([0.0, 0.0, 1.0])


def turning(momentum: np.ndarray, axis: np.ndarray) -> np.ndarray:
    """Angular velocity by the angular momentum."""
    return momentum / ACROSS + (1 / AXIAL - 1 / ACROSS) * (momentum @ axis) * axis


def rates(_: float, state: np.ndarray) -> np.ndarray:
    """Of axis, angular momentum about the mass centre, and its horizontal velocity."""
    axis, momentum = state[:3], state[3:6]
    turn = turning(momentum, axis)
    swing, arm = np.cross(turn, axis), R * (OFFSET * axis - UP)
    speed = np.array([*state[6:], -R * OFFSET * swing[2]])
    push = UP - FRICTION * (speed + np.cross(turn, arm))

    def rise(force: float) -> float:  # of the mass centre, for a force of the table
        change = np.cross(arm, push) * force
        along = change @ axis + momentum @ swing
        twist = change / ACROSS + (1 / AXIAL - 1 / ACROSS) * (
            along * axis + (momentum @ axis) * swing
        )
        return float(-R * OFFSET * (np.cross(twist, axis) + np.cross(turn, swing))[2])

    force = (G + rise(0.0)) / (1 / M - (rise(1.0) - rise(0.0)))
    return np.array([*swing, *np.cross(arm, push) * force, *force * push[:2] / M])


def tilts(spin: float, tilt: float, times: np.ndarray) -> np.ndarray:
    """Angle of the axis from the vertical [rad]."""
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    start = np.array([*axis, *AXIAL * spin * axis, 0.0, 0.0])
    run = solve_ivp(
        rates, (0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-8, atol=1e-11
    )
    axes = run.y[:3] / norm(run.y[:3], axis=0)
    return np.arccos(axes[2])
