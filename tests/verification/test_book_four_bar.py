"""The four-bar of section 5.4.3 and example 5.2, step by step against joint angles in NumPy.

The twin writes the open chain of three bars with absolute angles, closes it by two equations, and
takes the same RK–Gill steps with the same corrections; nothing of the package is in it.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

import dalembert as da

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
MASS, LENGTH, G = np.array([1.5, 5.0, 3.0]), np.array([0.3, 1.0, 0.6]), 9.81
INERTIA = MASS * LENGTH**2 / 12
ARMS = np.array(
    [[LENGTH[0] / 2, 0, 0], [LENGTH[0], LENGTH[1] / 2, 0], [*LENGTH[:2], LENGTH[2] / 2]]
)
STEP, COUNT, R = 0.05, 160, np.sqrt(2)


def partials(q):
    """Partial velocities of the three mass centres, x and y."""
    return -ARMS * np.sin(q), ARMS * np.cos(q)


def mass(q):
    (x, y), weight = partials(q), np.diag(MASS)
    return x.T @ weight @ x + y.T @ weight @ y + np.diag(INERTIA)


def load(q, w):
    """Weight less the forces of moving bases."""
    x, y = partials(q)
    ax, ay = -(ARMS * np.cos(q)) @ w**2, -(ARMS * np.sin(q)) @ w**2
    return -x.T @ (MASS * ax) - y.T @ (MASS * (ay + G))


def potential(q):
    return G * MASS @ (ARMS @ np.sin(q))


def gap(q):
    return np.array([LENGTH @ np.cos(q), LENGTH @ np.sin(q) - 1.0])


def jacobian(q):
    return np.array([-LENGTH * np.sin(q), LENGTH * np.cos(q)])


def rate(state, baumgarte: bool):
    q, w = state[:3], state[3:]
    c = jacobian(q)
    xi = np.array([(LENGTH * np.cos(q)) @ w**2, (LENGTH * np.sin(q)) @ w**2])
    if baumgarte:
        xi = xi - 10 * c @ w - 25 * gap(q)
    saddle = np.block([[mass(q), c.T], [c, np.zeros((2, 2))]])
    return np.concatenate([w, np.linalg.solve(saddle, np.concatenate([load(q, w), xi]))[:3]])


def gill(state, baumgarte: bool):
    h = STEP
    k1 = rate(state, baumgarte)
    k2 = rate(state + h / 2 * k1, baumgarte)
    k3 = rate(state + h * ((R - 1) / 2 * k1 + (2 - R) / 2 * k2), baumgarte)
    k4 = rate(state + h * (-R / 2 * k2 + (2 + R) / 2 * k3), baumgarte)
    return state + h / 6 * (k1 + (2 - R) * k2 + (2 + R) * k3 + k4)


def towards(q, level):
    """Mass-orthogonal correction (5.21)."""
    c, weighted = jacobian(q), np.linalg.solve(mass(q), jacobian(q).T)
    return -weighted @ np.linalg.solve(c @ weighted, level)


def corrected(state, energy: float | None):
    q, w = state[:3], state[3:]
    for _ in range(6):
        q = q + towards(q, gap(q))
    w = w + towards(q, jacobian(q) @ w)
    if energy is not None:
        kinetic = w @ mass(q) @ w / 2
        w = w * np.sqrt(1 - (kinetic + potential(q) - energy) / kinetic)
    return np.concatenate([q, w])


def twin(case: str) -> np.ndarray:
    """Angles and their rates at all steps, (6, 161)."""
    q = np.array([np.pi, 0.69, 2.48])
    for _ in range(20):
        q[1:] -= np.linalg.solve(jacobian(q)[:, 1:], gap(q))
    c = jacobian(q)
    w = np.array([1.0, *np.linalg.solve(c[:, 1:], -c[:, 0])])
    energy = w @ mass(q) @ w / 2 + potential(q)
    states = [np.concatenate([q, w])]
    for _ in range(COUNT):
        state = gill(states[-1], case == "b")
        if case in "cd":
            state = corrected(state, energy if case == "d" else None)
        states.append(state)
    return np.array(states).T


@pytest.mark.few(2)
@pytest.mark.parametrize("case", "abcd")
def test_every_step_is_that_of_the_joint_angles(case):
    example = importlib.import_module("four_bar_violation")
    name = next(n for n in example.CASES if n.startswith(f"({case})"))
    motion = da.solve_dynamics(
        example.build().build(),
        STEP * COUNT,
        step=STEP,
        integrator=da.RKGill(),
        stabilization=example.CASES[name],
        coordinates=example.ANGLES,
    )
    expected = twin(case)
    for k, bar in enumerate(("crank", "coupler", "rocker")):
        np.testing.assert_allclose(motion[f"{bar}.angle"], expected[k], atol=1e-8)
        np.testing.assert_allclose(motion[f"{bar}.angular_velocity"], expected[3 + k], atol=1e-7)
