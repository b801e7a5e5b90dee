"""Frames of pictures, which are loaded before they are needed."""

from __future__ import annotations

from typing import Any

import pytest
from studio_desk import Desk

from dalembert.report.page import PageFrame
from dalembert.report.scripts import CHARTS, PAGES
from dalembert.studio.picture_frames import frame_page

BAR = """format = 1
gravity = [0.0, -9.81]

[bodies]
bar = { type = "Bar", length = 0.5, mass = 1.0 }

[joints]
O = { type = "Revolute", connect = ["ground", "bar.start"] }
"""
PREPARED = "studio.pictures.frames.spare.size > 0"
CHANGE = """(k) => studio.change({ label: "add", operations: [{ op: "add", section: "bodies",
    base: "p", fields: { type: "Particle", mass: 1, position: [0.1 * k, 0.5] } }] })"""


@pytest.mark.parametrize("kind", PAGES)
def test_a_frame_is_named_by_its_page(kind: str) -> None:
    run = "structure frequency" if kind.startswith("live") else ""
    for charts in ((), tuple(sorted(set(CHARTS.values())))):
        frame = PageFrame(kind, run, charts)
        assert PageFrame.named(frame.name) == frame


@pytest.mark.parametrize(
    "name",
    ["", "mechanism", "~", "other~", "mechanism~other", "mechanism~~page.js", "mechanism~~~"],
)
def test_other_names_have_no_frame(name: str) -> None:
    assert PageFrame.named(name) is None and frame_page(name) == ""


@pytest.mark.thorough
def test_a_picture_is_shown_in_the_frame_that_waits(desk: tuple[Desk, Any]) -> None:
    visit, _ = desk
    visit.show(BAR)
    visit.until(PREPARED, 20)
    visit.js("""{ const { scene: { view }, player } = studio.pictures.page;
        Object.assign(view, { x: 0.3, y: 0.2, s: 321, fitted: false });
        player.pause(); player.seek(0.4);
        window.waiting = [...studio.pictures.frames.spare.values()]; }""")
    visit.page.evaluate(CHANGE, 1)
    visit.settle(visit.base + 2)
    assert visit.js("waiting.includes(studio.pictures.frame)")
    shown = "(({ scene: { view: { x, y, s } }, player }) => [x, y, s, player.time])"
    assert visit.js(f"{shown}(studio.pictures.page)") == pytest.approx([0.3, 0.2, 321, 0.4])
    assert visit.js("studio.pictures.frame.contentDocument.title") == "untitled"


@pytest.mark.thorough
def test_a_frame_that_was_not_loaded_is_loaded_again(desk: tuple[Desk, Any]) -> None:
    visit, _ = desk
    visit.show(BAR)
    visit.until(PREPARED, 20)
    visit.until(
        "[...studio.pictures.frames.spare.values()].every(f => f.contentWindow.receiveData)"
    )
    visit.js("""window.broken = [...studio.pictures.frames.spare.values()];
        for (const frame of broken) frame.contentWindow.receiveData = undefined""")
    visit.page.evaluate(CHANGE, 1)
    visit.settle(visit.base + 2)
    assert visit.js("studio.pictures.page.motion.bodies.length") == 2
    assert not visit.js("broken.includes(studio.pictures.frame)")


@pytest.mark.thorough
def test_a_picture_in_place_of_one_without_data_has_its_frame(desk: tuple[Desk, Any]) -> None:
    visit, _ = desk
    visit.show(BAR)
    visit.until("studio.described.page", 20)
    same = """(() => {
        const { pictures, described } = studio, number = pictures.shown + 1;
        pictures.receive({ ...described, number });
        const { next } = pictures;
        pictures.receive({ ...described, number: number + 1 });
        window.wanted = number + 1;
        return next === pictures.next;
    })()"""
    assert visit.js(same)
    visit.until("studio.pictures.shown === wanted", 20)
