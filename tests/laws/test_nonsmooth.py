"""Laws of steps with impacts: order, which law of impact, sticking, joints beside contacts."""

import functools

import numpy as np
import pytest
from rigid_contacts import other_warnings

import dalembert as da
from dalembert import planar
from dalembert.results.status import Outcome

G = 9.81
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean(), da.MoreauJean(projection=False)]
NAMES = ["anticipated", "Moreau-Jean", "Moreau-Jean, not projected"]
schemes = pytest.mark.parametrize("scheme", SCHEMES, ids=NAMES)


@functools.cache
def bouncing_ball(restitution: float, height: float = 1.0) -> da.Model:
    system = da.System("ball", gravity=(0.0, -G))
    ball = system.add(planar.Particle("ball", mass=2.0, position=(0.0, 0.1 + height)))
    floor = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))
    system.add(
        planar.Collisions(
            "floor", [planar.contact.Circle(ball, 0.1), floor], restitution=restitution
        )
    )
    return system.build()


@pytest.mark.few(1)
@schemes
@pytest.mark.parametrize("step", [1.7e-2, 7e-3, 3.1e-3])
def test_bouncing_ball_is_of_first_order(scheme, step):
    """The bounce is two steps off at most, and the height ``(1 + e) v`` times that."""
    e, end, fall = 0.7, 0.8, np.sqrt(2 / G)
    exact = e * G * fall * (end - fall) - G / 2 * (end - fall) ** 2
    motion = da.solve_nonsmooth(bouncing_ball(e), end, step=step, integrator=scheme)
    assert abs(motion.values("ball.y")[-1] - 0.1 - exact) <= 2 * (1 + e) * G * fall * step


def test_elastic_ball_keeps_its_energy():
    motion = da.solve_nonsmooth(bouncing_ball(1.0), 2.0, step=4e-3)
    energy = motion.data["energy"].values
    assert np.ptp(energy) <= 1e-12 * energy[0]
    assert motion.data["penetration"].max() <= 1e-13


@pytest.mark.few(1)
@schemes
def test_bounces_without_end_end(scheme):
    """Infinitely many impacts in finite time; the ball lies on the floor then."""
    motion = da.solve_nonsmooth(bouncing_ball(0.5), 2.0, step=4e-3, integrator=scheme)
    assert motion.status.success
    assert motion.values("ball.y")[-1] == pytest.approx(0.1, abs=3 * G * 4e-3**2 + 0.02)
    assert abs(motion.values("ball.vy")[-1]) <= 2 * G * 4e-3
    impulses = motion.impulse("floor").values[-100:]
    assert impulses.mean() == pytest.approx(2.0 * G * 4e-3, rel=1e-6)  # the weight


@pytest.mark.few(1)
@schemes
def test_newtons_cradle_follows_newtons_law_at_once(scheme):
    """All contacts in one: ``(−1/3, 2/3, 2/3)``, not ``(0, 0, 1)`` of impacts one by one."""
    system = da.System("cradle")
    balls = [
        system.add(planar.Body(f"b{k}", mass=1.0, inertia=1.0, position=(x, 0.0), velocity=(v, 0)))
        for k, (x, v) in enumerate([(-0.5, 1.0), (0.0, 0.0), (0.2, 0.0)])
    ]
    system.add(
        planar.Collisions(
            "collisions", [planar.contact.Circle(b, 0.1) for b in balls], restitution=1.0
        )
    )
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3, integrator=scheme)
    after = [motion.values(f"b{k}.vx")[-1] for k in range(3)]
    assert after == pytest.approx([-1 / 3, 2 / 3, 2 / 3], abs=1e-9)


@pytest.mark.parametrize("friction", [0.4, 0.7])
def test_disc_that_cannot_roll_sticks_or_slides_on_an_incline(friction):
    """It slides down by ``(sin α − μ cos α) g t²/2`` where ``μ < tan α``, and not at all above."""
    angle = np.pi / 6
    normal = np.array([-np.sin(angle), np.cos(angle)])
    system = da.System("incline", gravity=(0.0, -G))
    disc = system.add(planar.Particle("disc", mass=1.0, position=tuple(0.1 * normal)))
    wall = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), tuple(normal))
    system.add(
        planar.Collisions("slope", [planar.contact.Circle(disc, 0.1), wall], friction=friction)
    )
    motion = da.solve_nonsmooth(system.build(), 1.0, step=5e-3)
    gone = motion.data["position"].values[-1, 0] - 0.1 * normal
    expected = max(0.0, np.sin(angle) - friction * np.cos(angle)) * G / 2
    assert np.linalg.norm(gone) == pytest.approx(expected, abs=1e-9)
    pressed = motion.impulse("slope").sum().item()
    assert pressed == pytest.approx(G * np.cos(angle), rel=1e-9)


