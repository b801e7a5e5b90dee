"""Live pages of structures in a browser: values and slopes as in Python, pictures that follow."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, visit
from live_visits import SLOPE, SLOPES, VALUES, change, close, settle

import dalembert as da


def truss() -> Any:
    """Truss with two load cases and its weight."""
    structure = da.Structure("truss")
    height = structure.parameter("height", 1.0, "m", bounds=(0.5, 2.0))
    area = structure.parameter("area", 10.0, "cm^2", bounds=(5.0, 40.0))
    load = structure.parameter("load", 10.0, "kN", bounds=(-20.0, 40.0))
    low = [structure.node(f"a{k}", k, 0.0) for k in range(4)]
    high = [structure.node(f"b{k}", k + 0.5, height) for k in range(3)]
    pairs = [*pairwise(low), *pairwise(high)]
    pairs += [*zip(low[:-1], high, strict=True), *zip(high, low[1:], strict=True)]
    for k, (i, j) in enumerate(pairs):
        bar = {"area": area, "modulus": 2.1e11, "density": 7850.0}
        structure.add(da.structures.Truss(f"bar{k}", i, j, **bar))
    structure.support(low[0])
    structure.support(low[3], uy=0.0)
    structure.gravity(0, -9.81, case="middle")
    structure.load(high[1], case="middle", fy=-load)
    structure.load(low[1], case="side", fx=load / 2, fy=-2 * load)
    return structure.build()


def portal() -> Any:
    """Portal frame with a mass on its beam."""
    structure = da.Structure("portal")
    width = structure.parameter("width", 4.0, "m", bounds=(2.0, 8.0))
    depth = structure.parameter("depth", 200.0, "mm", bounds=(100.0, 400.0))
    mass = structure.parameter("mass", 100.0, "kg", bounds=(1.0, 1000.0))
    places = {"A": (0, 0), "B": (0, 3), "E": (width / 2, 3), "C": (width, 3), "D": (width, 0)}
    nodes = {name: structure.node(name, *place) for name, place in places.items()}
    section = {"area": 0.1 * depth, "second_moment": 0.1 * depth**3 / 12}
    for i, j in ("AB", "BE", "EC", "CD"):
        more = {"modulus": 2.1e11, "density": 7850.0}
        structure.add(da.structures.Frame(f"{i}{j}", nodes[i], nodes[j], **section, **more))
    structure.add(da.structures.PointMass("block", nodes["E"], mass=mass))
    structure.support(nodes["A"])
    structure.support(nodes["D"])
    structure.load(nodes["B"], fx=1e4)
    return structure.build()


def compare(page: Visit, result: Any) -> None:
    """Drawing, fields and reactions of the page and of a result."""
    expected = result.page()
    mesh, scene = "dalembert.motion.mesh", expected["scene"]
    close(page.js(f"[...{mesh}.rest]"), scene["mesh"]["rest"], VALUES)

    def scaled(columns: Any) -> np.ndarray:
        """Columns of modes relative to their largest entries."""
        columns = np.array(columns, float)
        return columns / np.nanmax(np.abs(columns), axis=1, keepdims=True, initial=1e-300)

    modes = result.of_any_size
    moved = np.array(scene["mesh"]["vertex_displacements"], float)
    drawn = np.array(page.js(f"{mesh}.moved.map((column) => [...column])"))
    close(*((scaled(drawn), scaled(moved)) if modes else (drawn, moved)), VALUES)
    for field in scene["fields"]:
        name = f"{mesh}.fields.find(({{ name }}) => name === '{field['name']}')"
        values = page.js(f"{name}.values.map((column) => [...column])")
        close(values, scaled(field["values"]) if modes else field["values"], VALUES)
    reactions = page.js(f"{mesh}.reactions.map(({{ values }}) => [...values])")
    assert len(reactions) == len(expected["reactions"])
    if reactions:
        close(reactions, [row["values"] for row in expected["reactions"]], VALUES)


def test_a_truss_follows_its_sliders(browser: Any, tmp_path: Path) -> None:
    model, analysis = truss(), da.Statics()
    responses = [da.maximum("a1.uy**2"), da.total("compliance"), da.maximum("bar3.stress")]
    path = analysis.run(model).report(tmp_path / "truss.html", responses=responses)
    with visit(browser, path) as page:
        settle(page)
        assert page.page.locator(".parameter").count() == 3
        compare(page, analysis.run(model))
        picture = page.picture("#scene")
        change(page, {0: 1.5, 1: 2e-3, 2: 25e3})
        values = {"height": 1.5, "area": 2e-3, "load": 25e3}
        other = analysis.run(model, values)
        compare(page, other)
        assert page.picture("#scene") != picture
        assert page.js("dalembert.motion.otherMesh !== null")
        shown = page.js("dalembert.table.values")
        for k, response in enumerate(responses):
            assert shown[k] == pytest.approx(da.evaluate(other, response), rel=VALUES)
            slopes = da.sensitivity(other, response, method="adjoint").values
            close(page.js(SLOPE.format(k)), slopes, SLOPES)
        row = page.page.locator("#displacements tr", has_text="b1")
        cells = row.locator("td").all_inner_texts()
        head = page.page.locator("#displacements th", has_text="uy").inner_text()
        factor = {"uy [µm]": 1e6, "uy [mm]": 1e3}[head.replace("\xa0", " ")]
        uy = factor * other.values("b1.uy")[0]
        assert float(cells[1].replace("−", "-")) == pytest.approx(uy, rel=1e-4)
        page.page.click("#undo")
        settle(page)
        compare(page, analysis.run(model))
        change(page, {0: 1.7})
        page.page.get_by_role("button", name="Reset", exact=True).click()
        settle(page)
        compare(page, analysis.run(model))
        assert page.js("dalembert.motion.otherMesh === null")
        assert (page.requests, page.console) == ([], [])


@pytest.mark.thorough
def test_modes_of_a_frame_follow_their_sliders(browser: Any, tmp_path: Path) -> None:
    model, analysis = portal(), da.Modal(count=3)
    path = analysis.run(model).report(tmp_path / "portal.html")
    with visit(browser, path) as page:
        settle(page)
        page.page.select_option("#case", "1")
        compare(page, analysis.run(model))
        picture = page.picture("#scene")
        change(page, {0: 6.0, 1: 0.15, 2: 500.0})
        other = analysis.run(model, {"width": 6.0, "depth": 0.15, "mass": 500.0})
        compare(page, other)
        assert page.picture("#scene") != picture
        assert page.js("dalembert.table.values") == pytest.approx(other.frequencies, rel=VALUES)
        for k in range(3):
            slopes = da.sensitivity(other, da.at(k + 1, "frequency"), method="adjoint").values
            close(page.js(SLOPE.format(k)), slopes, SLOPES)
        names = page.page.locator("#case option").all_inner_texts()
        assert names == other.state_names
        assert page.page.input_value("#case") == "1"
        assert page.js("dalembert.motion.mesh.scales.length") == 3
        assert (page.requests, page.console) == ([], [])


@pytest.mark.thorough
def test_responses_of_structures_are_added(browser: Any, tmp_path: Path) -> None:
    model, analysis = truss(), da.Statics()
    path = analysis.run(model).report(tmp_path / "truss.html", responses=[da.total("compliance")])
    added = {
        ("side", "b0.uy"): ("b0.uy, side [m]", da.at(1, "b0.uy")),
        ("maximum", "bar3.stress"): ("maximum of bar3.stress [Pa]", da.maximum("bar3.stress")),
    }
    with visit(browser, path) as page:
        settle(page)
        change(page, {0: 1.5})
        other = analysis.run(model, {"height": 1.5})
        for k, ((state, quantity), (label, response)) in enumerate(added.items(), 1):
            page.page.click("#add-response > summary")
            page.page.select_option("#add-response [aria-label='Load case']", label=state)
            page.page.select_option("#add-response .measure", label=quantity)
            page.page.click("#add-response-now")
            settle(page)
            assert page.page.locator(".responses tbody tr").last.inner_text().startswith(label)
            value = page.js("dalembert.table.values.at(-1)")
            assert value == pytest.approx(da.evaluate(other, response), rel=VALUES)
            slopes = da.sensitivity(other, response, method="adjoint").values
            close(page.js(SLOPE.format(k)), slopes, SLOPES)
        assert page.console == []


@pytest.mark.thorough
def test_a_statically_unstable_design_keeps_the_picture(browser: Any, tmp_path: Path) -> None:
    model = truss()
    path = da.solve_statics(model).report(tmp_path / "truss.html", live=True)
    with visit(browser, path) as page:
        settle(page)
        change(page, {0: 1.5})
        before = page.js("[...dalembert.motion.mesh.rest]")
        page.js(
            "dalembert.design.values[0] = 0; dalembert.solver.request({ parameters: "
            "dalembert.design.values, responses: [], gradients: [] })"
        )
        settle(page)
        assert "can move without strain" in page.page.inner_text(".live-status.error")
        assert page.js("[...dalembert.motion.mesh.rest]") == before
        assert page.console == []
