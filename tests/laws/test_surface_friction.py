"""Rigid friction over surfaces in space: impacts, the begin of sliding, gradients, what is told."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import dalembert as da
from dalembert import spatial
from dalembert.sensitivity.checks.certificate import certify

G, ROUGH, PULL = 9.81, 0.4, 3.0


@functools.cache
def tumbling(poisson: bool = False) -> da.Model:
    """A box thrown on a rough floor, on which its corners bounce, slide and stick."""
    system = da.System("tumbling", gravity=(0, 0, -G))
    e, spin = system.parameter("restitution", 0.7), system.parameter("spin", 4.0)
    rough = system.parameter("mu", 0.2)
    box = spatial.Body(
        "box",
        mass=1.2,
        inertia=(0.02, 0.03, 0.04),
        position=(0, 0, 0.5),
        velocity=(0.7, 0.3, 0.0),
        rotation=da.rotation.axis_angle((1, 2, 3), 0.7),
        angular_velocity=(spin, 1.0, -2.0),
    )
    system.add(box)
    for k, signs in enumerate(np.ndindex(2, 2, 2)):
        corner = box.point(*((2 * np.array(signs) - 1) * (0.1, 0.15, 0.05)))
        slips = corner.velocity[0], corner.velocity[1]
        law = {"restitution": e, "friction": rough, "poisson": poisson}
        system.add(spatial.UnilateralConstraint(f"c{k}", corner.z, slips, **law))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("poisson", "options"),
    [
        (False, {"integrator": da.DormandPrince(1e-10, 1e-12)}),
        (False, {"step": 0.005}),
        (True, {"integrator": da.Radau(1e-9, 1e-11)}),
    ],
)
def test_impacts_keep_the_cone_and_have_exact_gradients(poisson, options):
    model = tumbling(poisson)
    motion = da.solve_dynamics(model, 1.0, **options)
    assert motion.status.success and not motion.warnings and len(motion.impacts) > 4
    shares = [np.linalg.norm(i.tangential) / i.normal for i in motion.impacts]
    assert max(shares) <= 0.2 * (1 + 1e-9) and min(shares) < 0.19  # some stick
    assert poisson or max(shares) == pytest.approx(0.2, rel=1e-9)  # whose parts differ in direction
    assert np.diff(motion.data["dissipated_energy"]).min() > -1e-12
    assert np.abs(motion.data["balance_error"]).max() < 1e-7
    place = [da.final(model[f"box.{axis}"]) for axis in "xyz"]
    computed = [
        da.sensitivity(motion, place, method=method).values
        for method in ("direct", "adjoint", "finite-difference")
    ]
    np.testing.assert_allclose(computed[0], computed[1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(computed[0], computed[2], rtol=1e-6, atol=1e-8)


def test_newtons_law_holds_for_the_slip_of_every_impact():
    """``ġ⁺ = −e ġ⁻``; what slides goes on against friction, what sticks has no slip after it."""
    motion = da.solve_dynamics(tumbling(), 1.0, integrator=da.DormandPrince(1e-10, 1e-12))
    for impact in motion.impacts:
        before, after = (motion.at(np.array([impact.time + s * 1e-10])) for s in (-1, 1))
        corner = int(impact.name[1])
        local = (2 * np.array(np.unravel_index(corner, (2, 2, 2))) - 1) * (0.1, 0.15, 0.05)
        speeds = []
        for seen in (before, after):
            turn = seen["box.rotation"].values[0].reshape(3, 3)
            spin = seen["box.angular_velocity"].values[0]
            speeds.append(seen["box.velocity"].values[0] + np.cross(spin, turn @ local))
        assert speeds[1][2] == pytest.approx(-0.7 * speeds[0][2], rel=1e-6)
        rubbed, slip = impact.tangential, speeds[1][:2]
        if np.linalg.norm(rubbed) < 0.2 * impact.normal * (1 - 1e-9):
            assert np.linalg.norm(slip) < 1e-7
        else:
            across = rubbed[0] * slip[1] - rubbed[1] * slip[0]
            assert abs(across) < 1e-7 and np.dot(rubbed, slip) < 0


def pushed() -> da.Model:
    """A particle at rest on a rough plane under a force that grows and turns, ``(c t, 6 t²)``."""
    system = da.System("pushed", gravity=(0, 0, -G))
    rough, pull = system.parameter("mu", ROUGH), system.parameter("c", PULL)
    block = system.add(spatial.Particle("block", mass=1.0, position=(0, 0, 0)))
    slips = block.vx, block.vy
    system.add(spatial.UnilateralConstraint("plane", block.z, slips, restitution=0, friction=rough))
    system.add(spatial.Force("push", block.center, (pull * da.t, 6 * da.t**2, 0)))
    return system.build()


def slid(time: float, rough: float = ROUGH, pull: float = PULL) -> tuple[float, np.ndarray]:
    """When it begins to slide, and where it is, by the law itself from just after that."""

    def force(t: float) -> np.ndarray:
        return np.array([pull * t, 6 * t * t])

    most, little = rough * G, 1e-5
    begins = brentq(lambda t: np.hypot(*force(t)) - most, 0.01, 5, xtol=1e-15)
    along, change = force(begins) / most, np.array([pull, 12 * begins])
    across = change - along * (along @ change)
    speed = (change @ along) / 2 * little**2 * (along + across * little / most)
    ends = solve_ivp(
        lambda t, x: np.append(x[2:], force(t) - most * x[2:] / np.hypot(*x[2:])),
        (begins + little, time),
        [*(speed * little / 3), *speed],
        method="Radau",
        rtol=1e-11,
        atol=1e-14,
    )
    return begins, ends.y[:2, -1]


@pytest.mark.thorough
def test_a_slide_begins_in_the_right_direction():
    model, (begins, place) = pushed(), slid(2.0)
    motion = da.solve_dynamics(model, 2.0, integrator=da.DormandPrince(1e-9, 1e-11))
    assert motion.status.success and not motion.warnings
    steps = motion.record.steps
    assert steps.t[steps.h == 0][0] == pytest.approx(begins, rel=1e-12)
    computed = [motion.values(f"block.{axis}")[-1] for axis in "xy"]
    np.testing.assert_allclose(computed, place, atol=2e-8)
    direct = da.sensitivity(motion, [da.final(model["block.x"]), da.final(model["block.y"])])
    h = 1e-4
    by_pull = (slid(2.0, pull=PULL + h)[1] - slid(2.0, pull=PULL - h)[1]) / (2 * h)
    by_friction = (slid(2.0, ROUGH + h)[1] - slid(2.0, ROUGH - h)[1]) / (2 * h)
    np.testing.assert_allclose(direct.values, np.transpose([by_friction, by_pull]), atol=1e-6)


def test_steps_of_given_length_are_warned_of_such_a_begin():
    motion = da.solve_dynamics(pushed(), 1.0, step=0.01)
    assert any("begins to slide over a surface" in text for text in motion.warnings)


@pytest.mark.thorough
def test_gradients_over_a_stop_are_certified():
    system = da.System("stop", gravity=(0, 0, -G))
    rough = system.parameter("mu", 0.3)
    block = system.add(
        spatial.Particle("block", mass=1.0, position=(0, 0, 0), velocity=(0.6, 0.8, 0))
    )
    slips = block.vx, block.vy
    system.add(spatial.UnilateralConstraint("plane", block.z, slips, restitution=0, friction=rough))
    model = system.build()
    motion = da.solve_dynamics(model, 1.0, step=0.02)
    way = 1 / (2 * 0.3 * G)
    assert motion.values("block.x")[-1] == pytest.approx(0.6 * way, rel=1e-12)
    certificate = certify(motion, [da.final(model["block.x"])], [0])
    assert certificate.passed, str(certificate)