def test_sliding_disc_begins_to_roll():
    """Speed at which slip ends: two thirds of the first, ``ω = −v/R`` from then on."""
    system = da.System("bowling", gravity=(0.0, -G))
    disc = planar.Body("d", mass=1.0, inertia=0.005, position=(0.0, 0.1), velocity=(1.0, 0.0))
    system.add(disc)
    wall = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))
    system.add(planar.Collisions("floor", [planar.contact.Circle(disc, 0.1), wall], friction=0.2))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3)
    assert motion.values("d.vx")[-1] == pytest.approx(2 / 3, abs=1e-9)
    assert motion.values("d.angular_velocity")[-1] == pytest.approx(-20 / 3, abs=1e-8)


def pendulum_at_a_wall() -> da.System:
    system = da.System("pendulum", gravity=(0.0, -G))
    rod = system.add(planar.Bar("rod", length=1.0, mass=1.0, angle=0.0, position=(0.5, 0.0)))
    system.add(planar.Revolute("pin", system.ground.point(0.0, 0.0), rod.start))
    wall = planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (1.0, 0.0))
    system.add(
        planar.Collisions("wall", [planar.contact.Circle(rod.end, 0.1), wall], restitution=0.5)
    )
    return system


@pytest.mark.thorough
@schemes
def test_joints_stay_closed_beside_contacts(scheme):
    """A pendulum that swings against a wall: the pin holds, and the disc does not pass."""
    model = pendulum_at_a_wall().build()
    motion = da.solve_nonsmooth(model, 1.5, step=2e-3, integrator=scheme)
    assert motion.status.success
    assert motion.data["position_violation"].max() <= 1e-11
    assert motion.data["velocity_violation"].max() <= 1e-10
    closed = motion.data["penetration"].max().item()
    assert closed <= (1e-11 if scheme.projection else 1e-2)
    assert motion.impulse("wall").sum() > 0
    assert motion.status.residual == pytest.approx(closed, abs=1e-11)


@schemes
def test_reactions_are_those_of_a_turning_bar(scheme):
    """The pin carries ``m ω² l/2``, a motor the whole of what speeds a wheel up."""
    system = da.System("turning", gravity=(0.0, 0.0))
    bar = system.add(planar.Bar("bar", length=1.0, mass=2.0, inertia=0.5, angular_velocity=3.0))
    system.add(planar.Revolute("pin", system.ground.center, bar.start))
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.7))
    system.add(planar.Revolute("axle", system.ground.point(0.0, 5.0), wheel.center))
    system.add(planar.RotationalDriver("motor", system.ground, wheel, da.t**2 / 2))
    floor = planar.contact.HalfPlane(system.ground.point(0.0, -9.0), (0.0, 1.0))
    system.add(planar.Collisions("floor", [planar.contact.Circle(bar.end, 0.01), floor]))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-2, integrator=scheme)
    assert motion.values("pin.force_norm")[-1] == pytest.approx(9.0, rel=1e-4)
    assert motion.values("motor.effort")[-1] == pytest.approx(0.7, rel=1e-9)
    assert np.abs(motion.data["balance_error"]).max() < 1e-5


@pytest.mark.thorough
def test_a_stack_is_opened_all_at_once():
    """What lifts a disc lifts those above it, in the same Newton step."""
    system = da.System("stack", gravity=(0.0, -G))
    discs = []
    for k in range(5):
        disc = planar.Body(f"d{k}", mass=1.0, inertia=0.001, position=(0.0, 0.07 + 0.105 * k))
        discs.append(planar.contact.Circle(system.add(disc), 0.05))
    floor = planar.contact.HalfPlane(system.ground.center, (0.0, 1.0))
    system.add(planar.Collisions("stack", [*discs, floor], restitution=0.3, friction=0.4))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=5e-4, integrator=da.MoreauJean())
    assert motion.status.success
    assert motion.data["penetration"].max() < 1e-12
    assert motion.values("d4.y")[-1] == pytest.approx(0.45, abs=1e-5)


# how runs end -------------------------------------------------------------------------------


def test_a_gap_that_is_left_closed_is_no_motion():
    """Steps in which the ball falls further than the mechanism is large."""
    scheme = da.MoreauJean(projection=False)
    motion = da.solve_nonsmooth(bouncing_ball(0.7), 3.0, step=0.3, integrator=scheme)
    assert motion.status.outcome is Outcome.VIOLATED and not motion.status.success
    assert motion.status.residual == pytest.approx(motion.record.penetration.max())
    assert "a gap of floor is -" in motion.status.message
    assert motion.status.message.endswith("use a shorter step")


def falling_box() -> da.Model:
    """A box that falls and turns."""
    system = da.System("box", gravity=(0.0, -G))
    start = {"position": (0.0, 0.3), "angle": 0.2, "angular_velocity": 10.0}
    box = planar.Body("box", mass=1.0, inertia=0.01, **start)
    shapes = [planar.contact.Rectangle(system.add(box), (0.4, 0.1))]
    system.add(planar.Collisions("floor", [*shapes, planar.contact.HalfPlane(system.ground)]))
    return system.build()


