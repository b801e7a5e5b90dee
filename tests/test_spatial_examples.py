"""The examples in space and their numbers, found elsewhere.

What holds of every example, these among them, stands in ``test_examples.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from example_runs import motion, numbers, script, value
from scipy.optimize import brentq

import dalembert as da

G = 9.81


def test_heavy_top_is_the_published_one(pictures: Path) -> None:
    """Height at 1 s of the benchmark; the axis stays between the two roots of its cubic."""
    assert value("heavy_top", "height") == pytest.approx(-0.74849079, abs=1e-7)
    printed = numbers("heavy_top", pictures)
    assert printed["height of the mass centre at 1 s [m]"] == pytest.approx(-0.74849079, abs=1e-7)
    about, along, spin, swing = 15.234375, 0.46875, 150.0, -4.61538
    energy, momentum = about * swing**2 / 2, about * swing
    kinetic = np.poly1d([-15 * G, energy]) * np.poly1d([-1, 0, 1]) * 2 * about
    turning = kinetic - np.poly1d([-along * spin, momentum]) ** 2
    lowest = min(r.real for r in turning.roots if abs(r.imag) < 1e-9 and abs(r) <= 1)
    assert printed["lowest height [m]"] == pytest.approx(lowest, abs=1e-4)
    assert printed["energy drift [J]"] < 1e-5


def test_spatial_slider_crank_is_the_exact_one(pictures: Path) -> None:
    """Slider at 1 s and 5 s by the one equation of the motion."""
    assert value("spatial_slider_crank", "x") == pytest.approx(0.211721661394, abs=1e-7)
    printed = numbers("spatial_slider_crank", pictures)
    assert printed["slider after 5 s [m]"] == pytest.approx(0.240719573741, abs=1e-7)
    assert printed["largest error of the energy [J]"] < 1e-7


def test_driveline_has_the_speeds_of_cardan_joints(pictures: Path) -> None:
    printed = numbers("universal_driveline", pictures)
    assert printed["fastest / input"] == pytest.approx(1 / np.cos(0.5), rel=1e-9)
    assert printed["slowest / input"] == pytest.approx(np.cos(0.5), rel=1e-5)
    slope = np.sin(0.5) / np.cos(0.5) ** 2
    assert printed["slope of fastest / input by beta [1/rad]"] == pytest.approx(slope, rel=1e-9)
    assert printed["largest error of the ratio"] < 1e-12
    assert printed["largest error of the output speed [rad/s]"] < 1e-11
    run = motion("universal_driveline")
    angle, c, s = run["motor.coordinate"].values, np.cos(0.5), np.sin(0.5)
    ratio = c / (1 - (s * np.cos(angle)) ** 2)
    slope = -2 * s**2 * np.sin(angle) * np.cos(angle) * ratio**2 / c
    torque = 5.0 + 2 * 0.02 * ratio * slope * 10.0**2  # of the load, and of d(J ω²/2)/dφ
    np.testing.assert_allclose(run["motor.effort"], torque, atol=1e-9)


@pytest.mark.thorough
def test_disc_rolls_in_its_steady_circle(pictures: Path) -> None:
    """``(Ia + m r²) ω Ω sin θ = (It Ω² sin θ − m g r) cos θ``."""
    tilt, turn, r = 1.2, 1.5, 0.3
    up, level = np.sin(tilt), np.cos(tilt)
    roll = (turn**2 * up * r / 4 - G) * level / (1.5 * r * turn * up)
    circle = r * roll / turn  # negative: opposite to the heading
    assert value("rolling_disc", "x") == pytest.approx(-circle * np.sin(turn * 4.0), abs=1e-8)
    friction = -2.0 * circle * turn**2 * np.cos(turn * 4.0)
    assert value("rolling_disc", "friction") == pytest.approx(friction, abs=1e-7)
    printed = numbers("rolling_disc", pictures)
    assert printed["diameter of the circle [m]"] == pytest.approx(2 * abs(circle), rel=1e-5)
    assert printed["height varies by [m], steady"] < 1e-8 < 0.05
    assert printed["height varies by [m], reeling"] > 0.01
    assert printed["energy drift [J], reeling"] < 1e-7
    assert printed["slip [m/s], reeling"] < 1e-12


@pytest.mark.thorough
def test_bricard_moves_as_published(pictures: Path) -> None:
    printed = numbers("bricard", pictures)
    assert printed["degrees of freedom"] == 1
    assert printed["degrees of freedom by Gruebler"] == 0
    assert printed["x of P2 after 10 s [m]"] == pytest.approx(0.9997309873, abs=1e-7)
    assert printed["largest error of the energy [J]"] < 1e-6


@pytest.mark.thorough
def test_gyroscope_precesses(pictures: Path) -> None:
    """``Ω = m g l / (J ω)``; let go at rest, the weight drops by about ``2 Ω² I / (m g)``."""
    printed, rate = numbers("gyroscope", pictures), 0.2 * G * 0.1 / (4e-3 * 400.0)
    assert printed["precession, steady [rad/s]"] == pytest.approx(rate, rel=1e-9)
    assert printed["axis leaves the level by [m], steady"] < 1e-9
    assert printed["precession, let go at rest [rad/s]"] == pytest.approx(rate, rel=1e-2)
    across = 2.5e-3 + 4e-4 + 1e-3  # of rotor and rings about the vertical, the axis level
    drop = 2 * rate**2 * across / (0.2 * G)
    assert printed["axis drops by [m], let go at rest"] == pytest.approx(drop, rel=1e-2)


@pytest.mark.thorough
def test_stewart_platform_carries_what_newton_and_euler_ask(pictures: Path) -> None:
    """Forces of the legs by the motion wanted, differentiated by central differences."""
    from scipy.spatial.transform import Rotation

    example = script("stewart_platform")

    def pose(t):
        turn = np.pi * t
        place = (0.12 * np.sin(turn), 0.08 - 0.08 * np.cos(turn), 0.9 + 0.1 * np.sin(2 * turn))
        nod, roll = 0.15 * np.sin(turn), 0.1 - 0.1 * np.cos(turn)
        return np.array(place), Rotation.from_euler("XY", [nod, roll])

    def spin(t, h=1e-3):
        """By the turn between instants, in fourth order; inertial axes."""
        one, two = (
            (pose(t + k * h)[1] * pose(t - k * h)[1].inv()).as_rotvec() / (2 * k * h)
            for k in (1, 2)
        )
        return (4 * one - two) / 3

    def legs(t, h=1e-3):
        place, turn = pose(t)
        near, far = (
            (pose(t + k * h)[0] - 2 * place + pose(t - k * h)[0]) / (k * h) ** 2 for k in (1, 2)
        )
        force = example.MASS * ((4 * near - far) / 3 + [0, 0, G])
        one, two = ((spin(t + k * h) - spin(t - k * h)) / (2 * k * h) for k in (1, 2))
        inertia = turn.as_matrix() @ np.diag(example.INERTIA) @ turn.as_matrix().T
        moment = inertia @ ((4 * one - two) / 3) + np.cross(spin(t), inertia @ spin(t))
        arms = turn.apply(example.TOP)
        along = place + arms - example.BASE
        along /= np.linalg.norm(along, axis=1)[:, None]
        wrench = np.vstack([along.T, np.cross(arms, along).T])
        return np.linalg.solve(wrench, np.concatenate([force, moment]))

    printed = numbers("stewart_platform", pictures)
    expected = np.array([legs(t) for t in np.linspace(0, 2, 201)])
    assert printed["largest force in a leg [N]"] == pytest.approx(abs(expected).max(), rel=1e-6)
    assert abs(printed["work of a period [J]"]) < 1e-9


def test_robot_arm_holds_and_moves(pictures: Path) -> None:
    """At rest as printed in Corke's book (``p560.gravload(qn)``); in motion by Newton and Euler,
    link by link (recursive, in inertial axes, with differences of the wanted motion).
    """
    numbers_printed, example = numbers("robot_arm", pictures), script("robot_arm")
    printed = {"shoulder": 31.6399, "elbow": 6.0351, "wrist": 0.0283}
    for name, torque in printed.items():
        assert numbers_printed[f"{name} at rest [N m]"] == pytest.approx(torque, abs=1e-4)
    hand = example.placed(example.NOMINAL)[-1] @ [0, 0, 0.1, 1]
    assert numbers_printed["shoulder per payload at rest [N m/kg]"] == pytest.approx(
        G * hand[0], rel=1e-9
    )
    run = da.solve_inverse_dynamics(example.build().build(), example.DURATION, outputs=[0.4, 0.9])
    for k, t in enumerate(run.time):
        np.testing.assert_allclose(example.torques(run)[:, k], torques_of(example, t), atol=2e-6)


def torques_of(example, t: float, h: float = 2e-3) -> np.ndarray:
    """(6,) by forces and moments of all links beyond each joint."""

    def frames(t):
        s = t / example.DURATION
        return np.array(
            example.placed(example.NOMINAL + example.REACH * s**3 * (10 - 15 * s + 6 * s**2))
        )

    def centers(t):
        local = np.array([[*link[4], 1.0] for link in example.LINKS])
        return np.einsum("kij,kj->ki", frames(t), local)[:, :3]

    def momenta(t):
        """Angular momenta about the mass centres."""
        slope = [(frames(t + k * h) - frames(t - k * h)) / (2 * k * h) for k in (1, 2)]
        turns, rates = frames(t)[:, :3, :3], ((4 * slope[0] - slope[1]) / 3)[:, :3, :3]
        skew = rates @ turns.transpose(0, 2, 1)
        spin = np.stack([skew[:, 2, 1], skew[:, 0, 2], skew[:, 1, 0]], axis=1)
        inertia = turns @ np.array([np.diag(link[5]) for link in example.LINKS])
        return np.einsum("kij,kj->ki", inertia @ turns.transpose(0, 2, 1), spin)

    near, far = (
        (centers(t + k * h) - 2 * centers(t) + centers(t - k * h)) / (k * h) ** 2 for k in (1, 2)
    )
    weights = np.array([link[3] for link in example.LINKS])[:, None]
    force = weights * ((4 * near - far) / 3 + [0, 0, G])
    one, two = ((momenta(t + k * h) - momenta(t - k * h)) / (2 * k * h) for k in (1, 2))
    moment = (4 * one - two) / 3
    before = np.array([np.eye(4), *frames(t)[:-1]])
    arms = centers(t)[None] - before[:, None, :3, 3]
    total = np.array(
        [(moment[k:] + np.cross(arms[k, k:], force[k:])).sum(axis=0) for k in range(6)]
    )
    return np.einsum("ki,ki->k", before[:, :3, 2], total)


def test_double_wishbone_steers_as_its_points_say(pictures: Path) -> None:
    """The twist of the upright is perpendicular to what each arm and the tie rod forbid."""

    def twist(rod_z: float) -> np.ndarray:
        """Velocity of the wheel and angular velocity for one metre per second of travel."""
        wheel, rows = np.array([0, -0.8, 0.3]), [np.array([0, 0, 1.0, 0, 0, 0])]

        def forbid(point, direction):
            rows.append(np.r_[direction, np.cross(point - wheel, direction)])

        for ball, front, rear in (
            ((0, -0.75, 0.1), (-0.2, -0.4, 0.15), (0.2, -0.45, 0.155)),
            ((0.04, -0.675, 0.525), (0.1, -0.45, 0.525), (0.25, -0.49, 0.53)),
        ):
            along = np.array(rear) - front
            free = np.cross(along, np.array(ball) - front)
            for direction in (along, np.cross(along, free)):  # the ball moves across both
                forbid(np.array(ball), direction)
        outer = np.array([0.15, -0.75, 0.3])
        forbid(outer, outer - [0.2, -0.4, rod_z])
        return np.linalg.solve(np.array(rows), [1, 0, 0, 0, 0, 0])

    printed = numbers("double_wishbone", pictures)
    assert value("double_wishbone", "bump_steer") == pytest.approx(twist(0.3)[5], rel=1e-9)
    assert printed["bump steer [deg/m]"] == pytest.approx(np.degrees(twist(0.3)[5]), rel=1e-9)
    height = brentq(lambda z: twist(z)[5], 0.25, 0.35, xtol=1e-14)
    assert printed["height of the tie rod without bump steer [m]"] == pytest.approx(
        height, abs=1e-9
    )
    assert abs(printed["bump steer there [deg/m]"]) < 1e-4


def test_rssr_four_bar_solves_its_closure(pictures: Path) -> None:
    """``P cos ψ + Q sin ψ = R`` with the vector from the crank pin to the axis of the rocker."""

    def angle(crank, a=0.1, b=0.25, l=0.45, off=-0.1):
        y, square = 0.5 - a * np.sin(crank), 0.25 + a**2 - a * np.sin(crank) + off**2
        reach = (l**2 - square - b**2) / (2 * b * np.hypot(y, off))
        return np.arctan2(off, y) + np.arccos(reach)

    turn = np.radians(np.arange(361))
    run = motion("rssr_four_bar")
    np.testing.assert_allclose(np.unwrap(run["C.angle"]), angle(turn), atol=1e-12)
    printed = numbers("rssr_four_bar", pictures)
    assert printed["ways to close at the start"] == 2
    swing = np.degrees(np.ptp(angle(turn)))
    assert printed["swing of the rocker [deg]"] == pytest.approx(swing, abs=1e-9)


@pytest.mark.thorough
def test_governor_settles_where_moments_balance(pictures: Path) -> None:
    """``dU/dβ = 0`` of weight, spring and centrifugal force at each speed; its slope by speed."""
    printed, example = numbers("governor", pictures), script("governor")

    def height(speed: float) -> float:
        def energy(angle):
            depth = example.sleeve_depth(angle)
            weight = -G * (2 * example.BALL * example.ARM * np.cos(angle) + example.SLEEVE * depth)
            spring = example.STIFFNESS * (depth - example.FREE) ** 2 / 2
            return weight + spring - example.BALL * (speed * example.ARM * np.sin(angle)) ** 2

        def moment(angle, h=1e-4):
            near, far = (energy(angle + k * h) - energy(angle - k * h) for k in (1, 2))
            return (8 * near - far) / (12 * h)

        return -example.sleeve_depth(brentq(moment, 0.05, 1.5, xtol=1e-14))

    for speed in example.SPEEDS:
        settled = printed[f"height of the sleeve at {speed:g} rad/s [m]"]
        assert settled == pytest.approx(height(speed), abs=1e-7)
    slope = (height(15.01) - height(14.99)) / 0.02
    assert printed["rise per speed [m s/rad]"] == pytest.approx(slope, rel=1e-4)


@pytest.mark.thorough
def test_bicycle_is_stable_between_the_published_speeds(pictures: Path) -> None:
    """By the matrices of Meijaard et al.; printed there as 4.292 m/s and 6.024 m/s."""
    mass = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
    damping = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
    weight = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
    turning = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])

    def growth(speed: float, oscillating: bool) -> float:
        stiffness = G * weight + speed**2 * turning
        lower = np.linalg.solve(mass, np.hstack([-stiffness, -speed * damping]))
        eigenvalues = np.linalg.eigvals(np.vstack([np.eye(2, 4, 2), lower]))
        return max(z.real for z in eigenvalues if bool(z.imag > 1e-6) is oscillating)

    printed = numbers("bicycle", pictures)
    for name, low, high, oscillating in (("weave", 4.0, 4.6, True), ("capsize", 5.5, 6.5, False)):
        speed = brentq(growth, low, high, args=(oscillating,), xtol=1e-12)
        assert printed[f"{name} speed [m/s]"] == pytest.approx(speed, abs=1e-6)
    assert printed["weave speed [m/s]"] == pytest.approx(4.292, abs=5e-4)
    assert printed["capsize speed [m/s]"] == pytest.approx(6.024, abs=5e-4)
    assert abs(printed["steer after 5 s [deg]"]) < 1.0
    assert printed["largest error of the energy [J]"] < 1e-4
