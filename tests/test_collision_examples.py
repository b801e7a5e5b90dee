"""Examples with many rigid contacts, beside theories, closed forms and published numbers."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from example_runs import numbers, script


@pytest.mark.thorough
def test_dominoes_topple_at_the_speed_of_the_theory(
    pictures: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within 1.5 % of van Leeuwen's theory; friction between dominoes slows the wave."""
    monkeypatch.setattr(script("dominoes").main, "__defaults__", (None, 3, (0.25,)))
    printed = numbers("dominoes", pictures)
    smooth, rough, theory = (
        printed[f"{kind}, spacing 0.25 [m/s]"] for kind in ("smooth", "rough", "theory")
    )
    assert smooth == pytest.approx(theory, rel=0.015)
    assert 0.5 * smooth < rough < 0.95 * smooth


def test_the_theory_of_dominoes_is_the_published_one() -> None:
    """86.281 dominoes per second far from the start, by the public program of M. Chapman
    (github.com/eigenmatt/domino-simulation) for the same dominoes and g = 9.81 m/s².

    RK4 with steps of 10 µs, mean of the 39th and 40th domino.
    """
    times = script("dominoes").theory(0.0085, 40)
    assert 2 / (times[-1] - times[-3]) == pytest.approx(86.281, rel=5e-4)


@pytest.mark.thorough
def test_geneva_drive_indexes_within_its_clearances(pictures: Path) -> None:
    """Deviations from the law of the pin in a slot, and of the lock, are those of clearances."""
    printed, drive = numbers("geneva_drive", pictures), script("geneva_drive")
    assert printed["finished"] == 1
    middle = drive.APART - drive.REACH  # from the pin to the axle of the wheel
    assert printed["deviation in the slot [mrad]"] <= 1e3 * drive.CLEARANCE / middle * 1.001
    between = drive.CLEARANCE + drive.LOCK * (1 - math.cos(drive.FACET / 2))
    slack = 1e3 * between / (drive.APART * math.sin(drive.FACE))
    assert printed["deviation in the lock [mrad]"] <= 1.02 * slack
    assert printed["turned [deg]"] == pytest.approx(-90, abs=math.degrees(1.02e-3 * slack))
    fastest = drive.REACH / middle
    assert printed["maximum speed over that of the crank"] == pytest.approx(fastest, rel=1e-3)
    assert printed["maximum penetration [m]"] <= 1e-12


@pytest.mark.thorough
def test_chain_hoist_lifts_with_the_polygon_effect(
    pictures: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A tooth lifts by a pitch, at ``ω R cos θ``; impacts of rollers take the rest of the work."""
    hoist = script("chain_hoist")
    monkeypatch.setattr(hoist.main, "__defaults__", (None, 0.36))
    monkeypatch.setattr(hoist, "HANGING", (5, 3))  # more than two pitches are not lifted
    printed = numbers("chain_hoist", pictures)
    assert printed["finished"] == 1
    assert printed["lift in a pitch of the sprocket [p]"] == pytest.approx(1, abs=0.01)
    assert printed["deviation of the speed [ω R]"] <= 0.015
    moment = printed["mean moment [(m₁ − m₂) g z p/2π]"]
    lost = printed["energy dissipated in a pitch [(m₁ − m₂) g p]"]
    assert 0 <= lost < 0.05
    assert moment - lost == pytest.approx(1, abs=0.015)
    assert printed["maximum penetration [m]"] <= 1e-12


@pytest.mark.thorough
def test_hopper_empties_faster_through_a_wider_opening(
    pictures: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Few discs here, so that the exponent is only near that of Beverloo's law, 3/2."""
    hopper = script("hopper")
    monkeypatch.setattr(hopper.main, "__defaults__", (None, 20, (4.0, 6.0)))
    monkeypatch.setattr(hopper, "STEP", 2e-3)
    monkeypatch.setattr(hopper, "OPENS", 0.05)
    printed = numbers("hopper", pictures)
    assert printed["finished"] == 1
    assert 1.0 < printed["exponent with k, at least 0"] < 2.0
    fastest = math.sqrt(2 * hopper.G * (hopper.TRAY + 0.2))  # on the tray
    assert printed["maximum penetration [d]"] <= hopper.STEP * fastest / (2 * hopper.RADIUS)
