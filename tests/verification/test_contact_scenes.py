"""Scenes with contacts and their gradients against closed forms of textbooks.

A box on an accelerating table, a block on a wedge that gives way, a ball that hits a hinged bar, a
row of three balls, a body that leaves a cylinder, a ladder that leaves its wall, a ball with
backspin, a cylinder in a groove, a box that tips or slides (Meriam & Kraige, Dynamics; Goldstein,
Classical Mechanics; Stronge, Impact Mechanics).
"""

from __future__ import annotations

import numpy as np
import pytest
from thorough import sampled

import dalembert as da
from dalembert import planar

contact = planar.contact
G = 9.81
BOTH = [da.AnticipatedImpacts(), da.MoreauJean()]
SCHEMES = pytest.mark.parametrize("scheme", BOTH)
ANTICIPATED = pytest.mark.parametrize("scheme", sampled(BOTH, 2))
MOREAU = pytest.mark.parametrize("scheme", sampled(BOTH[::-1], 2))
"""Of textbook scenes, one scheme in turn runs with every push."""
LAST = {da.AnticipatedImpacts: 5e-3, da.MoreauJean: 0.03}
"""Error of the place of the last contact, whose force vanishes: gaps of ``MoreauJean`` that open by
``h²`` miss contacts before."""
LAWS = pytest.mark.parametrize("law", ["newton", "poisson", "energetic"])


def run(system: da.System, duration: float, step: float, scheme) -> da.Motion:
    motion = da.solve_nonsmooth(system.build(), duration, step=step, integrator=scheme)
    assert motion.status.success
    return motion


def gradient(motion: da.Motion, *names: str) -> np.ndarray:
    """Direct derivatives of final values, equal to the adjoint ones."""
    ends = [da.final(name) for name in names]
    direct = da.sensitivity(motion, ends, method="direct").values
    adjoint = da.sensitivity(motion, ends, method="adjoint").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8, atol=1e-10 * np.abs(direct).max())
    return direct


@pytest.mark.thorough
@MOREAU
def test_box_on_an_accelerating_table(scheme):
    """``v = μ g t`` where the table accelerates by more than ``μ g``."""
    system = da.System("table", gravity=(0, -G))
    friction = system.parameter("friction", 0.3)
    table = system.add(planar.Body("table", mass=5.0, inertia=1.0))
    rail = planar.Prismatic("rail", system.ground.center, table.center, axis=(1, 0))
    system.add(planar.TranslationalDriver("pull", system.add(rail), 2.5 * da.t**2))
    box = planar.Body("box", mass=2.0, inertia=0.1, position=(0.0, 0.1))
    shapes = [contact.Rectangle(system.add(box), (0.3, 0.2)), contact.HalfPlane(table)]
    system.add(planar.Collisions("top", shapes, friction=friction))
    motion = run(system, 0.5, 5e-3, scheme)
    assert motion["box.vx"][-1].item() == pytest.approx(0.3 * G * 0.5, rel=0.015)
    assert motion["box.x"][-1].item() == pytest.approx(0.3 * G * 0.125, rel=0.03)
    np.testing.assert_allclose(gradient(motion, "box.vx")[0], [G * 0.5], rtol=0.02)


@pytest.mark.thorough
@ANTICIPATED
def test_block_on_a_wedge_that_gives_way(scheme):
    """``A = m g sin α cos α/(M + m sin² α)`` without friction."""
    system, alpha, m, big = da.System("wedge", gravity=(0, -G)), 0.5, 1.0, 3.0
    mass = system.parameter("m", m)
    wedge = system.add(planar.Body("wedge", mass=big, inertia=1.0))
    system.add(planar.Prismatic("rail", system.ground.center, wedge.center, axis=(1, 0)))
    block = system.add(planar.Particle("block", mass=mass, position=(0.0, 0.0)))
    normal = (np.sin(alpha), np.cos(alpha))
    shapes = [contact.Vertex(block.center), contact.HalfPlane(wedge, normal=normal)]
    system.add(planar.Collisions("slope", shapes))
    motion = run(system, 0.4, 5e-3, scheme)
    s, c = np.sin(alpha), np.cos(alpha)
    acceleration = m * G * s * c / (big + m * s**2)
    slope = G * s * c * big / (big + m * s**2) ** 2
    assert motion["wedge.vx"][-1].item() == pytest.approx(-acceleration * 0.4, rel=0.015)
    np.testing.assert_allclose(gradient(motion, "wedge.vx")[0], [-slope * 0.4], rtol=0.02)


