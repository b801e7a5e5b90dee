"""Rigid contacts that stay closed: what they carry, how they begin, and where they are not seen."""

from __future__ import annotations

import numpy as np
import pytest
from rigid_contacts import ball, thrown

import dalembert as da
from dalembert import planar
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.results.status import Outcome

OPTIONS = [
    {"step": 0.01},
    {"integrator": da.DormandPrince()},
    {"integrator": da.Radau()},
    {"integrator": da.BDF(rtol=1e-10, atol=1e-15)},
    {"integrator": da.Newmark(), "step": 0.01},
    {"integrator": da.GeneralizedAlpha(), "step": 0.01, "formulation": da.DAE(2, stabilized=True)},
]
"""Integrators with and without memory; that of the last but one grows with the constraints."""


@pytest.mark.thorough
def test_joints_transmit_what_lasting_contacts_give():
    """Reactions found along the tree of joints are those of the equations of all bodies."""
    options = {"parameters": {"restitution": 0.2}, "integrator": da.DormandPrince(rtol=1e-10)}
    absolute, joints = (
        da.solve_dynamics(thrown(), 1.0, outputs=[0.9, 1.0], coordinates=chosen, **options)
        for chosen in (da.AbsoluteCoordinates(), da.JointCoordinates())
    )
    assert joints.status.success and joints.values("A.normal_force")[-1] > 1
    computed = [motion.values("hinge.force") for motion in (absolute, joints)]
    np.testing.assert_allclose(*computed, atol=1e-5)


PARTITIONED = [
    (da.NullSpace(), da.JointCoordinates()),
    (da.NullSpace("gram-schmidt"), da.AbsoluteCoordinates()),
    (da.VelocityPartitioning(), da.AbsoluteCoordinates()),
]


@pytest.fixture(scope="module")
def settled():
    return da.solve_dynamics(thrown(), 1.0, integrator=da.DormandPrince(rtol=1e-9), **SETTLING)


SETTLING = {"parameters": {"restitution": 0.2}, "outputs": [0.9, 1.0]}


@pytest.mark.thorough
@pytest.mark.parametrize(("formulation", "coordinates"), PARTITIONED, ids=str)
def test_independent_speeds_follow_the_contacts_that_last(formulation, coordinates, settled):
    """Closed gaps are further constraints: fewer speeds are independent, and others may be."""
    options = {"formulation": formulation, "coordinates": coordinates, **SETTLING}
    motion = da.solve_dynamics(thrown(), 1.0, integrator=da.DormandPrince(), **options)
    assert motion.status.success and settled.values("A.normal_force")[-1] > 1
    for name in ("a.x", "b.angle", "A.normal_force", "hinge.force"):
        np.testing.assert_allclose(motion.values(name), settled.values(name), atol=1e-4)


def test_named_independent_speeds_end_where_a_contact_lasts():
    named = da.VelocityPartitioning(independent=("a.x", "a.y", "a.angle", "b.angle"))
    status = da.solve_dynamics(
        thrown(), 1.0, step=0.01, formulation=named, parameters={"restitution": 0.2}
    ).status
    assert not status.success and status.time > 0.2
    assert "closed" in status.message and "independent speeds are needed" in status.message


def test_contact_is_lasting_when_bounces_have_ended():
    """In the end both bars lie on the floor, which carries their weight."""
    motion = da.solve_dynamics(
        thrown(), 2.0, parameters={"restitution": 0.2}, integrator=da.DormandPrince()
    )
    assert motion.status.success
    gaps = np.array([motion.values(f"{name}.gap") for name in "ABC"])
    forces = np.array([motion.values(f"{name}.normal_force") for name in "ABC"])
    assert gaps.min() > -1e-12 and forces.min() > -1e-9
    assert np.abs(gaps[:, -1]).max() < 1e-12
    assert forces[:, -1].sum() == pytest.approx(3 * 9.81, rel=1e-9)
    assert np.abs(forces * gaps).max() < 1e-10  # either apart or pressing


