"""The report page, as text and in a browser."""

from __future__ import annotations

import json
import math
import os
import re
import stat
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from report_payload import crowd, four_bar, gallery

from dalembert.errors import FileError
from dalembert.report.page import render_page, write_page
from dalembert.text.wording import visible

HOSTILE = (
    "</script><b id=bad>x</b><!-- {{data}} \u2028 \" ' & <img src=x onerror=document.title='bad'>"
)


def data_of(text: str) -> Any:
    """Return the payload which a page carries."""
    return json.loads(
        re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.S)[1]
    )


# As text ------------------------------------------------------------------


def test_page_carries_its_data_and_nothing_from_elsewhere() -> None:
    payload = four_bar(frames=21)
    text = render_page(payload)
    assert data_of(text)["scene"]["bodies"][1]["name"] == "coupler"
    assert data_of(text)["time"] == pytest.approx(payload["time"], rel=1e-9)
    assert not re.search(r"(?:src|href)=[\"'](?!data:|#)", text)
    assert not re.search(r"@import|url\(", text)
    assert "{{" not in re.sub(r"\$\{\{", "", text)


def test_numbers_which_are_not_finite_become_null() -> None:
    text = render_page(
        {
            "format": 1,
            "title": "x",
            "time": [0.0, math.nan, -math.inf, None, 7],
            "scene": {},
            "series": [{"values": np.array([1.5, np.nan])}],
        }
    )
    assert data_of(text)["time"] == [0, None, None, None, 7]
    assert data_of(text)["series"][0]["values"] == [1.5, None]


def test_values_other_than_plain_data_are_refused() -> None:
    with pytest.raises(TypeError, match="object"):
        render_page({"title": "x", "time": [], "scene": object()})


def test_hostile_text_stays_text() -> None:
    text = render_page({"format": 1, "title": HOSTILE + "\ud800", "time": [], "scene": {}})
    assert "<b id=bad>" not in text
    assert "\u2028" not in text.split('id="data">')[1].split("</script>")[0]
    assert data_of(text)["title"] == visible(HOSTILE + "\ud800")
    assert text.encode("utf-8")


def test_write_page_replaces_the_file_in_one_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "report.html"
    assert write_page(four_bar(frames=5), target) == target
    assert stat.S_IMODE(target.stat().st_mode) & 0o400
    before = target.read_text(encoding="utf-8")

    def refuse(*_: Any) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(FileError, match="cannot be written"):
        write_page(four_bar(frames=7), target)
    assert target.read_text(encoding="utf-8") == before
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


# In a browser -------------------------------------------------------------


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("viewport", [(1440, 900), (390, 844)])
@pytest.mark.parametrize("make", [four_bar, gallery])
def test_draws(show: Any, make: Any, viewport: tuple[int, int], scheme: str) -> None:
    page = show(make(), viewport=viewport, scheme=scheme)
    assert page.ink("#scene") > 20
    assert page.ink(".plot .base") > 5
    assert page.js("document.documentElement.dataset.theme") == scheme
    assert page.js("document.documentElement.scrollWidth <= innerWidth")


@pytest.mark.thorough
def test_plays_pauses_and_keeps_still_on_request(show: Any) -> None:
    page = show(four_bar())
    assert page.js("dalembert.player.playing") is False
    before = page.picture("#scene")
    page.page.keyboard.press("Space")
    page.until("dalembert.player.time > 0.02")
    page.page.click("#play")
    assert page.js("dalembert.player.playing") is False
    page.frames(3)
    time, after = page.js("dalembert.player.time"), page.picture("#scene")
    assert after != before
    page.frames(10)
    assert page.js("dalembert.player.time") == time
    assert page.picture("#scene") == after


@pytest.mark.thorough
def test_plays_by_itself_where_motion_is_welcome(show: Any) -> None:
    page = show(four_bar(), still=False)
    assert page.js("dalembert.player.playing") is True
    page.until("dalembert.player.time > 0.01")


