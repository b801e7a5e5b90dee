"""Statics and vibration of structures in a page equal those of Python, with gradients."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from live_modules import Modules
from structure_models import MASSIVE, MODELS, model_of

import dalembert as da
from dalembert.results.sources import Row

VALUES, GRADIENTS = 1e-9, 1e-8
"""Largest differences, relative to the largest measure of the unit and the largest derivative."""
CHANGE = 0.02
"""Relative change of the parameters."""
FIRST = "Truss 2-D"
GROUPS = [[FIRST], pytest.param([n for n in MODELS if n != FIRST], marks=pytest.mark.thorough)]


def bridge():
    """Truss with two load cases, its weight and a support that sinks."""
    system = da.Structure("bridge")
    height, area, load = (
        system.parameter(n, x) for n, x in (("height", 1.0), ("area", 1e-3), ("load", 1e4))
    )
    low = [system.node(f"a{k}", k, 0.0) for k in range(4)]
    high = [system.node(f"b{k}", k + 0.5, height) for k in range(3)]
    pairs = [*pairwise(low), *pairwise(high)]
    pairs += [*zip(low[:-1], high, strict=True), *zip(high, low[1:], strict=True)]
    for k, (i, j) in enumerate(pairs):
        bar = {"area": area, "modulus": 2.1e11, "density": 7850.0}
        system.add(da.structures.Truss(f"bar{k}", i, j, **bar))
    system.support(low[0])
    system.support(low[3], uy=-0.001 * height)
    system.gravity(0, -9.81, case="middle")
    system.load(high[1], case="middle", fy=-load)
    system.load(low[1], case="side", fx=load / 2, fy=-2 * load)
    return system.build()


def changed(model: Any) -> np.ndarray:
    p = np.array([q.value for q in model.parameters.values()], float)
    return p * (1 + CHANGE * np.random.default_rng(0).uniform(-1, 1, p.size))


def names_of(result: Any) -> list[str]:
    """Scalar measures with a value."""
    return [name for name in result.model.measures.names() if name != "kinetic_energy"]


class Pairs:
    """Results of Python and of a page."""

    def __init__(self, folder: Path):
        self.modules = Modules(folder)
        self.expected: dict[str, Any] = {}

    def add(self, label: str, analysis: Any, model: Any, names: list[str], chosen: str) -> None:
        result, values = analysis.run(model), changed(model)
        assert analysis.live_obstacle(result) == ""
        other, numbers = analysis.run(model, values), np.array(result.time, float)
        rows = [Row(result.expression(name).sx) for name in names]
        data = analysis.live_functions(result, rows, numbers).page_data()
        weights = np.eye(numbers.size)[-1]
        self.modules.add(label, data, values, [{names.index(chosen): weights}])
        at = other.time[-1] if numbers[0] == 0 else int(numbers[-1])
        slope = da.sensitivity(other, da.at(at, chosen), method="adjoint").values
        self.expected[label] = other, names, slope

    def check(self) -> None:
        outcomes, _ = self.modules.run()
        for label, (other, names, slope) in self.expected.items():
            outcome = outcomes[label]
            assert outcome.table is not None, (label, outcome.status)
            units = [other.expression(name).unit for name in names]
            expected = np.array([other.values(name) for name in names])
            sizes = {
                unit: np.abs(expected[[u == unit for u in units]]).max() or 1.0 for unit in units
            }
            for name, unit, row, values in zip(names, units, expected, outcome.table, strict=True):
                share = np.abs(values - row).max() / sizes[unit]
                assert share <= VALUES, (label, name, values, row)
            share = np.abs(outcome.gradients[0] - slope).max() / np.abs(slope).max()
            assert share <= GRADIENTS, (label, outcome.gradients[0], slope)
            assert outcome.status["message"] == other.status.message


def test_a_parameter_has_the_name_of_a_measure(tmp_path: Path) -> None:
    """The mass of the structure is listed beside the parameter."""
    structure = da.Structure("rod")
    mass = structure.parameter("mass", 3.0, "kg", bounds=(1.0, 5.0))
    base, top = structure.node("base", 0.0, 0.0), structure.node("top", 0.0, 2.0)
    bar = {"area": 1e-4, "modulus": 2e11, "density": 5000.0}
    structure.add(da.structures.Truss("bar", base, top, **bar))
    structure.add(da.structures.PointMass("block", top, mass=mass))
    structure.support(base)
    structure.support(top, ux=0.0)
    structure.gravity(0, -10.0)
    result = da.solve_statics(structure.build())
    page = result.live_page(result.page(), True)["live"]
    module = Modules(tmp_path)
    module.add("rod", page, np.array([4.0]))
    outcomes, _ = module.run()
    (response,) = [r for r in json.loads(page["exact"])["responses"] if r["label"] == "mass"]
    row = outcomes["rod"].table[response["terms"][0]["row"]]
    assert row == pytest.approx([4.0 + 5000.0 * 1e-4 * 2.0], rel=1e-14)


@pytest.mark.parametrize("names", GROUPS)
def test_statics(names: list[str], tmp_path: Path) -> None:
    pairs, analysis = Pairs(tmp_path), da.Statics()
    for name in names:
        model = model_of(name)
        measures = names_of(analysis.run(model))
        pairs.add(name, analysis, model, measures, "compliance")
    model = bridge()
    pairs.add("bridge", analysis, model, ["bar1.stress", "b0.uy", "a0.fx", "mass"], "bar1.stress")
    pairs.check()


@pytest.mark.parametrize("names", GROUPS)
def test_vibration(names: list[str], tmp_path: Path) -> None:
    pairs, analysis = Pairs(tmp_path), da.Modal(count=2)
    for name in names:
        if name in MASSIVE:
            model = model_of(name)
            pairs.add(name, analysis, model, ["frequency", "effective_mass.ux"], "frequency")
    model = bridge()
    pairs.add("bridge", analysis, model, ["frequency", "b1.uy", "bar1.force"], "b1.uy")
    pairs.check()
