"""Help of the studio, its keyboard, contrast, phones, and remedies of errors as buttons."""

from __future__ import annotations

from pathlib import Path

import pytest
from studio_desk import Desk
from studio_runs import Studio

Desks = tuple[Desk, Studio]
CHECKS = (Path(__file__).parent / "studio_access.js").read_text("utf-8")


def check(visit: Desk, name: str) -> list[str]:
    """Parts of the page at which a check fails."""
    return list(visit.page.evaluate(f"() => {CHECKS.partition(chr(10))[2].strip()}.{name}()"))


@pytest.mark.thorough
def test_a_bar_is_drawn_moved_and_removed_by_the_keyboard(desk: Desks) -> None:
    visit, _ = desk
    keys = visit.page.keyboard
    visit.js("document.getElementById('canvas').focus()")
    keys.press("b")
    keys.press("ArrowRight")
    start = visit.js("studio.crosshair.at")
    keys.press("Enter")
    for _ in range(4):
        keys.press("ArrowUp")
    assert visit.js("!document.querySelector('.crosshair').hidden")
    keys.press("Enter")
    visit.settle(visit.base + 1)
    bar = visit.js("studio.file.document.bodies.bar1")
    end = visit.js("studio.crosshair.at")
    assert bar["length"] == pytest.approx(end[1] - start[1])
    keys.press("ArrowDown")
    keys.press("ArrowUp")
    assert "bar1.end" in visit.page.inner_text("#canvas .unseen")
    keys.press("v")
    keys.press("Enter")  # grasps the end
    keys.press("ArrowRight")
    keys.press("Enter")
    visit.settle(visit.base + 2)
    moved = visit.js("studio.file.document.bodies.bar1")
    assert moved["length"] == pytest.approx(
        ((end[1] - start[1]) ** 2 + (visit.js("studio.crosshair.at")[0] - end[0]) ** 2) ** 0.5
    )
    keys.press("Delete")
    visit.settle(visit.base + 3)
    assert "bar1" not in visit.text


@pytest.mark.thorough
def test_the_guide_leads_through_a_four_bar(desk: Desks, tmp_path: Path) -> None:
    visit, _ = desk
    assert "in two minutes" in visit.page.inner_text(".guide")
    visit.page.click(".guide >> text=Show me")
    seen = []

    def step() -> None:
        seen.append(int(visit.page.inner_text(".guide").split(" of ")[0]))

    step()
    actions = [("b", (0, 0), (0, 0.3)), ("b", (0, 0.3), (0.7, 0.5)), ("b", (0.7, 0.5), (0.8, 0))]
    for key, *places in [*actions, ("o", (0, 0)), ("o", (0.8, 0)), ("m", (0, 0))]:
        visit.draw(key, *places)
        step()
    assert seen == [1, 3, 4, 5, 5, 6, 7]
    visit.page.reload()
    visit.until("window.studio?.guide?.step === 6", 20)
    visit.page.click(".guide >> text=Leave")
    assert not visit.page.locator(".guide").is_visible()
    visit.page.reload()
    visit.until("window.studio?.file.document", 20)
    assert not visit.page.locator(".guide").is_visible()
    visit.page.keyboard.press("?")
    assert "Ctrl+S" in visit.page.inner_text("#sheet")
    visit.page.click("text=Guided first build")
    assert visit.page.inner_text(".guide").startswith("7 of 9")


@pytest.mark.thorough
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_contrast_and_names(desk: Desks, theme: str) -> None:
    visit, _ = desk
    visit.js(f"studio.theme.set('{theme}')")
    visit.page.emulate_media(reduced_motion="reduce")
    visit.draw("b", (0, 0), (0.5, 0))
    for opened in ("", "text=Open…", "text=Export…", "text=Help"):
        if opened:
            visit.page.click(opened)
            visit.page.wait_for_selector("#sheet h3")
        assert check(visit, "contrast") == [], opened
        assert check(visit, "nameless") == [], opened
        visit.page.keyboard.press("Escape")
        assert not visit.js("document.getElementById('sheet').open")


@pytest.mark.thorough
def test_the_keyboard_reaches_all_parts_and_is_not_caught(desk: Desks) -> None:
    visit, _ = desk
    visit.js("document.activeElement.blur()")
    seen = []
    for _ in range(60):
        visit.page.keyboard.press("Tab")
        seen.append(
            visit.js(
                "document.activeElement.closest('#actions, #more, #palette, #divider, .cm-editor, "
                "iframe, #canvas, #problems, .guide')?.id || document.activeElement.tagName"
            )
        )
    assert {"actions", "more", "palette", "canvas", "divider", "DIV", "IFRAME"} <= set(seen), seen
    assert (seen.count("actions") > 5 and "BODY" in seen) or seen[-1] != seen[-20]


@pytest.mark.thorough
def test_a_phone_shows_the_picture_and_its_sliders(desk: Desks) -> None:
    visit, _ = desk
    visit.draw("b", (0, 0), (0.5, 0))
    visit.draw("o", (0, 0))
    visit.js(
        "studio.edit('add parameter', [{ op: 'extract', keys: ['bodies', 'bar1', 'length'] }])"
    )
    visit.until("studio.pictures.live && studio.pictures.page?.design", 60)
    visit.page.set_viewport_size({"width": 390, "height": 800})
    visit.frames()
    assert check(visit, "wide") == []
    frame = visit.page.frame_locator("#canvas iframe:not(.loading)")
    slider = frame.locator("input[type=range][aria-label*=bar1_length], .design input[type=range]")
    slider.first.scroll_into_view_if_needed()
    assert slider.first.bounding_box()["width"] > 60  # type: ignore[index]


def test_a_fix_is_a_button(desk: Desks) -> None:
    visit, _ = desk
    visit.draw("b", (0, 0), (0.5, 0))
    text = visit.text
    visit.js(f"studio.editor.replace({text.index('mass')}, {text.index('mass') + 4}, 'mas')")
    visit.until("document.querySelector('#problems .fix')", 20)
    assert visit.page.inner_text("#problems .fix") == "Write mass"
    visit.page.click("#problems .fix")
    visit.until("!document.querySelector('#problems .error')", 20)
    assert visit.text == text


@pytest.mark.thorough
def test_print_shows_the_picture_alone(desk: Desks) -> None:
    visit, _ = desk
    visit.draw("b", (0, 0), (0.5, 0))
    visit.page.emulate_media(media="print")
    parts = ("canvas", "masthead", "writing", "palette")
    shown = [visit.js(f"document.getElementById('{part}').checkVisibility()") for part in parts]
    assert shown == [True, False, False, False]
