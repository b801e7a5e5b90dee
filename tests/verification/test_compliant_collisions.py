"""Force laws of ``Collisions`` against exact solutions, and against ``Contact``."""

import numpy as np
import pytest
from rigid_contacts import other_warnings
from scipy.integrate import quad, solve_ivp
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial

contact = planar.contact
K, C, V0, RADIUS = 1e6, 0.2, 1.0, 0.1
LAWS = {
    "Hertz": (contact.Hertz(stiffness=K), lambda d, r: K * d**1.5),
    "HuntCrossley": (
        contact.HuntCrossley(stiffness=K, damping=C),
        lambda d, r: K * d**1.5 * max(0.0, 1 + C * r),
    ),
    "Flores": (
        contact.Flores(stiffness=K, restitution=0.7, impact_speed=V0),
        lambda d, r: K * d**1.5 * max(0.0, 1 + 1.6 * 0.3 / 0.7 / V0 * r),
    ),
    "LankaraniNikravesh": (
        contact.LankaraniNikravesh(stiffness=K, restitution=0.8, impact_speed=V0),
        lambda d, r: K * d**1.5 * max(0.0, 1 + 0.75 * 0.36 / V0 * r),
    ),
    "KelvinVoigt": (
        contact.KelvinVoigt(stiffness=1e5, damping=50.0),
        lambda d, r: max(0.0, 1e5 * d + 50 * r),
    ),
}


def dropped(law, step: float, end: float, gravity=-10.0, height=1e-3, **options):
    """A ball at ``V0`` above the floor."""
    system = da.System("drop", gravity=(0, gravity))
    place, speed = (0, RADIUS + height), (0, -V0)
    ball = system.add(planar.Particle("ball", mass=1.0, position=place, velocity=speed))
    shapes = [contact.Circle(ball.center, RADIUS), contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("floor", shapes, law=law))
    return da.solve_nonsmooth(system.build(), end, step=step, **options)


def fall(force, end: float, gravity=-10.0, height=1e-3) -> np.ndarray:
    """Height above the floor and speed at the end, phase by phase."""

    def rates(t, x, pressing):
        return [x[1], gravity + (force(-x[0], -x[1]) if pressing and x[0] < 0 else 0.0)]

    def surface(t, x, pressing):
        return x[0]

    state, time, pressing = np.array([height, -V0]), 0.0, False
    surface.terminal = True
    while time < end:
        surface.direction = 1 if pressing else -1
        options = {"rtol": 1e-13, "atol": 1e-15, "events": surface, "args": (pressing,)}
        run = solve_ivp(rates, (time, end), state, method="DOP853", **options)
        time, state, pressing = run.t[-1], run.y[:, -1], not pressing
    return state


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("name", LAWS)
def test_ball_on_a_floor_converges_to_the_exact_motion(name, scheme):
    """Through the whole contact: second order, to 1e-8 by extrapolation for smooth laws."""
    (law, force), end = LAWS[name], 0.0165
    exact = fall(force, end)
    states = []
    for step in (4e-5,) if name == "KelvinVoigt" else (2e-4, 1e-4, 5e-5):
        motion = dropped(law, step, end, integrator=scheme)
        assert motion.status.success and (states or not motion.warnings)  # of the longest step
        assert float(abs(motion.data["balance_error"]).max()) < 1e-12
        states.append([motion["ball.y"][-1].item() - RADIUS, motion["ball.vy"][-1].item()])
    errors = np.abs(np.array(states) - exact).max(axis=1)
    assert errors[-1] < 1e-5
    if name != "KelvinVoigt":  # whose force jumps at first contact
        assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.05)
        extrapolated = (4 * np.array(states[2]) - states[1]) / 3
        assert extrapolated == pytest.approx(exact, abs=2e-8)


def test_rebound_and_duration_of_an_elastic_impact():
    """``T = 2.94 δ_max/v = 3.21 (m²/(K² v))^{1/5}`` (Johnson, Contact Mechanics, 1985, 11.4)."""
    duration = 3.2145 * (1 / (K**2 * V0)) ** 0.2
    deepest = (1.25 / K * V0**2) ** 0.4
    integral = 2 * quad(lambda z: 4 * z**3 / np.sqrt(1 - (1 - z**4) ** 2.5), 0, 1)[0]
    assert duration == pytest.approx(integral * deepest / V0, rel=2e-3)
    step = duration / 200
    motion = dropped(LAWS["Hertz"][0], step, 0.02, gravity=0.0)
    record = motion.record
    assert record.step.size * step == pytest.approx(duration, abs=2 * step)
    assert motion["ball.vy"][-1].item() == pytest.approx(V0, rel=1e-12)
    assert record.stored.max() == pytest.approx(0.5 * V0**2, rel=1e-4)
    assert 1 / record.fraction.max() == pytest.approx(200, rel=0.35)


