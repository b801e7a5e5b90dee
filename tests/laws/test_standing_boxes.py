"""Boxes stand, slide and topple; bodies of all shapes neither overlap nor gain energy."""

import numpy as np
import pytest
from rigid_contacts import other_warnings
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration

G = 9.81
contact = planar.contact


def stack(count: int, angle: float = 0.0, friction: float = 0.5, width: float = 0.2) -> da.Model:
    """Boxes on top of each other, on an incline."""
    system, normal = da.System("stack", gravity=(0.0, -G)), (-np.sin(angle), np.cos(angle))
    shapes = [contact.HalfPlane(system.ground.center, normal)]
    for k in range(count):
        place = tuple((0.1 + 0.2 * k) * np.array(normal))
        box = planar.Body(f"b{k}", mass=1.0, inertia=0.01, position=place, angle=angle)
        shapes.append(contact.Rectangle(system.add(box), (width, 0.2)))
    system.add(planar.Collisions("stack", shapes, friction=friction))
    return system.build()


@pytest.mark.parametrize("count", [1, 3])
def test_boxes_stand(count):
    """At rest to rounding, and every face carries what is above it."""
    motion = da.solve_nonsmooth(stack(count), 0.5, step=2e-3)
    assert motion.status.success
    assert np.ptp(motion.trajectory.y, axis=1).max() < 1e-10
    carried = motion.impulse("stack").values[-1]
    assert carried == pytest.approx(G * 2e-3 * count * (count + 1) / 2, rel=1e-7)


@pytest.mark.parametrize("law", ["newton", "poisson"])  # steps in machine code and general ones
def test_slips_by_rounding_lift_no_box(law):
    """Friction that stops the residual slip of a box at rest does work, little beside that of
    lifting a corner whose gap by rounding no longer counts as closed: its contact acts, too."""
    slope = 0.3
    system = da.System("crate", gravity=(G * np.sin(slope), -G * np.cos(slope)))
    start = {"position": (0.0, 0.1), "angle": 1e-11, "velocity": (-1e-9, 0.0)}
    box = system.add(planar.Body("box", mass=1.0, inertia=0.1, **start, angular_velocity=1e-9))
    shapes = [contact.Rectangle(box, (1.0, 0.2)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("ramp", shapes, friction=0.5, impact_law=law))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=2e-3, integrator=da.MoreauJean())
    assert abs(motion.record.ends.v).max() < 2e-9


@pytest.mark.parametrize("law", ["newton", "poisson"])  # steps in machine code and general ones
def test_a_box_that_tips_over_its_corner_is_not_lifted(law):
    """As a pendulum about its corner, ``θ̈ = (F h cos θ + F b sin θ − m g r sin(β − θ))/J``, with
    the error of the midpoint rule; friction that turns with the box supplies 10⁻⁴ of the work of
    lifting it."""
    mass, (width, height), arm = 10.0, (0.4, 0.6), 0.5
    force = 1.1 * mass * G * width / 2 / arm
    system = da.System("tipped", gravity=(0.0, -G))
    inertia = mass * (width**2 + height**2) / 12
    box = planar.Body("box", mass=mass, inertia=inertia, position=(0.0, height / 2))
    system.add(planar.Force("push", system.add(box).point(0.0, arm - height / 2), (force, 0.0)))
    shapes = [contact.Rectangle(box, (width, height)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.9, impact_law=law))
    motion = da.solve_nonsmooth(system.build(), 0.6, step=5e-3, integrator=da.MoreauJean())
    radius, lean = np.hypot(width, height) / 2, np.arctan2(width, height)
    about = inertia + mass * radius**2

    def rates(_, z):
        lever = arm * np.cos(z[0]) + width / 2 * np.sin(z[0])
        return [z[1], (force * lever - mass * G * radius * np.sin(lean - z[0])) / about]

    exact = solve_ivp(rates, (0.0, 0.6), [0.0, 0.0], rtol=1e-10, atol=1e-12).y[0, -1]
    assert abs(motion["box.angle"][-1].item() / -exact - 1) < 5e-4
    assert abs(motion.statistics["work of corrections of positions [J]"]) < 1e-3
    assert abs(np.minimum(motion.record.loss, 0).sum()) < 1e-3


@pytest.mark.thorough
@pytest.mark.parametrize(("axes", "count", "duration"), [(planar, 3, 0.45), (spatial, 5, 1.3)])
def test_stacks_stand_with_moreau_jean(axes, count, duration):
    """Impulses within the tolerance gain no energy that would hide a contact from a step, and edges
    that cross beyond their ends are no contacts."""
    plane = axes is planar
    system = da.System("stack", gravity=(0.0, -G) if plane else (0.0, 0.0, -G))
    ground = system.ground
    floor = contact.HalfPlane(ground) if plane else spatial.contact.HalfSpace(ground.frame())
    shapes = [floor]
    for k in range(count):
        place, own = (0.0, 0.1 + 0.2 * k), {"name": f"b{k}", "mass": k + 1.0}
        if plane:
            box = system.add(planar.Body(**own, inertia=0.01, position=place))
            shapes.append(contact.Rectangle(box, (0.3, 0.2)))
        else:
            inertia = (0.01, 0.02, 0.03)
            box = system.add(spatial.Body(**own, inertia=inertia, position=(0.0, *place)))
            shapes.append(spatial.contact.Box(box.center, (0.3, 0.3, 0.2)))
    system.add(axes.Collisions("stack", shapes, friction=0.5))
    options = {"integrator": da.MoreauJean(), "step": 5e-3}
    motion = da.solve_nonsmooth(system.build(), duration, **options)
    assert motion.status.success
    assert not other_warnings(motion)
    assert np.ptp(motion.trajectory.y, axis=1).max() < 1e-8