@pytest.mark.product
@pytest.mark.parametrize("options", OPTIONS)
@pytest.mark.parametrize("speed", [-1.0, 0.0, 1.0])
def test_starts_on_the_surface(options, speed):
    """Closing it bounces at once, at rest it begins closed, opening it flies."""
    system = da.System("start", gravity=(0, -9.81))
    v = system.parameter("v", speed)
    particle = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=(0, v)))
    system.add(planar.UnilateralConstraint("floor", particle.y, restitution=0.5))
    motion = da.solve_dynamics(system.build(), 0.1, **options)
    away = max(speed, -0.5 * speed)
    height = away * 0.1 - 9.81 * 0.1**2 / 2 if away else 0.0
    assert motion.values("ball.y")[-1] == pytest.approx(height, abs=1e-14)
    assert [i.time for i in motion.impacts] == ([0.0] if speed < 0 else [])


@pytest.mark.thorough
def test_a_box_settles_on_its_face():
    """Corners whose gaps are differences, where rounding ends the bounces before time does."""
    system = da.System("box", gravity=(0, -9.81))
    e = system.parameter("e_n", 0.6)
    at = {"position": (0, 1.0), "angle": 0.3, "velocity": (1.0, 0)}
    box = system.add(planar.Body("box", mass=1.0, inertia=0.01, **at))
    for k, (x, y) in enumerate(((-0.15, -0.1), (0.15, -0.1), (0.15, 0.1), (-0.15, 0.1))):
        corner = box.point(x, y)
        law = {"restitution": e, "friction": 0.3}
        system.add(planar.UnilateralConstraint(f"c{k}", corner.y, corner.velocity[0], **law))
    motion = da.solve_dynamics(system.build(), 2.0, integrator=da.DormandPrince())
    assert motion.status.success and not motion.warnings
    assert motion.values("box.y")[-1] == pytest.approx(0.1, abs=1e-13)
    assert motion.values("box.vx")[-1] == pytest.approx(0.0, abs=1e-13)
    pressing = sum(motion.values(f"c{k}.normal_force")[-1] for k in range(2))
    assert pressing == pytest.approx(9.81, rel=1e-12)
    assert np.abs(motion.data["balance_error"]).max() < 1e-8


def test_a_belt_that_moves_drags_along():
    system = ball(slip=lambda b: b.vx - 2.0, height=0.0, restitution=0.0, friction=0.5)
    motion = da.solve_dynamics(system.build(), 1.0, step=0.01)
    reached = 2.0 / (0.5 * 9.81)
    assert motion.values("ball.vx")[-1] == pytest.approx(2.0, rel=1e-13)
    assert motion.values("ball.x")[-1] == pytest.approx(2.0 * (1 - reached / 2), rel=1e-12)
    assert np.abs(motion.data["balance_error"]).max() < 1e-12


def test_a_block_tips_where_friction_has_grown():
    """A sliding block tips about its front corner where ``μ(t) = b/h``, b and h its half sides."""
    g, slope, b, h = 9.81, 0.3, 0.1, 0.2
    system = da.System("block", gravity=(g * np.sin(slope), -g * np.cos(slope)))
    growth = system.parameter("growth", 0.4, "1/s")
    block = planar.Body("block", mass=1, inertia=(b * b + h * h) / 3, position=(0, h))
    system.add(block), system.initial(block.vx, 2.0)
    for name, x in (("back", -b), ("front", b)):
        p = block.point(x, -h)
        law = {"restitution": 0.0, "friction": 0.1 + growth * da.t}
        system.add(planar.UnilateralConstraint(name, p.y, p.velocity[0], **law))
    motion = da.solve_dynamics(system.build(), 1.1, integrator=da.DormandPrince())
    tips = motion.at(1.0)
    fast = 2 + g * np.sin(slope) - g * np.cos(slope) * 0.3
    np.testing.assert_allclose(tips.values("block.vx"), fast, rtol=1e-12)
    np.testing.assert_allclose(tips.values("block.angle"), 0, atol=1e-9)
    assert motion.values("block.angle")[-1] < -5e-3
    slope_of = da.sensitivity(motion, da.final("block.vx")).item()
    differences = da.sensitivity(motion, da.final("block.vx"), method="finite-difference").item()
    assert slope_of == pytest.approx(differences, rel=1e-5)


