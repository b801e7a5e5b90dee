"""The examples that decide on a design, and their numbers, found elsewhere.

The numbers come from closed forms, from the one equation of a mechanism with one freedom, from
published solutions, or from a calculation by hand; none is recorded from our own output.
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from example_runs import motion, numbers, script
from one_freedom import G, slider_crank, slider_crank_inertia, slope
from scipy.optimize import minimize


@pytest.mark.thorough
def test_synthesis_beats_the_literature(pictures):
    """4.08e-5 is the least sum of squares printed for the six points; cognates draw one curve."""
    printed = numbers("straight_line_synthesis", pictures)
    assert printed["error"] < 4.08e-5 and printed["off"] < 1e-10
    assert printed["transmission"] > math.radians(30) - 1e-6


def test_smallest_cams_are_at_their_limits(pictures):
    printed = numbers("smallest_cam", pictures)
    assert printed["pressure"] == pytest.approx(30, abs=1e-6)
    assert printed["least radius"] == pytest.approx(0.003) and not printed["undercut"]
    # without an offset tan α = s'/(R + r + s): the base radius from the cycloidal law itself
    x = np.linspace(0, 1, 100_001)
    rise = 0.02 * (x - np.sin(2 * np.pi * x) / (2 * np.pi))
    slope = 0.02 / (np.pi / 2) * (1 - np.cos(2 * np.pi * x))
    needed = (slope / math.tan(math.radians(30)) - rise).max() - 0.006
    assert printed["base"] == pytest.approx(needed, rel=1e-4)


def test_study_against_closed_form(pictures):
    """Every design's least transmission angle is that of the law of cosines."""
    pytest.importorskip("SALib")
    pytest.importorskip("sklearn")
    printed = numbers("four_bar_study", pictures)
    assert printed["failed"] == 0 and printed["off"] < 1e-6
    assert printed["error"] < 0.1 and printed["total_d"] > printed["total_c"] > printed["total_f"]


@pytest.mark.thorough
def test_path_is_found(pictures: Path) -> None:
    printed = numbers("path_optimization", pictures)
    assert printed["success"]
    assert printed["after"] < printed["before"] / 1000
    hidden = {
        "l0": 0.08,
        "l1": 0.04,
        "l2": 0.1,
        "l3": 0.1,
        "a": 0.2,
        "b": 0,
        "phase": 0,
        "x": 0,
        "y": 0,
    }
    for name, length in hidden.items():  # the linkage that the path was made with
        assert printed[name] == pytest.approx(length, abs=1e-4)


def test_spring_smooths_the_torque_as_well_as_any(pictures: Path) -> None:
    r, l, speed = 0.06, 0.22, 6 * math.pi
    time = np.linspace(0, 1 / 3, 241)
    q = speed * time + math.pi / 2  # from the downward line of the plunger

    def torque(k: float, free: float, foot: float):
        x, dx = slider_crank(q, r, l)
        inertia = slope(lambda q: slider_crank_inertia(q, r, l, 1.5, 1.2, 9.0), q) * speed**2 / 2
        weight = G * ((1.5 + 1.2) / 2 * r * np.sin(q) - (1.2 / 2 + 9.0) * dx)
        return inertia + weight - k * (-foot - x - free) * dx

    def rms(design) -> float:
        return math.sqrt(np.mean(torque(*design)[:-1] ** 2))

    run = motion("smooth_torque")
    np.testing.assert_allclose(run["motor.effort"].values, torque(100, 0.35, -0.6), atol=1e-10)
    printed = numbers("smooth_torque", pictures)
    best = minimize(
        lambda s: rms((s[0] * 1e3, s[1], -0.6)),
        (2, 0.4),
        method="Nelder-Mead",
        options={"xatol": 1e-9, "fatol": 1e-12, "maxiter": 2000},
    )
    assert printed["before"] == pytest.approx(rms((100, 0.35, -0.6)), rel=1e-6)
    assert printed["after"] == pytest.approx(best.fun, rel=1e-6)


@pytest.mark.thorough
def test_front_of_pump_springs(pictures: Path) -> None:
    """Its end in torque is the best for torque alone; every spring on it beats the first."""
    printed = numbers("pump_front", pictures)
    r, l, speed = 0.06, 0.22, 6 * math.pi
    q = speed * np.linspace(0, 1 / 3, 121) + math.pi / 2
    x, dx = slider_crank(q, r, l)
    inertia = slope(lambda q: slider_crank_inertia(q, r, l, 1.5, 1.2, 9.0), q) * speed**2 / 2
    alone = inertia + G * ((1.5 + 1.2) / 2 * r * np.sin(q) - (1.2 / 2 + 9.0) * dx)
    # torque is linear in k and k(free + foot): least squares
    columns = np.stack([(0.6 - x) * dx, -dx], axis=1)[:-1]
    left = np.linalg.lstsq(columns, alone[:-1], rcond=None)[1][0]
    assert printed["least torque"] == pytest.approx(math.sqrt(left / 120), rel=1e-4)
    assert printed["points"] == 7 and printed["least load"] < 0.3 * printed["first load"]
    assert printed["least torque"] < 0.2 * printed["first torque"]