@pytest.mark.thorough
def test_scrubber_keys_and_seek_set_the_time(show: Any) -> None:
    payload = four_bar(frames=81, duration=8.0)
    page = show(payload)
    box = page.page.locator("#scrub").bounding_box()
    page.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert page.js("dalembert.player.time") == pytest.approx(4.0, abs=0.1)
    page.js("dalembert.player.seek(2)")
    for key, time in (
        ("ArrowRight", 2.1),
        ("ArrowLeft", 2.0),
        ("ArrowLeft", 1.9),
        ("Shift+ArrowRight", 2.1),
        ("End", 8.0),
        ("Home", 0.0),
    ):
        page.page.keyboard.press(key)
        assert page.js("dalembert.player.time") == pytest.approx(time)
    page.js("dalembert.player.seek(2.05)")
    page.page.keyboard.press("ArrowLeft")
    assert page.js("dalembert.player.time") == pytest.approx(2.0)
    page.js("dalembert.player.seek(99)")
    assert page.js("dalembert.player.time") == 8.0
    assert "8.00" in page.page.inner_text("#clock")
    page.page.click(".event >> nth=0")
    assert page.js("dalembert.player.time") == pytest.approx(0.21 * 8)


@pytest.mark.thorough
def test_pose_lies_between_frames(show: Any) -> None:
    page = show(four_bar(frames=5, duration=4.0))
    pose = "(() => { const p = dalembert.motion.pose(dalembert.motion.bodies[0]); return p.a; })()"
    angles = page.js("Array.from(dalembert.motion.bodies[0].a)")
    page.js("dalembert.player.seek(1.25)")
    assert page.js(pose) == pytest.approx(0.75 * angles[1] + 0.25 * angles[2])


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("duration", "speed"), [(6.0, 1), (0.008, 0.001), (86400.0, 10000), (2.0, 0.2)]
)
def test_a_loop_takes_a_few_seconds(show: Any, duration: float, speed: float) -> None:
    page = show(four_bar(frames=41, duration=duration))
    chosen = page.js("dalembert.player.speed")
    assert chosen == pytest.approx(speed, rel=0.001)
    assert 4 <= duration / chosen <= 12
    assert page.page.input_value("#speed") == str(page.js("String(dalembert.player.speed)"))
    page.page.select_option("#speed", index=0)
    assert page.js("dalembert.player.speed") == pytest.approx(min(0.1 * speed, 1))


@pytest.mark.thorough
def test_without_loop_it_stops_at_the_end(show: Any) -> None:
    page = show(four_bar())
    page.page.click("#loop")
    page.js("dalembert.player.seek(0.79)")
    page.js("dalembert.player.play()")
    page.until("!dalembert.player.playing")
    assert page.js("dalembert.player.time") == pytest.approx(0.8)


@pytest.mark.few(1)
@pytest.mark.parametrize("control", ["#reactions", "#labels", "#grid", ".trace"])
def test_toggles_change_the_picture_and_back(show: Any, control: str) -> None:
    page = show(four_bar())
    page.js("dalembert.player.seek(0.3)")
    page.frames()
    before, was = page.picture("#scene"), page.page.get_attribute(control, "aria-pressed")
    page.page.click(control)
    page.frames(3)
    assert page.page.get_attribute(control, "aria-pressed") != was
    assert page.picture("#scene") != before
    page.page.click(control)
    page.frames(3)
    assert page.picture("#scene") == before


def test_zoom_pan_and_fit(show: Any) -> None:
    page = show(four_bar())
    view = "(({ x, y, s }) => ({ x, y, s }))(dalembert.scene.view)"
    home = page.js(view)
    page.page.mouse.move(300, 400)
    page.page.mouse.wheel(0, -300)
    page.frames(3)
    assert page.js(view)["s"] > home["s"]
    x = page.js(view)["x"]
    page.page.mouse.down()
    page.page.mouse.move(360, 400)
    page.page.mouse.up()
    assert page.js(view)["x"] < x
    page.page.click("#fit")
    assert page.js(view) == home


