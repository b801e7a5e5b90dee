"""The guided first build is carried out as it reads, in the view that a new model has."""

from __future__ import annotations

from typing import Any

import pytest
from studio_desk import Desk, opened, reset
from studio_runs import Studio

O, A, B, C = (-0.3, 0.0), (-0.3, 0.2), (0.3, 0.4), (0.3, 0.0)


@pytest.mark.thorough
def test_the_guide_leads_to_a_four_bar_that_turns(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, look="void 0", size=(1280, 800)) as desk:
        page = desk.page
        page.click(".guide >> text=Show me")

        def step() -> int:
            card, stage = (page.locator(part).bounding_box() for part in (".guide", "#canvas"))
            assert card["x"] >= stage["x"] + stage["width"], "the card hides a part of the picture"
            return int(page.inner_text(".guide p").split(" of ")[0])

        def click(*places: tuple[float, float]) -> None:
            revision = desk.revision
            for place in places:
                desk.click(*place)
            desk.settle(revision + 1)

        assert step() == 1
        page.click('.group[data-group="Bodies"]')
        assert step() == 2
        click(O, A)
        assert step() == 3
        click(A, B)
        assert step() == 4
        click(B, C)
        assert step() == 5
        page.keyboard.press("o")
        click(O)
        click(C)
        assert step() == 6
        page.keyboard.press("m")
        click(O)
        assert step() == 7
        assert desk.errors_shown() == []
        page.keyboard.press("v")
        revision = desk.revision
        desk.drag(B, (0.28, 0.38))
        desk.settle(revision + 1)
        assert step() == 8
        bar = page.locator(".cm-line", has_text="bar1 =")
        bar.locator("span", has_text="0.2").first.click()
        page.click("#make-parameter")
        desk.until("studio.file.document.parameters?.bar1_length")
        assert step() == 9
        page.click("#save")
        page.fill("#ask input", "guided")  # the suffix is added
        page.keyboard.press("Enter")
        desk.until("!studio.file.changed")
        assert page.inner_text(".guide p").startswith("Done.")
        lengths = [bar["length"] for bar in desk.document["bodies"].values()]
        assert lengths[0] == "bar1_length"
        assert all(0.3 < length < 0.7 for length in lengths[1:])
    assert (studio_server.folder / "guided.toml").is_file()


def _scale(desk: Desk) -> float:
    return float(desk.js("studio.pictures.page.scene.view.s"))


def test_the_guide_follows_what_is_drawn(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, look="void 0", size=(1280, 800)) as desk:
        page = desk.page
        page.click(".guide >> text=Show me")
        assert page.inner_text(".guide p").startswith("1 of ")
        page.click('.group[data-group="Bodies"]')
        assert page.inner_text(".guide p").startswith("2 of ")
        revision = desk.revision
        desk.click(*O)
        desk.click(*A)
        desk.settle(revision + 1)
        assert page.inner_text(".guide p").startswith("3 of ")


@pytest.mark.thorough
def test_the_view_stays_while_a_falling_body_is_drawn(browser: Any, studio_server: Studio) -> None:
    reset(studio_server)
    with opened(browser, studio_server, look="void 0") as desk:
        scale = _scale(desk)
        desk.draw("b", (0.0, 0.0), (0.0, 0.3))
        assert _scale(desk) == scale
        desk.page.keyboard.press("b")
        revision = desk.revision
        desk.page.keyboard.type("9,9")
        desk.page.keyboard.press("Enter")
        desk.page.keyboard.type("9,8")
        desk.page.keyboard.press("Enter")
        desk.settle(revision + 1)
        assert _scale(desk) < scale, "what is typed outside the view is brought into it"
