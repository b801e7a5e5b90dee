"""Examples of trajectories and of synthesis: each has a number found elsewhere."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import numbers, script
from one_freedom import FourBar, slope
from scipy.optimize import fsolve
from scipy.sparse import coo_array
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation


@pytest.mark.thorough
def test_torque_of_the_four_bar_is_that_of_its_one_equation(pictures: Path) -> None:
    """``τ = J q̈ + J' q̇²/2 + V'``, by virtual work, along the motion that was planned."""
    printed = numbers("swing_up", pictures)
    assert printed["distance of plan and run"] < 0.01
    assert printed["angle of the pole at the end [rad]"] == pytest.approx(math.pi, abs=0.01)
    assert printed["swing of the rocker [rad]"] == pytest.approx(0.7, abs=0.002)
    best = script("swing_up").moved()
    bars = FourBar((0.3, 0.9, 0.7), (1.0, 2.0, 1.5), (1.0, 0.0), 1)
    planned = best.planned
    q, speed = planned.values("crank.angle"), planned.values("crank.angular_velocity")
    torque = best.control("torque").values[::2]
    for k in range(0, q.size, 3):
        force = slope(bars.potential, q[k]) + slope(bars.inertia, q[k]) * speed[k] ** 2 / 2
        needed = bars.inertia(q[k]) * planned.trajectory.a[2, k] + force
        assert torque[k] == pytest.approx(needed, abs=1e-6)


@pytest.mark.thorough
def test_counterweights_are_those_of_berkof_and_lowen(pictures: Path) -> None:
    printed = numbers("four_bar_balancing", pictures)
    for name, mass in script("four_bar_balancing").balanced_masses().items():
        assert printed[f"mass on the {name} [kg]"] == pytest.approx(mass, rel=1e-6)
    assert printed["force without force [N]"] < 1e-6 * printed["force before [N]"]
    assert printed["moment without force [N m]"] > printed["moment before [N m]"]
    half = printed["force half the force [N]"] / printed["force before [N]"]
    assert half == pytest.approx(0.5, rel=1e-4)
    assert printed["moment half the force [N m]"] <= printed["moment before [N m]"]


def test_toe_of_the_wheel_by_its_eight_equations(pictures: Path) -> None:
    """Both balls, the tie rod and the height of the wheel, solved by SciPy for full bump."""
    printed = numbers("bump_steer", pictures)
    rod = np.array([0.2, printed["rod_y [m]"], printed["rod_z [m]"]])
    rest, steer = np.array([0.0, -0.8, 0.3]), np.array([0.15, 0.05, 0.0])
    lower, upper = np.array([0, 0.05, -0.2]), np.array([0.04, 0.125, 0.225])
    bushes = (
        ((-0.2, -0.4, 0.15), (0.4, -0.05, 0.005), rest + lower),
        ((0.1, -0.45, 0.525), (0.15, -0.04, 0.005), rest + upper),
    )

    def ball(bush, angle: float) -> np.ndarray:
        place, axis, begin = map(np.array, bush)
        turn = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
        return place + turn.apply(begin - place)

    def open_by(x: np.ndarray) -> np.ndarray:
        wheel, turn = x[:3], Rotation.from_rotvec(x[3:6])
        tie = np.linalg.norm(wheel + turn.apply(steer) - rod) - np.linalg.norm(rest + steer - rod)
        return np.concatenate(
            [
                wheel + turn.apply(lower) - ball(bushes[0], x[6]),
                wheel + turn.apply(upper) - ball(bushes[1], x[7]),
                [tie, wheel[2] - 0.38],
            ]
        )

    x = fsolve(open_by, np.r_[rest + np.array([0, 0, 0.08]), np.zeros(5)], xtol=1e-13)
    toe = math.degrees(math.asin(Rotation.from_rotvec(x[3:6]).apply([0, 0.1, 0])[0] / 0.1))
    assert printed["toe at full bump [deg]"] == pytest.approx(toe, abs=1e-6)
    assert (
        printed["toe after [deg rms]"] < 0.4 * printed["toe without bump steer at rest [deg rms]"]
    )
    assert printed["toe after [deg rms]"] < 0.1 * printed["toe before [deg rms]"]


def test_gripper_by_two_circles(pictures: Path) -> None:
    """The pin is where its arm and its link meet; the tip turns with the arm."""
    printed = numbers("gripper", pictures)
    v = {n: printed[f"{n} [mm]"] for n in (*script("gripper").START, "tip_x")}
    pivot, pin = complex(v["pivot_x"], v["pivot_y"]), complex(v["pin_x"], v["pin_y"])
    ear, tip = 1j * v["slider_y"], complex(v["tip_x"], 25.0)
    arm, link = abs(pin - pivot), abs(pin - ear)
    for slider, half in ((-10.0, 10.0), (0.0, 25.0), (10.0, 40.0)):
        line = pivot - (ear + slider)
        along = (abs(line) ** 2 + link**2 - arm**2) / (2 * abs(line))
        across = math.sqrt(link**2 - along**2)
        there = ear + slider + line / abs(line) * (along - 1j * across)
        turned = (there - pivot) / (pin - pivot)
        assert (pivot + turned * (tip - pivot)).imag == pytest.approx(half, abs=0.02)
    assert printed["miss"] < 0.01 * printed["miss before"]
    assert printed["ratio, largest"] - printed["ratio, least"] < 0.05


def stiffness_of_a_square() -> np.ndarray:
    """Of a bilinear element of unit size, plane stress, ν = 0.3, as in the 88 lines."""
    a = np.array([[12, 3, -6, -3], [3, 12, 3, 0], [-6, 3, 12, -3], [-3, 0, -3, 12]])
    b = np.array([[-6, -3, 0, 3], [-3, -6, -3, -6], [0, -3, -6, 3], [3, -6, 3, -6]])
    c = np.array([[-4, 3, -2, 9], [3, -4, -9, 4], [-2, -9, -4, -3], [9, 4, -3, -4]])
    d = np.array([[2, -3, 4, -9], [-3, 2, 9, -2], [4, 9, 2, 3], [-9, -2, 3, 2]])
    first, second = (np.block([[x, y], [y.T, x]]) for x, y in ((a, b), (c, d)))
    return (first + 0.3 * second) / (1 - 0.3**2) / 24


def by_optimality_criteria(columns: int, cone: np.ndarray) -> float:
    """Compliance at the end of the method of Andreassen et al. (2011), density filter."""
    rows, single = columns // 3, stiffness_of_a_square()
    i, j = (x.ravel() for x in np.meshgrid(range(columns), range(rows), indexing="ij"))
    corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    nodes = np.stack([x * (rows + 1) + y for x, y in corners], axis=1)
    places = np.stack([2 * nodes, 2 * nodes + 1], axis=2).reshape(-1, 8)
    count = 2 * (columns + 1) * (rows + 1)
    load, u = np.zeros(count), np.zeros(count)
    load[2 * rows + 1] = -1
    held = np.r_[2 * np.arange(rows + 1), 2 * columns * (rows + 1) + 1]
    free = np.setdiff1d(np.arange(count), held)
    x, change = np.full(i.size, 0.5), 1.0
    while change > 0.01:
        filtered = cone @ x
        moduli = 1e-9 + (1 - 1e-9) * filtered**3
        entries = (moduli[:, None, None] * single).ravel()
        at = np.repeat(places, 8, axis=1).ravel(), np.tile(places, (1, 8)).ravel()
        matrix = coo_array((entries, at), shape=(count, count)).tocsc()
        u[free] = spsolve(matrix[free][:, free], load[free])
        energy = np.einsum("ei,ij,ej->e", u[places], single, u[places])
        falls, fills = cone.T @ (3 * (1 - 1e-9) * filtered**2 * energy), cone.T @ np.ones(i.size)
        low, high = 0.0, 1e9
        while high - low > 1e-4 * (high + low):
            price = (low + high) / 2
            moved = x * np.sqrt(falls / fills / price)
            moved = np.clip(moved, np.maximum(0, x - 0.2), np.minimum(1, x + 0.2))
            low, high = (price, high) if (cone @ moved).mean() > 0.5 else (low, price)
        change, x = float(abs(moved - x).max()), moved
    return float(moduli @ energy)


@pytest.mark.thorough
def test_beam_is_as_stiff_as_by_88_lines(pictures: Path) -> None:
    """Those lines, written again here; of 60 by 20 elements they give the published 233.71."""
    printed, example = numbers("mbb_beam", pictures), script("mbb_beam")
    reference = by_optimality_criteria(30, example.weights(30, 10))
    assert printed["compliance"] == pytest.approx(reference, rel=3e-3)
    assert printed["compliance"] < reference * 1.0005
    assert printed["volume"] <= 0.5 * (1 + 1e-6)


@pytest.mark.thorough
def test_targets_of_synthesis(pictures: Path) -> None:
    """Dead centres by the law of cosines; what is met exactly, and what as well as can be."""
    printed, example = numbers("synthesis_tasks", pictures), script("synthesis_tasks")
    d, c, f, g = (printed[f"rocker: {n}"] for n in ("crank", "coupler", "follower", "ground"))

    def angle(near: float, other: float, across: float) -> float:
        return math.acos((near**2 + other**2 - across**2) / (2 * near * other))

    swing = angle(f, g, c + d) - angle(f, g, c - d)
    advance = angle(c - d, g, f) - angle(c + d, g, f)
    assert swing == pytest.approx(example.SWING, abs=1e-8)
    assert abs(advance) == pytest.approx(example.ADVANCE, abs=1e-8)
    assert printed["error of the function"] < 1e-5 and printed["error of the motion"] < 2e-3
    assert printed["error of the six-bar"] < 1e-4 and printed["error of the geared five-bar"] < 1e-8
    assert printed["four-bars"] > printed["of five points"] >= 2
