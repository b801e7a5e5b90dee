"""The examples with contact, impacts and play, and their numbers, found elsewhere.

The numbers come from closed forms, from the one equation of a mechanism with one freedom, from
published solutions, or from a calculation by hand; none is recorded from our own output.
"""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest
from example_runs import model, motion, numbers, script
from one_freedom import G

import dalembert as da


def test_cam_lifts_by_its_law(pictures: Path) -> None:
    run = motion("cam_follower")
    for degrees, lift in (
        (0, 0.0),
        (60, 0.0075),
        (120, 0.015),
        (150, 0.015),
        (240, 0.0075),
        (330, 0.0),
    ):
        computed = float(run.at([degrees / 3600])["follower.y"][0])
        assert computed - 0.042 == pytest.approx(lift, abs=1e-7)
    x = 30 / 120
    computed = float(run.at([30 / 3600])["follower.y"][0])
    assert computed - 0.042 == pytest.approx(0.015 * (10 * x**3 - 15 * x**4 + 6 * x**5), abs=1e-7)
    at_rest = (
        4000 * (0.075 - (0.16 - 0.06 - 0.057)) + 0.4 * G
    )  # spring and weight on the upper dwell
    assert float(run.at([150 / 3600])["contact.force_norm"][0]) == pytest.approx(at_rest, rel=1e-3)
    assert numbers("cam_follower", pictures)["lift error"] < 2e-7


@pytest.mark.thorough
def test_cam_loses_its_follower_where_a_joint_would_have_to_pull(pictures: Path) -> None:
    """At low speed the contact bears what the joint bears, and it flies once that would pull."""
    printed, speeds = numbers("cam_lift_off", pictures), script("cam_lift_off").SPEEDS
    for speed in speeds:
        run = da.solve_inverse_dynamics(
            model("cam_follower"), 2 * math.pi / speed, outputs=721, parameters={"speed": speed}
        )
        pushes = run["contact.force"].values[:, 1]
        flown = printed[f"share of the turn in flight at {speed:.0f} rad/s"]
        assert (flown > 0) == (pushes.min() < 0)
        if not flown:
            largest = printed[f"largest force at {speed:.0f} rad/s"]
            assert largest == pytest.approx(pushes.max(), rel=0.01)


def test_play_in_a_pin_shakes_the_slider(pictures: Path) -> None:
    printed, example = numbers("slider_crank_with_play", pictures), script("slider_crank_with_play")
    ideal = example.SPEED**2 * 0.05 * (1 + 0.05 / 0.12)  # in the outer dead centre
    assert printed["largest without play [m/s^2]"] == pytest.approx(ideal, rel=1e-6)
    assert printed["largest acceleration [m/s^2]"] > 2 * ideal
    assert printed["slider off its place [mm]"] < 1e3 * example.PLAY * 1.3 * (1 + 0.05 / 0.12)
    assert 0.01 < printed["share of time in flight"] < 0.5


@pytest.mark.thorough
def test_geneva_wheel_goes_on_by_quarters(pictures: Path) -> None:
    """By 90° at each turn, off the course of a wheel without play by no more than that allows."""
    printed = numbers("geneva_wheel", pictures)
    play = 5e-5 / (0.1 - 0.1 / math.sqrt(2))  # of the pin, where it is next to the axle
    assert printed["turned"] == pytest.approx(-180, abs=0.2)
    assert printed["off"] < 2 * play


@pytest.mark.thorough
def test_belt_on_a_drum_obeys_the_capstan_equation(pictures: Path) -> None:
    """Tensions grow by ``e^{μφ}``; the error converges and is below 1 % with 10 elements."""
    printed = numbers("capstan", pictures)
    errors = [abs(printed[f"error of {n} elements"]) for n in script("capstan").ELEMENTS]
    assert errors[0] < 0.01
    assert all(fine < coarse / 2 for coarse, fine in pairwise(errors))
    assert printed["tension by friction"] == pytest.approx(1.0, rel=0.01)


@pytest.mark.thorough
def test_chain_drive_keeps_the_ratio_of_its_teeth(pictures: Path) -> None:
    """Mean speeds and torques of rigid links; the polygon's effect but for what vibrates."""
    printed = numbers("chain_drive", pictures)
    assert printed["ratio"] == pytest.approx(9 / 14, rel=1e-3)
    assert printed["torque"] == pytest.approx(3.0, rel=0.03)
    assert printed["motor"] == pytest.approx(3.0 * 9 / 14, rel=0.01)
    assert printed["ripple"] == pytest.approx(1 - math.cos(math.pi / 9), abs=0.01)


@pytest.mark.thorough
def test_woodpecker_by_published_states(pictures: Path) -> None:
    """Its start is the published one but for 0.15 mrad, by which that stands inside the pole."""
    printed = numbers("woodpecker", pictures)
    assert printed["angle of the bird after 0.02 s [rad]"] == pytest.approx(-0.452309979, abs=1e-4)
    assert printed["pecks"] == 3
    assert printed["way down by friction [m]"] < 0
    assert printed["energy not accounted for [J]"] < 1e-9


def test_discs_in_a_box(pictures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Fewer of them here: nothing passes through anything, and no energy comes from contacts."""
    discs = script("discs_in_a_box")
    monkeypatch.setattr(discs.main, "__defaults__", (None, 12))
    printed = numbers("discs_in_a_box", pictures)
    assert printed["finished"] == 1
    assert printed["deepest penetration [radii]"] <= 1e-6
    assert printed["largest gain of energy [share]"] <= 1e-12
    assert 0.2 < printed["energy left [share]"] < 0.9


def test_crates_and_ball(pictures: Path) -> None:
    """The stack stands until the ball comes, and nothing overlaps afterwards."""
    printed = numbers("crates_and_ball", pictures)
    assert printed["finished"] == 1
    assert printed["motion of the stack before the impact [m]"] <= 1e-9
    assert printed["maximum penetration [m]"] <= 1e-9
    assert 0.05 < printed["energy left [share]"] < 0.9
