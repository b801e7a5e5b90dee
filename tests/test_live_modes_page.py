"""Live pages of modes of mechanisms in a browser: values, slopes and pictures as in Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, visit
from live_visits import SLOPE, SLOPES, VALUES, change, close, settle
from mode_models import carts, double_pendulum, spinning_rotor, suspended_body

import dalembert as da

DRAWN = """dalembert.motion.bodies.map(({ x, y, a, position, rotation }) =>
    [...(position ? [...position, ...rotation] : [x, y, a])].map((column) => [...column]))"""
"""Columns of the poses of all bodies."""
POSES = ("x", "y", "z", "angle", "e0", "e1", "e2", "e3")


def compare(page: Visit, modes: Any) -> None:
    """Eigenvalues, names and pictures of the page and of a result."""
    expected = modes.page()
    for series in expected["series"]:
        values = page.js(f"[...dalembert.motion.seriesByName.get('{series['name']}').values]")
        size = np.abs(modes.eigenvalues).max()
        np.testing.assert_allclose(values, series["values"], rtol=0, atol=VALUES * size)
    bodies = expected["scene"]["bodies"]
    poses = [[body[key] for key in POSES if key in body] for body in bodies]
    for drawn, columns in zip(page.js(DRAWN), poses, strict=True):
        close(drawn, columns, VALUES)
    names = page.page.locator("#case option").all_inner_texts()
    states = [name.partition(", ")[0] for name in names]
    for number, expected_name in enumerate(modes.state_names, 1):
        free = f"mode {number}: free motion"
        assert states[number - 1] == (free if modes.frequencies[number - 1] == 0 else expected_name)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("build", "values"),
    [
        (carts, {"stiffness": 700.0, "damping": 5.0, "mass": 2.0}),
        (double_pendulum, {"first": 0.7, "second": 1.5}),
        (suspended_body, {"length": 1.6, "width": 0.4}),
    ],
    ids=["carts", "double pendulum", "spatial pendulum"],
)
def test_modes_follow_their_sliders(
    build: Any, values: dict[str, float], browser: Any, tmp_path: Path
) -> None:
    model, analysis = build(), da.Modal()
    path = analysis.run(model).report(tmp_path / "modes.html", live=True)
    with visit(browser, path) as page:
        settle(page)
        page.page.select_option("#case", "1")
        compare(page, analysis.run(model))
        picture = page.picture("#scene")
        change(page, dict(enumerate(values.values())))
        other = analysis.run(model, values)
        compare(page, other)
        assert page.picture("#scene") != picture
        assert page.page.input_value("#case") == "1"
        assert page.js("dalembert.table.values") == pytest.approx(other.frequencies, rel=VALUES)
        for k, number in enumerate(other.numbers):
            response = da.at(int(number), "frequency")
            close(page.js(SLOPE.format(k)), da.sensitivity(other, response).values, SLOPES)
        row = page.page.locator("#eigenvalues tr.chosen td").first.inner_text()
        assert float(row) == pytest.approx(other.frequencies[1], rel=1e-4)
        page.page.click("#undo")
        settle(page)
        compare(page, analysis.run(model))
        assert (page.requests, page.console) == ([], [])


@pytest.mark.thorough
def test_whirl_of_a_spinning_rotor(browser: Any, tmp_path: Path) -> None:
    model, analysis = spinning_rotor(), da.Modal(equilibrium=False)
    path = analysis.run(model).report(tmp_path / "modes.html", live=True)
    with visit(browser, path) as page:
        settle(page)
        compare(page, analysis.run(model))
        change(page, {0: 80.0, 1: 700.0})
        other = analysis.run(model, {"spin": 80.0, "stiffness": 700.0})
        compare(page, other)
        for number in (3, 4):
            response = da.at(number, "frequency")
            close(page.js(SLOPE.format(number - 1)), da.sensitivity(other, response).values, SLOPES)
        assert (page.requests, page.console) == ([], [])


@pytest.mark.thorough
def test_strong_damping_changes_the_number_of_modes(browser: Any, tmp_path: Path) -> None:
    """A pair of conjugate eigenvalues becomes two decays."""
    model, analysis = carts(), da.Modal()
    responses = [da.at(1, "damping_ratio"), da.at(3, "frequency")]
    path = analysis.run(model).report(tmp_path / "modes.html", responses=responses)
    with visit(browser, path) as page:
        settle(page)
        page.page.select_option("#case", "2")
        change(page, {1: 50.0})
        other = analysis.run(model, {"damping": 50.0})
        assert other.numbers.size > 3
        compare(page, other)
        assert "decays" in page.page.inner_text("#case option >> nth=3")
        assert page.page.locator("#eigenvalues tbody tr").count() == other.numbers.size
        status = page.js("dalembert.picture.result.status")
        assert (status["outcome"], status["message"]) == ("completed", other.status.message)
        assert page.js("dalembert.table.values") == pytest.approx(
            [da.evaluate(other, response) for response in responses], rel=VALUES
        )
        page.page.get_by_role("button", name="Reset", exact=True).click()
        settle(page)
        compare(page, analysis.run(model))
        assert page.page.locator("#case option").count() == 3
        assert page.console == []


@pytest.mark.thorough
def test_the_amplitude_and_kept_designs_remain(browser: Any, tmp_path: Path) -> None:
    path = da.linearize(carts()).report(tmp_path / "modes.html")
    with visit(browser, path) as page:
        settle(page)
        page.page.fill("#scale", "2")
        change(page, {2: 2.0})
        assert page.js("dalembert.motion.swing.factor") == 2
        assert page.js("dalembert.motion.ghosts.length") == 3
        assert not page.page.locator("#ghosts").is_hidden()
        page.page.click("#add-response")
        page.page.select_option(".add-response select >> nth=0", "1")
        page.page.select_option(".add-response .measure", label="damping_ratio")
        page.page.click("#add-response-now")
        settle(page)
        assert page.js("dalembert.table.responses.at(-1).label") == "damping_ratio of mode 2"
        expected = da.linearize(carts(), parameters={"mass": 2.0}).damping_ratios[1]
        assert page.js("dalembert.table.values.at(-1)") == pytest.approx(expected, rel=VALUES)


@pytest.mark.thorough
def test_coincident_modes_have_different_pictures(browser: Any, tmp_path: Path) -> None:
    system = da.System("spherical pendulum", gravity=(0.0, 0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    ball = system.add(da.spatial.Particle("ball", mass=1.0, position=(0, 0, -length)))
    system.add(
        da.spatial.RigidLink("rod", system.ground.point(0, 0, 0), ball.center, length=length)
    )
    path = da.linearize(system.build()).report(tmp_path / "modes.html", live=True)
    with visit(browser, path) as page:
        settle(page)
        columns = np.array(page.js(DRAWN)[0][:2])
        real = columns[:, 2:4]
        assert abs(np.linalg.det(real)) > 0.1


@pytest.mark.parametrize(
    ("reason", "modes"),
    [
        ("the model has no parameters", lambda: da.linearize(_swing(None))),
        ("the modes are a selection", lambda: da.linearize(carts()).at([2, 3])),
        ("the modes are about the end of a motion", lambda: _moving()),
    ],
    ids=["parameters", "selection", "motion"],
)
def test_pages_that_are_not_live_state_the_reason(reason: str, modes: Any) -> None:
    result = modes()
    assert result.live_page(result.page(), True)["live"] == {"reason": reason}


def _swing(length: float | None) -> Any:
    system = da.System("swing", gravity=(0.0, -9.81))
    size = 1.0 if length is None else system.parameter("length", length, "m", bounds=(0.5, 2.0))
    bar = system.add(da.planar.Bar("bar", length=size, mass=1.0, angle=-1.5))
    system.add(da.planar.Revolute("O", system.ground.center, bar.start))
    return system.build()


def _moving() -> Any:
    model = _swing(1.0)
    return da.linearize(model, about=da.solve_dynamics(model, 0.1, step=0.01))
