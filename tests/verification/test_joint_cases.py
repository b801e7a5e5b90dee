"""Rigid bodies on one joint, released under gravity for 5 s: default runs beside SciPy.

Twins by hand: Newton–Euler equations with the reaction as unknown, or minimal coordinates, whose
velocities follow by complex steps. Integrated by DOP853 to 1e-11.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import spatial

G = np.array([0.0, 0.0, -9.81])
MASS, INERTIA = 1.0, np.diag([0.1, 0.04, 0.1])
PLATE = {"mass": MASS, "inertia": tuple(np.diag(INERTIA))}
TIGHT = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
END = 5.0


def _rotation(e: np.ndarray) -> np.ndarray:
    w, x, y, z = e / np.linalg.norm(e)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def _turned(e: np.ndarray, w: np.ndarray) -> np.ndarray:
    """Rate of Euler parameters by the angular velocity in inertial axes."""
    return 0.5 * np.concatenate([[-w @ e[1:]], e[0] * w + np.cross(w, e[1:])])


def _skew(a: np.ndarray) -> np.ndarray:
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def _about(n, angle) -> np.ndarray:
    """Rotation matrix by Rodrigues' formula; the angle may be complex."""
    k = _skew(np.asarray(n, dtype=float))
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * (k @ k)


@dataclass
class Twin:
    """Centre, velocity of the centre and reaction on the body over time, each (3, K)."""

    place: np.ndarray
    velocity: np.ndarray
    force: np.ndarray


def _solved(rates: Callable, start: np.ndarray, times: np.ndarray) -> np.ndarray:
    return solve_ivp(rates, (0, END), start, t_eval=times, **TIGHT).y


# Newton–Euler -----------------------------------------------------------------------
def _hung(times: np.ndarray, across: Callable, ball: np.ndarray, start: np.ndarray) -> Twin:
    """A body on a massless link that ends in a ball at ``ball`` of the body.

    ``across(P, v)`` gives rows C and c with ``C a_P = c`` for the acceleration of the ball; the
    reaction on the body is ``Cᵀ λ``.
    """

    def accelerations(x: np.ndarray) -> np.ndarray:
        r, e, v, w = x[:3], x[3:7], x[7:10], x[10:13]
        turn = _rotation(e)
        s, inertia = turn @ ball, turn @ INERTIA @ turn.T
        rows, right = across(r + s, v + np.cross(w, s))
        n = len(rows)
        matrix, rest = np.zeros((6 + n, 6 + n)), np.zeros(6 + n)
        matrix[:3, :3], matrix[3:6, 3:6] = MASS * np.eye(3), inertia
        matrix[:3, 6:], matrix[3:6, 6:] = -rows.T, -_skew(s) @ rows.T
        matrix[6:, :3], matrix[6:, 3:6] = rows, -rows @ _skew(s)
        rest[:3], rest[3:6] = MASS * G, -np.cross(w, inertia @ w)
        rest[6:] = right - rows @ np.cross(w, np.cross(w, s))
        return np.linalg.solve(matrix, rest)

    def rates(_, x: np.ndarray) -> np.ndarray:
        a = accelerations(x)
        return np.concatenate([x[7:10], _turned(x[3:7], x[10:13]), a[:6]])

    x = _solved(rates, np.concatenate([start, [1, 0, 0, 0], np.zeros(6)]), times)
    force = np.column_stack([MASS * (accelerations(c)[:3] - G) for c in x.T])
    return Twin(x[:3], x[7:10], force)


def _on_distance(place: np.ndarray, v: np.ndarray):
    return place[None, :], np.array([-v @ v])


def _on_hinge(place: np.ndarray, v: np.ndarray):
    """Distance from the axis z, and no travel along it."""
    return np.array([place, [0.0, 0.0, 1.0]]), np.array([-v @ v, 0.0])


# minimal coordinates ----------------------------------------------------------------
Pose = Callable[[np.ndarray], list[tuple[float, np.ndarray, np.ndarray, np.ndarray]]]


