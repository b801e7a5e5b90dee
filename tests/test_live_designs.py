"""Live pages of design tasks in a browser: selected designs run, and agree with their tables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Visit, visit

import dalembert as da
from dalembert import planar, structures


def crank_slider() -> da.Model:
    """A crank and slider whose radius trades stroke for force; the mass does not vary."""
    system = da.System("crank slider")
    mass = system.parameter("mass", 2.0, "kg")
    r = system.parameter("r", 100.0, "mm", bounds=(50, 200))
    rod = system.parameter("l", 0.4, "m", bounds=(0.3, 0.6))
    crank = system.add(planar.Bar("crank", length=r, mass=1.0, angle=0.0))
    link = system.add(planar.Bar("rod", length=rod, mass=1.0))
    block = system.add(planar.Body("block", mass=mass, inertia=0.01, position=(0.5, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, link.start))
    system.add(planar.Revolute("B", link.end, block.center))
    system.add(planar.Prismatic("rail", system.ground.point(0, 0), block.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 10 * da.t))
    return system.build()


ANALYSIS = da.InverseDynamics(duration=0.6, step=0.02)
FORCE = da.rms("O.force_norm", name="force")
SPEED = da.maximum("block.vx", name="speed")


@pytest.fixture(scope="module")
def model() -> da.Model:
    return crank_slider()


@pytest.fixture(scope="module")
def front(model: da.Model) -> da.ParetoResult:
    return da.pareto(model, [FORCE], maximize=[SPEED], analysis=ANALYSIS, points=5)


@pytest.fixture(scope="module")
def optimum(model: da.Model) -> da.OptimizationResult:
    limits = [da.Limit(SPEED, lower=1.2)]
    return da.optimize(model, FORCE, subject_to=limits, analysis=ANALYSIS)


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Any:
    """Open the live page of a result; it makes no request and reports no error."""

    @contextmanager
    def manager(decision: Any, address: str = "", **options: Any) -> Iterator[Visit]:
        path = decision.report(tmp_path / "page.html", **options)
        with visit(browser, path) as page:
            if address:
                page.page.goto(path.as_uri() + address)
                page.page.reload()
                page.until("window.dalembert !== undefined")
            settle(page)
            yield page
            assert (page.requests, page.console) == ([], [])

    return manager


def settle(page: Visit) -> None:
    """Wait until the worker has answered the newest request."""
    page.until(
        "document.documentElement.dataset.live && !dalembert.solver.running && "
        "!dalembert.solver.waiting && dalembert.solver.number >= 2"
    )
    page.frames()


def choose(page: Visit, k: int) -> dict[str, float]:
    """Select a design of the table; returns its responses as the page computes them."""
    page.js(f"dalembert.choice.choose({k})")
    settle(page)
    return responses(page)


def responses(page: Visit) -> dict[str, float]:
    labels = page.js("dalembert.table.responses.map(({ label }) => label)")
    return dict(zip(labels, page.js("[...dalembert.table.values]"), strict=True))


def sliders(page: Visit) -> dict[str, float]:
    names = page.js("dalembert.design.parameters.map(({ name }) => name)")
    return dict(zip(names, page.js("dalembert.design.values"), strict=True))


@pytest.mark.thorough
def test_points_of_a_front_run_in_the_page(opened: Any, front: da.ParetoResult) -> None:
    with opened(front) as page:
        for k in range(len(front)):
            values = choose(page, k)
            assert list(values) == front.labels
            assert np.allclose(list(values.values()), front.values[k], rtol=1e-7)
            shown = sliders(page)
            assert {name: shown[name] for name in front.names} == front.design(k)
        assert page.js("document.querySelector('.parameter .value small').textContent") == "mm"


@pytest.mark.thorough
def test_values_of_the_table_in_the_page(opened: Any, front: da.ParetoResult) -> None:
    with opened(front) as page:
        values = choose(page, 1)
        for name, value in values.items():
            listed = f"dalembert.choice.columns.find((c) => c.name === {name!r}).values[1]"
            assert value == pytest.approx(page.js(listed), rel=1e-7)


@pytest.mark.thorough
def test_iterations_of_an_optimum_run_in_the_page(
    opened: Any, optimum: da.OptimizationResult
) -> None:
    with opened(optimum) as page:
        assert page.js("dalembert.choice.chosen") == len(optimum.history) - 1
        assert responses(page)["force"] == pytest.approx(optimum.fun, rel=1e-9)
        assert responses(page)["speed"] == pytest.approx(optimum.limits[0].value, rel=1e-9)
        for k, iterate in enumerate(optimum.history):
            assert choose(page, k)["force"] == pytest.approx(iterate.objective, rel=1e-7)


@pytest.mark.thorough
def test_an_optimum_is_compared_with_its_start(opened: Any, optimum: da.OptimizationResult) -> None:
    with opened(optimum) as page:
        assert page.js("dalembert.motion.ghosts.length") == 3
        was = page.page.locator(".responses .was").first.inner_text()
        assert float(was) == pytest.approx(optimum.history[0].objective, rel=1e-4)
        page.page.click("#reset-design")
        settle(page)
        assert page.js("dalembert.choice.chosen") == 0
        assert page.js("dalembert.motion.ghosts.length") == 0


@pytest.mark.thorough
def test_dots_of_the_convergence_select_iterations(
    opened: Any, optimum: da.OptimizationResult
) -> None:
    with opened(optimum) as page:
        page.page.locator("#convergence circle[data-design='1']").click()
        settle(page)
        assert page.js("dalembert.choice.chosen") == 1
        assert page.page.locator("#convergence circle.chosen").get_attribute("data-design") == "1"
        assert responses(page)["force"] == pytest.approx(optimum.history[1].objective, rel=1e-7)
        page.page.locator("#convergence svg.chart").focus()
        page.page.keyboard.press("ArrowLeft")
        assert page.js("dalembert.choice.chosen") == 0


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, unit="m", bounds=(0.5, 2.0))
    mass = system.parameter("mass", 2.0, unit="kg", bounds=(1.0, 3.0))
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=0.3))
    system.add(planar.Revolute("pivot", system.ground.center, bar.start))
    return system.build()


@pytest.mark.thorough
def test_iterations_of_a_simulated_mechanism_run_in_the_page(opened: Any) -> None:
    peak = da.maximum("pivot.force_norm", smooth=0.05, name="peak")
    slow = da.Limit(da.rms("bar.angular_velocity"), upper=4.0)
    limits = [slow, da.Limit(da.integral("kinetic_energy"), lower=4.0)]
    analysis = da.Dynamics(1.0, step=0.005)
    best = da.optimize(pendulum(), peak, subject_to=limits, analysis=analysis)
    assert len(best.history) > 2
    with opened(best) as page:
        values = responses(page)
        assert values["peak"] == pytest.approx(best.fun, rel=1e-7)
        for limit in best.limits:
            assert values[limit.name] == pytest.approx(limit.value, rel=1e-7)
        for k, iterate in enumerate(best.history):
            assert choose(page, k)["peak"] == pytest.approx(iterate.objective, rel=1e-7)


@pytest.mark.thorough
def test_a_saved_page_shows_its_design(
    browser: Any, opened: Any, front: da.ParetoResult, tmp_path: Path
) -> None:
    with opened(front) as page:
        choose(page, 1)
        with page.page.expect_download() as download:
            page.page.click("#use-design > summary")
            page.page.click("#save-page")
        download.value.save_as(tmp_path / "saved.html")
    with visit(browser, tmp_path / "saved.html") as saved:
        settle(saved)
        assert saved.js("dalembert.choice.chosen") == 1
        assert np.allclose(list(responses(saved).values()), front.values[1], rtol=1e-7)
        assert (saved.requests, saved.console) == ([], [])


@pytest.mark.thorough
def test_sliders_leave_the_designs_and_return(opened: Any, front: da.ParetoResult) -> None:
    with opened(front) as page:
        choose(page, 0)
        page.js("dalembert.design.begin(); dalembert.design.set(1, 0.123)")
        settle(page)
        assert page.js("dalembert.choice.chosen") == -1
        assert page.page.locator(".chart .chosen").count() == 0
        assert page.page.locator("tr.chosen").count() == 0
        assert "none of the designs" in page.page.inner_text(".chosen-design").lower()
        page.page.click("#undo")
        settle(page)
        assert page.js("dalembert.choice.chosen") == 0
        page.page.click("#next-design")
        settle(page)
        assert page.js("dalembert.choice.chosen") == 1


def test_parameters_that_vary_come_first(opened: Any, front: da.ParetoResult) -> None:
    with opened(front) as page:
        labels = page.page.locator(".parameters label").all_inner_texts()
        assert labels == ["r", "l", "mass"]


@pytest.mark.thorough
def test_the_address_names_a_design(opened: Any, front: da.ParetoResult) -> None:
    with opened(front, "#design=0") as page:
        assert page.js("dalembert.choice.chosen") == 0
        assert np.allclose(list(responses(page).values()), front.values[0], rtol=1e-7)
        choose(page, 1)
        assert page.js("location.hash") == "#design=1"
    with opened(front, "#p=r:0.123") as page:
        assert page.js("dalembert.choice.chosen") == -1
        assert sliders(page)["r"] == 0.123
    with opened(front, "#design=99999") as page:
        assert page.js("dalembert.choice.chosen") == front.table_of_designs()["chosen"]


@pytest.mark.thorough
def test_designs_of_a_study_run_in_the_page(opened: Any, model: da.Model) -> None:
    table = da.DesignTable.grid({"r": [0.45, 0.06, 0.1, 0.14], "l": [0.4, 0.5, 0.7]})
    study = da.sweep(model, table, analysis=ANALYSIS, responses=[FORCE, SPEED])
    assert study.reasons[0] and study.failures
    with opened(study) as page:
        for k in np.flatnonzero(study.success):
            values = choose(page, int(k))
            assert np.allclose(list(values.values()), study.values[k], rtol=1e-7)
        choose(page, 0)
        assert page.page.locator(".live-status.error").count() == 1


@pytest.mark.thorough
def test_samples_of_tolerances_run_in_the_page(opened: Any, model: da.Model) -> None:
    tolerances = {"r": "1 mm", "l": "1 mm"}
    result = da.tolerance(model, FORCE, tolerances, analysis=ANALYSIS, samples=20)
    with opened(result) as page:
        assert page.js("dalembert.choice.label(dalembert.choice.chosen)") == "nominal"
        assert responses(page)["force"] == pytest.approx(result.nominal, rel=1e-7)
        for k in (0, 7, 19):
            assert choose(page, k + 1)["force"] == pytest.approx(result.sampled[k], rel=1e-7)
        low, high = page.js("dalembert.design.range(1)")
        samples = result.samples[:, 0]
        assert low == pytest.approx(min(0.099, samples.min()))
        assert high == pytest.approx(max(0.101, samples.max()))


@pytest.mark.thorough
def test_a_tolerance_without_samples_has_sliders(opened: Any, model: da.Model) -> None:
    result = da.tolerance(model, FORCE, {"mass": 0.1}, analysis=ANALYSIS)
    with opened(result) as page:
        assert page.page.locator(".parameters label").all_inner_texts() == ["mass", "r", "l"]
        page.js("dalembert.design.set(0, dalembert.design.range(0)[1])")
        settle(page)
        assert sliders(page)["mass"] == pytest.approx(2.1)
        assert responses(page)["force"] == pytest.approx(result.worst[1], rel=1e-7)


@pytest.mark.thorough
def test_points_and_samples_of_a_reliability_run_in_the_page(opened: Any, model: da.Model) -> None:
    random = {"mass": da.Normal(2.0, 0.2), "r": da.Lognormal(0.1, 0.005)}
    limit = da.Limit(FORCE, upper=30.0)
    result = da.reliability(model, limit, random, analysis=ANALYSIS, samples=30)
    with opened(result) as page:
        assert page.js("dalembert.choice.label(dalembert.choice.chosen)") == "design point"
        assert responses(page)["force"] == pytest.approx(30.0, rel=1e-7)
        median = ANALYSIS.run(model, {"mass": 2.0, "r": random["r"].from_normal(0.0)})
        assert choose(page, 1)["force"] == pytest.approx(da.evaluate(median, FORCE), rel=1e-7)
        values = page.js("dalembert.choice.columns[0].values")
        assert len(values) == 32
        for k in (2, 31):
            assert choose(page, k)["force"] == pytest.approx(values[k], rel=1e-7)


@pytest.mark.thorough
def test_estimates_have_sliders(opened: Any, model: da.Model) -> None:
    run = ANALYSIS.run(model, {"r": 0.12, "mass": 2.3})
    data = {"time": run.time, "torque": run.values("motor.effort")}
    measured = {"torque": "motor.effort"}
    estimate = da.identify(model, data, measured, ["r", "mass"], analysis=ANALYSIS)
    with opened(estimate) as page:
        assert page.page.locator(".parameters label").all_inner_texts() == ["mass", "r", "l"]
        assert sliders(page)["mass"] == pytest.approx(2.3, rel=1e-5)
        page.js("dalembert.design.replace([2.0, 0.15, 0.5], 'test')")
        settle(page)
        again = ANALYSIS.run(model, {"mass": 2.0, "r": 0.15, "l": 0.5})
        shown = page.js("Math.max(...dalembert.motion.seriesByName.get('motor.effort').values)")
        assert shown == pytest.approx(again.values("motor.effort").max(), rel=1e-7)


@pytest.mark.thorough
def test_candidates_of_one_topology_run_in_the_page(opened: Any) -> None:
    chain = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}
    joints = {"A": (0, 0), "B": (0, 1), "C": (3, 2.5), "D": (3, 0)}
    tip = {"coupler": {"P": (1.5, 3)}}
    system = da.linkage_from_chain(chain, joints, "frame", "crank", tip, reach=1.5)
    target = da.Target.path([(1.5, 3.0), (1.0, 3.2), (0.5, 3.0), (0.2, 2.5), (0.6, 2.2)])
    result = da.synthesize_mechanism(target, system.build(), point="coupler.P", starts=8)
    assert len(result.solutions) > 1
    with opened(result) as page:
        angles = "[...dalembert.motion.seriesByName.get('coupler.P.x').values]"
        for k, solution in enumerate(result.solutions):
            page.js(f"dalembert.choice.choose({k})")
            settle(page)
            assert {n: sliders(page)[n] for n in solution.parameters} == solution.parameters
            expected = solution.motion.values("coupler.P.x")
            assert np.allclose(page.js(angles), expected, rtol=1e-7, atol=1e-9)


def test_pages_are_live_by_default_and_on_request(front: da.ParetoResult) -> None:
    still = front.live_page(False)
    assert len(still["designs"]["alternatives"]) == len(front) and "live" not in still
    live = front.live_page()
    assert not live["designs"]["alternatives"] and "code" in live["live"]


def spring(name: str) -> Any:
    structure = da.Structure(name)
    k, load = structure.parameter("k", 5.0, bounds=(1, 10)), structure.parameter("load", 1.0)
    end = structure.node("end", 0)
    structure.add(structures.GroundSpring("spring", end, stiffness_x=k))
    structure.load(end, fx=load)
    return structure.build()


def test_pages_that_are_not_live_state_the_reason() -> None:
    first = da.Case(spring("first"), da.Statics())
    inputs = {"load": first[da.final("end.ux")]}
    second = da.Case(spring("second"), da.Statics(), inputs)
    best = da.optimize(minimize=second[da.final("end.ux")])
    reason = "results of other analyses set load of second"
    assert best.live_page(True)["live"] == {"reason": reason}
    assert "live" not in best.live_page()


def test_an_obstacle_is_stated_by_default() -> None:
    level = {"level": da.Event("bar.angle", terminal=True)}
    analysis = da.Dynamics(1.0, step=0.005, events=level)
    lengths = da.DesignTable.grid({"length": [1.0, 1.2]})
    speed = da.final("bar.angular_velocity")
    study = da.sweep(pendulum(), lengths, analysis=analysis, responses=[speed])
    assert study.success.all()
    assert "event" in study.live_page()["live"]["reason"]
