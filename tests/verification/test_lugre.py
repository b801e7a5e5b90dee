"""LuGre friction against what its equations say in closed form (Canudas de Wit et al. 1995).

Pushed below the limit, the block goes ``−μ/σ0 ln(1 − T/(μ N))`` and stays (Dahl); it slides on
with ``N (g(u) + σ2 u)``; let go, it slides ``v²/(2 μ g)``, v less what bends the bristles first.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

kit = planar.contact
G, ROUGH, DEPTH = 9.81, 0.3, 1e-5
STIFF = da.Radau(rtol=1e-8, atol=1e-10)


def block(friction, push=0.0, speed: float = 0.0, weight: float = G) -> da.Model:
    """A block of 1 kg that its weight presses on the floor, at its depth in equilibrium."""
    system = da.System("block", gravity=(0.0, -weight))
    mu = system.parameter("mu", ROUGH)
    force = system.parameter("force", 1.0)
    start = {"position": (0.0, -DEPTH), "velocity": (speed, 0.0)}
    element = system.add(planar.Particle("block", mass=1.0, **start))
    system.add(planar.Force("push", element.center, (force * push, 0.0)))
    law = kit.KelvinVoigt(stiffness=weight / DEPTH, damping=500.0)
    ends = kit.HalfPlane(system.ground.point(0, 0)), element.center
    system.add(planar.Contact("floor", *ends, law=law, friction=friction(mu)))
    return system.build()


def test_it_sticks_below_the_limit():
    """The block stays for good where the bristles hold it, and does not creep."""
    pushed = 0.8 * ROUGH * G
    slowly = pushed * (1 - da.exp(-9 * da.t))
    model = block(lambda mu: kit.LuGre(mu, stiffness=1e5, damping=30.0), slowly)
    places = []
    for duration in (5.0, 50.0):
        motion = da.solve_dynamics(model, duration, integrator=STIFF)
        assert motion["floor.friction_force"].values[-1] == pytest.approx(-pushed, rel=1e-6)
        assert abs(motion["block.vx"].values[-1]) < 1e-9
        places.append(float(motion["block.x"].values[-1]))
    bent = -ROUGH / 1e5 * math.log(1 - 0.8)  # of bristles that slip on the way, after Dahl
    assert places[0] == pytest.approx(bent, rel=0.01)
    assert places[1] == pytest.approx(places[0], abs=1e-3 * bent)


def test_it_slides_by_the_curve_of_stribeck():
    """Dragged by a stiff damper at 5 mm/s, with static friction above dynamic."""
    speed, held, fallen, viscous = 5e-3, 0.45, 1e-2, 0.7
    system = da.System("dragged", gravity=(0.0, -G))
    particle = planar.Particle("block", mass=1.0, position=(0, -DEPTH), velocity=(speed, 0))
    element = system.add(particle)
    system.add(planar.Force("drag", element.center, (2e3 * (speed - element.vx), 0)))
    law = kit.KelvinVoigt(stiffness=G / DEPTH, damping=500.0)
    friction = kit.LuGre(ROUGH, held, damping=1.0, viscous=viscous, stribeck_speed=fallen)
    ends = kit.HalfPlane(system.ground.point(0, 0)), element.center
    system.add(planar.Contact("floor", *ends, law=law, friction=friction))
    motion = da.solve_dynamics(system.build(), 0.5, integrator=STIFF)
    u, rubbed = (float(motion[name].values[-1]) for name in ("block.vx", "floor.friction_force"))
    curve = ROUGH + (held - ROUGH) * math.exp(-((u / fallen) ** 2)) + viscous * u
    assert rubbed == pytest.approx(-G * curve, rel=1e-5)  # |u| is smooth over 1e-6 v_s


@pytest.mark.parametrize("space", [2, 3])
def test_it_comes_to_rest(space):
    """After v²/(2 μ g), in any direction, and stays there."""
    if space == 2:
        model = block(lambda mu: kit.LuGre(mu, stiffness=1e5, damping=50.0), speed=1.0)
    else:
        system = da.System("block", gravity=(0, 0, -G))
        start = {"position": (0, 0, -DEPTH), "velocity": (0.6, 0.8, 0)}
        element = system.add(spatial.Particle("block", mass=1.0, **start))
        law = kit.KelvinVoigt(stiffness=G / DEPTH, damping=500.0)
        friction = kit.LuGre(ROUGH, stiffness=1e5, damping=50.0)
        ends = spatial.contact.HalfSpace(system.ground.frame()), element.center
        system.add(spatial.Contact("floor", *ends, law=law, friction=friction))
        model = system.build()
    motion = da.solve_dynamics(model, 0.6, integrator=STIFF)
    gone = float(np.hypot(motion["block.x"], motion["block.y"] if space == 3 else 0.0)[-1])
    begun = 1 - 50.0 * G * ROUGH / 1e5  # bristles that bend from nothing take σ1 N z
    assert gone == pytest.approx(begun**2 / (2 * ROUGH * G), abs=1e-5)
    assert abs(motion["block.vx"].values[-1]) < 1e-6


@pytest.mark.thorough
def test_gradients_through_sticking_and_sliding():
    model = block(lambda mu: kit.LuGre(mu, damping=0.3), 1.3 * ROUGH * G * da.sin(2 * da.t))
    integrator = da.DormandPrince853(rtol=1e-10, atol=1e-12)
    motion = da.solve_dynamics(model, 1.5, integrator=integrator)
    responses = [da.final("block.x"), da.final("block.vx")]
    direct, adjoint = (
        da.sensitivity(motion, responses, method=m).values for m in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=0, atol=1e-11)
    for k, name in enumerate(("mu", "force")):
        value = float(model.parameters[name].value)
        ends = []
        for by in (1e-6, -1e-6):
            moved = {name: value * (1 + by)}
            run = da.solve_dynamics(model, 1.5, integrator=integrator, parameters=moved)
            ends.append([run["block.x"].values[-1], run["block.vx"].values[-1]])
        slope = (np.array(ends[0]) - ends[1]) / (2e-6 * value)
        np.testing.assert_allclose(direct[:, k], slope, rtol=0, atol=1e-4 * abs(slope).max())


def test_joint_coordinates_carry_the_bristles():
    model = block(lambda mu: kit.LuGre(mu), push=2.0)
    one, other = (
        da.solve_dynamics(model, 0.1, integrator=STIFF, coordinates=c)
        for c in (da.AbsoluteCoordinates(), da.JointCoordinates())
    )
    assert other["block.x"].values[-1] == pytest.approx(one["block.x"].values[-1], abs=1e-9)
