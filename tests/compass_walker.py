"""Compass biped in two angles: a step of its return map by SciPy, without contact forces.

Leans of the leg on the ground and of the leg in the air, forwards from the vertical (Goswami,
Thuilot and Espiau 1996, equations of motion and conservation of angular momentum at the strike).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

LEG, MASS, HIP, G = 1.0, 5.0, 10.0, 9.81


def rates(_: float, state: np.ndarray, low: float) -> np.ndarray:
    """Leans and their rates; ``low`` is the height of a leg's mass above its foot."""
    s, n, ds, dn = state
    high, turn = LEG - low, s - n
    coupling = -MASS * LEG * high * math.cos(turn)
    inertia = [
        [(HIP + MASS) * LEG**2 + MASS * low**2, coupling],
        [coupling, MASS * high**2],
    ]
    gyro = MASS * LEG * high * math.sin(turn)
    weight = (HIP * LEG + MASS * low + MASS * LEG) * G * math.sin(s)
    force = [gyro * dn**2 + weight, -gyro * ds**2 - MASS * high * G * math.sin(n)]
    return np.array([ds, dn, *np.linalg.solve(inertia, force)])


def strike(state: np.ndarray, low: float) -> np.ndarray:
    """Angular momentum about the new foot, and of the old leg about the hip, is conserved."""
    s, n, ds, dn = state
    high, c = LEG - low, math.cos(s - n)
    after = [
        [
            (HIP + MASS) * LEG**2 + MASS * low**2 - MASS * LEG * high * c,
            MASS * high**2 - MASS * LEG * high * c,
        ],
        [-MASS * LEG * high * c, MASS * high**2],
    ]
    before = [
        [(HIP * LEG**2 + 2 * MASS * low * LEG) * c - MASS * low * high, -MASS * low * high],
        [-MASS * low * high, 0.0],
    ]
    return np.array([n, s, *np.linalg.solve(after, np.array(before) @ (ds, dn))])


def step(state, slope: float, low: float) -> tuple[np.ndarray, float, float]:
    """State after the next strike, duration and length of the step."""

    def height(time: float, state: np.ndarray, low: float) -> float:  # of the foot, once past
        past = math.sin(state[1]) < math.sin(state[0])
        return math.cos(state[0] - slope) - math.cos(state[1] - slope) if past else 1.0

    height.terminal, height.direction = True, -1
    run = solve_ivp(
        rates, (0, 3), state, method="DOP853", args=(low,), events=height, rtol=1e-12, atol=1e-12
    )
    s, n = run.y[:2, -1]
    return (
        strike(run.y[:, -1], low),
        run.t[-1],
        LEG * math.hypot(math.sin(s) - math.sin(n), math.cos(s) - math.cos(n)),
    )


def start(half: float, stance: float, swing: float, slope: float) -> np.ndarray:
    """Both feet on the slope, the leg in the air behind."""
    return np.array([slope - half, slope + half, stance, swing])


def errors(unknown, slope: float, low: float) -> np.ndarray:
    """Of a periodic gait; zero for half angle and rates at its start."""
    after, _, _ = step(start(*unknown, slope), slope, low)
    return after[[1, 2, 3]] - (slope + unknown[0], *unknown[1:])


def gait(slope: float, low: float, guess) -> tuple[np.ndarray, float, float]:
    """Half angle and rates of the periodic gait, period and step."""
    unknown = fsolve(errors, guess, args=(slope, low), xtol=1e-12)
    _, period, length = step(start(*unknown, slope), slope, low)
    return unknown, period, length