def _minimal(times: np.ndarray, pose: Pose, count: int) -> Twin:
    """Bodies posed by coordinates: ``pose(q)`` lists mass, inertia, centre and rotation."""
    tiny, short = 1e-30, 1e-5

    def jacobians(q: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
        computed = [(np.zeros((3, count)), np.zeros((3, count))) for _ in pose(q)]
        now = pose(q)
        for k in range(count):
            moved = pose(q + 1j * tiny * np.eye(count)[k])
            for (v, w), (_, _, r, turn), (_, _, _, still) in zip(computed, moved, now, strict=True):
                spin = np.imag(turn) / tiny @ np.real(still).T
                v[:, k], w[:, k] = np.imag(r) / tiny, (spin[2, 1], spin[0, 2], spin[1, 0])
        return computed

    def accelerations(q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        here = jacobians(q)
        ahead, back = jacobians(q + short * u), jacobians(q - short * u)
        mass, rest, biases = np.zeros((count, count)), np.zeros(count), []
        bodies = zip(pose(q), here, ahead, back, strict=True)
        for (m, i, _, turn), (v, w), (va, wa), (vb, wb) in bodies:
            turned = np.real(turn) @ i @ np.real(turn).T
            bias, spun = ((a - b) @ u / (2 * short) for a, b in ((va, vb), (wa, wb)))
            mass += m * v.T @ v + w.T @ turned @ w
            rest += m * v.T @ (G - bias) - w.T @ (turned @ spun + np.cross(w @ u, turned @ (w @ u)))
            biases.append(bias)
        a = np.linalg.solve(mass, rest)
        return a, here[0][0] @ a + biases[0]

    def rates(_, x: np.ndarray) -> np.ndarray:
        return np.concatenate([x[count:], accelerations(x[:count], x[count:])[0]])

    x = _solved(rates, np.zeros(2 * count), times)
    q, u = x[:count].T, x[count:].T
    place = np.column_stack([np.real(pose(c)[0][2]) for c in q])
    velocity = np.column_stack([jacobians(c)[0][0] @ d for c, d in zip(q, u, strict=True)])
    m = pose(q[0])[0][0]
    force = [m * (accelerations(c, d)[1] - G) for c, d in zip(q, u, strict=True)]
    return Twin(place, velocity, np.column_stack(force))


TILTED = np.array([0.6, 0.0, 0.8])
LEVER, LONG = np.array([0.3, 0.2, -0.1]), np.array([0.7, 0.2, -0.1])
PITCH, RADIUS, RACK = 0.4, 0.25, 1.3


def _universal(q):
    turn = _about((1, 0, 0), q[0]) @ _about((0, 1, 0), q[1])
    return [(MASS, INERTIA, turn @ LONG, turn)]


def _cylindrical(q):
    turn = _about(TILTED, q[1])
    return [(MASS, INERTIA, q[0] * TILTED + turn @ LEVER, turn)]


def _screw(q):
    turn = _about(TILTED, q[0])
    return [(MASS, INERTIA, PITCH * q[0] / (2 * np.pi) * TILTED + turn @ LEVER, turn)]


def _rack(q):
    turn = _about((0, 1, 0), q[0])
    pinion = (MASS, INERTIA, turn @ LEVER, turn)
    still = np.eye(3)
    return [pinion, (RACK, INERTIA, RADIUS * q[0] * np.array([0.8, 0, 0.6]), still)]


# models -----------------------------------------------------------------------------
def _plate(system: da.System, position) -> spatial.Body:
    return system.add(spatial.Body("plate", position=position, **PLATE))


def _on_axis(system: da.System, kind: type, axis, **more):
    plate = _plate(system, tuple(LEVER))
    ends = system.ground.frame((0, 0, 0), axis=axis), plate.frame(tuple(-LEVER), axis=axis)
    return system.add(kind("joint", *ends, **more))


def _link(system: da.System) -> None:
    plate = _plate(system, (2, 2, 0))
    hinge, ball = system.ground.frame((0, 0, 0), axis=(0, 0, 1)), plate.point(0, -2, 0)
    system.add(spatial.RevoluteSphericalLink("joint", hinge, ball, length=2.0))


def _distance(system: da.System) -> None:
    plate = _plate(system, (2, 2, 0))
    ends = system.ground.point(0, 0, 0), plate.point(0, -2, 0)
    system.add(spatial.RigidLink("joint", *ends, length=2.0))


def _cross(system: da.System) -> None:
    plate = _plate(system, tuple(LONG))
    ends = (
        system.ground.frame((0, 0, 0), axis=(1, 0, 0)),
        plate.frame(tuple(-LONG), axis=(0, 1, 0)),
    )
    system.add(spatial.Universal("joint", *ends))


def _meshed(system: da.System) -> None:
    hinge = _on_axis(system, spatial.Revolute, (0, 1, 0))
    rack = system.add(spatial.Body("rack", mass=RACK, inertia=tuple(np.diag(INERTIA))))
    along = {"axis": (0.8, 0, 0.6)}
    rail = spatial.Prismatic("rail", system.ground.frame(**along), rack.frame(**along))
    system.add(rail)
    system.add(spatial.RackAndPinion("mesh", hinge, rail, radius=RADIUS))


CASES: dict[str, tuple[Callable, Callable]] = {
    "revolute-spherical link": (
        _link,
        lambda t: _hung(t, _on_hinge, np.array([0, -2.0, 0]), np.array([2.0, 2, 0])),
    ),
    "distance link": (
        _distance,
        lambda t: _hung(t, _on_distance, np.array([0, -2.0, 0]), np.array([2.0, 2, 0])),
    ),
    "universal": (_cross, lambda t: _minimal(t, _universal, 2)),
    "cylindrical": (
        lambda s: _on_axis(s, spatial.Cylindrical, tuple(TILTED)),
        lambda t: _minimal(t, _cylindrical, 2),
    ),
    "screw": (
        lambda s: _on_axis(s, spatial.Screw, tuple(TILTED), pitch=PITCH),
        lambda t: _minimal(t, _screw, 1),
    ),
    "rack": (_meshed, lambda t: _minimal(t, _rack, 1)),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("name", CASES)
def test_default_run_agrees_with_scipy(name):
    describe, solve = CASES[name]
    system = da.System(name, gravity=tuple(G))
    describe(system)
    motion = da.solve_dynamics(system.build(), END, outputs=51)
    twin = solve(motion.time)
    seen = {
        "plate.position": twin.place,
        "plate.velocity": twin.velocity,
    }
    if name != "rack":  # whose pinion also carries the force of the teeth
        seen["joint.force"] = twin.force
    for measure, expected in seen.items():
        error = np.abs(motion[measure].values.T - expected).max() / np.abs(expected).max()
        assert error < 1e-5, (measure, error)
    assert motion.error_estimate.share < 1e-5 and not motion.warnings
