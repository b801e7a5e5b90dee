"""Sliding friction in space does not depend on the orientation of the scene; its gradients."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial

contact = spatial.contact
SHAPES = {
    "sphere": lambda body, size: contact.Sphere(body.center, size / 2),
    "box": lambda body, size: contact.Box(body.center, (size, size, size)),
    "cylinder": lambda body, size: contact.Cylinder(
        body.point(-size / 2, 0.0, 0.0), body.point(size / 2, 0.0, 0.0), size / 2
    ),
    "capsule": lambda body, size: contact.Capsule(
        body.point(0.0, 0.0, -size / 2), body.point(0.0, 0.0, size / 2), size / 2
    ),
}
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]
EXACT = da.ContactSolver(tolerance=1e-11)
INSIDE = 1e-8
"""Overlap at the start [m]; rounding does not decide whether the bodies touch."""
TURNS = [Rotation.from_euler("x", 90, degrees=True), Rotation.random(random_state=2)]
"""With the first one the normal crosses the xy plane, where tangents of ``across`` change sign."""


def on_turning_plate(turn: Rotation, shape: str, others: int = 0) -> da.System:
    """A body that slides on a heavy plate that turns, with the normal along ``turn`` of x."""

    def turned(*vector) -> tuple[float, ...]:
        return tuple(float(x) for x in turn.apply(np.array(vector, float)))

    system = da.System("plate", gravity=(0.0, 0.0, 0.0))
    speed = system.parameter("speed", 0.5, "m/s")
    size, friction = system.parameter("size", 0.1, "m"), system.parameter("friction", 0.2)
    lean = Rotation.from_euler("y", 10, degrees=True)
    spin = {"angular_velocity": turned(0.0, -2.0, 0.0), "rotation": turn * lean}
    plate = spatial.Body("plate", mass=1e5, inertia=(1e5, 1e5, 1e5), **spin)
    normal, along = turned(*lean.apply([1.0, 0.0, 0.0])), turned(0.0, 1.0, 0.0)
    place = [(size / 2 - INSIDE) * n - 0.1 * a for n, a in zip(normal, along, strict=True)]
    velocity = [speed * a + b for a, b in zip(along, turned(0.0, 0.0, 0.4), strict=True)]
    body = spatial.Body(
        "body", mass=1.0, inertia=(0.01,) * 3, position=place, velocity=velocity, **spin
    )
    system.add(plate), system.add(body)
    pull = system.ground.point(*turned(-10.0, 0.0, 0.0)), body.center
    system.add(spatial.Spring("pull", *pull, stiffness=2.0, free_length=0.0))
    shapes = [contact.HalfSpace(plate.frame(axis=(1, 0, 0))), SHAPES[shape](body, size)]
    for number in range(others):
        place = turned(50.0 + number, 0.0, 0.0)
        other = spatial.Body(f"other_{number}", mass=1.0, inertia=(0.01,) * 3, position=place)
        shapes.append(contact.Sphere(system.add(other).center, 0.1))
    system.add(spatial.Collisions("touch", shapes, friction=friction))
    return system


def motion_of(system: da.System, scheme, duration: float) -> da.Motion:
    model, steps = system.build(), {"step": 1e-3, "solver": EXACT}
    motion = da.solve_nonsmooth(model, duration, integrator=scheme, **steps)
    assert motion.status.success
    return motion


def state_of(motion: da.Motion, turn: Rotation) -> np.ndarray:
    """Velocities of the body in the axes of the scene."""
    names = "body.velocity", "body.angular_velocity"
    return np.hstack([turn.inv().apply(motion[name].values) for name in names])


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
@pytest.mark.parametrize("shape", SHAPES)
def test_orientation_of_the_scene(shape, scheme):
    one, *others = (
        state_of(motion_of(on_turning_plate(turn, shape), scheme, 0.1), turn)
        for turn in (Rotation.identity(), *TURNS)
    )
    assert np.ptp(one[:, 1]) > 0.05  # it slides
    rounded = 1e-5 if shape == "box" else 1e-7  # which of the flush corners close
    for other in others:
        np.testing.assert_allclose(other, one, atol=rounded)


def test_directions_of_many_bodies():
    """Directions of many bodies are compressed by rows."""
    one, other = (
        state_of(motion_of(on_turning_plate(turn, "sphere", 20), SCHEMES[0], 0.02), turn)
        for turn in (Rotation.identity(), TURNS[1])
    )
    np.testing.assert_allclose(other, one, atol=1e-7)


@pytest.mark.few(3)
@pytest.mark.parametrize("turn", TURNS, ids=["passes", "random"])
@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
@pytest.mark.parametrize("shape", SHAPES)
def test_gradients(shape, scheme, turn):
    motion = motion_of(on_turning_plate(turn, shape), scheme, 0.05)
    rates = [da.final(f"body.velocity.{axis}") for axis in "xyz"]
    direct, adjoint, differences = (
        da.sensitivity(motion, rates, method=method).values
        for method in ("direct", "adjoint", da.FiniteDifference("richardson"))
    )
    scale = abs(direct).max()
    assert abs(direct).max(axis=0).min() > 1e-3
    np.testing.assert_allclose(adjoint, direct, atol=1e-9 * scale)
    np.testing.assert_allclose(direct, differences, atol=1e-6 * scale)
