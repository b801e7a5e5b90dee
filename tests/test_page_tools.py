"""What one does on a report page: arrows, following, plots, pictures and films, two runs."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from report_payload import four_bar, gallery

import dalembert as da
from dalembert import spatial
from dalembert.errors import FileError
from dalembert.report.overlay import overlay
from dalembert.report.page import InlinePage, render_page


def convoy(distance: float = 40.0) -> dict[str, Any]:
    """Two bars that travel far together."""
    t = np.linspace(0, 4, 81)
    way = distance * t / 4

    def body(name: str, x: float) -> dict[str, Any]:
        bar = {"kind": "bar", "from": [-0.5, 0], "to": [0.5, 0]}
        place = {"x": (x + way).tolist(), "y": (0 * t).tolist(), "angle": (0 * t).tolist()}
        return {"name": name, **place, "shapes": [bar]}

    points = [{"name": f"p{k}", "body": "front", "point": [0.5, 0]} for k in range(2)]
    scene = {"bodies": [body("front", 0), body("rear", -1.2)], "points": points}
    return {"format": 1, "title": "convoy", "time": t.tolist(), "scene": scene, "series": []}


def set_slider(page: Any, name: str, value: float) -> None:
    page.js(f"""(() => {{ const s = document.getElementById({name!r});
        s.value = {value}; s.dispatchEvent(new Event("input")); }})()""")
    page.frames()


def saved(page: Any, click: str) -> bytes:
    """What a control gives to keep."""
    with page.page.expect_download() as waiting:
        page.js(click)
    return waiting.value.path().read_bytes()


@pytest.mark.thorough
def test_each_kind_of_arrow_has_a_length_of_its_own(show: Any) -> None:
    page = show(gallery())
    assert page.page.locator("#arrows input").count() == 2
    before = page.picture("#scene")
    set_slider(page, "arrows-load", 1.0)
    assert page.picture("#scene") != before
    assert page.js("dalembert.scene.sizes.load") == pytest.approx(10)
    assert page.js("dalembert.scene.sizes.twist") == 1


def test_menus_open_and_close_by_key(show: Any) -> None:
    page = show(gallery())
    page.page.focus("#arrows summary")
    page.page.keyboard.press("Enter")
    assert page.js("document.querySelector('#arrows').open")
    page.page.keyboard.press("Escape")
    assert not page.js("document.querySelector('#arrows').open")
    assert page.js("document.activeElement.textContent") == "Arrows"


@pytest.mark.thorough
def test_what_travels_is_followed(show: Any) -> None:
    page = show(convoy())
    assert page.js("dalembert.scene.followed.name") == "front"
    read = "dalembert.scene.screen(dalembert.motion.at(dalembert.scene.followed, [0, 0]))"
    start = page.js(read)
    page.js("dalembert.player.seek(3)")
    page.frames()
    assert page.js(read) == pytest.approx(start, abs=1e-6)
    page.page.select_option("#follow", "")
    assert page.js("dalembert.scene.followed") is None
    assert page.js("dalembert.scene.view.s") < 40


@pytest.mark.thorough
def test_points_that_are_one_share_a_chip(show: Any) -> None:
    page = show(convoy())
    assert page.page.locator(".trace").all_inner_texts() == ["p0 = p1"]


@pytest.mark.thorough
def test_time_is_zoomed_in_all_plots(show: Any) -> None:
    page = show(four_bar())
    assert page.js("dalembert.board.span") == pytest.approx([0, 0.8])
    page.js("dalembert.player.seek(0.4)")
    page.page.click("#zoom-time")
    assert page.js("dalembert.board.span") == pytest.approx([0.2, 0.6])
    page.page.locator(".plot .over").first.focus()
    page.page.keyboard.press("+")
    assert page.js("dalembert.board.span") == pytest.approx([0.3, 0.5])
    page.page.keyboard.press("0")
    assert page.js("dalembert.board.window") is None
    box = page.page.locator(".plot .over").first.bounding_box()
    at = [box["x"] + box["width"] * k for k in (0.4, 0.6)]
    page.page.keyboard.down("Shift")
    page.page.mouse.move(at[0], box["y"] + 60)
    page.page.mouse.down()
    page.page.mouse.move(at[1], box["y"] + 60)
    page.page.mouse.up()
    page.page.keyboard.up("Shift")
    first, last = page.js("dalembert.board.span")
    assert 0.1 < first < last < 0.7


@pytest.mark.thorough
def test_a_plot_runs_over_another_series(show: Any) -> None:
    page = show(four_bar())
    before = page.picture(".plot .base")
    page.page.click(".plot [aria-label='Choose the x-axis']")
    page.page.fill("#search", "rocker.angle rad")
    page.page.locator(".choice:visible").first.click()
    page.page.keyboard.press("Escape")
    assert page.js("dalembert.board.plots[0].against.name") == "rocker.angle"
    assert page.picture(".plot .base") != before
    assert "over rocker.angle" in page.page.get_attribute(".plot .base", "aria-label")


@pytest.mark.thorough
def test_angles_in_degrees_and_back(show: Any) -> None:
    page = show(four_bar())
    series = "dalembert.motion.seriesByName.get('crank.angle')"
    read = f"(({{ unit, values }}) => [unit, values[9]])({series})"
    unit, value = page.js(read)
    page.page.click("#degrees")
    assert page.js(read) == ["°", pytest.approx(np.degrees(value))]
    assert page.js("dalembert.motion.seriesByName.get('crank.x').unit") == "m"
    page.page.click("#degrees")
    assert page.js(read) == [unit, value]


def test_pictures_drawings_and_films_are_saved(show: Any) -> None:
    page = show(four_bar(frames=41), viewport=(1000, 560))
    png = saved(page, "document.getElementById('save-png').click()")
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    svg = saved(page, "document.getElementById('save-svg').click()").decode()
    assert svg.startswith("<svg") and "coupler" in svg and "NaN" not in svg
    page.js("dalembert.player.setSpeed(0.4)")
    film = saved(page, "document.getElementById('save-film').click()")
    at = film.index(b"acTL")
    frames, plays = struct.unpack(">II", film[at + 4 : at + 12])
    assert (frames, plays) == (40, 0) and film.count(b"fcTL") == 40


@pytest.mark.thorough
def test_a_plot_is_saved_with_its_legend(show: Any) -> None:
    page = show(four_bar())
    svg = saved(page, "document.querySelectorAll('.plot .menu-item')[2].click()").decode()
    assert "crank.angle [rad]" in svg and "NaN" not in svg
    assert saved(page, "document.querySelectorAll('.plot .menu-item')[1].click()")[1:4] == b"PNG"


def test_two_runs_on_one_page(show: Any) -> None:
    other = four_bar(frames=121, duration=1.0)
    page = overlay(four_bar(), other, "other.nc")
    at = page["series"][0]["other"]
    expected = np.interp(page["time"], other["time"], other["series"][0]["values"])
    assert np.allclose(at, expected)
    assert len(page["scene"]["ghosts"]) == 3
    view = show(page)
    assert "other.nc" in view.page.inner_text(".other-run")
    before = view.picture("#scene")
    view.page.click("#ghosts")
    view.frames()
    assert view.picture("#scene") != before


def test_unsuitable_comparisons_are_refused() -> None:
    with pytest.raises(FileError, match="mechanism and spatial"):
        overlay(four_bar(), four_bar() | {"kind": "spatial"}, "x")


def test_every_control_has_a_name(show: Any) -> None:
    """And is reached in the order of the page, for nothing has a place of its own in it."""
    page = show(gallery())
    nameless = """[...document.querySelectorAll("button, input, select, summary, [tabindex='0']")]
        .filter((n) => !n.closest("dialog") && !n.textContent.trim() && !n.closest("label")
            && !n.getAttribute("aria-label") && !n.getAttribute("aria-labelledby"))
        .map((n) => n.outerHTML)"""
    assert page.js(nameless) == []
    placed = "[...document.querySelectorAll('[tabindex]')].filter((n) => n.tabIndex > 0).length"
    assert page.js(placed) == 0


def test_sliders_that_do_nothing_are_not_there() -> None:
    page = render_page(four_bar(frames=3))
    assert 'type="range"' not in page.split("<script>")[0]


@pytest.fixture(scope="module")
def flight() -> da.Motion:
    """Two balls that fly far beside each other, one of them pushed."""
    system = da.System("flight")
    for k in range(2):
        arguments = {"density": 800.0, "radius": 0.1, "velocity": (20.0, 0, 0)}
        ball = system.add(spatial.Sphere(f"ball{k}", position=(0.5 * k, 0, 0), **arguments))
    system.add(spatial.Force("push", ball.center, (0, 24.0, 0)))
    return da.solve_dynamics(system.build(), 1.0, step=0.02)


@pytest.mark.thorough
def test_what_travels_in_space_is_followed(show: Any, flight: da.Motion) -> None:
    page = show(flight, viewport=(1000, 560))
    assert page.js("dalembert.scene.followed.name") == "ball0"
    seen = "dalembert.scene.screen(dalembert.motion.at(dalembert.scene.followed, [0, 0, 0]))"
    start = page.js(seen)
    page.js("dalembert.player.seek(0.9)")
    page.frames()
    assert page.js(seen) == pytest.approx(start, abs=0.5)
    assert page.js("dalembert.scene.arrows[0].value") == pytest.approx(24)


@pytest.mark.thorough
def test_pictures_in_space_are_not_blank(show: Any, flight: da.Motion) -> None:
    image = pytest.importorskip("PIL.Image")
    page = show(flight, viewport=(1000, 560))
    png = saved(page, "document.getElementById('save-png').click()")
    assert len(image.open(io.BytesIO(png)).convert("RGB").getcolors(1 << 24)) > 200


@pytest.mark.thorough
def test_a_report_plays_inside_a_notebook(browser: Any, tmp_path: Path) -> None:
    """In a frame without rights beyond scripts and downloads."""
    path = tmp_path / "notebook.html"
    shown = InlinePage(four_bar(frames=400), height=400)._repr_html_()
    path.write_text(f"<html><body>{shown}</body></html>", encoding="utf-8")
    page, messages = browser.new_page(), []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.goto(path.as_uri())
    frame = page.frames[1]
    frame.wait_for_selector("#play")
    frame.wait_for_selector(".plot canvas")
    assert frame.evaluate("dalembert.motion.n") == 400
    assert messages == []
    page.close()
