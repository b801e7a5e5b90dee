"""Live pages in a browser: responses and slopes as in Python, improvement, kept designs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, visit

import dalembert as da
from dalembert import planar
from dalembert.errors import UnsupportedError

INITIAL = {"l1": 0.3, "l2": 1.0, "m": 1.5}
"""Parameters of the four-bar linkage."""


def four_bar() -> da.Model:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3, bounds=(0.05, 0.9), unit="m", description="crank length")
    l2 = system.parameter("l2", 1000, bounds=(800, 1500), unit="mm")
    m = system.parameter("m", 1.5, bounds=(1, 3), unit="kg")
    crank = system.add(planar.Bar("crank", length=l1, mass=m, angle=1.5708, angular_velocity=1.0))
    coupler = system.add(planar.Bar("coupler", length=l2, mass=5.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system.build()


RESPONSES = [
    da.maximum("A.force_norm"),
    da.minimum("rocker.angle", smooth=0.02),
    da.maximum("B.force_norm", smooth="20 N"),
    da.final("crank.angle"),
    da.at(1.0, "coupler.x"),
    da.mean("A.force.x**2", name="mean square"),
    da.rms("A.force_norm"),
    da.integral("kinetic_energy"),
    da.total("coupler.end.y"),
    da.maximum("kinetic_energy") - 2 * da.mean("kinetic_energy") + 1,
]


@pytest.fixture(scope="module")
def motion() -> Any:
    return da.solve_dynamics(four_bar(), 2.0, step=0.004)


@pytest.fixture(scope="module")
def page_path(motion: Any, tmp_path_factory: Any) -> Path:
    return motion.report(tmp_path_factory.mktemp("live") / "live.html", responses=RESPONSES)


@pytest.fixture(scope="module")
def page(browser: Any, page_path: Path) -> Iterator[Visit]:
    with visit(browser, page_path) as found:
        settle(found)
        yield found
        assert (found.requests, found.console) == ([], [])


@pytest.fixture
def live(page: Visit) -> Visit:
    """The page with its initial design."""
    page.js("dalembert.design.replace(dalembert.design.initial, 'test')")
    settle(page)
    return page


def settle(page: Visit) -> None:
    """Wait until the worker has answered the newest request."""
    page.until(
        "document.documentElement.dataset.live && !dalembert.solver.running && "
        "!dalembert.solver.waiting && dalembert.solver.number >= 2"
    )
    page.frames()


def change(page: Visit, **values: float) -> None:
    """Set parameters, in SI units."""
    names = page.js("dalembert.design.parameters.map(({ name }) => name)")
    design = [values.get(name, INITIAL[name]) for name in names]
    page.js(f"dalembert.design.replace({design}, 'test')")
    settle(page)


def test_responses_and_slopes_equal_those_of_python(live: Visit, motion: Any) -> None:
    change(live, l1=0.36, l2=1.1, m=2.0)
    again = motion.analysis.run(motion.model, {"l1": 0.36, "l2": 1.1, "m": 2.0})
    values = np.array(live.js("dalembert.table.values"))
    expected = np.array([da.evaluate(again, response) for response in RESPONSES])
    assert np.abs(values / expected - 1).max() < 1e-9
    slopes = live.js(
        """dalembert.solver.request({ parameters: dalembert.design.values,
            responses: dalembert.table.responses,
            gradients: dalembert.table.responses.map((_, k) => k) })
            .then(({ slopes }) => slopes.map((row) => [...row]))"""
    )
    gradients = da.sensitivity(again, RESPONSES).values
    scale = np.abs(gradients).max(axis=1, keepdims=True)
    assert np.abs((np.array(slopes) - gradients) / scale).max() < 1e-8


def test_labels_and_units_of_responses(live: Visit, motion: Any) -> None:
    listed = live.js("dalembert.table.responses.map(({ label, unit }) => [label, unit])")
    assert [label for label, _ in listed] == [response.label for response in RESPONSES]
    assert [unit for _, unit in listed] == [
        unit if (unit := response.unit_of(motion)) != "1" else "" for response in RESPONSES
    ]


def test_initial_design_stays_visible(live: Visit) -> None:
    ghosts = "dalembert.motion.ghosts.length"
    assert live.js(ghosts) == 0
    assert live.page.locator("#ghosts").is_hidden()
    before = live.js("[...dalembert.motion.seriesByName.get('crank.angle').values.slice(0, 50)]")
    change(live, l1=0.4)
    assert live.js(ghosts) == 3
    assert live.page.locator("#ghosts").is_visible()
    assert live.page.inner_text(".other-run") == "Dashed: initial design"
    dashed = live.js("[...dalembert.motion.seriesByName.get('crank.angle').other.slice(0, 50)]")
    assert np.allclose(dashed, before, atol=1e-4)  # columns of a payload are rounded
    lengths = "dalembert.motion.ghosts.map(({ x }) => new Set(x).size)"
    assert min(live.js(lengths)) > 1  # moves with time
    live.page.click("#ghosts")
    assert live.js(ghosts) == 0
    assert live.js("dalembert.motion.seriesByName.get('crank.angle').other") is None
    live.page.click("#ghosts")
    live.page.click("#reset-design")
    settle(live)
    assert live.js(ghosts) == 0


def test_responses_are_added_and_removed(live: Visit, motion: Any) -> None:
    count = live.js("dalembert.table.responses.length")
    change(live, l1=0.35)
    live.page.click("#add-response > summary")
    live.page.select_option("#add-response [aria-label='Reduction over time']", "integral")
    live.page.select_option("#add-response .measure", label="rocker.angular_velocity")
    live.page.click("#add-response-now")
    settle(live)
    again = motion.analysis.run(motion.model, {"l1": 0.35})
    added = da.integral("rocker.angular_velocity")
    row = live.page.locator(".responses tbody tr").last
    assert row.locator("th").inner_text() == "integral of rocker.angular_velocity [rad/s s]"
    assert live.js("dalembert.table.values.at(-1)") == pytest.approx(
        da.evaluate(again, added), rel=1e-9
    )
    assert float(row.locator(".was").inner_text().replace("−", "-")) == pytest.approx(
        da.evaluate(motion, added), rel=1e-4
    )
    assert live.js("dalembert.table.selected") == count
    row.locator("button").click()
    settle(live)
    assert live.js("dalembert.table.responses.length") == count


def test_responses_that_a_page_cannot_compute_are_refused(motion: Any, tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match=r"at\(0\.0015, coupler\.x\).*not an output"):
        motion.report(tmp_path / "x.html", responses=[da.at(0.0015, "coupler.x")])
    with pytest.raises(da.errors.AnalysisError, match="is not a response"):
        motion.report(tmp_path / "x.html", responses=["A.force_norm"])


def test_series_in_preferred_units(browser: Any, motion: Any, tmp_path: Path) -> None:
    path = motion.report(tmp_path / "mm.html", plots=[["coupler.x"]], units=["mm", "kN"])
    with visit(browser, path) as found:
        settle(found)
        again = motion.analysis.run(motion.model, {"l1": 0.35})
        change(found, l1=0.35)
        highest = 1e3 * again.values("coupler.x").max()
        assert found.js("dalembert.table.values[0]") == pytest.approx(highest, rel=1e-9)
        shown = found.js("Math.max(...dalembert.motion.seriesByName.get('coupler.x').values)")
        assert shown == pytest.approx(highest, rel=1e-9)
        assert json.dumps(found.js("dalembert.table.responses[0].unit")) == '"mm"'
