"""Boxes on planes: stacks, sliding, tipping and impacts of corners, against closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial

G, MASS = 9.81, 2.0


def box(system: da.System, name: str, size: tuple[float, float, float], **start) -> spatial.Body:
    """A homogeneous box."""
    x, y, z = (s**2 for s in size)
    inertia = tuple(MASS / 12 * np.array([y + z, x + z, x + y]))
    pose = {"rotation": np.eye(3)} | start
    return system.add(spatial.Body(name, mass=MASS, inertia=inertia, **pose))


def on_floor(
    sizes: list[tuple[float, float, float]], starts: list[dict], gravity=(0, 0, -G), **laws
) -> da.Model:
    """Boxes above a horizontal floor."""
    system, shapes = da.System("boxes", gravity=gravity), []
    for k, (size, start) in enumerate(zip(sizes, starts, strict=True)):
        body = box(system, f"box{k}", size, **start)
        shapes.append(spatial.contact.Box(body.center, size))
    shapes.append(spatial.contact.HalfSpace(system.ground.frame(axis=(0, 0, 1))))
    system.add(spatial.Collisions("hits", shapes, **laws))
    return system.build()


def test_a_stack_of_ten_boxes_stands():
    size = (0.3, 0.25, 0.2)
    starts = [{"position": (0, 0, 0.1 + 0.2 * k)} for k in range(10)]
    motion = da.solve_nonsmooth(on_floor([size] * 10, starts, friction=0.4), 2.0, step=2e-3)
    assert motion.status.success
    positions = motion.record.ends.y
    assert np.abs(positions - positions[:, :1]).max() < 1e-7
    floor = motion.record.impulse[motion.record.step == 900]
    assert floor[:, 0].max() > 0


def test_a_box_slides_as_far_as_friction_lets_it():
    speed, friction = 1.5, 0.3
    start = {"position": (0, 0, 0.05), "velocity": (speed, 0, 0)}
    model = on_floor([(0.4, 0.3, 0.1)], [start], friction=friction)
    motion = da.solve_nonsmooth(model, 0.8, step=1e-3)
    assert motion.status.success
    distance = speed**2 / (2 * friction * G)
    assert motion["box0.x"][-1].item() == pytest.approx(distance, rel=1e-5)
    assert abs(motion["box0.vx"][-1].item()) < 1e-9


@pytest.mark.parametrize("factor", [0.97, 1.03])
def test_a_box_tips_where_gravity_leaves_its_base(factor):
    width, height = 0.1, 0.3
    slope = np.arctan(factor * width / height)
    gravity = (G * np.sin(slope), 0, -G * np.cos(slope))
    start = {"position": (0, 0, height / 2)}
    model = on_floor([(width, 0.2, height)], [start], gravity, friction=0.8)
    motion = da.solve_nonsmooth(model, 0.5, step=1e-3)
    assert motion.status.success
    tilt = 2 * abs(motion.record.ends.y[4:7, -1]).max()  # Euler parameters of a small turn
    if factor < 1:
        assert tilt < 1e-6
    else:  # I θ'' = m g (r cos(slope + …) …), which grows as cosh(p t) from equilibrium
        inertia = MASS / 12 * (width**2 + height**2) + MASS * (width**2 + height**2) / 4
        radius = np.hypot(width, height) / 2
        alpha = np.arctan(width / height)
        rate = np.sqrt(MASS * G * radius / inertia)
        grown = (slope - alpha) * (np.cosh(rate * 0.5) - 1)
        assert tilt == pytest.approx(grown, rel=2e-2)


@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_the_impact_of_a_corner_dissipates_what_restitution_states(restitution):
    """Without friction the normal speed changes by ``(1 + e) v``; the loss is ``P (1 − e) v/2``.

    The impulse is ``P = m_e (1 + e) v``, less that of the gyroscopic moment of the step, which has
    the mean of the spins before and after.
    """
    size, speed, step = np.array([0.3, 0.2, 0.1]), 2.0, 1e-3
    turn = Rotation.from_rotvec([0.6, 0.25, 0.1]).as_matrix()
    corners = np.array(np.meshgrid(*(size[:, None] / 2 * [-1, 1]))).reshape(3, -1).T @ turn.T
    arm = corners[corners[:, 2].argmin()]
    start = {
        "position": (0, 0, 0.021 - arm[2]),
        "rotation": turn,
        "velocity": (0, 0, -speed),
    }
    model = on_floor([tuple(size)], [start], (0, 0, 0), restitution=restitution)
    motion = da.solve_nonsmooth(model, 0.03, step=step)
    assert motion.status.success
    x, y, z = size**2
    inertia = MASS / 12 * np.array([y + z, x + z, x + y])
    lever = turn.T @ np.cross(arm, [0, 0, 1.0])
    effective = 1 / (1 / MASS + lever @ (lever / inertia))
    record = motion.record
    mean = record.ends.v[3:, record.step[0] + 1] / 2
    gyroscopic = step * np.cross(inertia * mean, mean) / inertia
    expected = effective * ((1 + restitution) * speed - lever @ gyroscopic)
    impulse = record.impulse[record.step == record.step[0], 0].sum()
    assert impulse == pytest.approx(expected, rel=1e-9)
    assert impulse == pytest.approx(effective * (1 + restitution) * speed, rel=1e-5)
    loss = impulse * (1 - restitution) * speed / 2
    rounding = 1e-9 * MASS * speed**2 / 2  # tolerance of the impulses
    assert record.loss[record.step[0]] == pytest.approx(loss, abs=rounding)


@pytest.mark.few(1)
@pytest.mark.parametrize("step", [2e-3, 5e-3])
def test_a_heavy_ball_stays_on_a_light_box(step):
    """At rest, 500,000 times as heavy: where impulses miss the tolerance, the run ends there."""
    system = da.System("press", gravity=(0, 0, -9.81))
    crate = box(system, "crate", (0.2, 0.2, 0.2), position=(0, 0, 0.1))
    weight = spatial.Sphere("weight", mass=1e6, radius=0.1, position=(0, 0, 0.3))
    shapes = [
        spatial.contact.Box(crate.center, (0.2, 0.2, 0.2)),
        spatial.contact.Sphere(system.add(weight).center, 0.1),
        spatial.contact.HalfSpace(system.ground.frame()),
    ]
    system.add(spatial.Collisions("contacts", shapes, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.4, step=step, integrator=da.MoreauJean())
    assert motion.time[-1] > 0.1
    assert abs(motion["crate.x"]).max() < 1e-6
    assert abs(motion["weight.z"] - 0.3).max() < 1e-6
