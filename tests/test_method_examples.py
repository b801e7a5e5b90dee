"""The examples of formulations and coordinates, and their numbers, found elsewhere.

The numbers come from closed forms, from the one equation of a mechanism with one freedom, from
published solutions, or from a calculation by hand; none is recorded from our own output.
"""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from example_runs import numbers
from one_freedom import FourBar, G, reduced_motion


@pytest.mark.thorough
def test_violation_grows_is_held_is_removed(pictures: Path) -> None:
    printed = numbers("four_bar_violation", pictures)
    assert printed["violation a"] > 30 * printed["violation b"] > 1e3 * printed["violation c"]
    assert max(printed["violation c"], printed["violation d"]) < 1e-12
    assert (
        printed["energy d"]
        < 1e-9
        < 0.1
        < min(printed["energy a"], printed["energy b"], printed["energy c"])
    )
    assert (
        printed["angle a"] > printed["angle c"] > 10 > 1.5 > printed["angle d"]
    )  # degrees, Fig. 5.9
    bars = FourBar((0.3, 1.0, 0.6), (1.5, 5.0, 3.0), (0.0, 1.0), -1)
    angle = reduced_motion(bars.inertia, bars.potential, math.pi, 1.0, 8.0)
    assert printed["reference angle"] == pytest.approx(angle, abs=1e-5)


def test_conserved_energy_is_not_accuracy(pictures: Path) -> None:
    """Phase errors of RK–Gill and of the trapezoidal rule by their expansions in ωh."""
    printed = numbers("oscillator_energy", pictures)
    frequency = math.sqrt(10.0)

    def late(per_radian: float) -> float:  # largest position error after 10 s, to leading order
        return 0.1 * per_radian * frequency * 10.0

    gill, rule = (frequency * 0.1) ** 4 / 120, (frequency * 0.1) ** 2 / 12
    assert printed["position (a) RK-Gill, 0.1 s"] == pytest.approx(late(gill), rel=0.1)
    assert printed["position (c) trapezoidal, 0.1 s"] == pytest.approx(late(rule), rel=0.1)
    assert printed["position (c) trapezoidal, 0.025 s"] == pytest.approx(late(rule / 16), rel=0.1)
    ratio = printed["position (c) trapezoidal, 0.1 s"] / printed["position (a) RK-Gill, 0.1 s"]
    assert 85 < ratio < 115
    assert printed["position (b) with energy, 0.1 s"] < printed["position (a) RK-Gill, 0.1 s"]
    for case in ("(b) with energy, 0.1 s", "(c) trapezoidal, 0.1 s", "(c) trapezoidal, 0.025 s"):
        assert printed[f"energy {case}"] < 1e-14
    assert printed["energy (a) RK-Gill, 0.1 s"] > 1e-5


@pytest.mark.thorough
def test_partition_is_regular_in_every_position(pictures: Path) -> None:
    """|det W| = √(l2² − (b + l3 sin φ3 − l1)²) for u = θ3 (Example 6.2), zero for the others."""
    printed = numbers("partition_conditioning", pictures)
    smallest = math.sqrt(1.0 - (1.0 - 0.5 - 0.8) ** 2), math.sqrt(1.0 - (1.0 + 0.5 - 0.8) ** 2)
    assert printed["smallest det W, crank.angle"] == pytest.approx(min(smallest), rel=1e-4)
    assert printed["largest det W, crank.angle"] == pytest.approx(1.0, rel=1e-4)
    assert max(printed["smallest det W, link.angle"], printed["smallest det W, slider.x"]) < 1e-3
    assert printed["largest number watched"] < 1.6
    assert printed["velocity violation [m/s]"] < 1e-12