@pytest.mark.few(1)
@SCHEMES
@LAWS
def test_ball_that_hits_a_hinged_bar(law, scheme):
    """``ω⁺ = (1 + e) m v d/(I + m d²)``, with all laws; no friction, no gravity."""
    system, m, length, place, v = da.System("bar"), 0.5, 1.0, 0.6, 2.0
    e, mass = system.parameter("e", 0.7), system.parameter("m", m)
    bar = planar.Bar("bar", length=length, mass=1.2, angle=-np.pi / 2)
    system.add(bar)
    system.add(planar.Revolute("hinge", system.ground.center, bar.start))
    start = {"position": (-0.15, -place), "velocity": (v, 0.0)}
    ball = system.add(planar.Particle("ball", mass=mass, **start))
    shapes = [contact.Circle(ball.center, 0.05), contact.Capsule(bar.start, bar.end, 0.02)]
    system.add(planar.Collisions("hit", shapes, restitution=e, impact_law=law))
    motion = run(system, 0.06, 1e-3, scheme)
    inertia = 1.2 * length**2 / 3
    whole = inertia + m * place**2
    spin = 1.7 * m * v * place / whole
    slopes = [m * v * place / whole, 1.7 * v * place * inertia / whole**2]
    assert motion["bar.angular_velocity"][-1].item() == pytest.approx(spin, rel=1e-4)
    np.testing.assert_allclose(gradient(motion, "bar.angular_velocity")[0], slopes, rtol=1e-3)


@pytest.mark.few(1)
@SCHEMES
@LAWS
def test_three_balls_in_a_row(law, scheme):
    """``v = (1 − 2 e, 1 + e, 1 + e)/3`` of balls in contact, with all three laws: the second
    contact has an impulse in compression, but no work."""
    system = da.System("row")
    e, shapes = system.parameter("e", 0.6), []
    for k in range(3):
        start = {"position": (0.2 * k, 0.0), "velocity": (1.0 if k == 0 else 0.0, 0.0)}
        ball = system.add(planar.Particle(f"b{k}", mass=1.0, **start))
        shapes.append(contact.Circle(ball.center, 0.1))
    system.add(planar.Collisions("hits", shapes, restitution=e, impact_law=law))
    motion, names = run(system, 1e-3, 1e-3, scheme), [f"b{k}.vx" for k in range(3)]
    speeds = [motion[name][-1].item() for name in names]
    assert speeds == pytest.approx([-0.2 / 3, 1.6 / 3, 1.6 / 3], abs=1e-8)
    np.testing.assert_allclose(gradient(motion, *names)[:, 0], np.array([-2, 1, 1]) / 3, atol=1e-6)


@pytest.mark.thorough
@SCHEMES
def test_body_that_leaves_a_cylinder(scheme):
    """It slides without friction down to ``cos θ = 2/3``."""
    system = da.System("cylinder", gravity=(0, -G))
    radius, small = 1.0, 0.05
    theta = 0.4
    place = ((radius + small) * np.sin(theta), (radius + small) * np.cos(theta))
    body = system.add(planar.Particle("p", mass=1.0, position=place))
    shapes = [contact.Circle(body.center, small), contact.Circle(system.ground.center, radius)]
    system.add(planar.Collisions("surface", shapes))
    motion = run(system, 0.6, 1e-3, scheme)
    last = int(motion.record.step.max()) + 1
    height = motion.record.ends.y[1, last] / (radius + small)
    assert height == pytest.approx(2 / 3 * np.cos(theta), abs=LAST[type(scheme)])


