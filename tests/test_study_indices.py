"""Indices and surfaces of functions whose answers are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da

RANGES = dict.fromkeys(("a", "b", "c"), (-math.pi, math.pi))


def runner(function):
    """Studies of a function of the parameters, without a model."""

    def run(design: da.DesignTable) -> da.SweepResult:
        values = function(*design.values.T)[:, None]
        return da.SweepResult("function", design, ("f",), values, ("",) * len(design))

    return run


def test_ishigami():
    """T. Ishigami, T. Homma (1990): f = sin a + 7 sin² b + c⁴ sin a / 10, with exact indices."""
    pytest.importorskip("SALib")
    run = runner(lambda a, b, c: np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a))
    indices = da.sobol_indices(run, RANGES, samples=1024, rng=3)
    pi4 = math.pi**4
    parts = np.array([0.5 * (1 + pi4 / 50) ** 2, 49 / 8, 0.0])
    both = pi4**2 * 8 / 22500
    whole = parts.sum() + both
    first, total = parts / whole, (parts + np.array([both, 0, both])) / whole
    # the error that the method message is 95 % confidence; three halves of it is 99.7 %
    assert np.all(abs(indices.first[0] - first) < 1.5 * indices.first_error[0] + 1e-3)
    assert np.all(abs(indices.total[0] - total) < 1.5 * indices.total_error[0] + 1e-3)
    assert indices.total_error.max() < 0.15


def test_morris_of_a_plane():
    """The effects of a linear function are its slopes times the ranges, without deviation."""
    pytest.importorskip("SALib")
    indices = da.morris_indices(runner(lambda a, b, c: a - 3 * b), RANGES, trajectories=5, rng=0)
    slopes = 2 * math.pi * np.array([1, -3, 0])
    np.testing.assert_allclose(indices["mean"][0], slopes, atol=1e-9)
    np.testing.assert_allclose(indices.mean_absolute[0], abs(slopes), atol=1e-9)
    np.testing.assert_allclose(indices.deviation[0], 0, atol=1e-9)


def test_surfaces():
    pytest.importorskip("sklearn")
    ranges = {"a": (0.0, 2.0), "b": (-1.0, 1.0)}
    design = da.DesignTable.latin_hypercube(ranges, 40, rng=1)
    parabola = da.response_surface(runner(lambda a, b: 1 + a * b - 2 * a**2)(design))
    assert parabola.error < 1e-9 and parabola.determination == pytest.approx(1)
    assert parabola(a=0.5, b=0.25) == pytest.approx(1 + 0.125 - 0.5)

    study = runner(lambda a, b: np.sin(3 * a) * np.exp(b))(design)
    process = da.gaussian_process(study)
    a, b = np.meshgrid(np.linspace(0.2, 1.8, 9), np.linspace(-0.8, 0.8, 9))
    off = np.sqrt(np.mean((process(a=a, b=b) - np.sin(3 * a) * np.exp(b)) ** 2))
    # the error told from designs left out is that found at new ones, or more
    assert off < 2 * process.error < 0.1
    assert da.response_surface(study).error > 5 * process.error
    assert process.deviation(a=1.0, b=0.0) < process.deviation(a=4.0, b=0.0)


def test_indices_need_every_design():
    pytest.importorskip("SALib")

    def run(design: da.DesignTable) -> da.SweepResult:
        reasons = ("broke", *[""] * (len(design) - 1))
        return da.SweepResult("function", design, ("f",), design.values[:, :1], reasons)

    with pytest.raises(da.AnalysisError, match="broke"):
        da.sobol_indices(run, RANGES, samples=4)


def test_invalid_studies_are_refused():
    pytest.importorskip("sklearn")
    design = da.DesignTable.grid({"a": [0.0, 1.0], "b": [1.0]})
    study = runner(lambda a, b: a)(design)
    with pytest.raises(da.AnalysisError, match="too few"):
        da.response_surface(study)
    with pytest.raises(da.AnalysisError, match="name one response"):
        study.column("g")
