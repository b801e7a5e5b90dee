"""The pages of decisions in a browser: views draw, a choice is shared, keys work, all is quiet."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from browser import browser, show  # noqa: F401

import dalembert as da
from dalembert import planar, structures
from dalembert.report import views
from dalembert.report.page import render_page

HOSTILE = "</script><img src=x onerror=document.title='bad'>"


@pytest.fixture(scope="module")
def slider():
    """A crank and slider; its radius trades stroke for force."""
    system = da.System("crank slider")
    r = system.parameter("r", 0.1, "m", bounds=(0.05, 0.2))
    rod = system.parameter("l", 0.4, "m", bounds=(0.3, 0.6))
    mass = system.parameter("mass", 2.0, "kg")
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
REACH = da.rms("block.vx", name="speed")


@pytest.fixture(scope="module")
def front(slider):
    return da.pareto(slider, [FORCE], maximize=[REACH], analysis=ANALYSIS, points=5)


def chosen(page) -> int:
    return page.js("dalembert.choice.chosen")


@pytest.mark.thorough
def test_a_point_of_the_front_is_a_mechanism(show, front):  # noqa: F811
    page = show(front.live_page(False), still=True)
    assert len(front) >= 4
    dots = "#view-0 circle.design"
    assert page.page.locator(dots).count() == len(front)
    assert "design" in page.js("document.querySelector('.chosen-design h2').textContent").lower()
    before = page.picture("#scene")
    page.page.locator(f"{dots}[data-design='0']").click()
    page.frames(3)
    assert chosen(page) == 0 and page.picture("#scene") != before
    length = "Math.hypot(...dalembert.motion.bodies[0].shapes[0].to.map((v, k) => v - dalembert.motion.bodies[0].shapes[0].from[k]))"  # noqa: E501
    assert page.js(length) == pytest.approx(front.design(0)["r"])
    page.page.locator("#view-0 svg").focus()
    for key, k in (("ArrowRight", 1), ("End", len(front) - 1), ("ArrowLeft", len(front) - 2)):
        page.page.keyboard.press(key)
        assert chosen(page) == k
    assert page.js(length) == pytest.approx(front.design(len(front) - 2)["r"])
    marked = page.js("[...document.querySelectorAll('.chart .chosen')].map(n => n.dataset.design)")
    assert set(marked) == {str(len(front) - 2)} and len(marked) >= 2
    page.page.click("#view-2 tbody tr:first-child")
    assert chosen(page) == 0
    page.page.click("#next-design")
    assert chosen(page) == 1
    page.page.click("#play")
    page.until("dalembert.player.time > 0.02")


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("viewport", [(1440, 900), (390, 844)])
def test_draws(show, front, viewport, scheme):  # noqa: F811
    page = show(front, viewport=viewport, scheme=scheme)
    assert page.js("document.documentElement.scrollWidth <= innerWidth")
    assert page.js("document.documentElement.dataset.theme") == scheme
    assert page.js("[...document.querySelectorAll('svg.chart')].every(s => s.children.length)")


@pytest.mark.thorough
def test_a_range_of_an_axis_keeps_designs(show, slider):  # noqa: F811
    design = da.DesignTable.grid({"r": [0.06, 0.1, 0.14, 0.45], "l": [0.4, 0.5]})
    study = da.sweep(slider, design, analysis=ANALYSIS, responses=[FORCE, REACH])
    assert 0 < len(study.failures) < len(design)
    page = show(study)
    done = int(study.success.sum())
    assert page.page.locator("#view-0 path.design").count() == done
    page.page.locator("#view-0").scroll_into_view_if_needed()
    grips = page.page.locator("#view-0 .grip")
    box = grips.nth(2).bounding_box()  # the radius
    x = box["x"] + box["width"] / 2
    page.page.mouse.move(x, box["y"] + box["height"] - 2)
    page.page.mouse.down()
    page.page.mouse.move(x, box["y"] + 0.7 * box["height"], steps=4)
    page.page.mouse.up()
    page.frames(3)
    low, high = page.js("[...dalembert.choice.ranges.get(2)]")
    inside = (design.values[:, 0] >= low) & (design.values[:, 0] <= high) & study.success
    assert 0 < inside.sum() < done
    assert page.page.locator("#view-0 path.design:not(.outside)").count() == inside.sum()
    page.page.locator("#view-0 svg").focus()
    page.page.keyboard.press("Home")
    assert inside[chosen(page)]
    box = grips.nth(2).bounding_box()
    page.page.mouse.dblclick(x, box["y"] + box["height"] / 2)
    assert page.page.locator("#view-0 path.design:not(.outside)").count() == done
    assert "failed" in page.page.inner_text("#panels").lower()


@pytest.mark.thorough
def test_structures_are_chosen_too(show):  # noqa: F811
    structure = da.Structure("two bars")
    h = structure.parameter("h", 0.4, "m", bounds=(0.3, 2.0))
    area = structure.parameter("area", 4e-4, "m^2", bounds=(1e-4, 2e-3))
    a, b, c = (structure.node(n, *at) for n, at in (("a", (0, 0)), ("b", (2, 0)), ("c", (1, h))))
    for name, end in (("left", a), ("right", b)):
        structure.add(structures.Truss(name, end, c, area=area, modulus=2e11, density=7850))
    structure.support(a)
    structure.support(b)
    structure.load(c, fy=-5e4)
    model = structure.build()
    mass, sag = da.final("mass", name="mass"), da.final("-c.uy", name="sag")
    front = da.pareto(model, [mass, sag], analysis=da.Statics(), points=4)
    page = show(front)
    before = page.picture("#scene"), page.page.inner_text("#displacements")
    page.js("dalembert.choice.choose(0)")
    page.frames(3)
    assert page.picture("#scene") != before[0]
    assert page.page.inner_text("#displacements") != before[1]
    best = da.optimize(
        model,
        mass,
        subject_to=[da.Limit(da.final("left.stress", name="stress"), lower=-1e8)],
        analysis=da.Statics(),
    )
    ghost = show(best)
    before = ghost.picture("#scene")
    ghost.page.click("#ghosts")
    ghost.frames(3)
    assert ghost.picture("#scene") != before


@pytest.mark.thorough
def test_designs_in_space_are_shown_at_once(show):  # noqa: F811
    path = Path(__file__).parents[1] / "examples" / "rssr_four_bar.toml"
    model = da.load_model(path).build()
    rate = da.rms("rocker.angular_velocity.x", name="rate")
    swing = da.at(0.6, "C.angle", name="swing")
    turn = da.Kinematics(1.0, outputs=21)
    front = da.pareto(model, [rate], maximize=[swing], analysis=turn, vary=["a"], points=3)
    page = show(front.live_page(False))
    assert chosen(page) == 1
    before = page.picture("#scene")
    page.page.locator("#view-0 svg").focus()
    page.page.keyboard.press("ArrowLeft")
    page.frames(3)
    assert page.js("location.hash") == "#design=0" and chosen(page) == 0
    assert page.picture("#scene") != before
    page.page.reload()
    page.until("window.dalembert !== undefined")
    assert chosen(page) == 0
    assert f"{front.design(0)['a']:g}" in page.page.inner_text(".chosen-design")


def reliability(slider):
    random = {"mass": da.Normal(2.0, 0.2), "r": da.Lognormal(0.1, 0.005)}
    return da.reliability(slider, da.Limit(FORCE, upper=40.0), random, analysis=ANALYSIS)


def tolerance(slider):
    tolerances = {"r": 1e-3, "l": 1e-3}
    return da.tolerance(slider, FORCE, tolerances, analysis=ANALYSIS, samples=25)


def identification(slider):
    run = ANALYSIS.run(slider, {"r": 0.12, "mass": 2.3})
    noisy = run.values("motor.effort") + np.random.default_rng(0).normal(0, 0.05, run.time.size)
    data, names = {"time": run.time, "torque": noisy}, ["r", "mass"]
    return da.identify(slider, data, {"torque": "motor.effort"}, names, analysis=ANALYSIS)


def linkages(slider):
    return da.synthesize(da.Target.path([[0, 0], [1, 0.2], [2, 1], [0.2, 1.5]]), starts=3)


@pytest.mark.few(1)
@pytest.mark.parametrize("decide", [reliability, tolerance, identification, linkages])
def test_all_other_decisions_draw(show, slider, decide):  # noqa: F811
    """On paper and on a screen, with every view that they have."""
    decision = decide(slider)
    page = show(decision)
    views = decision.live_page()["views"]
    kinds = {view["kind"] for view in views}
    assert len(views) >= len(decision.views())
    assert page.page.locator("section[id^=view-]").count() == len(views), kinds
    assert page.js("[...document.querySelectorAll('svg.chart')].every(s => s.children.length)")
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert page.js("document.documentElement.classList.contains('paper')")
    page.js("window.dispatchEvent(new Event('afterprint'))")


def test_notebooks_show_the_page(slider, front):
    shown = front._repr_html_()
    assert shown.count("<iframe") == 1 and "srcdoc=" in shown
    assert "<script" not in shown  # all of it is the text of the frame
    assert not re.search(r"https?://(?!www\.w3\.org)", shown)
    result = da.reliability(None, "2 - a", {"a": da.Normal(0, 1)})
    assert "2 - a" in result._repr_html_()


def test_names_stay_text(show):  # noqa: F811
    columns = [(HOSTILE, HOSTILE, "aim", [1.0, np.nan]), ("b", "", "parameter", [1.0, 2.0])]
    payload = {
        **{"format": 1, "kind": "decision", "title": HOSTILE, "subtitle": HOSTILE},
        "designs": views.designs(columns, reasons=["", HOSTILE]),
        "views": [
            views.of_designs("parallel", HOSTILE),
            views.of_designs("table", HOSTILE),
            views.bars(HOSTILE, {HOSTILE: np.nan, "b": -1.0}, HOSTILE),
            views.histogram(HOSTILE, HOSTILE, np.zeros(0), {HOSTILE: 1.0}, (1.0, 0.1)),
            views.curves(HOSTILE, "x", "y", [views.line(HOSTILE, [0, np.nan], [1, 2])]),
        ],
    }
    assert "<img" not in render_page(payload)
    page = show(payload)
    assert page.js("document.title") == HOSTILE
    assert page.page.locator("img").count() == 0


NAMES = {
    **{"pressure ripple": "Pa", "peak torque": "N m", "mean friction power": "W"},
    **{"length of rod": "m", "eccentricity": "m", "mass": "kg", "spring stiffness": "N/m"},
    **{"radius": "m", "pad clearance": "m", "phase": "rad"},
}
OVERLAPS = """(() => {
    const texts = [...document.querySelectorAll(".chart g.axis text")];
    const frame = document.querySelector("svg.chart").getBoundingClientRect(), wrong = [];
    const boxes = texts.map((text) => text.getBoundingClientRect());
    boxes.forEach((a, i) => {
        if (a.left < frame.left - 1 || a.right > frame.right + 1 || a.top < frame.top - 1)
            wrong.push(texts[i].textContent);
        boxes.slice(0, i).forEach((b, j) => {
            const beside = a.right <= b.left || b.right <= a.left;
            if (!beside && a.top < b.bottom - 3 && b.top < a.bottom - 3)
                wrong.push([texts[i].textContent, texts[j].textContent]);
        });
    });
    return wrong;
})()"""


@pytest.mark.few(2)
@pytest.mark.parametrize("count", [1, 2, 3, 5, 7, 10])
@pytest.mark.parametrize("viewport", [(1440, 900), (390, 844)])
def test_texts_of_parallel_axes_are_clear_of_each_other(show, count, viewport):  # noqa: F811
    rng = np.random.default_rng(0)
    columns = [
        (
            name,
            unit,
            "parameter" if k > 1 else "aim",
            rng.uniform(1, 2, 12) * (-10.0) ** (k % 5 - 3),
        )
        for k, (name, unit) in enumerate(list(NAMES.items())[:count])
    ]
    view = views.of_designs("parallel", "All columns", place="board")
    page = {
        **{"format": 1, "kind": "decision", "title": "front", "subtitle": ""},
        **{"designs": views.designs(columns), "views": [view]},
    }
    opened = show(page, viewport=viewport)
    assert opened.js(OVERLAPS) == []
    assert opened.page.locator(".chart g.axis .label").count() == count
