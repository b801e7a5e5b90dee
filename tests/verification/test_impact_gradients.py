"""Gradients through impacts, in closed form.

Two discs: of equal discs that collide without loss the struck one goes on as the other came, so
``x2(T) = x1 + v T`` and no derivative with respect to ``x2`` is left. Derivatives of (1, 0, 1, 0)
were asked for, and missed by a time-stepping scheme, in nimblephysics issue 97.

Ball: Ma, Gowda, Anantharaman, Laughman, Shah and Rackauckas 2021, "A comparison of automatic
differentiation and continuous sensitivity analysis for derivatives of differential equation
solutions", with its data; the motion between bounces is a parabola.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

INTEGRATORS = [(da.RK4(), 0.01), (da.DormandPrince(), None)]


@pytest.mark.few(1)
@pytest.mark.parametrize(("integrator", "step"), INTEGRATORS)
def test_discs(integrator, step):
    system = da.System("discs")
    x1, x2, v, u = (
        system.parameter(name, value)
        for name, value in (("x1", 0.0), ("x2", 0.52), ("v1", 1.0), ("v2", 0.0))
    )
    a = system.add(planar.Particle("a", mass=1.0, position=(x1, 0), velocity=(v, 0)))
    b = system.add(planar.Particle("b", mass=1.0, position=(x2, 0), velocity=(u, 0)))
    apart = da.sqrt((b.x - a.x) ** 2 + (b.y - a.y) ** 2) - 0.2
    system.add(planar.UnilateralConstraint("discs", apart, restitution=1.0))
    model = system.build()
    motion = da.solve_dynamics(model, 1.0, step=step, integrator=integrator)
    assert motion.impacts[0].time == pytest.approx(0.32, abs=1e-14)
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(motion, da.final(model["b.x"]), method=method).values
        np.testing.assert_allclose(gradient, [[1, 0, 1, 0]], atol=1e-13)


TIME = 1.9


def bounced(z, v, g, e):
    """Height and speed after one bounce, and the time of it."""
    impact = (v + np.sqrt(v**2 + 2 * g * z)) / g
    up, left = e * np.sqrt(v**2 + 2 * g * z), TIME - impact
    return np.array([up * left - g * left**2 / 2, up - g * left])


def complex_step(k):
    values = np.array([5.0, -0.1, 10.0, 0.8], dtype=complex)
    values[k] += 1e-30j
    return bounced(*values).imag / 1e-30


@pytest.mark.few(1)
@pytest.mark.parametrize(("integrator", "step"), INTEGRATORS)
def test_ball(integrator, step):
    system = da.System("ball")
    z, v, g, e = (
        system.parameter(name, value)
        for name, value in (("z0", 5.0), ("v0", -0.1), ("g", 10.0), ("restitution", 0.8))
    )
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, z), velocity=(0, v)))
    system.add(planar.Force("weight", ball.center, (0, -g)))
    system.add(planar.UnilateralConstraint("floor", ball.y, restitution=e))
    model = system.build()
    motion = da.solve_dynamics(model, TIME, step=step, integrator=integrator)
    computed = [motion.values(name)[-1] for name in ("ball.y", "ball.vy")]
    np.testing.assert_allclose(computed, [3.1399189570, -1.0991000225], atol=6e-11)
    np.testing.assert_allclose(computed, bounced(5.0, -0.1, 10.0, 0.8), rtol=1e-12)
    published = [
        [0.8378281129, 0.1015317211, -0.1039068435, 9.0999549761],
        [1.7999100067, 0.9820008999, -1.0000449966, 10.0004999875],
    ]
    exact = np.transpose([complex_step(k) for k in range(4)])
    np.testing.assert_allclose(exact, published, atol=6e-11)
    responses = [da.final(model[name]) for name in ("ball.y", "ball.vy")]
    for method in ("direct", "adjoint"):
        computed = da.sensitivity(motion, responses, method=method).values
        np.testing.assert_allclose(computed, exact, rtol=1e-11)
