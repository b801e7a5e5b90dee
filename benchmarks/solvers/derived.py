"""SymPy derives the equation of a pendulum, SciPy integrates it: what a lecture does."""

from __future__ import annotations

import time

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks.mechanism import Mechanism
from benchmarks.solvers.base import Contestant, installed


def contestants(mechanism: Mechanism, duration: float, first: int) -> list[Contestant]:
    """For one body on one hinge in the plane; ``steps`` set the tolerance of order 8."""
    if not installed("sympy") or len(mechanism.bodies) > 1 or not mechanism.planar:
        return []
    rate, length = _derived(mechanism)

    def run(steps: int) -> tuple[float, np.ndarray]:
        begin = time.perf_counter()
        done = solve_ivp(
            lambda t, s: (s[1], rate(s[0], s[1])),
            (0, duration),
            [0.0, 0.0],
            method="DOP853",
            rtol=max(float(steps) ** -4, 3e-14),
            atol=1e-14,
        )
        angle = done.y[0, -1]
        elapsed = time.perf_counter() - begin
        return elapsed, np.array([length * np.cos(angle), length * np.sin(angle), 0.0])

    return [Contestant("SymPy + SciPy", run, first)]


def _derived(mechanism: Mechanism):
    """Angular acceleration of (φ, φ̇) by Lagrange's equation, and the length to the point."""
    import sympy
    from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

    body, (_, place) = mechanism.bodies[0], mechanism.observed
    q = dynamicsymbols("q")
    lever = float(body.position[0])
    spin = q.diff()
    inertia = body.inertia[2] + body.mass * lever**2
    energy = inertia * spin**2 / 2
    height = lever * sympy.sin(q)
    lagrangian = energy + body.mass * mechanism.gravity[1] * height
    method = LagrangesMethod(lagrangian, [q])
    method.form_lagranges_equations()
    forced = (method.mass_matrix.LUsolve(method.forcing))[0]
    angle, speed = sympy.symbols("angle speed")
    return sympy.lambdify((angle, speed), forced.subs({spin: speed, q: angle})), float(place[0])
