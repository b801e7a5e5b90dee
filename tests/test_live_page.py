"""Live pages in a browser: responses and slopes as in Python, improvement, kept designs."""

from __future__ import annotations

import json
import tomllib
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
    l1 = system.parameter("l1", 0.3, bounds=(0.05, 1.2), unit="m", description="crank length")
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
    da.maximum("crank.end.x**2 + crank.end.y**2", name="reach"),
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


# Improvement --------------------------------------------------------------------------------------


@pytest.fixture
def improving(live: Visit) -> Iterator[Visit]:
    live.page.click("#improve")
    yield live
    live.js(
        """{ const { improvement, design } = dalembert;
            improvement.stop();
            improvement.goals.goals.clear();
            design.locked.fill(false); }"""
    )
    live.until("!dalembert.improvement.running")
    live.page.click("#improve")


def improved(page: Visit, goals: dict[str, tuple[Any, ...]], locked: str = "") -> str:
    """Message at the end of an improvement."""
    page.js(
        f"""{{ const {{ design, improvement, table }} = dalembert;
            const locked = {json.dumps(locked)}, goals = {json.dumps(goals)};
            design.locked = design.parameters.map(({{ name }}) => locked.includes(name));
            const find = (label) => table.responses.find((r) => r.label === label);
            for (const label of Object.keys(goals))
                improvement.goals.set(find(label), ...goals[label]); }}"""
    )
    page.page.click("#improve-start")
    page.until("!dalembert.improvement.running")
    settle(page)
    return page.page.inner_text("#improve-status")


def present(page: Visit) -> dict[str, float]:
    return page.js(
        "Object.fromEntries(dalembert.design.parameters.map(({ name }, k) => "
        "[name, dalembert.design.values[k]]))"
    )


def test_improvement_ends_at_an_optimum_within_bounds_and_limits(
    improving: Visit, motion: Any
) -> None:
    energy, angle = da.integral("kinetic_energy"), da.final("crank.angle")
    limit = 1.01 * da.evaluate(motion, angle)
    goals = {energy.label: ("minimise",), angle.label: ("atLeast", limit)}
    message = improved(improving, goals, locked="m")
    assert message.startswith("Converged after")
    values = present(improving)
    assert values["m"] == INITIAL["m"]
    again = motion.analysis.run(motion.model, values)
    assert da.evaluate(again, angle) >= limit * (1 - 1e-6)
    gradients = da.sensitivity(again, [energy, angle]).values
    lower, upper = np.array([[0.05, 0.8, 1], [1.2, 1.5, 3]])
    now, ranges = np.array(list(values.values())), upper - lower
    free = (now > lower + 1e-9) & (now < upper - 1e-9) & np.array([True, True, False])
    objective, constraint = (gradients * ranges)[:, free]
    price = max(0.0, objective @ constraint / (constraint @ constraint))
    assert np.abs(objective - price * constraint).max() < 1e-3 * np.abs(gradients[0] * ranges).max()


def test_improvement_stops_beside_designs_that_cannot_be_assembled(improving: Visit) -> None:
    change(improving, l2=0.8)
    message = improved(improving, {"reach": ("maximise",)}, locked="l2 m")
    assert message.startswith("Ended beside designs that cannot be computed after")
    assert "could not be computed." in message
    last = present(improving)["l1"]
    assert 0.9 < last < np.sqrt(1.4**2 - 1) + 1e-6
    assert improving.js("dalembert.table.values.every(Number.isFinite)")


def test_history_of_an_improvement(improving: Visit) -> None:
    energy = da.integral("kinetic_energy").label
    improved(improving, {energy: ("minimise",)})
    count = improving.js("dalembert.improvement.history.length")
    assert count > 3
    slider = improving.page.locator("#improve-history")
    slider.focus()
    improving.page.keyboard.press("Home")
    settle(improving)
    assert present(improving) == INITIAL
    assert slider.get_attribute("aria-valuetext").startswith("iteration 0: ")
    box = improving.page.locator(".improve-chart").bounding_box()
    improving.page.mouse.click(box["x"] + box["width"] - 6, box["y"] + box["height"] / 2)
    settle(improving)
    assert slider.input_value() == str(count - 1)
    last = improving.js("dalembert.improvement.history.at(-1).values")
    assert list(present(improving).values()) == last
    improving.page.click("#undo")
    settle(improving)
    assert present(improving) == INITIAL


def test_improvement_is_stopped(improving: Visit) -> None:
    improving.js("dalembert.improvement.goals.set(dalembert.table.responses[0], 'minimise')")
    improving.page.click("#improve-start")
    improving.until("dalembert.improvement.history.length > 1")
    improving.page.click("#improve-start")
    improving.until("!dalembert.improvement.running")
    assert improving.page.inner_text("#improve-status").startswith("Stopped after")


