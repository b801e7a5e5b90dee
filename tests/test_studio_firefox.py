"""A four-bar is drawn in Firefox, with the mouse and the keyboard."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from firefox import Firefox, firefox
from studio_desk import LOOK, PIXEL
from studio_runs import running_studio

SETTLED = "studio.described?.revision >= {} && studio.pictures.shown === studio.described.number"
O, A, B, C = (0.1, 0.1), (0.1, 0.3), (0.8, 0.5), (0.9, 0.1)
DRAWN = [("b", O, A), ("b", A, B), ("b", B, C), ("o", O), ("o", C), ("m", O)]
"""Keys of tools and the places that are clicked: three bars, two pins of the ground, a motor."""
CONTROL = "\ue009"
INNER = "studio.pictures.frame.contentDocument"
PLACE = f"""{{{{
    const inner = {INNER}.querySelector("{{0}}").getBoundingClientRect();
    const outer = studio.pictures.frame.getBoundingClientRect();
    return [inner.left + outer.left, inner.top + outer.top, inner.width, inner.height];
}}}}"""
"""Left, top, width and height of a part of the picture on the screen."""


class Page:
    """The studio in a tab.

    Parameters
    ----------
    tab : of Firefox
    """

    def __init__(self, tab: Firefox):
        self.tab = tab

    def act(self, kind: str, *actions: dict[str, Any]) -> None:
        source = {"type": kind, "id": kind, "actions": list(actions)}
        self.tab.command("input.performActions", context=self.tab.context, actions=[source])

    def press(self, *keys: str) -> None:
        """Press keys together."""
        down = [{"type": "keyDown", "value": key} for key in keys]
        up = [{"type": "keyUp", "value": key} for key in reversed(keys)]
        self.act("key", *down, *up)

    def drag(self, *places: tuple[float, float]) -> None:
        """Press at the first place and release at the last one."""
        pixels = [self.tab.js(f"({PIXEL})({list(place)})") for place in places]
        moves = [{"type": "pointerMove", "x": round(x), "y": round(y)} for x, y in pixels]
        down, up = ({"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp"))
        self.act("pointer", moves[0], down, *moves[1:], up)

    def settle(self, revision: int) -> None:
        self.tab.until(f"studio.file.revision >= {revision}")
        self.tab.until(SETTLED.format(revision))

    def js(self, expression: str) -> Any:
        return self.tab.js(f"(() => {expression})() ?? null")


@pytest.fixture
def page(tmp_path: Path) -> Iterator[Page]:
    with running_studio(tmp_path) as studio, firefox() as tab:
        size = {"width": 1400, "height": 850}
        tab.command("browsingContext.setViewport", context=tab.context, viewport=size)
        url = studio.address
        tab.command("browsingContext.navigate", context=tab.context, url=url, wait="complete")
        tab.until("window.studio?.pictures.shown >= 1")
        yield Page(tab)


@pytest.mark.thorough
def test_a_four_bar_is_drawn_dragged_and_undone_in_firefox(page: Page) -> None:
    page.js(LOOK)
    for key, *places in DRAWN:
        revision = page.js("studio.file.revision")
        page.js("document.querySelector('#palette button').focus()")
        page.press(key)
        for place in places:
            page.drag(place)
        page.settle(revision + 1)
    document = page.js("studio.file.document")
    assert {section: len(document[section]) for section in ("bodies", "joints", "drivers")} == {
        "bodies": 3,
        "joints": 4,
        "drivers": 1,
    }
    drawn, revision = page.js("studio.editor.text"), page.js("studio.file.revision")
    page.press("v")
    page.js("studio.drawing.rest()")
    page.drag(B, (0.78, 0.52), (0.75, 0.55))
    page.settle(revision + 1)
    assert page.js("studio.editor.text") != drawn
    page.press(CONTROL, "z")
    page.settle(revision + 2)
    assert page.js("studio.editor.text") == drawn
    number = page.js(
        "{ const at = studio.editor.text.indexOf('length = ') + 10;"
        " studio.editor.select(at, at); return at }"
    )
    assert number > 10
    revision = page.js("studio.file.revision")
    page.js("document.querySelector('#make-parameter').click()")
    page.settle(revision + 1)
    assert len(page.js("studio.file.document.parameters")) == 1
    page.js(f"{INNER}.querySelector('#play').click()")
    player = "studio.pictures.page.player"
    page.tab.until(f"{player}.playing && {player}.time > 0.05")
    slide(page, "#parameter-0")


def slide(page: Page, slider: str) -> None:
    """Drag a slider of the live picture; its value is written into the text."""
    page.tab.until("studio.pictures.live")
    before = page.js("studio.editor.text")
    page.js(f"{INNER}.querySelector('{slider}').scrollIntoView({{ block: 'center' }})")
    left, top, width, height = page.js(PLACE.format(slider))
    points = [
        {"type": "pointerMove", "x": round(left + part * width), "y": round(top + height / 2)}
        for part in (0.5, 0.6, 0.8)
    ]
    down, up = ({"type": kind, "button": 0} for kind in ("pointerDown", "pointerUp"))
    page.act("pointer", points[0], down, *points[1:], up)
    page.tab.until("studio.file.undo.startsWith('set ')")
    assert page.js("studio.editor.text") != before
    revision = page.js("studio.file.revision")
    page.press(CONTROL, "z")
    page.settle(revision + 1)
    assert page.js("studio.editor.text") == before
