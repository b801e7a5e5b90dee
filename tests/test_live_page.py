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


@pytest.mark.thorough
def test_responses_have_the_preferred_units(motion: Any, browser: Any, tmp_path: Path) -> None:
    responses = [
        da.final("coupler.x"),
        2 * da.maximum("A.force_norm") + 5,
        da.mean("kinetic_energy"),
    ]
    path = motion.report(tmp_path / "units.html", responses=responses, units=["mm", "kN", "deg"])
    expected = [da.evaluate(motion, response) for response in responses]
    with visit(browser, path) as page:
        settle(page)
        units = page.js("dalembert.table.responses.map(({ unit }) => unit)")
        values = page.js("dalembert.table.values")
        slopes = da.sensitivity(motion, responses).values
        own = page.js(
            """dalembert.solver.request({ parameters: dalembert.design.values,
                responses: dalembert.table.responses, gradients: [0, 1, 2] })
                .then(({ slopes }) => slopes.map((row) => [...row]))"""
        )
    assert units == ["mm", "kN", "J"]
    factors = np.array([1e3, 1e-3, 1.0])
    assert values == pytest.approx(factors * expected, rel=1e-9)
    slopes *= factors[:, None]
    assert np.abs(np.array(own) - slopes).max() < 1e-8 * np.abs(slopes).max()


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


@pytest.mark.thorough
def test_responses_that_a_page_cannot_compute_are_refused(motion: Any, tmp_path: Path) -> None:
    with pytest.raises(UnsupportedError, match=r"at\(0\.0015, coupler\.x\).*not an output"):
        motion.report(tmp_path / "x.html", responses=[da.at(0.0015, "coupler.x")])
    with pytest.raises(da.errors.AnalysisError, match="is not a response"):
        motion.report(tmp_path / "x.html", responses=["A.force_norm"])


@pytest.mark.thorough
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


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_improvement_stops_beside_designs_that_cannot_be_assembled(improving: Visit) -> None:
    change(improving, l2=0.8)
    message = improved(improving, {"reach": ("maximise",)}, locked="l2 m")
    assert message.startswith("Ended beside designs that cannot be computed after")
    assert "could not be computed." in message
    last = present(improving)["l1"]
    assert 0.9 < last < np.sqrt(1.4**2 - 1) + 1e-6
    assert improving.js("dalembert.table.values.every(Number.isFinite)")


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_improvement_is_stopped(improving: Visit) -> None:
    improving.js("dalembert.improvement.goals.set(dalembert.table.responses[0], 'minimise')")
    improving.page.click("#improve-start")
    improving.until("dalembert.improvement.history.length > 1")
    improving.page.click("#improve-start")
    improving.until("!dalembert.improvement.running")
    assert improving.page.inner_text("#improve-status").startswith("Stopped after")


# Kept designs, texts, address ---------------------------------------------------------------------


@pytest.mark.thorough
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


