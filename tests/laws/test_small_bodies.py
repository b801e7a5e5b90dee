"""Small bodies beside heavy ones: mass and inertia are compared within a body only."""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import SingularityError


def ball_beside_machine(inertia, radius=5e-3, mass=1e-4):
    """A ball that slides and spins backwards on a floor, beside a machine of 10 t."""
    system = da.System("ball beside a machine", gravity=(0.0, -9.81))
    machine = planar.Body("machine", mass=1e4, inertia=2e3, position=(-3.0, 0.5))
    start = {"position": (0.0, radius), "velocity": (0.2, 0.0), "angular_velocity": 3.0}
    ball = system.add(planar.Body("ball", mass=mass, inertia=inertia, **start))
    shapes = [
        planar.contact.Circle(ball, radius),
        planar.contact.Rectangle(system.add(machine), (1.0, 1.0)),
        planar.contact.HalfPlane(system.ground),
    ]
    system.add(planar.Collisions("contacts", shapes, friction=0.3))
    return system.build()


@pytest.mark.parametrize("inertia", [1e-9, 1e-10, 1e-13])
def test_a_small_ball_rolls_beside_a_heavy_machine(inertia):
    model = ball_beside_machine(inertia)
    assert not model.diagnosis.massless
    ratio = inertia / (1e-4 * 5e-3**2)
    rolling = (0.2 - ratio * 3.0 * 5e-3) / (1 + ratio)  # angular momentum about the contact
    motion = da.solve_nonsmooth(model, 0.2, step=1e-3)
    assert motion["ball.vx"].values[-1] == pytest.approx(rolling, rel=1e-9)


def test_located_impacts_of_a_small_ball_beside_a_heavy_machine():
    motion = da.solve_dynamics(ball_beside_machine(1e-9), 0.2)
    assert motion["ball.vx"].values[-1] == pytest.approx((0.2 - 0.4 * 0.015) / 1.4, rel=1e-9)


@pytest.mark.parametrize("inertia", [0.0, 1e-25])
def test_inertia_of_zero_or_rounding_is_refused(inertia):
    model = ball_beside_machine(inertia)
    assert model.diagnosis.massless == ("ball",)
    with pytest.raises(SingularityError, match="ball: can move without any mass moving"):
        da.solve_nonsmooth(model, 0.1, step=1e-3)


def test_a_small_sphere_rolls_beside_a_heavy_machine():
    system = da.System("sphere beside a machine", gravity=(0.0, 0.0, -9.81))
    system.add(spatial.Body("machine", mass=1e4, inertia=(2e3, 2e3, 2e3), position=(-3, 0, 0)))
    start = {"position": (0.0, 0.0, 1e-3), "velocity": (0.2, 0.0, 0.0)}
    ball = system.add(spatial.Sphere("ball", mass=1e-6, radius=1e-3, **start))
    floor = spatial.contact.HalfSpace(system.ground.frame())
    shapes = [spatial.contact.Sphere(ball, 1e-3), floor]
    system.add(spatial.Collisions("contacts", shapes, friction=0.3))
    motion = da.solve_nonsmooth(system.build(), 0.2, step=1e-3)
    assert motion["ball.vx"].values[-1] == pytest.approx(5 / 7 * 0.2, rel=1e-9)