@pytest.mark.parametrize("friction", [0.3, 0.55, 0.6])
def test_box_slides_above_the_angle_of_friction(friction):
    angle = np.pi / 6
    motion = da.solve_nonsmooth(stack(1, angle, friction), 0.2, step=2e-3)
    position = motion.data["position"].values[:, 0]
    gone = np.linalg.norm(position[-1] - position[0])
    expected = max(0.0, np.sin(angle) - friction * np.cos(angle)) * G * 0.2**2 / 2
    assert gone == pytest.approx(expected, abs=1e-11)
    assert motion.values("b0.angle")[-1] == pytest.approx(angle, abs=1e-11)


@pytest.mark.parametrize(("width", "topples"), [(0.1, True), (0.13, False)])
def test_slender_box_topples_on_an_incline(width, topples):
    """Where its mass centre is not above its base, ``b/h < tan α``."""
    angle = np.pi / 6
    motion = da.solve_nonsmooth(stack(1, angle, 2.0, width), 0.4, step=2e-3)
    assert (abs(motion.values("b0.angle")[-1] - angle) > 0.1) == topples


def mixture() -> da.Model:
    """Bodies of all planar shapes that fall into a box."""
    rng, system = np.random.default_rng(5), da.System("mixture", gravity=(0.0, -G))
    corners = system.ground.point(-0.3, 0.0), system.ground.point(0.3, 0.0)
    shapes = [
        contact.HalfPlane(corners[0], (0.0, 1.0)),
        contact.HalfPlane(corners[0], (1.0, 0.0)),
        contact.HalfPlane(corners[1], (-1.0, 0.0)),
    ]
    for k in range(9):
        body = planar.Body(
            f"b{k}",
            mass=1.0,
            inertia=2e-3,
            position=(-0.18 + 0.18 * (k % 3), 0.1 + 0.17 * (k // 3)),
            angle=rng.uniform(0, 2 * np.pi),
            velocity=tuple(0.5 * rng.normal(size=2)),
            angular_velocity=3 * rng.normal(),
        )
        system.add(body)
        triangle = [(-0.06, -0.04), (0.06, -0.04), (0.0, 0.08)]
        kinds = [
            contact.Circle(body, 0.06),
            contact.Capsule(body.point(-0.04, 0.0), body.point(0.04, 0.0), 0.03),
            contact.Rectangle(body, (0.12, 0.08)),
            contact.Polygon(body, triangle),
        ]
        shapes.append(kinds[k % 4])
    system.add(planar.Collisions("all", shapes, restitution=0.3, friction=0.3))
    return system.build()


@pytest.fixture(scope="module")
def fallen() -> da.Motion:
    return da.solve_nonsmooth(mixture(), 0.6, step=2e-3)


def test_bodies_of_all_shapes_do_not_overlap(fallen):
    assert fallen.status.success
    source, p = gap_sources(fallen.model)[0], fallen.model.nominal
    none = np.zeros((fallen.model.equations.speed_count, 1))
    deepest = min(
        source.near(Configuration(0.0, y, p), none).distance.min(initial=0.0)
        for y in fallen.trajectory.y.T
    )
    assert deepest > -1e-9


def test_energy_is_never_gained(fallen):
    """At no step, also where a corner is over a turning face; what is lost is accounted for."""
    energy = fallen.data["energy"].values
    assert fallen.statistics["maximum energy gained in contacts [J]"] <= 1e-12 * energy[0]
    assert np.diff(energy).max() <= 1e-10 * energy[0]
    assert np.abs(fallen.data["balance_error"]).max() <= 1e-10 * energy[0]
    assert energy[-1] < 0.5 * energy[0]


def test_elastic_box_conserves_its_energy():
    """A box that falls on a corner, without friction: no energy is lost at all."""
    system = da.System("elastic", gravity=(0.0, -G))
    box = planar.Body("box", mass=1.0, inertia=0.01, position=(0.0, 0.4), angle=0.3)
    shapes = [contact.Rectangle(system.add(box), (0.3, 0.2)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, restitution=1.0))
    motion = da.solve_nonsmooth(system.build(), 1.0, step=1e-3)
    energy = motion.data["energy"].values
    assert motion.status.success and motion.impulse("floor").max() > 0
    assert np.ptp(energy) <= 1e-9 * energy[0]
