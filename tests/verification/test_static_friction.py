"""Static friction above the friction of sliding contacts.

A block on an incline breaks away at ``tan α = μ_s``, then accelerates by ``g (sin α − μ cos α)``.
A mass ``m`` on a belt of speed ``w``, tied by a spring ``k`` to the ground, sticks until ``k x =
μ_s m g``, then oscillates about ``x = μ m g/k`` until its speed is ``w`` again.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.errors import ModelError, UnsupportedError

G, STATIC, SLIDING = 9.81, 0.5, 0.3
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


def block(angle: float, shape: str = "Rectangle", speed: float = 0.0) -> da.Model:
    """A block, or a sliding point, on an incline."""
    system = da.System("block", gravity=(G * np.sin(angle), -G * np.cos(angle)))
    friction = system.parameter("friction", SLIDING)
    start = {"position": (0, 0.1), "velocity": (speed, 0)}
    if shape == "Rectangle":
        body = system.add(planar.Body("block", mass=2.0, inertia=0.1, **start))
        own = planar.contact.Rectangle(body, (0.8, 0.2))
    else:
        own = planar.contact.Circle(system.add(planar.Particle("block", mass=2.0, **start)), 0.1)
    floor = planar.contact.HalfPlane(system.ground)
    law = {"friction": friction, "static_friction": STATIC}
    system.add(planar.Collisions("floor", [own, floor], **law))
    return system.build()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("share", [0.7, 0.999, 1.001, 1.3])
def test_break_away_by_static_friction_and_acceleration_by_the_other(scheme, share):
    angle = np.arctan(share * STATIC)
    motion = da.solve_nonsmooth(block(angle), 0.3, step=1e-3, integrator=scheme)
    speed = 0.0 if share < 1 else G * (np.sin(angle) - SLIDING * np.cos(angle)) * 0.3
    assert motion.status.success
    assert motion["block.vx"][-1].item() == pytest.approx(speed, abs=1e-9)
    assert motion["block.angle"][-1].item() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_sliding_block_keeps_sliding_until_it_stops(scheme):
    """Between both angles it remains at rest, and remains in motion until it stops."""
    angle = np.arctan(0.4)
    deceleration = -G * (np.sin(angle) - SLIDING * np.cos(angle))
    assert deceleration < 0  # downhill it accelerates
    motion = da.solve_nonsmooth(block(angle, speed=0.1), 0.3, step=1e-3, integrator=scheme)
    assert motion["block.vx"][-1].item() == pytest.approx(0.1 - deceleration * 0.3, abs=1e-9)
    motion = da.solve_nonsmooth(block(angle, speed=-0.5), 0.3, step=1e-3, integrator=scheme)
    stops = 0.5 / (G * (np.sin(angle) + SLIDING * np.cos(angle)))
    assert stops < 0.2
    assert motion["block.vx"][-1].item() == pytest.approx(0.0, abs=1e-9)  # uphill, it stops
    assert motion["block.x"][-1].item() == pytest.approx(-0.5 * stops / 2, abs=0.5 * 1e-3)


MASS, STIFFNESS, BELT = 1.0, 100.0, 0.1


def belt(step: float, scheme) -> da.Motion:
    """A mass on a belt, tied to the ground."""
    system = da.System("stick-slip", gravity=(0, -G))
    carrier = system.add(planar.Body("belt", mass=1.0, inertia=1.0, velocity=(BELT, 0)))
    rail = system.add(planar.Prismatic("rail", system.ground.point(0, 0), carrier.center))
    system.add(planar.TranslationalDriver("drive", rail, law=BELT * da.t))
    start = {"position": (0.0, 0.0), "velocity": (BELT, 0.0)}
    mass = system.add(planar.Particle("mass", mass=MASS, **start))
    anchor = system.ground.point(-1.0, 0.0)
    spring = {"stiffness": STIFFNESS, "free_length": 1.0}
    system.add(planar.Spring("spring", anchor, mass.center, **spring))
    shapes = [planar.contact.Vertex(mass.center), planar.contact.HalfPlane(carrier.center)]
    friction = system.parameter("friction", SLIDING)
    law = {"friction": friction, "static_friction": STATIC}
    system.add(planar.Collisions("contact", shapes, **law))
    return da.solve_nonsmooth(system.build(), 3.0, step=step, integrator=scheme)


def piecewise(times: np.ndarray) -> np.ndarray:
    """Positions of the mass by exact pieces of sticking and slipping."""
    omega, middle = np.sqrt(STIFFNESS / MASS), SLIDING * MASS * G / STIFFNESS
    x, t, places = 0.0, 0.0, np.empty_like(times)
    while t < times[-1]:
        sticks = (STATIC * MASS * G / STIFFNESS - x) / BELT
        part = (times >= t) & (times <= t + sticks)
        places[part] = x + BELT * (times[part] - t)
        x, t = x + BELT * sticks, t + sticks
        # x = middle + a cos ωτ + b sin ωτ until the speed is that of the belt again
        a, b = x - middle, BELT / omega
        slips = (2 * np.pi - 2 * np.arctan2(a, b)) / omega
        part, tau = (times >= t) & (times <= t + slips), omega * (times - t)
        places[part] = (middle + a * np.cos(tau) + b * np.sin(tau))[part]
        x, t = middle - a, t + slips
    return places


@pytest.mark.parametrize("scheme", SCHEMES)
def test_stick_slip_oscillator(scheme):
    errors = []
    for step in (8e-3, 1e-3):
        motion = belt(step, scheme)
        assert motion.status.success
        exact = piecewise(motion.time)
        errors.append(abs(motion["mass.x"].values - exact).max() / exact.max())
    assert errors[1] < 0.005
    assert errors[1] < 0.3 * errors[0]  # first order


def test_gradients_refuse_break_away():
    angle, scheme = np.arctan(0.9 * STATIC), da.MoreauJean()
    motion = da.solve_nonsmooth(block(angle, "Circle", 0.2), 0.1, step=1e-3, integrator=scheme)
    slope = da.sensitivity(motion, da.final("block.vx")).item()
    assert slope == pytest.approx(-G * np.cos(angle) * 0.1, rel=1e-7)
    motion = belt(4e-3, scheme)
    with pytest.raises(UnsupportedError, match="with static friction breaks away at t = 0"):
        da.sensitivity(motion, da.final("mass.x"))


def test_static_friction_is_not_below_friction():
    system = da.System("wrong")
    circle = planar.contact.Circle(system.add(planar.Body("b", mass=1.0, inertia=1.0)), 0.1)
    law = {"friction": 0.3, "static_friction": 0.2}
    system.add(planar.Collisions("floor", [circle], **law))
    with pytest.raises(ModelError, match=r"static_friction is 0\.2; it must not be below friction"):
        system.build()
