"""Every number and column of a page of a structure that follows from parameters has a formula."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np
import pytest
from structure_models import MASSIVE, MODELS, model_of

import dalembert as da
from dalembert.report.packing import pack
from dalembert.report.page import as_json
from dalembert.results.sources import InitialPicture, payload_sources

TOLERANCE = 1e-9
"""Relative to the largest entry of a column."""
CHANGE = 0.02
"""Relative change of the parameters."""
PARTS = ("scene", "displacements", "reactions", "states")
REMAIN = {"scales", "inward", "drop", "names"}
"""Sizes of the drawing, sides of arrows, and names, which the page writes from the values."""


def portal() -> Any:
    """Portal frame with two load cases, a moment, a support that sinks and a mass."""
    structure = da.Structure("portal")
    width, height, depth, load = (
        structure.parameter(n, x)
        for n, x in (("width", 4.0), ("height", 3.0), ("depth", 0.2), ("load", 2e4))
    )
    places = {"A": (0, 0), "B": (0, height), "E": (width / 2, 1.1 * height)}
    places |= {"C": (width, height), "D": (width, 0)}
    nodes = {name: structure.node(name, *place) for name, place in places.items()}
    section = {"area": 0.1 * depth, "second_moment": 0.1 * depth**3 / 12}
    for i, j in ("AB", "BE", "EC", "CD"):
        more = {"modulus": 2.1e11, "density": 7850.0}
        structure.add(da.structures.Frame(f"{i}{j}", nodes[i], nodes[j], **section, **more))
    structure.add(da.structures.PointMass("mass", nodes["E"], mass=load / 100))
    structure.support(nodes["A"])
    structure.support(nodes["D"], ux=0.0, uy=-0.001 * height)
    structure.load(nodes["B"], case="wind", fx=load, mz=load / 10)
    structure.load(nodes["E"], case="snow", fy=-2 * load)
    return structure.build()


NAMES = ["portal", *MODELS]


def pages(name: str, analysis: Any) -> Iterator[Any]:
    """Results of the nominal and of changed parameters."""
    model = portal() if name == "portal" else model_of(name)
    p = np.array([q.value for q in model.parameters.values()], float)
    factors = 1 + CHANGE * np.random.default_rng(0).uniform(-1, 1, p.size)
    for values in (p, p * factors):
        yield analysis.run(model, values)


def evaluated(result: Any, sx: ca.SX) -> np.ndarray:
    """(n, K) values of formulas over the states."""
    symbols = result.model.measure_symbols(sx)
    function = ca.Function("f", [ca.vertcat(*symbols), result.model.p], [ca.densify(sx)])
    measures = [result.measure(s.name()) for s in symbols]
    states = [result.state(k) for k in range(len(result.time))]
    columns = [[m.value(state) for m in measures] for state in states]
    return np.hstack([function(column, result.parameters).full() for column in columns])


def at(payload: Any, place: Any) -> Any:
    for key in place:
        payload = payload[key]
    return payload


def close(one: Any, other: Any, place: Any) -> None:
    one, other = np.asarray(one, float), np.asarray(other, float)
    size = np.nanmax(np.abs(other), initial=0.0)
    assert np.allclose(one, other, rtol=0, atol=TOLERANCE * max(size, 1e-3), equal_nan=True), place


def differing(one: Any, other: Any, place: Any = ()) -> Iterator[Any]:
    """Places where two payloads differ."""
    if (place and place[-1] in REMAIN) or isinstance(one, InitialPicture):
        return
    if isinstance(one, dict):
        assert list(one) == list(other), place
        for key in one:
            yield from differing(one[key], other[key], (*place, key))
    elif isinstance(one, (list, np.ndarray)):
        assert len(one) == len(other), place
        for k in range(len(one)):
            yield from differing(one[k], other[k], (*place, k))
    elif one != other and not np.isclose(one, other, rtol=TOLERANCE, atol=1e-12, equal_nan=True):
        yield place


CASES = [(name, da.Statics()) for name in NAMES]
CASES += [(name, da.Modal(count=2)) for name in NAMES if name == "portal" or name in MASSIVE]


@pytest.mark.few(3)
@pytest.mark.parametrize(("name", "analysis"), CASES)
def test_pages_state_what_follows_from_parameters(name: str, analysis: Any) -> None:
    start, other = pages(name, analysis)
    page, expected = start.page(), other.page()
    sources = payload_sources(page)
    assert start.analysis.live_obstacle(start) == ""
    initial = bool(sources.initial)
    for place, sx in sources.numbers:
        if not (initial and "rest" in place):
            close(evaluated(other, sx)[0, 0], at(expected, place), place)
    for place, sx in sources.columns:
        close(evaluated(other, sx)[0], at(expected, place), place)
    for place, sx in sources.states:
        values, before = evaluated(other, sx).T, np.array(at(page, place), float)
        constant = [entry.is_constant() for entry in ca.vertsplit(ca.densify(sx))]
        close(np.where(constant, before, values), at(expected, place), place)
    stated = {p for p, _ in [*sources.numbers, *sources.columns, *sources.states]}
    places = {p for part in PARTS for p in differing(page[part], expected[part], (part,))}
    rest = {p for p in places if not {p[:k] for k in range(1, len(p) + 1)} & stated}
    height = page["scene"]["dimension"] == 1  # bars on one axis are drawn side by side
    assert {
        p for p in rest if not ("rest" in p and (initial or (height and p[-1] % 3 == 1)))
    } == set()


def test_formulas_do_not_change_the_page() -> None:
    (start, _) = pages("portal", da.Statics())
    page = start.page()
    assert payload_sources(page).states
    plain = copy.deepcopy(page)
    assert not payload_sources(plain).states and not payload_sources(plain).numbers
    assert as_json(page) == as_json(plain)
    assert as_json(pack(page)) == as_json(pack(plain))


def test_larger_structures_have_no_formulas() -> None:
    structure = da.Structure("chain")
    area = structure.parameter("area", 1e-3, bounds=(1e-4, 1e-2))
    nodes = [structure.node(f"n{k}", float(k)) for k in range(160)]
    for k in range(159):
        structure.add(da.structures.Truss(f"b{k}", nodes[k], nodes[k + 1], area=area, modulus=2e11))
    structure.support(nodes[0])
    structure.load(nodes[-1], fx=1.0)
    result = da.Statics().run(structure.build())
    page = result.page()
    assert not payload_sources(page).states
    reason = "the structure has 159 free displacements, more than 150"
    assert result.live_page(page)["live"] == {"reason": reason}
    assert "live" not in result.live_page(page, live=False)
