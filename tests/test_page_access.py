"""Keyboard and screen reader: every control has a name, is reached and seen; time at rest is told.

What a frame costs is counted in calls, which do not depend on the machine.
"""

from __future__ import annotations

from typing import Any

import pytest
from browser import Visit
from report_payload import four_bar
from test_structure_pictures import BUILDERS

import dalembert as da
from dalembert import planar, spatial

CONTROLS = "button slider combobox link textbox checkbox radio spinbutton searchbox listbox".split()
NAMED = {*CONTROLS, "image", "Canvas", "region", "group", "dialog"}
REACHABLE = "button, select, input, a[href], summary, [tabindex='0']"


def structure() -> Any:
    return da.solve_statics(BUILDERS["plate"]().build())


def top() -> Any:
    system = da.System("top", gravity=(0, 0, -9.81))
    body = system.add(spatial.Cylinder("rotor", radius=0.1, length=0.2, density=7800.0))
    system.add(spatial.Revolute("O", system.ground.frame((0, 0, 0)), body.frame((0, 0, 0))))
    return da.solve_dynamics(system.build(), 0.1, step=0.01)


def decision() -> Any:
    system = da.System("arm")
    length = system.parameter("l", 0.2, "m", bounds=(0.1, 0.4))
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    model = system.build()
    tip = da.maximum(model["bar.end.y"])
    return da.tolerance(model, tip, {"l": "1 mm"}, analysis=da.Dynamics(0.2, step=0.02))


def live() -> Any:
    system = da.System("arm", gravity=(0, -9.81))
    length = system.parameter("l", 200, "mm", bounds=(100, 400))
    mass = system.parameter("m", 1.0, "kg", bounds=(0.5, 2))
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return da.solve_dynamics(system.build(), 0.2, step=0.01)


PAGES = {"plane": four_bar, "space": top, "structure": structure, "decision": decision}
PAGES["live"] = live


def controls(page: Visit) -> list[tuple[str, str]]:
    """(role, name) of what a screen reader is told of."""
    session = page.page.context.new_cdp_session(page.page)
    nodes = session.send("Accessibility.getFullAXTree")["nodes"]
    return [
        (node["role"]["value"], node.get("name", {}).get("value", "").strip())
        for node in nodes
        if not node["ignored"] and node["role"]["value"] in NAMED
    ]


def open_menus(page: Visit) -> None:
    page.js("document.querySelectorAll('details').forEach((menu) => { menu.open = true; })")
    page.frames()


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", PAGES)
def test_everything_has_a_name_and_is_reached_where_it_is_seen(show, kind: str) -> None:
    page = show(PAGES[kind](), viewport=(1000, 700))
    if kind == "live":
        page.until("Number(document.documentElement.dataset.live) >= 2")
        for button in ("#keep", "#improve"):
            page.page.click(button)
    open_menus(page)
    names = controls(page)
    assert [role for role, name in names if not name] == []
    assert sum(role in CONTROLS for role, _ in names) >= 3
    page.js(
        f"""(() => {{
            window.waiting = new Set([...document.querySelectorAll({REACHABLE!r})].filter((one) =>
                !one.disabled && one.tabIndex >= 0 && one.checkVisibility() &&
                (one.type !== "radio" || one.checked)));  // arrow keys lead to the others
            window.unseen = [];
            document.addEventListener("focusin", ({{ target }}) => {{
                window.waiting.delete(target);
                if (getComputedStyle(target).outlineStyle === "none") unseen.push(target.outerHTML);
            }});
        }})()"""
    )
    for _ in range(page.js("waiting.size") + 3):
        page.page.keyboard.press("Tab")
    assert page.js("[...waiting].map((one) => one.outerHTML.slice(0, 99))") == []
    assert page.js("unseen") == []


@pytest.mark.thorough
def test_time_is_told_where_it_comes_to_rest(show) -> None:
    page = show(four_bar())
    page.js("dalembert.player.play()")
    page.until("dalembert.player.time > 0.05")
    assert page.js("document.querySelector('#spoken').textContent") in ("", "0.0000 s")
    page.js("dalembert.player.pause()")
    page.until(
        "document.querySelector('#spoken').textContent === "
        "document.querySelector('#clock').textContent"
    )
    page.page.keyboard.press("ArrowRight")
    page.until("document.querySelector('#spoken').textContent !== '0.0000 s'")
    assert page.js("document.querySelector('#spoken').getAttribute('role')") == "status"


COUNT = """(() => {
    const prototype = CanvasRenderingContext2D.prototype;
    window.drawn = 0;
    for (const name of ["lineTo", "moveTo", "stroke", "fill", "fillText", "arc", "rect"]) {
        const own = prototype[name];
        prototype[name] = function (...given) { drawn += 1; return own.apply(this, given); };
    }
    const { scene, motion } = dalembert, own = scene.screen;
    scene.screen = (place) => { drawn += 1; return own.call(scene, place); };
    for (const point of motion.points) point.traced = true;
})()"""


def cost(show, frames: int) -> int:
    """Calls of the canvas, and places, in one frame in the midst of a motion, all points traced."""
    page = show(four_bar(frames=frames))
    page.js(COUNT)
    middle = "(dalembert.motion.start + 0.6 * dalembert.motion.span"
    page.js(f"dalembert.player.seek({middle}))")
    page.frames(3)
    page.js("window.drawn = 0")
    page.js(f"dalembert.player.seek({middle} + 1e-3 * dalembert.motion.span))")
    page.frames(3)
    return page.js("drawn")


@pytest.mark.thorough
def test_a_frame_costs_what_is_seen_of_it(show) -> None:
    few, many = cost(show, 1000), cost(show, 20_000)
    assert many < 1.5 * few < 4000
