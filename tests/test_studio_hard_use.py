"""Hard use of the studio in a browser: pastes, reloads, odd names, small screens, the keyboard."""

from __future__ import annotations

from typing import Any

import pytest
from structure_desk import LOOK as STRUCTURE_LOOK
from studio_desk import Desk, opened, reset
from studio_runs import Studio
from test_studio_tools import CRANK


@pytest.mark.thorough
def test_what_was_typed_last_survives_a_reload(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(CRANK)
    visit.js("studio.editor.view.dispatch({ changes: { from: 0, insert: '# last\\n' } })")
    visit.page.reload()
    visit.until("window.studio?.file.document", 60)
    assert visit.text == "# last\n" + CRANK


@pytest.mark.thorough
def test_a_paste_that_is_too_long_is_refused_and_the_next_text_stored(
    desk: tuple[Desk, Studio],
) -> None:
    visit, _ = desk
    visit.show(CRANK)
    visit.js("studio.editor.replace(0, 0, '#'.repeat(5_000_000) + '\\n')")
    visit.until("document.getElementById('notice').textContent.includes('not stored')", 30)
    visit.js("studio.editor.replace(0, 5_000_001, '# short\\n')")
    visit.until("studio.file.changed && !studio.pending && studio.file.document?.bodies.crank", 30)
    visit.settle()
    visit.page.reload()
    visit.until("window.studio?.file.document", 60)
    assert visit.text == "# short\n" + CRANK


@pytest.mark.thorough
def test_any_name_can_be_selected(desk: tuple[Desk, Studio]) -> None:
    """Names that are not valid, or mean something to scripts, are text like others.

    Hidden characters, such as those that change the direction of a text, are refused by the reader.
    """
    visit, _ = desk
    names = ["a(", "__proto__", "constructor", "[", "\\\\", "é", "<b>", "x" * 3000]
    rows = "".join(f'[bodies."{name}"]\nmass = 1\n' for name in names)
    revision = visit.revision
    visit.page.evaluate("text => studio.editor.replace(0, studio.editor.text.length, text)", rows)
    visit.until(f"studio.file.revision > {revision} && !studio.pending", 20)
    visit.until("studio.described.revision === studio.file.revision", 60)
    for name in [*names[:4], "\\", *names[5:]]:
        visit.page.evaluate("name => studio.drawing.select([name])", name)
        visit.page.evaluate("name => studio.editor.reveal('bodies', name)", name)
        assert name in visit.js("Object.keys(studio.file.document.bodies)")
    assert visit.js("({}).mass") is None


@pytest.mark.thorough
def test_a_structure_is_drawn_by_the_keyboard(browser: Any, studio_server: Studio) -> None:
    reset(studio_server, structure=True)
    with opened(browser, studio_server, STRUCTURE_LOOK) as visit:
        visit.js("document.getElementById('canvas').focus()")
        keys = visit.page.keyboard
        keys.press("b")
        keys.press("ArrowRight")
        keys.press("Enter")
        start = visit.js("studio.crosshair.at")
        for _ in range(3):
            keys.press("ArrowUp")
        keys.press("Enter")
        visit.settle(visit.base + 1)
        keys.press("Escape")
        keys.press("Escape")
        nodes = list(visit.document["nodes"].values())
        assert nodes[0] == pytest.approx(start)
        assert nodes[1] == pytest.approx(visit.js("studio.crosshair.at"))
        assert visit.document["elements"]["bar1"]["type"] == "Truss"
        keys.press("Enter")  # grasps the node
        keys.press("ArrowRight")
        keys.press("Enter")
        visit.settle(visit.base + 2)
        moved = list(visit.document["nodes"].values())
        assert moved[1] == pytest.approx(visit.js("studio.crosshair.at")) and moved[1] != nodes[1]
        keys.press("Delete")  # with the bar, after which the other node has no element
        visit.settle(visit.base + 3)
        assert not {"nodes", "elements"} & visit.document.keys()


POINTS = """(() => {
    const { motion, scene: { view, canvas } } = studio.pictures.page;
    const { clientWidth: width, clientHeight: height } = canvas;
    const places = motion.points.map(({ body, point }) => view.screen(motion.at(body, point)));
    return { width, height, places };
})()"""


@pytest.mark.thorough
@pytest.mark.parametrize("size", [(390, 844), (844, 390)])
def test_a_phone_shows_the_whole_drawing(
    browser: Any, studio_server: Studio, size: tuple[int, int]
) -> None:
    reset(studio_server, example="four_bar")
    context = browser.new_context(
        viewport={"width": size[0], "height": size[1]},
        has_touch=True,
        is_mobile=True,
        reduced_motion="reduce",
    )
    visit = Desk(context.new_page())
    visit.page.on("pageerror", lambda error: visit.errors.append(str(error)))
    visit.page.goto(studio_server.address)
    visit.until("window.studio?.pictures.shown >= 1")
    visit.frames(4)
    shown = visit.js(POINTS)
    assert shown["height"] > 100 and shown["width"] > 250
    for x, y in shown["places"]:
        assert 0 < x < shown["width"] and 0 < y < shown["height"]
    xs, ys = zip(*shown["places"], strict=True)
    assert max(max(xs) - min(xs), max(ys) - min(ys)) > 0.25 * shown["height"]
    assert visit.js("document.documentElement.scrollWidth") <= size[0]
    context.close()
