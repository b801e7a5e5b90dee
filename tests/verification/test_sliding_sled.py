"""A sled on three balls that slides and spins: friction opposes the mean of the slip in a step.

    Σ N_i = m g,   Σ (r_i − c) × (N_i n − μ N_i s_i/|s_i|) = (0, 0, C α),   m a = −μ Σ N_i s_i/|s_i|

as long as no ball lifts off. The loads of three balls are determinate.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

contact = spatial.contact
MASS, INERTIA, HEIGHT, FRICTION, GRAVITY, RADIUS = 2.0, 0.03, 0.05, 0.3, 9.81, 0.02
PLACES = np.array([[0.12, 0.0], [-0.08, 0.1], [-0.05, -0.11]])
"""Of the balls, seen from above, relative to the mass centre [m]."""
START = np.array([0.0, 0.0, 0.0, 0.9, 0.3, 9.0])
"""x, y, angle, and their rates [m, m/s, rad, rad/s]."""
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


def rates(_, state: np.ndarray) -> np.ndarray:
    """Rates of the state of the sled."""
    angle, speed, spin = state[2], state[3:5], state[5]
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    arm = PLACES @ turn.T
    slip = speed + spin * np.column_stack([-arm[:, 1], arm[:, 0]])
    push = -FRICTION * slip / np.linalg.norm(slip, axis=1)[:, None]  # per load
    about_x = arm[:, 1] + HEIGHT * push[:, 1]
    about_y = -arm[:, 0] - HEIGHT * push[:, 0]
    loads = np.linalg.solve([np.ones(3), about_x, about_y], [MASS * GRAVITY, 0.0, 0.0])
    assert loads.min() > 0
    torque = loads @ (arm[:, 0] * push[:, 1] - arm[:, 1] * push[:, 0])
    return np.array([*speed, spin, *(loads @ push / MASS), torque / INERTIA])


def sled() -> da.System:
    system = da.System("sled", gravity=(0.0, 0.0, -GRAVITY))
    x, y, _, vx, vy, spin = START
    body = spatial.Body(
        "sled",
        mass=MASS,
        inertia=(INERTIA,) * 3,
        position=(x, y, HEIGHT),
        velocity=(vx, vy, 0.0),
        angular_velocity=(0.0, 0.0, spin),
    )
    system.add(body)
    balls = [
        contact.Sphere(body.point(float(x), float(y), RADIUS - HEIGHT), RADIUS) for x, y in PLACES
    ]
    ground = contact.HalfSpace(system.ground.frame(axis=(0, 0, 1)))
    system.add(spatial.Collisions("touch", [ground, *balls], friction=FRICTION))
    return system


def velocities(motion: da.Motion) -> np.ndarray:
    """Velocity and spin at the end."""
    velocity, spin = (
        motion[f"sled.{name}"].values[-1] for name in ("velocity", "angular_velocity")
    )
    return np.array([*velocity[:2], spin[2]])


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_errors_of_second_order(scheme):
    model, end = sled().build(), 0.2
    exact = solve_ivp(rates, (0.0, end), START, rtol=1e-11, atol=1e-12).y[3:, -1]
    errors = []
    for h in (4e-3, 2e-3):
        motion = da.solve_nonsmooth(model, end, step=h, integrator=scheme)
        assert motion.status.success
        errors.append(np.abs(velocities(motion) - exact).max())
    assert errors[1] < 5e-6  # of 9 rad/s
    assert errors[0] / errors[1] == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize("scheme", SCHEMES, ids=lambda scheme: type(scheme).__name__)
def test_sled_comes_to_rest(scheme):
    """The slip of a ball is small where its direction turns fast, and ends in a step, in which
    friction opposes the slip at its end."""
    motion = da.solve_nonsmooth(sled().build(), 0.6, step=5e-4, integrator=scheme)
    assert motion.status.success
    assert np.abs(velocities(motion)).max() < 1e-8
    slides = solve_ivp(rates, (0.0, 0.6), START, rtol=1e-9, max_step=1e-4, events=_stops)
    place = motion["sled.position"].values[-1, :2]
    np.testing.assert_allclose(place, slides.y[:2, -1], atol=5e-6)


def _stops(_, state: np.ndarray) -> float:
    return float(np.abs(state[3:]).max() - 1e-3)


_stops.terminal = True  # type: ignore[attr-defined]