@pytest.mark.thorough
@pytest.mark.parametrize("restitution", sampled([0.6, 0.9, 0.3], 3))
def test_restitution_of_hunt_and_crossley(restitution):
    law = contact.HuntCrossley(stiffness=K, damping=contact.damping_factor(restitution) / V0)
    motion = dropped(law, 4e-5, 0.03, gravity=0.0)
    assert motion["ball.vy"][-1].item() == pytest.approx(restitution, abs=1e-4)
    lost = motion.statistics["energy dissipated in contacts [J]"]
    assert lost == pytest.approx(0.5 * V0**2 * (1 - restitution**2), abs=1e-4)


@pytest.mark.few(1)
@pytest.mark.parametrize("height", [1e-3, 3.7e-3, 9e-3])
@pytest.mark.parametrize("step", [1e-3, 5e-3, 0.02])
def test_long_steps_keep_energy_or_warn(step, height):
    """An elastic ball returns at its speed; otherwise a warning bounds the error."""
    elastic = dropped(LAWS["Hertz"][0], step, 0.2, gravity=0.0, height=height)
    assert elastic["ball.vy"][-1].item() == pytest.approx(V0, rel=1e-9)
    law = contact.HuntCrossley(stiffness=1e8, damping=contact.damping_factor(0.5) / V0)
    motion = dropped(law, step, 0.2, gravity=0.0, height=height)
    (warning,) = other_warnings(motion)
    assert "as of floor at t = " in warning and "or shorter" in warning
    bound = float(warning.split("wrong by ")[1].split(";")[0])
    assert abs(motion["ball.vy"][-1].item() - 0.5) < 1.5 * bound


@pytest.mark.thorough
def test_cradle_of_compliant_balls():
    """Five balls in a row, whose contacts overlap in time, against the exact solution."""
    count, end, stiffness = 5, 0.012, 1e7
    system = da.System("cradle")
    balls = [
        system.add(planar.Particle(f"b{k}", mass=1.0, position=(0.2 * k, 0), velocity=(k == 0, 0)))
        for k in range(count)
    ]
    law = contact.HuntCrossley(stiffness=stiffness, damping=0.05)
    shapes = [contact.Circle(ball.center, 0.1) for ball in balls]
    system.add(planar.Collisions("row", shapes, law=law))
    model = system.build()

    def rates(t, x):
        depth, rate = np.maximum(-np.diff(x[:count]), 0.0), -np.diff(x[count:])
        force = stiffness * depth**1.5 * np.maximum(0.0, 1 + 0.05 * rate)
        return np.concatenate([x[count:], np.append(0, force) - np.append(force, 0)])

    start = np.zeros(2 * count)
    start[count] = 1.0
    options = {"rtol": 1e-12, "atol": 1e-14, "max_step": 1e-5}
    exact = solve_ivp(rates, (0, end), start, method="DOP853", **options).y[count:, -1]
    errors = []
    for step in (6e-5, 3e-5, 1.5e-5):
        motion = da.solve_nonsmooth(model, end, step=step)
        speeds = np.array([motion[f"b{k}.vx"][-1].item() for k in range(count)])
        errors.append(np.abs(speeds - exact).max())
    assert speeds.sum() == pytest.approx(1.0, rel=1e-12)
    assert errors[-1] < 2e-5 and np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.3)
    assert exact[-1] > 0.9 and 1e-3 < exact[-2] < 0.2  # not the impact of rigid balls


def _circles(system):
    a = planar.Body("a", mass=1.0, inertia=0.004, position=(0, 0), velocity=(1, 0))
    b = planar.Body("b", mass=2.0, inertia=0.004, position=(0.201, 0.05))
    return [contact.Circle(system.add(body).center, 0.1) for body in (a, b)]


def _rectangle(system):
    body = planar.Body(
        "a", mass=1.0, inertia=0.004, position=(0, 0.092), angle=0.5, velocity=(3.0, -0.3)
    )
    return contact.Rectangle(system.add(body).center, (0.2, 0.1)), contact.HalfPlane(system.ground)