@pytest.fixture
def pendulum(browser: Any, tmp_path: Path) -> Iterator[Visit]:
    """A page with a parameter without upper bound, and a response of tiny values."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", 500.0, "mm", bounds=(100, 900))
    mass = system.parameter("mass", 2.0, "kg", bounds=(0.1, np.inf))
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=0.4))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    reach = da.maximum("bar.end.x")
    run = da.solve_dynamics(system.build(), 0.5, step=0.005)
    path = run.report(tmp_path / "pendulum.html", responses=[reach, 1e-9 * reach])
    with visit(browser, path) as opened:
        settle(opened)
        yield opened
        assert (opened.requests, opened.console) == ([], [])


@pytest.mark.thorough
def test_copied_lines_contain_open_bounds(pendulum: Visit) -> None:
    pendulum.js("navigator.clipboard.writeText = (t) => { window.copied = t; }")
    pendulum.page.click("#use-design > summary")
    pendulum.page.click("#copy-toml")
    pendulum.until("window.copied !== undefined")
    rows = tomllib.loads(pendulum.js("window.copied"))["parameters"]
    assert rows["length"]["bounds"] == [100, 900]
    assert rows["mass"]["bounds"] == [0.1, np.inf]


@pytest.mark.thorough
def test_limits_of_tiny_responses_are_not_satisfied_by_chance(pendulum: Visit) -> None:
    pendulum.page.click("#improve")
    pendulum.js(
        """{ const { improvement: { goals }, table: { responses } } = dalembert;
            goals.set(responses[0], "maximise");
            goals.set(responses[1], "atMost", 1e-11); }"""  # at least 1e-10
    )
    pendulum.page.click("#improve-start")
    pendulum.until("!dalembert.improvement.running")
    message = pendulum.page.inner_text("#improve-status")
    assert "cannot be satisfied together" in message
    assert "Not all limits are satisfied." in message


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_addresses_without_effect_and_with_one(browser: Any, page_path: Path) -> None:
    with visit(browser, page_path) as found:
        for address, values in HOSTILE.items():
            found.page.goto(page_path.resolve().as_uri() + address)
            found.page.reload()
            found.until("window.dalembert !== undefined")
            settle(found)
            assert present(found) == INITIAL | values, address
            assert found.console == [], address
            assert found.js("dalembert.table.values.every(Number.isFinite)"), address


# Sliders ------------------------------------------------------------------------------------------


def test_sliders_by_keyboard(live: Visit) -> None:
    slider, keyboard = live.page.locator("#parameter-0"), live.page.keyboard
    assert slider.get_attribute("aria-label") == "l1 in m"
    slider.focus()
    for key, value in {
        "ArrowRight": 0.3 + 0.00115,
        "ArrowLeft": 0.3,
        "PageUp": 0.3 + 0.115,
        "End": 1.2,
        "Home": 0.05,
    }.items():
        keyboard.press(key)
        settle(live)
        assert present(live)["l1"] == pytest.approx(value, abs=0.6 * 0.00115)
        shown = slider.get_attribute("aria-valuetext")
        assert float(shown.removesuffix(" m")) == pytest.approx(present(live)["l1"], rel=1e-5)
    assert present(live)["l1"] == 0.05
    live.page.click("#undo")
    settle(live)
    assert present(live)["l1"] == 1.2
    assert not live.js("dalembert.player.playing")


@pytest.mark.thorough
def test_typed_values(live: Visit) -> None:
    entry, status = "[aria-label='Value of l2 in mm']", live.page.locator(".live-status").first
    for text, value in {"1100": 1.1, "1200 mm": 1.2, "1,25e3": 1.25, " 900mm ": 0.9}.items():
        live.page.fill(entry, text)
        live.page.press(entry, "Enter")
        settle(live)
        assert present(live)["l2"] == pytest.approx(value, rel=1e-15)
    for text in ("abc", "12 kg", "1e999", "--3"):
        live.page.fill(entry, text)
        live.page.press(entry, "Enter")
        assert status.inner_text() == f"“{text}” is not a number in mm; l2 stays 900 mm"
        assert live.page.input_value(entry) == "900"
    live.page.fill(entry, "2000")
    live.page.press(entry, "Enter")
    assert status.inner_text() == "l2 is at most 1500 mm"
    settle(live)
    assert present(live)["l2"] == 1.5
    live.page.click("[aria-label='Initial value of l2']")
    settle(live)
    assert present(live) == INITIAL


def test_bounds_are_shown(live: Visit) -> None:
    assert live.page.locator(".bound").all_inner_texts() == ["0.05", "1.2", "800", "1500", "1", "3"]


def chain(links: int = 10) -> Any:
    """Pendulum of many links with long names, four parameters for each."""
    system = da.System("chain", gravity=(0.0, -9.81))
    last = system.ground.point(0, 0)
    for k in range(links):
        length = system.parameter(f"length_{k}", 0.2, "m", bounds=(0.1, 0.5))
        mass = system.parameter(f"mass_of_a_link_with_a_very_long_name_{k}", 1.0, "kg")
        start = system.parameter(f"angle_{k}", 10.0 * k, "deg", bounds=(-180, 180))
        speed = system.parameter(f"speed_{k}", 0.0, "rad/s", bounds=(-1, 1), description="at start")
        bar = planar.Bar(f"b{k}", length=length, mass=mass, angle=start, angular_velocity=speed)
        bar = system.add(bar)
        system.add(planar.Revolute(f"joint_with_a_very_long_name_{k}", last, bar.start))
        last = bar.end
    return da.solve_dynamics(system.build(), 0.2, step=0.002)


@pytest.mark.thorough
def test_many_parameters_on_a_narrow_page(browser: Any, tmp_path: Path) -> None:
    longest = da.maximum("joint_with_a_very_long_name_3.force_norm")
    path = chain().report(tmp_path / "chain.html", live=True, responses=[longest])
    with visit(browser, path, viewport=(390, 844), scheme="dark") as found:
        settle(found)
        assert found.js("document.documentElement.scrollWidth") == 390
        found.page.click("#improve")
        found.page.click("#keep")
        assert found.js("document.documentElement.scrollWidth") == 390
        assert found.page.locator(".parameter").count() == 40
        wide = (
            "[...document.querySelectorAll('.live *')].filter((node) => node.checkVisibility() && "
        )
        wide += "!node.closest('.scroll') && node.getBoundingClientRect().right > 391).length"
        assert found.js(wide) == 0
        found.page.fill("#search-parameters", "speed start")
        assert found.page.locator(".parameter:visible").count() == 10
        found.js("window.dispatchEvent(new Event('beforeprint'))")
        assert found.page.locator(".live-tools:visible, .improve:visible").count() == 0
        found.js("window.dispatchEvent(new Event('afterprint'))")
        assert (found.requests, found.console) == ([], [])


# Dragged paths ------------------------------------------------------------------------------------


@pytest.fixture
def path_page(browser: Any, motion: Any, tmp_path: Path) -> Iterator[Visit]:
    path = motion.report(tmp_path / "path.html", trace=["coupler.end"], responses=RESPONSES[:1])
    with visit(browser, path) as opened:
        settle(opened)
        yield opened
        assert (opened.requests, opened.console) == ([], [])


def hold_path(page: Visit, instant: int = 20) -> tuple[float, float]:
    """Press the pointer on the path of the traced point; its place on the screen."""
    box = page.page.locator("#scene").bounding_box()
    at = page.js(
        f"""(() => {{ const {{ motion, drag }} = dalembert, spot = motion.spots.find(p => p.traced);
            return drag.scene.screen(motion.at(spot.body, spot.point, {{ i: {instant}, f: 0 }}));
        }})()"""
    )
    x, y = box["x"] + at[0], box["y"] + at[1]
    page.page.mouse.move(x, y)
    page.page.mouse.down()
    settle(page)
    return x, y


def rests(page: Visit) -> None:
    """Wait until the drag requests no more runs."""
    number = "dalembert.solver.number"
    for _ in range(25):
        last = page.js(number)
        page.js("new Promise((done) => setTimeout(done, 400))")
        if last == page.js(number):
            return
    pytest.fail("the drag does not come to rest")


@pytest.mark.thorough
def test_a_dragged_path_follows_the_pointer(path_page: Visit) -> None:
    x, y = hold_path(path_page)
    path_page.page.mouse.move(x + 12, y - 1, steps=3)
    rests(path_page)
    miss = path_page.js(
        "(({ drag }) => Math.hypot(...drag.target.map((v, k) => v - drag.place[k]))"
        " * drag.scene.view.scaleAt(drag.place))(dalembert)"
    )
    assert miss < 1  # pixels
    path_page.page.mouse.up()
    path_page.page.click("#undo")
    settle(path_page)
    assert present(path_page) == INITIAL


@pytest.mark.thorough
def test_a_path_dragged_out_of_reach_comes_to_rest_and_returns(path_page: Visit) -> None:
    x, y = hold_path(path_page)
    path_page.page.mouse.move(x + 400, y - 300, steps=4)
    start = path_page.js("dalembert.solver.number")
    rests(path_page)
    assert path_page.js("dalembert.solver.number") - start < 40
    assert path_page.page.locator(".live-status").first.inner_text() == ""
    far = present(path_page)
    path_page.page.mouse.move(x, y, steps=4)
    rests(path_page)
    assert present(path_page) != far
    path_page.page.mouse.up()


# Failures -----------------------------------------------------------------------------------------


def test_a_design_that_cannot_be_assembled_keeps_the_picture(live: Visit) -> None:
    change(live, l2=0.8)
    picture = live.js("[...dalembert.motion.bodies[1].x]")
    change(live, l1=1.2, l2=0.8)  # the ends are √(1 + 1.2²) m apart, coupler and rocker 1.4 m
    text = live.page.locator(".live-status.error").inner_text()
    assert text.startswith("The mechanism cannot be assembled: ")
    assert "is that of the last valid design" in text
    assert any(f"{joint} stays open by " in text for joint in ("O1", "A", "B", "O2"))
    gap = float(text.split("stays open by ")[1].split(" m.")[0])
    assert 0.01 < gap < np.sqrt(1 + 1.2**2) - 1.4 + 0.3
    assert live.js("[...dalembert.motion.bodies[1].x]") == picture
    change(live, l1=0.35)
    assert live.page.locator(".live-status").first.is_hidden()


@pytest.mark.thorough
def test_a_long_run_shows_progress_and_gives_way_to_a_newer_design(live: Visit) -> None:
    live.js("dalembert.solver.worker.postMessage = () => {}")  # a run that never ends
    live.js("dalembert.design.set(0, 0.36)")
    live.until("!document.querySelector('.live-progress').hidden")
    assert "computing, 0." in live.page.inner_text(".live-progress")
    frames = live.js(
        "new Promise((done) => { let n = 0; const next = () => n++ < 10 ? "
        "requestAnimationFrame(next) : done(n); next(); })"
    )
    assert frames > 10
    change(live, l1=0.37)
    assert live.page.locator(".live-progress").is_hidden()
    assert live.js("dalembert.picture.result.parameters[0]") == 0.37


@pytest.mark.few(1)
@pytest.mark.parametrize("absent", ["WebAssembly", "Worker"])
def test_a_browser_that_cannot_run_the_module(browser: Any, page_path: Path, absent: str) -> None:
    with visit(browser, page_path, before=f"delete window.{absent}") as found:
        found.until("document.documentElement.dataset.live === 'unavailable'")
        text = found.page.inner_text("#live")
        assert text.startswith("This browser cannot run the mechanism again: ")
        assert found.page.locator(".parameter").count() == 0
        assert found.ink("#scene") > 10
        assert (found.requests, found.console) == ([], [])


def test_a_page_without_sliders_states_the_reason(browser: Any, tmp_path: Path) -> None:
    system = da.System("ball", gravity=(0, -9.81))
    height = system.parameter("height", 1.0, "m", bounds=(0.5, 2))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, height)))
    floor = planar.contact.HalfPlane(system.ground.center, normal=(0, 1))
    law = planar.contact.Restitution(0.7)
    system.add(planar.Contact("floor", floor, planar.contact.Vertex(ball.center), law=law))
    path = da.solve_dynamics(system.build(), 0.2, step=0.01).report(tmp_path / "ball.html")
    with visit(browser, path) as found:
        assert "The page has no sliders: " in found.page.inner_text("#footer")
        assert found.page.locator("#live").count() == 0
        assert found.console == []
