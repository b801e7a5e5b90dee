"""The examples in space and their numbers, found elsewhere.

What holds of every example, these among them, stands in ``test_examples.py``.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from test_examples import model, motion, numbers, pictures, value  # noqa: F401

G = 9.81


def test_heavy_top_is_the_published_one(pictures: Path) -> None:  # noqa: F811
    """Height at 1 s of the benchmark; the axis stays between the two roots of its cubic."""
    assert value("heavy_top", "height") == pytest.approx(-0.74849079, abs=1e-7)
    found = numbers("heavy_top", pictures)
    assert found["height of the mass centre at 1 s [m]"] == pytest.approx(-0.74849079, abs=1e-7)
    about, along, spin, swing = 15.234375, 0.46875, 150.0, -4.61538
    energy, momentum = about * swing**2 / 2, about * swing
    kinetic = np.poly1d([-15 * G, energy]) * np.poly1d([-1, 0, 1]) * 2 * about
    turning = kinetic - np.poly1d([-along * spin, momentum]) ** 2
    lowest = min(r.real for r in turning.roots if abs(r.imag) < 1e-9 and abs(r) <= 1)
    assert found["lowest height [m]"] == pytest.approx(lowest, abs=1e-4)
    assert found["energy drift [J]"] < 1e-5


def test_spatial_slider_crank_is_the_exact_one(pictures: Path) -> None:  # noqa: F811
    """Slider at 1 s and 5 s by the one equation of the motion."""
    assert value("spatial_slider_crank", "x") == pytest.approx(0.211721661394, abs=1e-7)
    found = numbers("spatial_slider_crank", pictures)
    assert found["slider after 5 s [m]"] == pytest.approx(0.240719573741, abs=1e-7)
    assert found["largest error of the energy [J]"] < 1e-7