def _capsule(system):
    body = planar.Body(
        "a", mass=1.0, inertia=0.004, position=(0, 0.1), angle=0.5, velocity=(2.0, -0.3)
    )
    system.add(body)
    points = [body.point(x, 0) for x in (-0.1, 0.1)]
    return contact.Capsule(*points, 0.05), contact.HalfPlane(system.ground)


def _spheres(system):
    shapes = []
    for name, place, speed in (("a", (0, 0, 0), 1.0), ("b", (0.201, 0.05, 0.01), 0.0)):
        body = spatial.Body(
            name, mass=1.0, inertia=(0.004, 0.004, 0.004), position=place, velocity=(speed, 0, 0)
        )
        shapes.append(spatial.contact.Sphere(system.add(body).center, 0.1))
    return shapes


SCENES = {"circles": _circles, "rectangle": _rectangle, "capsule": _capsule, "spheres": _spheres}


@pytest.mark.thorough
@pytest.mark.parametrize("friction", [0.0, 0.1])
@pytest.mark.parametrize("name", SCENES)
def test_agreement_with_contact_of_two_shapes(name, friction):
    """Second order; first order where friction stops the slip, as of circles and spheres."""
    space = spatial if name == "spheres" else planar
    gravity = (0, 0, -10) if name == "spheres" else (0, -10)
    law, end = space.contact.HuntCrossley(stiffness=K, damping=0.1), 0.015

    def model(kind, **options):
        system = da.System("pair", gravity=gravity)
        shapes = SCENES[name](system)
        arguments = shapes if kind is space.Contact else [shapes]
        system.add(kind("touch", *arguments, law=law, **options))
        return system.build()

    rub = {"friction": space.contact.Coulomb(friction, slip_speed=1e-4)} if friction else {}
    exact = da.solve_dynamics(
        model(space.Contact, **rub), end, integrator=da.DormandPrince(1e-10, 1e-12)
    )
    many, errors = model(space.Collisions, friction=friction), []
    for step in (2e-4, 1e-4, 5e-5):
        motion = da.solve_nonsmooth(many, end, step=step)
        assert motion.status.success
        assert float(motion.data["contact_energy"].max()) > 0.01
        ends = motion.trajectory.v[:, -1] - exact.trajectory.v[:, -1]
        errors.append(np.abs(ends).max())
    size = np.abs(exact.trajectory.v[:, -1]).max()
    factor = 1.8 if friction and name in ("circles", "spheres") else 3.0
    assert errors[-1] < 2e-4 * size
    assert errors[1] < errors[0] / factor and errors[2] < errors[1] / factor


def block(angle: float, friction: float, end=0.25, step=1e-3, **options):
    """A block on an incline, from its depth at rest."""
    system = da.System("incline", gravity=(10 * np.sin(angle), -10 * np.cos(angle)))
    depth = 2.0 * 10 * np.cos(angle) / 2 / 1e5
    body = system.add(
        planar.Body("block", mass=2.0, inertia=0.05, position=(0, 0.05 - depth), **options)
    )
    shapes = [contact.Rectangle(body.center, (0.4, 0.1)), contact.HalfPlane(system.ground.center)]
    law = contact.KelvinVoigt(stiffness=1e5, damping=500.0)
    system.add(planar.Collisions("floor", shapes, law=law, friction=friction))
    return da.solve_nonsmooth(system.build(), end, step=step)


@pytest.mark.thorough
def test_block_slides_and_sticks_on_an_incline():
    slides = block(0.4, 0.3)
    assert slides.status.success and not slides.warnings
    acceleration = 10 * (np.sin(0.4) - 0.3 * np.cos(0.4))
    assert slides["block.vx"][-1].item() == pytest.approx(acceleration * 0.25, rel=1e-3)
    sticks = block(0.2, 0.3)
    assert sticks.status.success and abs(sticks["block.vx"][-1].item()) < 1e-8
    assert abs(sticks["block.x"][-1].item()) < 2e-6  # from the first swing
    forces = sticks.contact_forces(0.25).forces.sum(axis=0)
    assert forces == pytest.approx([-20 * np.sin(0.2), 20 * np.cos(0.2)], rel=1e-6)


