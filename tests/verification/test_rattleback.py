"""A rattleback: an ellipsoid with skewed moments of inertia rolls, and its spin reverses.

The gap of an ellipsoid with the half-axes ``A`` over a plane is ``z − √(nᵀ A² n)``, n the normal
in body axes, and the contact point ``−A² n/√(nᵀ A² n)``. The motion is compared with the equations
of a body that rolls (Garcia & Hubbard, Proc. R. Soc. A 418, 1988), integrated by SciPy.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial

SQUARES, MASS, G, TIME = np.array([0.2, 0.03, 0.02]) ** 2, 1.0, 9.81, 1.5
SKEW = Rotation.from_euler("z", 0.09).as_matrix()
INERTIA = SKEW @ np.diag([4e-4, 8e-3, 8.2e-3]) @ SKEW.T
SPIN = np.array([0.0, 0.01, -2.0])
START = Rotation.from_euler("y", 0.005).as_matrix()


def support(turn: np.ndarray) -> tuple[np.ndarray, float]:
    """From the centre to the contact point, in body axes, and the height of the centre."""
    normal = turn.T @ (0, 0, 1)
    height = float(np.sqrt(normal @ (SQUARES * normal)))
    return -SQUARES * normal / height, height


def rolling(_: float, state: np.ndarray) -> np.ndarray:
    """Rates of a quaternion and of the angular velocity, in inertial axes."""
    quaternion, omega = state[:4] / np.linalg.norm(state[:4]), state[4:]
    turn = Rotation.from_quat(quaternion).as_matrix()
    local, height = support(turn)
    arm, up, normal = turn @ local, np.array([0, 0, 1.0]), turn.T @ (0, 0, 1)
    change = -np.cross(turn.T @ omega, normal)
    climb = normal @ (SQUARES * change) / height
    moved = -SQUARES * change / height + SQUARES * normal * climb / height**2
    arm_rate = turn @ moved + np.cross(omega, arm)
    inertia, cross = turn @ INERTIA @ turn.T, np.cross(np.eye(3), arm).T  # cross @ x = arm × x
    matrix = inertia - MASS * cross @ cross
    force = MASS * (G * up - np.cross(omega, arm_rate))
    moment = np.cross(arm, force) - np.cross(omega, inertia @ omega)
    (x, y, z, w), (a, b, c) = quaternion, omega
    rate = [a * w + b * z - c * y, -a * z + b * w + c * x, a * y - b * x + c * w]
    rate.append(-a * x - b * y - c * z)
    return np.concatenate([0.5 * np.array(rate), np.linalg.solve(matrix, moment)])


@functools.cache
def exact() -> np.ndarray:
    """(31, 3) angular velocities at equal times."""
    start = np.concatenate([Rotation.from_matrix(START).as_quat(), SPIN])
    times, accuracy = np.linspace(0, TIME, 31), {"rtol": 1e-11, "atol": 1e-13}
    return solve_ivp(rolling, (0, TIME), start, "DOP853", times, **accuracy).y[4:].T


@functools.cache
def rattleback() -> da.Model:
    system = da.System("rattleback", gravity=(0, 0, -G))
    local, height = support(START)
    start = {"velocity": tuple(-np.cross(SPIN, START @ local)), "angular_velocity": tuple(SPIN)}
    start |= {"position": (0, 0, height), "rotation": START}
    stone = system.add(spatial.Body("stone", mass=MASS, inertia=INERTIA, **start))
    axes = [stone.point(*row).position - stone.center.position for row in np.eye(3)]
    height = da.sqrt(sum(float(s) * e[2] ** 2 for s, e in zip(SQUARES, axes, strict=True)))
    arm = [
        -sum(float(s) * e[2] * e[k] for s, e in zip(SQUARES, axes, strict=True)) / height
        for k in range(3)
    ]
    v, w = stone.velocity, stone.angular_velocity
    slip = v[0] + w[1] * arm[2] - w[2] * arm[1], v[1] + w[2] * arm[0] - w[0] * arm[2]
    table = {"restitution": 0.0, "friction": 1.0}
    system.add(spatial.UnilateralConstraint("table", stone.z - height, slip, **table))
    return system.build()


def test_the_spin_reverses():
    times, reference = np.linspace(0, TIME, 31), exact()
    assert reference[0, 2] == -2.0 and reference[-1, 2] > 1.9
    located = da.solve_dynamics(rattleback(), TIME, outputs=times)
    turned = located["stone.angular_velocity"].values
    np.testing.assert_allclose(turned, reference, atol=2e-7)


@pytest.mark.thorough
def test_steps_reverse_the_spin():
    """The gap is a formula of the surface, whose contact moves in the step: order 1.6."""
    times, errors = np.linspace(0, TIME, 31), []
    for step in (2e-3, 1e-3):
        motion = da.solve_nonsmooth(rattleback(), TIME, step=step, outputs=times)
        assert motion.status.success
        turned = motion["stone.angular_velocity"].values
        errors.append(np.abs(turned - exact()).max())
    assert errors[0] < 0.05 and errors[0] > 2.8 * errors[1]