# Kept designs, texts, address ---------------------------------------------------------------------


def test_kept_designs_are_compared_and_recalled(live: Visit, motion: Any) -> None:
    change(live, l1=0.35, l2=1.1)
    live.page.click("#keep")
    change(live, l1=0.4)
    live.page.click("#keep")
    heads = live.page.locator(".kept thead th")
    assert [text for text in heads.all_inner_texts() if text] == ["Initial", "A", "B", "Unit"]
    rows = live.page.locator(".kept tbody tr")
    assert rows.nth(1).locator("td").all_inner_texts() == ["1000", "1100", "1000", "mm"]
    again = motion.analysis.run(motion.model, {"l1": 0.35, "l2": 1.1})
    force = rows.filter(has_text="maximum(A.force_norm)").locator("td").all_inner_texts()
    expected = [da.evaluate(run, RESPONSES[0]) for run in (motion, again)]
    assert [float(text) for text in force[:2]] == pytest.approx(expected, rel=1e-4)
    live.page.click("[aria-label='Show design A in the drawing']")
    assert live.js("dalembert.motion.ghosts.length") == 6  # with the initial design
    live.page.get_by_title("Return to design A").click()
    settle(live)
    assert present(live) == INITIAL | {"l1": 0.35, "l2": 1.1}
    assert live.page.locator(".kept [aria-current]").inner_text().startswith("A")
    for letter in "AB":
        live.page.click(f"[aria-label='Remove design {letter}']")
    assert live.page.locator("#kept").is_hidden()
    live.page.click("#reset-design")
    settle(live)
    assert live.js("dalembert.motion.ghosts.length") == 0


def test_texts_of_a_design(live: Visit) -> None:
    change(live, l1=0.1 + 0.2, l2=1.1)
    live.js(
        "navigator.clipboard && (navigator.clipboard.writeText = (t) => { window.copied = t; })"
    )

    def copied(item: str) -> str:
        live.page.click("#use-design > summary")
        live.page.click(item)
        live.until("document.querySelector('.live-status').textContent.endsWith('copied')")
        return live.js("window.copied")

    assert tomllib.loads(copied("#copy-toml")) == {
        "parameters": {
            "l1": {
                "value": 0.1 + 0.2,
                "unit": "m",
                "bounds": [0.05, 1.2],
                "description": "crank length",
            },
            "l2": {"value": 1100, "unit": "mm", "bounds": [800, 1500]},
            "m": {"value": 1.5, "unit": "kg", "bounds": [1, 3]},
        }
    }
    assert copied("#copy-python") == f'parameters={{"l1": {0.1 + 0.2}, "l2": 1.1, "m": 1.5}}'
    assert copied("#copy-address").endswith("live.html#p=l1:0.30000000000000004,l2:1.1")


def test_a_page_saved_as_shown_opens_with_its_design(
    browser: Any, live: Visit, tmp_path: Path
) -> None:
    change(live, l1=0.35, l2=1.1)
    with live.page.expect_download() as saving:
        live.page.click("#use-design > summary")
        live.page.click("#save-page")
    saved = tmp_path / "saved.html"
    saving.value.save_as(saved)
    with visit(browser, saved) as found:
        settle(found)
        assert present(found) == INITIAL | {"l1": 0.35, "l2": 1.1}
        assert found.js("dalembert.motion.ghosts.length") == 3
        assert found.page.locator(".parameter").count() == 3
        assert found.js("dalembert.table.values") == live.js("dalembert.table.values")
        assert (found.requests, found.console) == ([], [])


HOSTILE = {
    "#p=l1:0.35,l2:1.1": {"l1": 0.35, "l2": 1.1},
    "#p=l1:99": {"l1": 1.2},
    "#p=l1:1e999,l2:NaN,m:Infinity": {},
    "#p=l1:0x20,l2:1_0,m:2;alert(1)": {},
    "#p=__proto__:1,constructor:2,toString:3": {},
    "#p=%3Cimg%20src=x%20onerror=alert(1)%3E:1,l1": {},
    "#p=l1:-+e..,,,:::,l2:": {},
    "#p=": {},
    "#p=l1:0.35&m=2": {},
    "#parameters": {},
}


@pytest.mark.parametrize("address", HOSTILE)
def test_addresses_without_effect_and_with_one(
    browser: Any, page_path: Path, tmp_path: Path, address: str
) -> None:
    path = tmp_path / "page.html"
    path.write_text(page_path.read_text())
    with visit(browser, path) as found:
        found.page.goto(path.resolve().as_uri() + address)
        found.page.reload()
        found.until("window.dalembert !== undefined")
        settle(found)
        assert present(found) == INITIAL | HOSTILE[address]
        assert found.console == []
        assert found.js("dalembert.table.values.every(Number.isFinite)")