@pytest.mark.thorough
def test_four_bars_pass_where_they_are_flat(pictures: Path) -> None:
    printed = numbers("flat_four_bars", pictures)  # IFToMM A02
    place = (
        printed["x of the first crank's end after 10 s [m]"],
        printed["y of the first crank's end after 10 s [m]"],
    )
    assert place == pytest.approx((0.328458111534, 0.944518538181), abs=1e-6)
    assert printed["singular positions passed"] == 10
    assert printed["largest error of the angle [rad]"] < 1e-6


def test_equal_bars_share_the_load(pictures: Path) -> None:
    printed = numbers("double_parallelogram", pictures)
    assert printed["redundant equations"] == 1
    assert printed["largest error of the angle [rad]"] < 1e-8
    assert printed["difference of the motions [m, rad]"] < 1e-10
    assert printed["difference of the shares, all equations [N]"] < 1e-3
    assert printed["difference of the shares, independent [N]"] > 10


@pytest.mark.thorough
def test_massless_coupler_is_the_limit_of_light_ones(pictures: Path) -> None:
    printed = numbers("massless_coupler", pictures)
    assert printed["difference to RangeSpace [m, rad]"] < 1e-10
    assert printed["power of the mass in the distance to the limit"] == pytest.approx(1.0, abs=0.02)
    assert printed["force across the coupler, no mass [N]"] < 1e-10
    assert printed["largest error of the energy [J]"] < 1e-5


@pytest.mark.thorough
def test_comparison_of_formulations(pictures: Path) -> None:
    """Exact formulations make the same error, the penalty method another one."""
    printed = numbers("compare_four_bar", pictures)
    for name in ("KKT", "NullSpace", "AugmentedLagrangian"):
        assert printed[f"error {name}"] == pytest.approx(printed["error RangeSpace"], rel=1e-4)
    assert printed["error Penalty"] > 5 * printed["error RangeSpace"]
    assert printed["violation Projection"] < 1e-12
    assert 1e-12 < printed["violation Baumgarte"] < printed["violation Stabilization"]
    assert printed["energy EnergyProjection"] < 1e-12 < printed["energy Projection"]


def test_three_bodies_have_the_equations_by_hand(pictures: Path) -> None:
    printed = numbers("three_body_system", pictures)  # Examples 6.1 and 6.3
    assert printed["M̄, d̄, f̄ from those by hand"] < 1e-12
    assert printed["Gibbs-Appell from those by hand"] < 1e-12
    assert printed["motion from that by hand"] < 1e-9
    assert printed["relative from absolute angles"] < 1e-9


def test_loop_is_closed_in_joint_coordinates(pictures: Path) -> None:
    printed = numbers("slider_link_crank", pictures)  # Example 6.4
    assert printed["joint coordinates"] == 3
    assert printed["closing equations"] == 2
    assert printed["smallest |det W| [m]"] == pytest.approx(math.sqrt(1 - 0.7**2), abs=1e-9)
    assert printed["crank's speed after one turn [rad/s]"] == pytest.approx(14.0, abs=1e-8)
    assert printed["loop open by at most [m]"] < 1e-12


def test_string_force_without_a_matrix(pictures: Path) -> None:
    printed = numbers("bar_slider_mass", pictures)  # Example 7.2
    assert max(printed["C D"], printed["C E − I"]) < 1e-14
    assert printed["λ by (7.13) from λ by (6.3)"] < 1e-12
    assert printed["string force from Newton's law [N]"] < 1e-11
    assert printed["smallest string force [N]"] > 0


def test_pendulum_tension_is_the_physical_multiplier(pictures: Path) -> None:
    printed = numbers("pendulum_multipliers", pictures)
    deepest = 1.5 * G * (3 - 2 * math.cos(1.2))
    assert printed["largest tension [N]"] == pytest.approx(deepest, abs=1e-3)  # among the outputs
    assert printed["error of the tension [N]"] < 1e-8
    assert printed["link against user constraint [N]"] < 1e-10
    assert printed["squared: ratio of the multipliers [1/m]"] == pytest.approx(1 / 1.6, rel=1e-12)