def test_terminal_events_end_runs_with_impacts():
    motion = da.solve_dynamics(
        ball().build(),
        3.0,
        step=0.01,
        events={"carried": da.Event("floor.normal_force - 5", terminal=True)},
    )
    assert motion.status.outcome is Outcome.TERMINATED
    fall = np.sqrt(2 / 9.81)
    assert motion.status.time == pytest.approx(3 * fall, abs=1e-6)


def test_what_a_driver_presses_on_a_rigid_floor_has_no_motion():
    """Without friction none is blamed: the driver leaves nothing to give way."""
    system = ball(height=0.05)
    particle = system.elements["ball"]
    system.add(planar.CoordinateDriver("ram", particle.center, 0.05 - 0.1 * da.t, (0.0, 1.0)))
    status = da.solve_dynamics(system.build(), 1.0, step=0.01).status
    assert status.outcome is Outcome.UNDECIDED
    assert status.time == pytest.approx(0.5, abs=0.01)
    assert "rigid impact has no motion" in status.message and "floor" in status.message
    assert "friction" not in status.message and "Painlev" not in status.message


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.MoreauJean(), da.AnticipatedImpacts()], ids=type)
def test_a_heavy_crate_slides_with_the_light_one_below_it(scheme):
    """A weight of 100 t presses on 1 kg, so that the impulses alone would change its speed by
    kilometres per second. Both decelerate by ``μ g``, and the ground carries both."""
    friction, slid, system = 0.3, 0.2, da.System("heavy on light", gravity=(0, -9.81))
    shapes = [planar.contact.HalfPlane(system.ground.center)]
    for k, mass in enumerate((1.0, 1e5)):
        start = {"position": (0.01 * k, 0.1 + 0.2 * k), "velocity": (1, 0)}
        crate = system.add(planar.Body(f"b{k}", mass=mass, inertia=0.01 * mass, **start))
        shapes.append(planar.contact.Rectangle(crate, (0.3, 0.2)))
    system.add(planar.Collisions("contacts", shapes, friction=friction))
    motion = da.solve_nonsmooth(system.build(), slid, step=2e-3, integrator=scheme)
    assert motion.status.success, motion.status
    expected = 1 - friction * 9.81 * slid
    assert motion["b1.vx"][-1] == pytest.approx(expected, abs=1e-6)
    assert motion["b0.vx"][-1] == pytest.approx(expected, abs=1e-4)
    weight, accuracy = (1 + 1e5) * 9.81, 1e5 * 1e-6 / 2e-3  # residuals of 1e-6 m/s in a step
    force = motion.contact_forces(slid).between("ground", "b0")
    assert force == pytest.approx([-friction * weight, weight], abs=accuracy)


@pytest.mark.parametrize("compiled", [True, False])
def test_a_body_on_others_that_would_fall_with_it_rests_on_them(compiled, monkeypatch):
    """A plate falls on a column of two discs: forces do not change their relative speeds, and those
    of rounding are no impacts."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    system, shapes = da.System("column", gravity=(0, -9.81)), planar.contact
    radius, side = 0.1, 0.2
    sides = [shapes.HalfPlane(system.ground.center)]
    for k in range(2):
        place = {"position": (0, radius * (1 + 2 * k))}
        disc = system.add(planar.Body(f"disc{k}", mass=1.0, inertia=0.005, **place))
        sides.append(shapes.Circle(disc, radius))
    rest = 4 * radius + side / 2
    place = {"position": (0, rest + 0.05)}
    plate = system.add(planar.Body("plate", mass=1.0, inertia=0.01, **place))
    sides.append(shapes.Rectangle(plate, (2 * side, side)))
    system.add(planar.Collisions("hits", sides, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.6, step=0.01)
    assert motion.status.success
    assert abs(motion["plate.y"][-1] - rest) < 1e-6  # 0.95 mm above it if they were