@pytest.mark.thorough
def test_pile_at_rest_has_its_weight_and_the_depth_of_the_law():
    """Three columns of four balls: each contact carries the balls above it."""
    system, stiffness, radius = da.System("pile", gravity=(0, 0, -10)), 1e6, 0.1
    shapes = [spatial.contact.HalfSpace(system.ground)]
    for column in range(3):
        for row in range(4):
            place = (0.5 * column, 0, radius * (2 * row + 1) - 1e-4)
            ball = spatial.Particle(f"b{column}{row}", mass=1.0 + column, position=place)
            shapes.append(spatial.contact.Sphere(system.add(ball).center, radius))
    law = spatial.contact.HuntCrossley(stiffness=stiffness, damping=20.0)
    system.add(spatial.Collisions("pile", shapes, law=law))
    motion = da.solve_nonsmooth(system.build(), 1.5, step=2e-3)
    assert motion.status.success
    for column in range(3):
        mass, height = 1.0 + column, 0.0
        for row in range(4):
            depth = (mass * 10 * (4 - row) / stiffness) ** (2 / 3)
            height += (radius if row == 0 else 2 * radius) - depth
            assert motion[f"b{column}{row}.z"][-1].item() == pytest.approx(height, abs=2e-8)
    forces = motion.contact_forces(1.5)
    on_floor = forces.places[:, 2] < radius / 2
    assert forces.forces[on_floor].sum(axis=0) == pytest.approx([0, 0, 240], rel=1e-5)
    energy = sum(
        0.4 * stiffness * ((1.0 + c) * 10 * (4 - r) / stiffness) ** (5 / 3)
        for c in range(3)
        for r in range(4)
    )
    assert float(motion.data["contact_energy"][-1]) == pytest.approx(energy, rel=1e-4)


@pytest.mark.thorough
def test_rigid_and_compliant_contacts_in_one_model():
    """A ball on a compliant ball on a rigid floor: depth by the law, no gap of the floor."""
    system = da.System("mixed", gravity=(0, -10))
    low = system.add(planar.Particle("low", mass=1.0, position=(0, 0.1)))
    high = system.add(planar.Particle("high", mass=2.0, position=(0, 0.3)))
    shapes = {
        "balls": [contact.Circle(ball.center, 0.1) for ball in (low, high)],
        "floor": [contact.HalfPlane(system.ground.center)],
    }
    pair = contact.Pair(("balls", "balls"), law=contact.KelvinVoigt(damping=200.0, stiffness=1e4))
    system.add(planar.Collisions("all", shapes, pairs=[pair]))
    motion = da.solve_nonsmooth(system.build(), 0.5, step=1e-3)
    assert motion.status.success and not motion.warnings
    assert motion["low.y"][-1].item() == pytest.approx(0.1, abs=1e-9)
    assert motion["high.y"][-1].item() == pytest.approx(0.3 - 20 / 1e4, abs=1e-7)
    assert float(motion.data["penetration"].max()) < 1e-12
    forces = motion.contact_forces(0.5)
    assert sorted(forces.forces[:, 1]) == pytest.approx([20, 30], rel=1e-5)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("support", ["plane", "box", "cylinder"])
def test_an_upright_cylinder_stands_on_eight_springs(support, scheme):
    """Its end does not tilt, at the penetration ``m g/(8 k)``."""
    stiffness, weight = 1e5, 9.81
    depth = weight / (8 * stiffness)
    system = da.System("column", gravity=(0.0, 0.0, -9.81))
    place = (0.0, 0.0, 0.025 - depth)
    body = system.add(spatial.Cylinder("d", radius=0.1, length=0.05, mass=1.0, position=place))
    ground, kit = system.ground, spatial.contact
    supports = {
        "plane": kit.HalfSpace(ground.frame()),
        "box": kit.Box(ground.point(0, 0, -0.1), (1.0, 1.0, 0.2)),
        "cylinder": kit.Cylinder(ground.point(0, 0, -0.2), ground.point(0, 0, 0), 0.3),
    }
    shapes = [kit.Cylinder(body.point(0, 0, -0.025), body.point(0, 0, 0.025), 0.1)]
    law = kit.KelvinVoigt(stiffness=stiffness)
    system.add(spatial.Collisions("s", [*shapes, supports[support]], friction=0.3, law=law))
    motion = da.solve_nonsmooth(system.build(), 0.05, step=1e-3, integrator=scheme)
    assert motion.status.success
    assert abs(motion["d.z"] - place[2]).max() < 1e-9
    assert abs(motion["d.angular_velocity"]).max() < 1e-8
    forces = motion.contact_forces(0.05).forces
    np.testing.assert_allclose(forces[:, 2], np.sign(forces[0, 2]) * weight / 8, rtol=1e-6)
