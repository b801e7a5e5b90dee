"""Poisson's law of restitution: a rod that falls on a rough plane (Wang and Mason 1992).

With ``u = (ġ, slip)``, ``G`` the inverse of the inertia at the tip and ``μ`` Coulomb's coefficient,
compression ends at ``P_c``, and ``P_N = (1 + e) P_c``. Where the tip slides all along,
``P_c = −u_N/(G_NN − σ μ G_NT)``; where it sticks before the end of compression,
``P_c = −(G_TT u_N − G_NT u_T)/det G``; it rests on the plane's surface in the end where it sticks.
Newton's law gives the same where slip does not change its way, and energy where it does, as in the
puzzle of Kane (Kane and Levinson 1985): a double pendulum that strikes a floor.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

LENGTH, MASS, NEAR = 1.0, 2.0, 1e-10


def rod(angle: float, speed, spin: float, e: float, mu: float, poisson: bool) -> da.Model:
    """Its lower end touches the floor."""
    system = da.System("rod")
    share = system.parameter("share", e)
    body = system.add(
        planar.Body(
            "rod",
            mass=MASS,
            inertia=MASS * LENGTH**2 / 12,
            position=(0, LENGTH / 2 * np.sin(angle) + NEAR),
            angle=angle,
            velocity=speed,
            angular_velocity=spin,
        )
    )
    tip = body.point(-LENGTH / 2, 0)
    law = {"restitution": share, "friction": mu, "poisson": poisson}
    system.add(planar.UnilateralConstraint("floor", tip.y, tip.velocity[0], **law))
    return system.build()


def inverse_inertia(angle: float) -> np.ndarray:
    """``G`` of the tip, normal direction first."""
    arm = np.array([-np.cos(angle), np.sin(angle)]) * LENGTH / 2  # of (ġ, slip) by the spin
    return np.eye(2) / MASS + np.outer(arm, arm) * 12 / (MASS * LENGTH**2)


def wang_mason(g: np.ndarray, u: np.ndarray, e: float, mu: float) -> np.ndarray:
    """Impulses, where the slip does not turn back."""
    sense = np.sign(u[1])
    pressed = -u[0] / (g[0, 0] - sense * mu * g[0, 1])
    left = u[1] + pressed * (g[0, 1] - sense * mu * g[1, 1])
    if sense * left < 0:  # it sticks before the end of compression
        pressed = -(g[1, 1] * u[0] - g[0, 1] * u[1]) / np.linalg.det(g)
    normal = (1 + e) * pressed
    slides = u[1] + normal * (g[0, 1] - sense * mu * g[1, 1])
    along = -sense * mu * normal
    if sense * slides < 0:
        along = -(u[1] + g[0, 1] * normal) / g[1, 1]
    assert abs(along) <= mu * normal * (1 + 1e-12)  # else it turns back
    return np.array([normal, along])


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("angle", "speed", "mu"),
    [(1.0, (3.0, -1.0), 0.1), (1.2, (0.3, -1.0), 0.9), (1.3, (1.5, -1.0), 0.3)],
)
def test_rod_slides_or_sticks(angle, speed, mu):
    """All along; sticking in compression; sticking in restitution."""
    e, spin, g = 0.7, 0.4, inverse_inertia(angle)
    motion = da.solve_dynamics(rod(angle, speed, spin, e, mu, True), 1e-3, step=1e-4)
    arm = np.array([-np.cos(angle), np.sin(angle)]) * LENGTH / 2
    wanted = wang_mason(g, np.array([speed[1], speed[0]]) + arm * spin, e, mu)
    (impact,) = motion.impacts
    np.testing.assert_allclose([impact.normal, *impact.tangential], wanted, rtol=1e-8, atol=1e-9)
    response = da.final(motion.model["rod.vy"])
    direct = da.sensitivity(motion, response, method="direct").values
    np.testing.assert_allclose(direct, wanted[0] / (1 + e) / MASS, rtol=1e-6)
    np.testing.assert_allclose(
        da.sensitivity(motion, response, method="adjoint").values, direct, rtol=1e-12
    )


def pendulum(mu: float, poisson: bool) -> da.Model:
    """Two rods on a hinge, the lower one touching the floor."""
    angles, rates = np.radians([20, 30]), (-0.1, -0.2)
    system = da.System("double pendulum", gravity=(0, -9.81))
    height = np.cos(angles).sum() + NEAR
    place, speed, rods = np.array([0.0, height]), np.zeros(2), []
    for name, angle, rate in zip(("upper", "lower"), angles, rates, strict=True):
        half = np.array([np.sin(angle), -np.cos(angle)]) / 2
        turning = rate * np.array([-half[1], half[0]])
        rod = planar.Bar(
            name,
            length=1.0,
            mass=1.0,
            position=tuple(place + half),
            angle=angle - np.pi / 2,
            velocity=tuple(speed + turning),
            angular_velocity=rate,
        )
        rods.append(system.add(rod))
        place, speed = place + 2 * half, speed + 2 * turning
    upper, lower = rods
    system.add(planar.Revolute("O", system.ground.point(0, height), upper.start))
    system.add(planar.Revolute("A", upper.end, lower.start))
    tip, law = lower.end, {"restitution": 0.5, "friction": mu, "poisson": poisson}
    system.add(planar.UnilateralConstraint("floor", tip.y, tip.velocity[0], **law))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("mu", [0.3, 0.5, 1.0])
def test_kanes_puzzle(mu):
    """Newton's law creates energy, Poisson's loses some."""
    gained = {}
    for poisson in (False, True):
        motion = da.solve_dynamics(pendulum(mu, poisson), 1e-5, step=1e-6)
        assert len(motion.impacts) == 1
        energy = motion.values("kinetic_energy")
        gained[poisson] = energy[-1] / energy[0] - 1
    assert gained[False] > 0.05 and gained[True] < -0.3


def test_both_laws_agree_without_friction():
    motions = [
        da.solve_dynamics(rod(0.8, (1.0, -1.0), 0.5, 0.6, 0.0, poisson), 1e-3, step=1e-4)
        for poisson in (False, True)
    ]
    impulses = [motion.impacts[0].normal for motion in motions]
    assert impulses[0] == pytest.approx(impulses[1], rel=1e-13)


def balls(*laws: bool) -> da.System:
    system = da.System("balls")
    for k, poisson in enumerate(laws):
        ball = system.add(planar.Particle(f"b{k}", mass=1.0, position=(0, 1)))
        law = {"restitution": 0.5, "poisson": poisson}
        system.add(planar.UnilateralConstraint(f"floor{k}", ball.y, **law))
    return system


def test_laws_are_not_mixed():
    with pytest.raises(da.ModelError, match="floor0: has restitution by Poisson's law and floor1"):
        balls(True, False).build()
    law = {"restitution": 0.5, "tangential_restitution": 0.5, "poisson": True}
    with pytest.raises(da.ModelError, match="Poisson's law has none"):
        planar.UnilateralConstraint("floor", da.t, **law)
