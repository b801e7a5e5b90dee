"""Layout of the studio: nothing moves or covers what is clicked, at usual widths of windows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from studio_desk import UNTITLED, Desk, opened, reset
from studio_runs import Studio

EXAMPLES = Path(__file__).parents[1] / "examples"
DRAWING = """(() => {
    const { left, top, width, height } = studio.pictures.page.scene.canvas.getBoundingClientRect();
    return [left, top, width, height];
})()"""
TABS = """(() => {
    const list = document.getElementById("sheets"), tabs = [...list.children];
    const right = Math.max(...tabs.map((tab) => tab.getBoundingClientRect().right));
    return [new Set(tabs.map((tab) => tab.offsetTop)).size, list.scrollWidth - list.clientWidth,
        right <= list.getBoundingClientRect().right];
})()"""
BARE = """(() => {
    const palette = [...document.querySelectorAll(".palette")].find((node) => !node.hidden
        && node.offsetWidth > 0);
    return studio.pictures.frame.getBoundingClientRect().left
        - palette.getBoundingClientRect().right;
})()"""

CUT = """(() => {
    const { document: inner, innerHeight } = studio.pictures.frame.contentWindow;
    const rows = [...inner.querySelectorAll(".toolbar .chip")];
    return rows.filter((chip) => chip.getBoundingClientRect().bottom > innerHeight).length;
})()"""
"""Number of buttons below the picture that are out of sight."""
HIDDEN = """(() => {
    const buttons = [...document.querySelectorAll("#actions .button")];
    return buttons.filter((node) => node.offsetWidth
        && node.getBoundingClientRect().right > innerWidth).length;
})()"""
SHOWN_TABS = "[...document.querySelectorAll('.tab')].filter((t) => t.offsetWidth).map((t) => t.id)"


@pytest.mark.thorough
def test_nothing_moves_or_covers_the_drawing(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, "0", (1180, 820)) as visit:
        assert visit.page.locator(".guide").is_visible()  # offered while nothing is drawn
        empty = visit.js(DRAWING)
        visit.show((EXAMPLES / "four_bar.toml").read_text("utf-8"))
        assert not visit.page.locator(".guide").is_visible()
        assert visit.js(DRAWING) == empty  # although two rows of traces appear
        assert visit.js(BARE) > 0
        visit.show(UNTITLED.replace("[0.0, -9.81]", "[0.0, 0.0, -9.81]"))
        visit.until("document.documentElement.dataset.space === 'true'", 20)
        assert visit.js(BARE) > 0
        for width in (1440, 1180, 900):
            visit.page.set_viewport_size({"width": width, "height": 820})
            assert visit.js(TABS) == [1, 0, True]
            heights = "[...document.querySelectorAll('.masthead .button')].map((b) => b.offsetTop)"
            assert len(set(visit.js(heights))) == 1
        visit.page.set_viewport_size({"width": 390, "height": 844})
        assert visit.js(HIDDEN) == 0
        visit.page.set_viewport_size({"width": 1900, "height": 1000})
        visit.show((EXAMPLES / "four_bar.toml").read_text("utf-8"))
        assert visit.js(CUT) == 0
        visit.page.click("#tab-model")
        visit.show('format = 1\nkind = "structure"\n')
        assert visit.js(SHOWN_TABS) == ["tab-text", "tab-analysis", "tab-design"]
        assert visit.page.is_visible("#text")


@pytest.mark.thorough
def test_impacts_are_an_analysis_of_the_sheet(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, "0", (1180, 820), Desk) as visit:
        visit.show((EXAMPLES / "dominoes.toml").read_text("utf-8"))
        visit.page.click("#tab-analysis")
        chosen = visit.page.locator(".analysis .picks [aria-selected=true]")
        assert chosen.inner_text() == "Nonsmooth"
        names = visit.js(
            "[...document.querySelectorAll('.analysis .fields input')].map(i => i.name)"
        )
        assert names[:2] == ["duration", "step"]


REFUSAL = "a contact of bar1 and plate1 is not available, only those of point masses; " * 4
NOTICE = """(() => {
    const notice = document.getElementById("notice");
    const { right, bottom } = notice.getBoundingClientRect();
    return [notice.scrollWidth - notice.clientWidth, notice.scrollHeight - notice.clientHeight,
        right <= innerWidth, bottom <= innerHeight];
})()"""
BANNER = "getComputedStyle(document.getElementById('canvas'), '::after').bottom"
GAP = """(() => {
    const measure = document.querySelector("[name=new-measure]"), type = measure.previousSibling;
    return measure.getBoundingClientRect().left - type.getBoundingClientRect().right;
})()"""


@pytest.mark.thorough
def test_messages_are_shown_in_full(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, "0", (1280, 720)) as visit:
        visit.page.evaluate("text => studio.drawing.actions.refuse(text)", REFUSAL)
        assert visit.page.inner_text("#notice") == REFUSAL.strip()
        assert visit.js(NOTICE) == [0, 0, True, True]
        assert visit.page.locator(".guide").is_visible()
        visit.js("(studio.editor.show('format = 1\\n['), studio.sendText('format = 1\\n['))")
        visit.until("studio.pictures.outdated", 20)
        visit.js("studio.guide.start()")
        assert float(visit.js(BANNER).removesuffix("px")) > 0
        guide = visit.page.locator(".guide").bounding_box()
        stage = visit.page.locator("#canvas").bounding_box()
        assert guide["x"] >= stage["x"] + stage["width"]  # the banner is not below the guide


@pytest.mark.thorough
def test_fields_of_a_row_have_one_distance(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, "0", (1600, 900)) as visit:
        visit.page.click("#tab-design")
        assert abs(visit.js(GAP) - 6) < 1
