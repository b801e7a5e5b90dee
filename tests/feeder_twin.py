"""Part on a vibrating trough by SciPy: one phase after the other, ended by events.

Along and normal to the trough, relative to it, with the trough's acceleration ``−A ω² sin ωt``:

    ẍ = A ω² cos ψ sin ωt − g sin β + T/m,   ÿ = A ω² sin ψ sin ωt − g cos β + N/m.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

SLOPE, AMPLITUDE, RATE, FRICTION, G = math.radians(4), 1e-3, 50 * math.pi, 0.4, 9.81
REST = 1e-10
"""Speeds below this one are zero [m/s]."""


def way(line: float, end: float) -> tuple[float, int]:
    """Way along the trough from rest on it, and the number of landings."""
    along, normal = (AMPLITUDE * RATE**2 * f(line) for f in (math.cos, math.sin))
    down, press = G * math.sin(SLOPE), G * math.cos(SLOPE)

    def free(time: float) -> tuple[float, float]:  # relative acceleration without contact
        shake = math.sin(RATE * time)
        return along * shake - down, normal * shake - press

    def rates(time: float, state: np.ndarray, mode: str) -> list[float]:
        x, y = free(time)
        if mode == "stick":
            return [0.0, 0.0, 0.0, 0.0]
        if mode == "flight":
            return [state[2], state[3], x, y]
        return [state[2], 0.0, x + (1 if mode == "back" else -1) * FRICTION * -y, 0.0]

    def leaves(time: float, state: np.ndarray, mode: str) -> float:
        return -free(time)[1]

    def slips(time: float, state: np.ndarray, mode: str) -> float:
        x, y = free(time)
        return FRICTION * -y - abs(x)

    def stops(time: float, state: np.ndarray, mode: str) -> float:
        return state[2] if mode == "on" else -state[2]

    def lands(time: float, state: np.ndarray, mode: str) -> float:
        return state[1]

    events = {
        "stick": (slips,),
        "on": (stops, leaves),
        "back": (stops, leaves),
        "flight": (lands,),
    }
    for watched in (leaves, slips, stops, lands):
        watched.terminal, watched.direction = True, -1

    def resting(time: float) -> str:  # mode of a part at rest on the trough
        x, y = free(time)
        if y > 0:
            return "flight"
        return "stick" if abs(x) <= FRICTION * -y * (1 + 1e-9) else ("on" if x > 0 else "back")

    time, state, mode, landings = 0.0, np.zeros(4), resting(0.0), 0
    while time < end:
        run = solve_ivp(
            rates,
            (time, end),
            state,
            method="DOP853",
            args=(mode,),
            events=events[mode],
            rtol=1e-11,
            atol=1e-14,
            max_step=5e-4,
        )
        time, state = run.t[-1], run.y[:, -1].copy()
        if time >= end:
            break
        if mode == "flight":
            landings += 1
            stop = FRICTION * -state[3]  # largest change of the slip in a plastic impact
            state[2] = math.copysign(max(abs(state[2]) - stop, 0.0), state[2])
            state[1] = state[3] = 0.0
            sliding = abs(state[2]) > REST
            mode = ("on" if state[2] > 0 else "back") if sliding else resting(time)
        elif len(events[mode]) == 2 and run.t_events[1].size:
            mode = "flight"
        elif mode == "stick":
            mode = "on" if free(time)[0] > 0 else "back"
        else:
            state[2] = 0.0
            mode = resting(time)
    return float(state[0]), landings


def fastest(lines: tuple[float, float], end: float) -> float:
    """Line of vibration of the longest way: zero of the central difference [rad]."""
    h = 1e-3
    return brentq(lambda a: way(a + h, end)[0] - way(a - h, end)[0], *lines, xtol=2e-5)
