"""Sliding pendulum: a slider on a spring carries a hanging body.

Source: P. E. Nikravesh, *Planar Multibody Dynamics*, 2nd ed., model SP of the program DAP_BC and
its stored results (ode45, relative tolerance 1e-6); the end state also by an accurate
independent calculation.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

TIMES = [0.5, 1.0, 2.0, 5.0, 10.0]
STORED = np.array(
    [  # x1, φ2, ẋ1, φ̇2
        (0.942381156091584, -0.077957184024802, -0.32901460610873, -1.53870219709629),
        (0.59259620484972, -0.186898494307719, -0.983060222112303, 1.10245521477544),
        (0.181604304603693, -0.36760576748032, 0.320858220527375, -1.20613390339883),
        (0.461389146748891, -0.298663520336292, -0.508863446704441, -1.41000291800763),
        (0.290985380740065, -0.177394633452164, 0.286809855735754, 1.71766036161997),
    ]
)
ACCURATE = np.array([0.29098559552745, -0.17739580965382, 0.28680948821451, 1.7176631355987])


def mechanism() -> da.System:
    system = da.System("sliding-pendulum", gravity=(0.0, -9.81))
    rail = system.ground.point(0.0, 0.2)
    slider = system.add(
        planar.Body("slider", mass=5.0, inertia=4.0, angle=0.0, position=(0.999999405396684, 0.2))
    )
    rod = system.add(planar.Body("rod", mass=2.0, inertia=0.2, angle=0.523601521953373))
    system.add(planar.Prismatic("rail", rail, slider.center))
    system.add(planar.Revolute("pin", slider.center, rod.point(0.0, 0.5)))
    system.add(planar.Spring("spring", rail, slider.center, stiffness=20.0, free_length=0.6))
    return system


def lagrange(time, state):
    """The two equations of Lagrange in x and φ."""
    x, angle, dx, turning = state
    c, s = np.cos(angle), np.sin(angle)
    rates = np.linalg.solve([[7.0, c], [c, 0.7]], [s * turning**2 - 20 * (x - 0.6), -9.81 * s])
    return [dx, turning, *rates]


def test_published_accurate_and_independent_results():
    motion = da.solve_dynamics(
        mechanism().build(), 10.0, integrator=da.DormandPrince(1e-12, 1e-12), outputs=TIMES
    )
    columns = ("slider.x", "rod.angle", "slider.vx", "rod.angular_velocity")
    computed = np.stack([motion[c].values for c in columns], axis=1)
    np.testing.assert_allclose(computed[:, :2], STORED[:, :2], atol=1e-5)
    np.testing.assert_allclose(computed[-1], ACCURATE, atol=1e-8)
    start = [0.999999405396684, 0.523601521953373, 0.0, 0.0]
    own = solve_ivp(lagrange, (0, 10), start, "DOP853", TIMES, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(computed, own.y.T, atol=1e-9)
    np.testing.assert_allclose(computed, STORED, rtol=1e-5, atol=3e-6)