def test_energy_from_nowhere_is_no_motion():
    """Corners are lifted by long steps of a scheme that opens gaps; the other creates none."""
    model = falling_box()
    motion = da.solve_nonsmooth(model, 2.0, step=0.2, integrator=da.MoreauJean())
    assert motion.status.outcome is Outcome.UNBALANCED
    assert "appeared by t = " in motion.status.message
    assert da.solve_nonsmooth(model, 2.0, step=0.2).status.success
    lax = da.solve_nonsmooth(model, 2.0, step=0.2, integrator=da.MoreauJean(), balance=1.0)
    assert lax.status.success and "the steps are long" in lax.warnings[0]


@pytest.mark.few(1)
@pytest.mark.parametrize("theta", [0.5, 0.75, 1.0])
def test_a_ball_of_long_steps_is_balanced(theta):
    """What the θ-method loses in the fall, an impact returns: no net energy is gained. The only
    warnings are those of rebounds with too much energy for their speed of approach."""
    scheme = da.MoreauJean(theta=theta)
    motion = da.solve_nonsmooth(bouncing_ball(0.7), 3.0, step=0.05, integrator=scheme)
    assert motion.status.success
    assert all("differs by" in warning for warning in other_warnings(motion))


def test_overlaps_are_warned_about():
    """By a share of the ball, not of the height of its fall; deep ones are failures."""
    options = {"integrator": da.MoreauJean(projection=False)}
    motion = da.solve_nonsmooth(bouncing_ball(0.7), 0.8, step=3e-3, **options)
    assert motion.status.success
    assert any("a gap of floor is -0.00" in warning for warning in motion.warnings)
    deep = da.solve_nonsmooth(bouncing_ball(0.7), 0.8, step=1.7e-2, **options)
    assert not deep.status.success and "use a shorter step" in deep.status.message


def test_joints_that_cannot_be_closed_end_the_run():
    """A rope shorter than the way to the rod, from t = 0.625 s on."""
    system = da.System("winch", gravity=(0.0, -G))
    rod = system.add(planar.Bar("rod", length=1.0, mass=1.0, angle=0.0, position=(0.5, 0.0)))
    system.add(planar.Revolute("pin", system.ground.point(0.0, 0.0), rod.start))
    far = system.ground.point(2.0, 0.0)
    system.add(planar.DistanceDriver("rope", far, rod.end, 1.5 - 0.8 * da.t))
    floor = planar.contact.HalfPlane(system.ground.point(0.0, -9.0), (0.0, 1.0))
    system.add(planar.Collisions("floor", [planar.contact.Circle(rod.end, 0.1), floor]))
    motion = da.solve_nonsmooth(system.build(), 1.0, step=0.01)
    assert motion.status.outcome is Outcome.NOT_CONVERGED
    assert motion.status.time == motion.time[-1] == pytest.approx(0.625, abs=0.01 / 32)
    assert motion.status.residual > 1e-5  # steps are divided up to the instant
    assert "joints could not be closed" in motion.status.message


def test_outputs_and_other_times():
    model = bouncing_ball(0.5)
    motion = da.solve_nonsmooth(model, 1.0, step=2e-3, outputs=11)
    whole = da.solve_nonsmooth(model, 1.0, step=2e-3)
    assert motion.time.size == 11
    assert motion.impulse("floor").sum() == pytest.approx(whole.impulse("floor").sum().item())
    assert whole.at(motion.time).values("ball.y") == pytest.approx(motion.values("ball.y"))


def test_forces_of_rigid_contacts_are_those_of_located_contacts():
    """Normal force and friction of a block that slides on two points and is pressed down."""
    system = da.System("block", gravity=(0, -10))
    block = planar.Body("block", mass=2.0, inertia=0.1, position=(0, 0.1), velocity=(1, 0))
    system.add(block)
    floor, law = planar.contact.HalfPlane(system.ground.center), planar.contact.Restitution(0.0)
    friction = planar.contact.Coulomb(0.3)
    for name, x in (("left", -0.2), ("right", 0.3)):
        point = planar.contact.Vertex(block.point(x, -0.1))
        system.add(planar.Contact(name, floor, point, law=law, friction=friction))
    system.add(planar.Force("pressure", block.center, (0, -3.0)))
    model = system.build()
    stepped = da.solve_nonsmooth(model, 0.1, step=0.005)
    located = da.solve_dynamics(model, 0.1, step=0.005)
    for name in ("left.normal_force", "right.normal_force", "left.friction_force"):
        expected = located.values(name)
        assert np.abs(stepped.values(name) - expected).max() < 1e-5 * np.abs(expected).max(), name
