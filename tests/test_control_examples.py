"""The examples of sampled control and their numbers, from linear theory and closed forms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers, script
from scipy.linalg import expm, solve_discrete_are


def held(a: np.ndarray, b: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Matrices of a plant with a held input."""
    n = len(a)
    whole = expm(np.block([[a, b[:, None]], [np.zeros((1, n + 1))]]) * time)
    return whole[:n, :n], whole[:n, n:]


def test_regulator_of_cart_and_pole(pictures: Path) -> None:
    """Gains by hand from the equations of the upright pole; its angle is counted from above."""
    e = script("cart_pole_lqr")
    half, moment = e.LENGTH / 2, e.POLE * e.LENGTH**2 / 3
    mass = np.array([[e.CART + e.POLE, -e.POLE * half], [-e.POLE * half, moment]])
    stiffness = np.diag([0.0, e.POLE * 9.81 * half])
    a = np.block(
        [[np.zeros((2, 2)), np.eye(2)], [np.linalg.solve(mass, stiffness), np.zeros((2, 2))]]
    )
    b = np.concatenate([[0, 0], np.linalg.solve(mass, [1.0, 0.0])])
    ad, bd = held(a, b, e.SAMPLE)
    p = solve_discrete_are(ad, bd, np.diag(e.WEIGHTS), [[e.EFFORT]])
    gains = np.linalg.solve(e.EFFORT + bd.T @ p @ bd, bd.T @ p @ ad)[0]
    printed = numbers("cart_pole_lqr", pictures)
    found = [printed[f"gain of {name}"] for name in ("x", "angle", "speed", "rate")]
    assert np.allclose(found, gains, rtol=1e-6)
    assert abs(printed["final angle"]) < 0.01
    assert abs(printed["final place"]) < 0.02
    assert printed["largest force"] == pytest.approx(gains[1] * e.TILT, rel=1e-5)  # at the start


def test_skyhook_of_quarter_car(pictures: Path) -> None:
    """Linear plant with a force held between samples, by matrix exponentials."""
    e = script("active_suspension")
    a = np.zeros((4, 4))
    a[0, 1] = a[2, 3] = 1.0
    for row, mass, sign in ((1, e.BODY, 1), (3, e.WHEEL, -1)):
        a[row] = sign * np.array([-e.SPRING, -e.DAMPER, e.SPRING, e.DAMPER]) / mass
    a[3, 2] -= e.TYRE / e.WHEEL
    b = np.array([0, 1 / e.BODY, 0, -1 / e.WHEEL])
    rest = np.array([e.KERB, 0, e.KERB, 0])
    parts = 5
    advance, push = held(a, b, e.SAMPLE / parts)
    printed = numbers("active_suspension", pictures)
    for gain, name in ((0.0, "passive"), (e.GAIN, "active")):
        x, heights = -rest, [0.0]
        for k in range(round(e.DURATION / e.SAMPLE) * parts):
            force = -gain * x[1] if k % parts == 0 else force  # noqa: F821
            x = advance @ x + push[:, 0] * force
            heights.append(x[0] + e.KERB)
        overshoot = printed[f"{name} overshoot"]
        assert overshoot == pytest.approx(max(heights) - e.KERB, abs=1e-7)
    assert printed["height after a second"] == pytest.approx(heights[1000], abs=1e-7)
    assert printed["rms acceleration, active"] < printed["rms acceleration, passive"]


def test_computed_torque_draws_a_circle(pictures: Path) -> None:
    """The error of torques held for T is of the order ``T``·jerk/K_p; without them centimetres."""
    printed = numbers("computed_torque", pictures)
    assert printed["error, computed torque"] < 3e-4
    assert printed["error, joints alone"] > 0.03
