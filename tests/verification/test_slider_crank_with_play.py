"""Slider-crank with play in the slider's pin, against what Flores and Ambrósio (2004) report of it.

Computers and Structures 82, "Revolute joints with clearance in multibody systems": at 5000 rpm the
slider keeps its path within the play, its acceleration has peaks several times those of the ideal
joint, the journal is in contact most of the time and flies between impacts, and the smaller the
play, the nearer it comes to the ideal joint. They print curves: nothing finer can be held.
"""

from __future__ import annotations

import importlib
import sys
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

import dalembert as da

EXAMPLES = Path(__file__).parents[2] / "examples"


@cache
def example():
    mpl.use("Agg")
    if str(EXAMPLES) not in sys.path:
        sys.path.insert(0, str(EXAMPLES))
    return importlib.import_module("slider_crank_with_play")


@cache
def motion(play: float) -> da.Motion:
    """Two turns with a play in the pin, or with none."""
    module = example()
    return module.run(module.build(ideal=not play, play=play or 1e-3).build(), turns=2)


@cache
def later() -> np.ndarray:
    return motion(0.0).time > motion(0.0).time[-1] / 2


def off(play: float) -> float:
    """How far the slider is off its ideal place."""
    return float(np.abs(motion(play)["slider.x"] - motion(0.0)["slider.x"]).max())


PLAYS = [5e-4, 2e-4, 1e-4]


@pytest.mark.few(1)
@pytest.mark.parametrize("play", PLAYS)
def test_the_slider_keeps_its_path_within_the_play(play):
    computed = motion(play)
    assert computed.status.success
    depth = float(computed["B.penetration"].max())
    tilt = 0.05 / 0.12  # what play across the rod does along it, at most
    assert off(play) < (play + depth) * (1 + tilt)
    assert np.abs(computed.data.balance_error).max() < 1e-4 * float(
        computed["kinetic_energy"].max()
    )


@pytest.mark.thorough
def test_a_smaller_play_is_nearer_to_the_ideal_joint():
    assert off(PLAYS[0]) > 2 * off(PLAYS[1]) > 2 * off(PLAYS[2])


def test_peaks_contact_and_flight():
    ideal, played = (np.abs(motion(p)["slider.ax"].values[later()]) for p in (0.0, PLAYS[0]))
    assert played.max() > 2 * ideal.max()
    flight = np.mean(motion(PLAYS[0])["B.gap"].values[later()] > 0)
    assert 0.01 < flight < 0.5
    assert np.median(played) < 1.5 * np.median(ideal)