@pytest.mark.thorough
@SCHEMES
def test_ladder_that_leaves_its_wall(scheme):
    """At two thirds of its height (Goldstein)."""
    system, length, start = da.System("ladder", gravity=(0, -G)), 2.0, 1.0
    end = (length / 2 * np.cos(start), length / 2 * np.sin(start))
    ladder = system.add(
        planar.Bar("ladder", length=length, mass=1.0, position=end, angle=np.pi - start)
    )
    tips = [contact.Vertex(ladder.start), contact.Vertex(ladder.end)]
    ground = system.ground
    walls = [contact.HalfPlane(ground), contact.HalfPlane(ground.center, normal=(1.0, 0.0))]
    system.add(planar.Collisions("corner", [*tips, *walls]))
    motion = run(system, 0.55, 1e-3, scheme)
    contacts = np.bincount(motion.record.step, minlength=motion.record.loss.size)
    last = int(np.flatnonzero(contacts == 2)[-1]) + 1
    height = motion.record.ends.y[1, last]
    assert height == pytest.approx(2 / 3 * length / 2 * np.sin(start), rel=LAST[type(scheme)])


@ANTICIPATED
def test_ball_with_backspin_returns(scheme):
    """``v = (v₀ − k r ω₀)/(1 + k)`` once it rolls, ``k`` the squared radius of gyration."""
    system, r, k = da.System("backspin", gravity=(0, -G)), 0.1, 0.4
    speed, spin = system.parameter("speed", 1.0), system.parameter("spin", 60.0)
    ball = planar.Body(
        "ball",
        mass=1.0,
        inertia=k * r**2,
        position=(0, r),
        velocity=(speed, 0.0),
        angular_velocity=spin,
    )
    shapes = [contact.Circle(system.add(ball), r), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.5))
    motion = run(system, 1.5, 2e-3, scheme)
    assert motion["ball.vx"][-1].item() == pytest.approx((1 - k * r * 60) / (1 + k), abs=1e-3)
    exact = [1 / (1 + k), -k * r / (1 + k)]
    np.testing.assert_allclose(gradient(motion, "ball.vx")[0], exact, atol=1e-3)


@MOREAU
def test_cylinder_in_a_groove(scheme):
    """Each face carries ``m g/(2 sin α)``, ``α`` the angle of a face with the vertical."""
    system, alpha, r = da.System("groove", gravity=(0, -G)), 0.6, 0.1
    start = (0.0, r / np.sin(alpha))
    body = system.add(planar.Body("body", mass=3.0, inertia=0.01, position=start))
    faces = [
        contact.HalfPlane(system.ground.center, normal=(s * np.cos(alpha), np.sin(alpha)))
        for s in (-1, 1)
    ]
    system.add(planar.Collisions("faces", [contact.Circle(body, r), *faces]))
    motion = run(system, 0.2, 2e-3, scheme)
    assert abs(motion["body.y"][-1].item() - start[1]) < 1e-4
    forces = np.linalg.norm(motion.contact_forces(0.2).forces, axis=1)
    assert forces == pytest.approx([3 * G / (2 * np.sin(alpha))] * 2, rel=1e-3)


@pytest.mark.few(1)
@SCHEMES
@pytest.mark.parametrize(("tilt", "friction", "tips"), [(0.3, 0.9, False), (0.42, 0.9, True)])
def test_box_tips_or_stands(scheme, tilt, friction, tips):
    """A box of the width 0.2 m and the height 0.5 m tips from ``tan α = 0.4``, ``α = 0.381``."""
    gravity = (G * np.sin(tilt), -G * np.cos(tilt))
    system = da.System("box", gravity=gravity)
    box = planar.Body("box", mass=1.0, inertia=0.29 / 12, position=(0.0, 0.25))
    shapes = [contact.Rectangle(system.add(box), (0.2, 0.5)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("slope", shapes, friction=friction))
    motion = run(system, 0.5, 1e-3, scheme)
    assert (abs(motion["box.angle"][-1].item()) > 0.05) == tips
