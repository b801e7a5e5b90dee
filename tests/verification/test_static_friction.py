"""Static friction above the friction of sliding contacts.

A block on an incline breaks away at ``tan α = μ_s``, then accelerates by ``g (sin α − μ cos α)``.
A mass ``m`` on a belt of speed ``w``, tied by a spring ``k`` to the ground, sticks until ``k x =
μ_s m g``, then oscillates about ``x = μ m g/k`` until its speed is ``w`` again.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import ModelError

G, STATIC, SLIDING = 9.81, 0.5, 0.3
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


@functools.cache
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


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("share", [0.7, 0.999, 1.001, 1.3])
def test_break_away_by_static_friction_and_acceleration_by_the_other(scheme, share):
    angle = np.arctan(share * STATIC)
    motion = da.solve_nonsmooth(block(angle), 0.3, step=1e-3, integrator=scheme)
    speed = 0.0 if share < 1 else G * (np.sin(angle) - SLIDING * np.cos(angle)) * 0.3
    assert motion.status.success
    assert motion["block.vx"][-1].item() == pytest.approx(speed, abs=1e-9)
    assert motion["block.angle"][-1].item() == pytest.approx(0.0, abs=1e-9)


@pytest.mark.thorough
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


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("direction", [-1, 1])
@pytest.mark.parametrize("step", [1e-2, 5e-3, 2e-3])
def test_a_block_that_slides_uphill_rests_where_it_stops(scheme, direction, step):
    """At ``v²/(2 g (sin α + μ cos α))``, for both directions and all places within a step."""
    angle, speed = 0.35, 1.5  # tan α is between both coefficients
    model = block(-direction * angle, speed=direction * speed)
    motion = da.solve_nonsmooth(model, 0.8, step=step, integrator=scheme)
    deceleration = G * (np.sin(angle) + SLIDING * np.cos(angle))
    path = direction * motion["block.x"][-1].item()
    assert path == pytest.approx(speed**2 / 2 / deceleration, abs=deceleration * step**2 / 2)
    assert motion["block.vx"][-1].item() == pytest.approx(0.0, abs=1e-9)


MASS, STIFFNESS, BELT = 1.0, 100.0, 0.1


@functools.cache
def mass_on_a_belt() -> da.Model:
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
    static = system.parameter("static", STATIC)
    law = {"friction": system.parameter("friction", SLIDING), "static_friction": static}
    system.add(planar.Collisions("contact", shapes, **law))
    return system.build()


def belt(step: float, scheme, duration: float = 1.5) -> da.Motion:
    return da.solve_nonsmooth(mass_on_a_belt(), duration, step=step, integrator=scheme)


def piecewise(times: np.ndarray, friction=SLIDING, static=STATIC) -> np.ndarray:
    """Positions of the mass by exact pieces of sticking and slipping."""
    omega, middle = np.sqrt(STIFFNESS / MASS), friction * MASS * G / STIFFNESS
    x, t, places = 0.0, 0.0, np.empty_like(times)
    while t < times[-1]:
        sticks = (static * MASS * G / STIFFNESS - x) / BELT
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


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", sampled(SCHEMES, 2))
def test_stick_slip_oscillator(scheme):
    errors = []
    for step in (8e-3, 1e-3):
        motion = belt(step, scheme)
        assert motion.status.success
        exact = piecewise(motion.time)
        errors.append(abs(motion["mass.x"].values - exact).max() / exact.max())
    assert errors[1] < 0.005
    assert errors[1] < 0.3 * errors[0]  # first order


@pytest.mark.thorough
def test_gradients_before_break_away():
    angle, scheme = np.arctan(0.9 * STATIC), da.MoreauJean()
    motion = da.solve_nonsmooth(block(angle, "Circle", 0.2), 0.1, step=1e-3, integrator=scheme)
    slope = da.sensitivity(motion, da.final("block.vx")).item()
    assert slope == pytest.approx(-G * np.cos(angle) * 0.1, rel=1e-7)


@pytest.mark.thorough
@pytest.mark.parametrize("duration", [0.65, 1.5])
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradients_of_the_stick_slip_oscillator(scheme, duration):
    """Before and after it sticks again, and beyond the next time that it breaks away."""
    exact = [
        (piecewise(*up) - piecewise(*down))[-1] / 2e-6
        for up, down in (
            [(np.array([0.0, duration]), SLIDING + s, STATIC) for s in (1e-6, -1e-6)],
            [(np.array([0.0, duration]), SLIDING, STATIC + s) for s in (1e-6, -1e-6)],
        )
    ]
    errors = []
    arguments = da.final("mass.x"), ["friction", "static"]
    for step in (8e-3, 2e-3):
        motion = belt(step, scheme, duration)
        direct = da.sensitivity(motion, *arguments, method="direct")
        if not errors:
            adjoint = da.sensitivity(motion, *arguments, method="adjoint")
            np.testing.assert_allclose(adjoint.values, direct.values, rtol=1e-8)
        errors.append(abs(direct.values.ravel() - exact).max() / np.abs(exact).max())
    assert errors[1] < 0.02
    assert errors[1] < 0.5 * errors[0]
    assert any("break away" in note for note in direct.attrs["notes"])


@pytest.mark.thorough
def test_gradient_of_a_break_away_at_the_end_of_a_step():
    """The load is at the limit of static friction at ``t = 0.4905 s``, to the last digits."""
    motion = belt(2.25e-3, da.MoreauJean(), 0.6)
    slopes = da.sensitivity(motion, da.final("mass.x"), ["static"], method="direct")
    ends = [piecewise(np.array([0.0, 0.6]), static=STATIC + s)[-1] for s in (1e-6, -1e-6)]
    assert slopes.item() == pytest.approx((ends[0] - ends[1]) / 2e-6, rel=0.02)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradient_of_a_block_that_a_growing_force_breaks_away(scheme):
    """Both corners at one instant ``t = μ_s m g/c``; ``v = c (T² − t²)/2m − μ g (T − t)``."""
    system = da.System("pulled block", gravity=(0, -G))
    static, pace = system.parameter("static", STATIC), system.parameter("pace", 20.0, "N/s")
    block = system.add(planar.Body("block", mass=2.0, inertia=0.1, position=(0, 0.1)))
    system.add(planar.Force("pull", block.point(0, -0.1), (pace * da.t, 0)))
    shapes = [planar.contact.Rectangle(block, (0.8, 0.2)), planar.contact.HalfPlane(system.ground)]
    law = {"friction": SLIDING, "static_friction": static}
    system.add(planar.Collisions("floor", shapes, **law))
    motion = da.solve_nonsmooth(system.build(), 0.8, step=2e-3, integrator=scheme)
    slopes = da.sensitivity(motion, da.final("block.vx"))
    t, jump = STATIC * 2.0 * G / 20.0, (STATIC - SLIDING) * G
    exact = [-jump * 2.0 * G / 20.0, (0.8**2 - t**2) / 4 + jump * t / 20.0]
    assert slopes.values.ravel() == pytest.approx(exact, rel=5e-3)


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradient_of_a_box_whose_corners_break_away_together(scheme):
    """Four contacts, the friction forces of which may balance each other; ``t = μ_s m g/c``."""
    system, end = da.System("pulled box", gravity=(0, 0, -G)), 0.5
    static, pace = system.parameter("static", 0.6), system.parameter("pace", 20.0, "N/s")
    box = system.add(spatial.Box("box", size=(0.4, 0.4, 0.1), mass=1.0, position=(0, 0, 0.05)))
    system.add(spatial.Force("pull", box.center, (pace * da.t, 0, 0)))
    own = spatial.contact.Box(box.center, (0.4, 0.4, 0.1))
    floor = spatial.contact.HalfSpace(system.ground.frame())
    law = {"friction": SLIDING, "static_friction": static}
    system.add(spatial.Collisions("floor", [own, floor], **law))
    motion = da.solve_nonsmooth(system.build(), end, step=1e-3, integrator=scheme)
    slopes = da.sensitivity(motion, da.final("box.x"), method="direct")
    t, jump = 0.6 * G / 20.0, (0.6 - SLIDING) * G * (end - 0.6 * G / 20.0)
    exact = [-jump * G / 20.0, (end**3 - t**3) / 6 - t**2 / 2 * (end - t) + jump * t / 20.0]
    assert slopes.values.ravel() == pytest.approx(exact, rel=3e-3)
    adjoint = da.sensitivity(motion, da.final("box.x"), method="adjoint")
    assert adjoint.values == pytest.approx(slopes.values, rel=1e-9)


LADDER = {"floor": 0.30, "wall": 0.25, "on floor": 0.2, "on wall": 0.15, "pace": 80.0}
LENGTH, LADDER_MASS, SLOPE = 2.0, 10.0, np.radians(65)


def ladder_at(angle: float, rate: float, load: float, floor: float, wall: float) -> float:
    """Angular acceleration of a sliding ladder between floor and wall, with a load at its top."""
    c, s, half, inertia = np.cos(angle), np.sin(angle), LENGTH / 2, LADDER_MASS * LENGTH**2 / 12
    rows = [
        [-LADDER_MASS * half * s, floor, -1],
        [LADDER_MASS * half * c, -1, -wall],
        [-inertia, -half * (c - s * floor), half * (c * wall + s)],
    ]
    spin = LADDER_MASS * half * rate**2
    right = [spin * c, spin * s - LADDER_MASS * G - load, half * c * load]
    return float(np.linalg.solve(rows, right)[0])


def ladder_foot(values: dict[str, float]) -> float:
    """Place of the foot after one second of a load that grows evenly."""
    limit = values["floor"], values["wall"]
    moving, pace = (values["on floor"], values["on wall"]), values["pace"]
    begin = brentq(lambda t: ladder_at(SLOPE, 0.0, pace * t, *limit), 0.0, 1.0)
    fall = solve_ivp(
        lambda t, y: [y[1], ladder_at(y[0], y[1], pace * t, *moving)],
        *((begin, 1.0), [SLOPE, 0.0]),
        rtol=1e-11,
        atol=1e-12,
    )
    return LENGTH * float(np.cos(fall.y[0, -1]))


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
def test_gradients_of_a_ladder_that_slips_by_unequal_amounts(scheme):
    """Foot and top break away together; forces between floor and wall are not unique before."""
    system = da.System("ladder", gravity=(0, -G))
    values = {name: system.parameter(name.replace(" ", "_"), v) for name, v in LADDER.items()}
    place = (LENGTH / 2 * np.cos(SLOPE), LENGTH / 2 * np.sin(SLOPE))
    bar = planar.Bar("bar", length=LENGTH, mass=LADDER_MASS, position=place, angle=np.pi - SLOPE)
    system.add(bar)
    system.add(planar.Force("load", bar.end, (0, -values["pace"] * da.t)))
    for name, point, normal in (("floor", bar.start, (0, 1)), ("wall", bar.end, (1, 0))):
        side = planar.contact.HalfPlane(system.ground.center, normal)
        law = {"friction": values[f"on {name}"], "static_friction": values[name]}
        system.add(planar.Collisions(name, [planar.contact.Vertex(point), side], **law))
    motion = da.solve_nonsmooth(system.build(), 1.0, step=1e-3, integrator=scheme)
    slopes = da.sensitivity(motion, da.final("bar.start.x"))
    exact = []
    for name, value in LADDER.items():
        ends = [ladder_foot({**LADDER, name: value * (1 + s)}) for s in (1e-5, -1e-5)]
        exact.append((ends[0] - ends[1]) / (2e-5 * value))
    assert motion["bar.start.x"][-1].item() == pytest.approx(ladder_foot(LADDER), abs=1e-3)
    assert slopes.values.ravel() == pytest.approx(exact, rel=3e-3)


def test_static_friction_is_not_below_friction():
    system = da.System("wrong")
    circle = planar.contact.Circle(system.add(planar.Body("b", mass=1.0, inertia=1.0)), 0.1)
    law = {"friction": 0.3, "static_friction": 0.2}
    system.add(planar.Collisions("floor", [circle], **law))
    with pytest.raises(ModelError, match=r"static_friction is 0\.2; it must not be below friction"):
        system.build()
