"""Gradients of motions with force laws in many contacts, against closed forms and differences."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from directional import assert_slopes
from thorough import sampled

import dalembert as da
from dalembert import planar

contact = planar.contact


@functools.cache
def ball_at_a_wall(law: str, **values: float) -> da.Model:
    """A ball that hits a wall without gravity."""
    start = {"stiffness": 1e6, "damping": 0.2, "speed": 2.0, "mass": 1.5} | values
    system = da.System("ball")
    p = {name: system.parameter(name, value) for name, value in start.items()}
    like = {"mass": p["mass"], "position": (0.0, 2e-4), "velocity": (0.0, -p["speed"])}
    ball = system.add(planar.Particle("ball", **like))
    kind = getattr(contact, law)(stiffness=p["stiffness"], damping=p["damping"])
    shapes = [contact.Vertex(ball.center), contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("wall", shapes, law=kind))
    return system.build()


def dropped(law: str, step: float, scheme=None, end: float = 0.02, **values: float) -> da.Motion:
    """Through the whole contact."""
    options = {"integrator": scheme or da.AnticipatedImpacts()}
    motion = da.solve_nonsmooth(ball_at_a_wall(law, **values), end, step=step, **options)
    assert motion.status.success and motion["ball.vy"][-1].item() > 0
    return motion


def both(motion: da.Motion, *responses) -> np.ndarray:
    direct = da.sensitivity(motion, list(responses), method="direct").values
    adjoint = da.sensitivity(motion, list(responses), method="adjoint").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-9, atol=1e-12 * abs(direct).max())
    return direct


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_restitution_of_hunt_and_crossley(scheme):
    """``v⁺ = e v``, ``(1 + e) d = ln (1 + d) − ln (1 − d e)``, ``d = c v``: neither the stiffness
    nor the mass matters, and the error is of second order."""
    c, v, errors = 0.2, 2.0, []
    d = c * v
    e = contact.achieved_restitution(d)
    by_e, by_d = d - d / (1 - d * e), 1 + e - 1 / (1 + d) - e / (1 - d * e)
    slope = -by_d / by_e  # de/dd
    exact = np.array([0.0, slope * v**2, e + slope * d, 0.0])
    size = np.array([1e6, 0.2, 2.0, 1.5])
    for step in (8e-4, 4e-4, 2e-4):
        gradient = both(dropped("HuntCrossley", step, scheme), da.final("ball.vy"))[0]
        errors.append(np.abs((gradient - exact) * size).max())
    assert errors[-1] < 2e-3 and errors[-1] < errors[0] / 6


@pytest.mark.thorough
def test_duration_of_a_linear_contact():
    """Kelvin and Voigt without damping: half a period, ``y = v (t − t₁ − π √(m/K))``."""
    end = 0.006
    motion = dropped("KelvinVoigt", 2.5e-5, end=end, damping=0.0)
    gradient = both(motion, da.final("ball.y"), da.final("ball.vy"))[:, [0, 2, 3]]
    k, v, m = 1e6, 2.0, 1.5
    half = np.pi * np.sqrt(m / k)
    exact = [[v * half / (2 * k), end - half, -v * half / (2 * m)], [0.0, 1.0, 0.0]]
    np.testing.assert_allclose(gradient[0], exact[0], rtol=2e-3)
    np.testing.assert_allclose(gradient[1] * [k, v, m], np.multiply(exact[1], [k, v, m]), atol=2e-3)


def two_discs_and_a_floor() -> da.Model:
    system = da.System("discs", gravity=(0, -1))
    stiffness, damping = system.parameter("stiffness", 1e5), system.parameter("damping", 0.3)
    height, size = system.parameter("height", 0.05, "m"), system.parameter("size", 0.1, "m")
    mass, friction = system.parameter("mass", 1.0, "kg"), system.parameter("friction", 0.2)
    a = planar.Body("a", mass=mass, inertia=0.004, position=(0, 0), velocity=(1, 0))
    b = planar.Body("b", mass=2.0, inertia=0.004, position=(0.201, height))
    shapes = [contact.Circle(system.add(body), size) for body in (a, b)]
    shapes.append(contact.HalfPlane(system.ground.point(0, -0.1001)))
    law = contact.HuntCrossley(stiffness=stiffness, damping=damping)
    system.add(planar.Collisions("touch", shapes, law=law, friction=friction))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("theta", sampled([0.7, 0.5], 2))
def test_differences_of_the_run_confirm_the_gradient(theta):
    """Means over curved paths, friction, and all parameters; differences converge to it."""
    scheme, solver = da.MoreauJean(theta=theta), da.ContactSolver(tolerance=1e-13)
    options = {"step": 1e-3, "integrator": scheme, "solver": solver}
    model, names = two_discs_and_a_floor(), ["a.x", "b.vy", "b.vx", "a.angular_velocity"]
    motion = da.solve_nonsmooth(model, 0.02, **options)
    gradient = both(motion, *map(da.final, names))

    def ends(parameters: np.ndarray) -> np.ndarray:
        moved = da.solve_nonsmooth(model, 0.02, parameters=parameters, **options)
        return np.array([moved[name][-1].item() for name in names])

    assert_slopes(gradient, ends, motion.parameters, 5e-6, 2e-6)
