"""Runs in a page are those of Python: outputs at other parameter values, and gradients."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
from live_modules import Modules, Outcome
from registry import CASES, PLANAR
from spatial_registry import SPATIAL_CASES, any_model_of
from units import Units

import dalembert as da
from dalembert.results.sources import Row
from dalembert.sensitivity.samples import take_sample

NAMES = [*CASES, *SPATIAL_CASES]
STRATEGIES: dict[str, dict[str, Any]] = {
    "RK4": {"step": 0.005},
    "error control": {},
    "GeneralizedAlpha": {"step": 0.005, "integrator": da.GeneralizedAlpha()},
}
VALUES = {"RK4": 1e-9, "error control": 1e-9, "GeneralizedAlpha": 1e-7}
"""Largest differences, relative to the size of each measure."""
GRADIENTS = 1e-8
"""Largest difference, relative to the largest derivative."""
DURATION = 0.1
CHANGE = 1e-3
"""Relative change of the parameters."""


@dataclass(frozen=True)
class Expected:
    """Outputs and gradients in Python."""

    names: list[str]
    sizes: np.ndarray
    table: np.ndarray
    gradients: np.ndarray


def changed(model: da.Model) -> np.ndarray:
    """Parameter values near those of the model."""
    p = np.array([q.value for q in model.parameters.values()], float)
    return p * (1 + CHANGE * np.random.default_rng(0).uniform(-1, 1, p.size))


def scalar_measures(model: da.Model) -> list[str]:
    return [name for name in model.measure_names if model.expression(name).sx.numel() == 1]


def natural_size(model: da.Model, name: str) -> float:
    """Size of a measure of the mechanism, below which its rounding does not fall."""
    scales = model.scales
    unit, *_ = model.expression(name).unit.split(" or ")  # violations of several rows
    return Units(scales.length, scales.mass, scales.time)(unit)


def prepare(modules: Modules, name: str, strategy: str) -> Expected | str:
    """Add a run, or return the obstacle."""
    model = any_model_of(name)
    motion = da.solve_dynamics(model, DURATION, **STRATEGIES[strategy])
    if reason := motion.analysis.live_obstacle(motion):
        return reason
    other = motion.analysis.run(model, changed(model))
    names = scalar_measures(model)
    acceleration = next(name for name in names if name.endswith(".ax"))
    subjects = [names.index(acceleration), names.index("kinetic_energy")]
    responses = [da.final(acceleration), da.integral("kinetic_energy")]
    integral = take_sample(other, responses[1])
    times = np.union1d(integral.motion.time, other.time[-1:])
    weights = np.zeros(times.size)
    weights[np.searchsorted(times, integral.motion.time)] = integral.weights
    weights = [np.eye(times.size)[-1], weights]
    rows = [Row(model.expression(n).sx) for n in names]
    data = motion.analysis.live_functions(motion, rows, times).page_data()
    pairs = [{row: column} for row, column in zip(subjects, weights, strict=True)]
    modules.add(f"{name}, {strategy}", data, other.parameters, pairs)
    gradients = da.sensitivity(other, responses, method="adjoint").values
    sampled = other.at(times)
    table = np.array([sampled.values(n) for n in names])
    return Expected(names, np.array([natural_size(model, n) for n in names]), table, gradients)


def differences(expected: Expected, outcome: Outcome, limit: float) -> list[str]:
    """Outputs and gradients that differ."""
    if outcome.table is None:
        return [outcome.status["message"]]
    texts = [] if outcome.same else ["a second run differs"]
    sizes = np.fmax(np.abs(expected.table).max(axis=1), expected.sizes)
    shares = np.abs(outcome.table - expected.table).max(axis=1) / sizes
    texts += [
        f"{n}: {s:.1e}" for n, s in zip(expected.names, shares, strict=True) if not s <= limit
    ]
    for wanted, values in zip(expected.gradients, outcome.gradients, strict=True):
        share = np.abs(values - wanted).max() / (np.abs(wanted).max() or 1.0)
        if not share <= GRADIENTS:
            texts.append(f"gradient: {share:.1e}")
    return texts


def check(folder: Path, cases: list[tuple[str, str]]) -> None:
    """Run cases in one process and compare them."""
    modules = Modules(folder)
    expected = {f"{n}, {s}": prepare(modules, n, s) for n, s in cases}
    outcomes, _ = modules.run()
    wrong = {}
    for label, entry in expected.items():
        if not isinstance(entry, str):
            wrong[label] = differences(entry, outcomes[label], VALUES[label.split(", ")[-1]])
    assert {label: texts for label, texts in wrong.items() if texts} == {}


IN_TURN = [(name, list(STRATEGIES)[k % len(STRATEGIES)]) for k, name in enumerate(NAMES)]
QUICK = [pair for pair in IN_TURN if pair[0] in PLANAR][::19]
"""A few elements of the plane, strategies in turn."""
OTHERS = [(name, strategy) for name in NAMES for strategy in STRATEGIES]
OTHERS = [pair for pair in OTHERS if pair not in QUICK]


@pytest.mark.parametrize(
    "cases",
    [QUICK, *(pytest.param(OTHERS[k::6], marks=pytest.mark.thorough) for k in range(6))],
)
def test_runs_equal_those_of_python(tmp_path: Path, cases: list[tuple[str, str]]) -> None:
    check(tmp_path, cases)


def test_library_functions(tmp_path: Path) -> None:
    """Functions that WebAssembly imports have the values of NumPy and SciPy."""
    rng = np.random.default_rng(1)
    special = np.array([0.0, -0.0, 1e-300, 1e-10, 0.5, 1.0, 2.5, 5.9, 6.0, 30.0, np.inf, np.nan])
    x = np.concatenate([special, -special, rng.uniform(-7, 7, 500), rng.standard_normal(100) * 1e8])
    a, b = (column.ravel() for column in np.meshgrid(x[::7], x[::5]))
    pairs = {"fmod": np.fmod, "fmin": np.fmin, "fmax": np.fmax, "remainder": ieee_remainder}
    modules = Modules(tmp_path)
    modules.calls = [["erf", x], *([name, a, b] for name in pairs)]
    _, (erf, *others) = modules.run()
    assert np.isnan(erf[np.isnan(x)]).all()
    numeric = ~np.isnan(x)
    np.testing.assert_array_max_ulp(erf[numeric], scipy.special.erf(x[numeric]), 6)
    for values, function in zip(others, pairs.values(), strict=True):
        with np.errstate(invalid="ignore"):
            np.testing.assert_array_equal(values, function(a, b))


def ieee_remainder(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    def one(x: float, y: float) -> float:
        try:
            return math.remainder(x, y)
        except ValueError:
            return math.nan

    return np.vectorize(one)(a, b)


def falling_stone() -> da.Model:
    system = da.System("stone", gravity=(0, -10))
    height = system.parameter("height", 5.0, unit="m")
    system.parameter("span", 1.0, unit="s")
    stone = system.add(da.planar.Particle("stone", mass=1.0, position=(0, height)))
    spring = da.planar.Spring("spring", system.ground.center, stone.center, stiffness=1.0)
    system.add(spring)
    return system.build()


OBSTACLES = {
    "event": {"duration": 2.0, "events": {"lands": da.Event("stone.y", terminal=True)}},
    "event that does not occur": {
        "duration": 0.1,
        "events": {"far": da.Event("stone.x - 9", True)},
    },
    "times": {"duration": "2*span"},
    "SUNDIALS": {"duration": 0.1, "integrator": da.CVODES()},
    "implicit": {"duration": 0.1, "integrator": da.Radau()},
    "unbalanced": {"duration": 9.0, "step": 1.0, "integrator": da.Euler(), "balance": 1e-9},
}


@pytest.mark.parametrize("options", OBSTACLES.values(), ids=OBSTACLES)
def test_other_runs_have_a_reason(options: dict[str, Any]) -> None:
    motion = da.solve_dynamics(falling_stone(), **options)
    reason = motion.analysis.live_obstacle(motion)
    assert reason and reason[-1] != "."


def test_switching_forces_have_a_reason() -> None:
    motion = da.solve_dynamics(any_model_of("contact"), 0.02)
    assert "switch" in motion.analysis.live_obstacle(motion)