def test_catapult_by_energy_alone(pictures: Path) -> None:
    """One freedom: the speed follows from the heights, the best throw from two numbers."""
    printed = numbers("catapult", pictures)
    arm, ball, counter, length, begin = 15.0, 3.0, 120.0, 3.0, math.radians(220)

    def rate(short: float, angle: float) -> float:
        long = length - short
        balance = ball * long + arm * (length / 2 - short) - counter * short
        inertia = ball * long**2 + counter * short**2
        inertia += arm * (length**2 / 12 + (length / 2 - short) ** 2)
        return -math.sqrt(2 * G * balance * (math.sin(begin) - math.sin(angle)) / inertia)

    def throw(design) -> float:
        (short, angle), long = design, length - design[0]
        x, y = long * math.cos(angle), long * math.sin(angle)
        vx, vy = (f * rate(short, angle) * long for f in (-math.sin(angle), math.cos(angle)))
        return x + vx * (vy + math.sqrt(vy**2 + 2 * G * (y + 2.0))) / G

    expected = minimize(
        lambda design: -throw(design), [0.7, 2.0], method="Nelder-Mead", options={"xatol": 1e-9}
    )
    assert printed["before"] == pytest.approx(throw((0.9, math.radians(115))), rel=1e-8)
    assert printed["after"] == pytest.approx(-expected.fun, rel=1e-8)
    np.testing.assert_allclose([printed["short"], printed["release"]], expected.x, rtol=1e-3)
    # a later angle is reached later by its inverse rate
    slope = 1 / rate(printed["short"], printed["release"])
    assert printed["d(instant)/d(release)"] == pytest.approx(slope, rel=1e-8)


def test_steps_of_differences_as_tabulated(pictures: Path) -> None:
    """Example 8.10: Θ = 9/k₁ + 4/k₂, so −9/(1 + h) and −9/(1 − h²), −2/(2 + h) and −4/(4 − h²).

    The text that we have keeps the captions of Tables 8.1 and 8.2, not their entries; what it says
    of them is tested: truncation for large steps, round-off for small ones, central differences
    better and over more steps, double precision more reliable.
    """
    printed = numbers("finite_difference_steps", pictures)
    assert printed["compliance"] == pytest.approx(11.0, abs=1e-13)
    assert (printed["gradient d1"], printed["gradient d2"]) == pytest.approx(
        (-9.0, -1.0), abs=1e-13
    )
    truncated = {
        "forward d1": lambda h: -9 / (1 + h),
        "central d1": lambda h: -9 / (1 - h * h),
        "forward d2": lambda h: -2 / (2 + h),
        "central d2": lambda h: -4 / (4 - h * h),
    }
    steps, eps = [float(f"1e-{k}") for k in range(1, 13)], {"double": 2.3e-16, "single": 1.2e-7}
    errors: dict[str, list[float]] = {}
    for precision in eps:
        for entry, by_hand in truncated.items():
            row = [printed[f"{precision} {entry} {h:.0e}"] for h in steps]
            for h, quotient in zip(steps, row, strict=True):  # 11 J, three roundings of half an eps
                assert abs(quotient - by_hand(h)) < 33 * eps[precision] / h
            errors[f"{precision} {entry}"] = [abs(q - by_hand(0.0)) for q in row]
    for name, error in errors.items():
        best = int(np.argmin(error))
        assert 0 < best < len(steps) - 1, name  # both ends are worse
        assert error[-1] > 30 * error[best]
    for d in ("d1", "d2"):
        for precision in eps:
            forward, central = (errors[f"{precision} {s} {d}"] for s in ("forward", "central"))
            assert min(central) < min(forward)
            assert sum(e < 0.01 for e in central) >= sum(e < 0.01 for e in forward)
        assert min(errors[f"double central {d}"]) < 1e-3 * min(errors[f"single central {d}"])
        assert printed[f"study against table {d}"] < 1e-8


@pytest.mark.thorough
def test_map_of_four_bars_has_grashofs_line(pictures: Path) -> None:
    printed, example = numbers("four_bar_map", pictures), script("four_bar_map")
    b, c = np.meshgrid(example.COUPLERS, example.ROCKERS)
    reach = math.hypot(example.CRANK, example.GROUND)  # from the crank pin to the rocker's pivot
    assert printed["assembled"] == ((b + c > reach) & (abs(b - c) < reach)).sum()
    assert printed["not finished"] < 0.01 * printed["designs"]
    assert printed["on the other side of Grashof's line"] == 0
    assert printed["transmission angle off by at most [deg]"] < 0.2  # 1 ms between outputs