def test_tooltip_names_what_is_under_the_pointer(show: Any) -> None:
    page = show(four_bar())
    box = page.page.locator("#scene").bounding_box()
    for joint, name, text in ((0, "A", "force"), (3, "D", "revolute")):
        x, y = page.js(f"dalembert.scene.screen(dalembert.motion.joints[{joint}].point)")
        page.page.mouse.move(box["x"] + x, box["y"] + y)
        page.frames(3)
        tip = page.page.inner_text("#tip")
        assert tip.startswith(name) and text in tip
    page.page.mouse.move(box["x"] + 5, box["y"] + 200)
    page.frames(3)
    assert not page.page.is_visible("#tip")


def test_plots_scrub_hover_and_change(show: Any, tmp_path: Path) -> None:
    view = show(four_bar())
    page = view.page
    area = page.locator(".plot .over").first.bounding_box()
    middle = area["x"] + area["width"] / 2, area["y"] + area["height"] / 2
    page.mouse.move(*middle)
    view.frames(3)
    assert view.js("dalembert.board.hoverTime") == pytest.approx(0.4, abs=0.05)
    assert view.js("dalembert.player.time") == 0
    page.mouse.down()
    assert view.js("dalembert.player.time") == pytest.approx(0.4, abs=0.05)
    page.mouse.move(middle[0] + 60, middle[1])
    page.mouse.up()
    assert view.js("dalembert.player.time") > 0.4

    assert page.locator(".plot").count() == 3
    page.click("#add-plot")
    page.fill("#search", "rocker rad/s²")
    assert page.locator(".choice:visible").count() == 1
    page.locator(".choice:visible input").check()
    page.keyboard.press("Escape")
    assert page.locator(".plot").count() == 4
    assert (
        page.locator(".plot >> nth=3")
        .locator(".key")
        .inner_text()
        .startswith("rocker.angle_acceleration")
    )
    view.frames(3)
    with page.expect_download() as saved:
        page.locator(".plot >> nth=3").locator("[aria-label='Save this plot']").click()
        page.locator(".plot >> nth=3").get_by_text("Numbers (CSV)").click()
    saved.value.save_as(tmp_path / "series.csv")
    rows = (tmp_path / "series.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "time [s],rocker.angle_acceleration [rad/s²]"
    assert len(rows) == 162
    page.locator(".plot >> nth=3").get_by_label("Remove this plot").click()
    assert page.locator(".plot").count() == 3


@pytest.mark.thorough
def test_picker_offers_two_units_at_most(show: Any) -> None:
    page = show(four_bar())
    page.page.get_by_label("Choose series").nth(1).click()
    assert page.page.locator(".choice:has-text('energy.total') input").is_disabled()
    assert page.page.locator(".choice:has-text('B.force_x') input").is_enabled()


@pytest.mark.thorough
def test_theme_button(show: Any) -> None:
    page = show(four_bar())
    before = page.picture("#scene")
    page.page.click("#theme")
    page.frames(3)
    assert page.js("document.documentElement.dataset.theme") == "dark"
    assert page.picture("#scene") != before


@pytest.mark.few(1)
@pytest.mark.parametrize("frames", [0, 1, 2])
@pytest.mark.parametrize("scene", [{}, {"bodies": []}, {"bodies": [{"name": "only"}]}])
def test_nearly_empty_payloads(show: Any, frames: int, scene: dict[str, Any]) -> None:
    time = [0.5 * k for k in range(frames)]
    pose = dict.fromkeys(("x", "y", "angle"), [0.0] * frames)
    bodies = [
        {**body, **pose, "shapes": [{"kind": "bar", "from": [0, 0], "to": [1, 0]}]}
        for body in scene.get("bodies", [])
    ]
    page = show(
        {
            "format": 1,
            "title": "nearly nothing",
            "time": time,
            "scene": {"bodies": bodies} if bodies else scene,
        }
    )
    assert page.page.is_visible("#player") == (frames == 2)
    assert page.page.is_hidden("#board")
    assert page.ink("#scene") > 1


def test_static_result_lists_its_values(show: Any) -> None:
    payload = four_bar(frames=2)
    payload["time"] = payload["time"][:1]
    page = show(payload)
    assert page.page.is_hidden("#player")
    assert "rocker.angle" in page.page.inner_text("#values")
    assert page.ink("#scene") > 20


@pytest.mark.thorough
def test_gaps_are_left_out(show: Any) -> None:
    payload = four_bar(frames=41)
    for column in ("x", "y", "angle"):
        payload["scene"]["bodies"][1][column][10:30] = [None] * 20
    payload["series"][0]["values"] = [None] * 41
    payload["scene"]["joints"][0]["force_x"][5:20] = [None] * 15
    page = show(payload)
    page.page.click("#reactions")
    page.js("dalembert.player.seek(0.4)")
    page.frames(3)
    assert page.js("dalembert.motion.pose(dalembert.motion.bodies[1])") is None
    assert page.ink("#scene") > 20


def test_hostile_names_do_no_harm(show: Any) -> None:
    payload = four_bar(frames=21)
    payload["title"] = payload["subtitle"] = HOSTILE
    for body in payload["scene"]["bodies"]:
        body["name"] = HOSTILE + body["name"]
    for point in payload["scene"]["points"]:
        point.update(name=HOSTILE, body=HOSTILE + point["body"])
    for joint in payload["scene"]["joints"]:
        joint.update(
            name=HOSTILE, body=HOSTILE + joint["body"] if joint["body"] != "ground" else "ground"
        )
    for series in payload["series"]:
        series["group"] = HOSTILE
    payload["series"][0]["name"] = HOSTILE
    payload["default_plots"] = [[HOSTILE]]
    payload["events"] = [{"name": HOSTILE, "time": 0.1}]
    payload["diagnosis"] = {"summary": HOSTILE, "messages": [{"level": HOSTILE, "text": HOSTILE}]}
    payload["parameters"] = [{"name": HOSTILE, "value": 1, "unit": HOSTILE}]
    page = show(payload)
    page.page.mouse.move(300, 400)
    page.page.click("#add-plot")
    page.frames(3)
    assert page.js("document.querySelector('#bad, img')") is None
    assert page.js("document.title") == HOSTILE.replace("\u2028", " ") or page.js(
        "document.title"
    ).startswith("</script>")


# Draws pictures, and counts the pieces of paths that each takes.
PIECES = """(times => {
    const paths = CanvasRenderingContext2D.prototype, counted = ["lineTo", "arc", "stroke", "fill"];
    const own = Object.fromEntries(counted.map(name => [name, paths[name]]));
    let pieces = 0;
    for (const name of counted) {
        paths[name] = function (...given) { pieces++; return own[name].apply(this, given); };
    }
    const found = times.map(time => {
        pieces = 0;
        dalembert.motion.setTime(time);
        dalembert.scene.draw();
        return pieces;
    });
    Object.assign(paths, own);
    return found;
})"""


@pytest.mark.thorough
def test_many_bodies_and_frames_stay_responsive(show: Any) -> None:
    """More frames take no more to draw; whole paths are drawn once, not in each picture."""
    pieces = {}
    for frames in (3000, 12000):
        page = show(crowd(bodies=20, frames=frames))
        page.page.click("#reactions")
        page.js("document.querySelectorAll('.trace').forEach(chip => chip.click())")
        counted = f"(dalembert.scene.zoom(0.8), {PIECES}({[9, 9, *range(10)]}))"
        pieces[frames] = page.js(counted)
    for first, again, *others in pieces.values():
        assert first > 2 * again
        assert max(others) < 1.5 * again
    assert pieces[12000][1] < 1.5 * pieces[3000][1]
    page.js("dalembert.player.play()")
    page.until("dalembert.player.time > 0")


@pytest.mark.thorough
def test_prints(show: Any, tmp_path: Path) -> None:
    page = show(four_bar(), scheme="dark")
    sheet = page.page.pdf(format="A4")
    assert sheet.startswith(b"%PDF") and len(sheet) > 20_000
    page.frames(3)
    assert page.js("document.documentElement.dataset.theme") == "dark"
