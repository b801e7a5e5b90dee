"""The report page of a structure in a browser, and its result file."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from test_structure_pictures import BUILDERS, cantilever

import dalembert as da
from dalembert import structures
from dalembert.report.overlay import overlay
from dalembert.report.page import write_page
from dalembert.results.files.store import report_of
from dalembert.results.pictures.animation import write_film
from dalembert.results.structural import payload as payload_module


def solved(name: str):
    return da.solve_statics(BUILDERS[name]().build())


def motion():
    structure = da.Structure("swing")
    a, b = structure.node("a", 0, 0), structure.node("b", 1, 0)
    structure.add(structures.Truss("bar", a, b, area=1e-4, modulus=1e9, density=1e3))
    structure.support(a)
    structure.support(b, uy=0)
    structure.load(b, fx=100.0)
    return da.Dynamics(duration=0.01, step=1e-4, outputs=21).run(structure.build())


@pytest.mark.few(2)
@pytest.mark.parametrize("name", list(BUILDERS))
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_kind_is_drawn(show, name: str, scheme: str) -> None:
    page = show(solved(name), scheme=scheme)
    assert page.ink("#scene") > 10
    assert page.js("document.documentElement.dataset.theme") == scheme
    assert page.js("document.querySelector('#colours').hidden") is False
    assert page.js("document.querySelectorAll('#displacements tbody tr').length") == len(
        solved(name).model.degrees.nodes
    )


def test_field_and_scale_change_the_picture(show) -> None:
    page = show(solved("plate"))
    seen = {page.picture("#scene")}
    page.page.select_option("#field", label="sxx")
    page.frames()
    seen.add(page.picture("#scene"))
    page.js("document.querySelector('#true-scale').click()")
    page.frames()
    seen.add(page.picture("#scene"))
    assert page.js("document.querySelector('#factor').textContent") == "× 1"
    page.js("document.querySelector('#show-mesh').click()")
    page.frames()
    seen.add(page.picture("#scene"))
    assert len(seen) == 4
    page.page.select_option("#field", label="none")
    assert page.js("document.querySelector('#colours').hidden") is True


@pytest.mark.thorough
def test_cases_change_the_tables(show) -> None:
    result = solved("beam")
    page = show(result)
    cell = "[...document.querySelectorAll('#displacements tbody tr')].at(-1).cells[2].textContent"
    column = "document.querySelectorAll('#displacements thead th')[2].textContent"
    for k, name in enumerate(("load", "twist")):
        page.page.select_option("#case", label=name)
        unit = re.search(r"\[(.*)\]", page.js(column))[1]
        shown = float(page.js(cell).replace("−", "-")) * {"m": 1, "mm": 1e-3, "µm": 1e-6}[unit]
        assert shown == pytest.approx(result["b.uy"][k], rel=1e-3)
    total = page.js("document.querySelector('#reactions > .note').textContent")
    assert total == "sum: fx 0 N, fy 0 N"


@pytest.mark.thorough
def test_tables_are_sorted_by_size(show) -> None:
    page = show(solved("plate"))
    page.js("document.querySelectorAll('#displacements .sort')[2].click()")
    shown = page.js(
        "[...document.querySelectorAll('#displacements tbody tr')].map(r => r.cells[2].textContent)"
    )
    sizes = [abs(float(text.replace("−", "-"))) for text in shown]
    assert sizes == sorted(sizes, reverse=True)
    heading = page.js("document.querySelectorAll('#displacements th')[2].getAttribute('aria-sort')")
    assert heading == "descending"


def test_hovering_tells_names_and_values(show) -> None:
    result = solved("beam")
    page = show(result)
    box = page.js(
        "(() => { const b = document.querySelector('#scene').getBoundingClientRect();"
        " return [b.x, b.y]; })()"
    )
    end = page.js("[...dalembert.scene.seen().slice(3, 5)]")
    page.page.mouse.move(box[0] + end[0], box[1] + end[1])
    assert "bnode" in page.js("document.querySelector('#tip').textContent")
    middle = page.js(
        "(() => { const k = dalembert.motion.mesh.lines[0].vertices[6];"
        " return [...dalembert.scene.seen().slice(3 * k, 3 * k + 2)]; })()"
    )
    page.page.mouse.move(box[0] + middle[0], box[1] + middle[1])
    tip = page.js("document.querySelector('#tip').textContent")
    assert "beamelement" in tip
    assert "moment i" in tip


@pytest.mark.thorough
def test_diagrams_along_beams(show) -> None:
    result = solved("beam")
    page = show(result)
    before = page.picture("#scene")
    page.page.select_option("#diagram", label="moment")
    page.frames()
    assert page.picture("#scene") != before
    (ordinates,) = page.js("dalembert.motion.mesh.ordinates()")
    start, end = -result["beam.moment_i"][0], result["beam.moment_j"][0]
    assert ordinates["values"] == pytest.approx([start, end], abs=1e-6)


@pytest.mark.thorough
def test_solids_turn_and_plates_pan(show) -> None:
    for name, turns in (("box", True), ("plate", False)):
        page = show(solved(name))
        way = "[...dalembert.scene.view.direction([1, 0, 0])]"
        before = page.js(way)
        page.page.mouse.move(400, 500)
        page.page.mouse.down()
        page.page.mouse.move(460, 520)
        page.page.mouse.up()
        assert (page.js(way) != before) == turns
        assert page.js("dalembert.scene.view.fitted") is False


@pytest.mark.thorough
def test_motion_plays(show) -> None:
    page = show(motion())
    assert page.js("dalembert.motion.n") == 21
    page.js("document.querySelector('#play').click()")
    page.until("dalembert.motion.state > 2")
    page.js("document.querySelector('#play').click()")
    assert page.js("document.querySelector('#clock').textContent").endswith(" s")
    page.js("dalembert.player.seek(0.00325)")
    lower, upper, between = page.js(
        "(({ mesh, cursor: { i } }) => [mesh.moved[i][3], mesh.moved[i + 1][3],"
        " mesh.placesAt({ i, f: 0.5 }, 1)[3] - mesh.rest[3]])(dalembert.motion)"
    )
    assert between == pytest.approx((lower + upper) / 2, rel=1e-9)


@pytest.mark.thorough
def test_modes_have_scales_of_their_own(show) -> None:
    structure = cantilever()
    structure.elements["beam"].density = da.Expression(7850.0)
    modes = da.Modal(count=2).run(structure.build())
    page = show(modes)
    assert page.js("dalembert.motion.mesh.field.name") == "shape"
    assert page.js("document.querySelector('#reactions')") is None
    page.page.select_option("#case", label=modes.cases[1])
    assert page.js("dalembert.motion.state") == 1
    page.page.locator("#scene").focus()
    page.page.keyboard.press("ArrowLeft")
    assert page.js("dalembert.motion.state") == 0
    assert page.page.input_value("#case") == "0"


def test_hostile_names_stay_text(show) -> None:
    name = "<img src=x onerror=document.title='bad'>"
    structure = da.Structure(name)
    a, b = structure.node("a", 0, 0), structure.node("b", 1, 0)
    structure.add(structures.Truss("bar", a, b, area=1.0, modulus=1.0))
    structure.support(a)
    structure.support(b, uy=0)
    for case in ("</script><b>1</b>", "{{data}}"):
        structure.load(b, case, fx=1.0)
    page = show(da.solve_statics(structure.build()))
    assert page.js("document.querySelectorAll('img, #stage b, td b').length") == 0
    assert page.js("document.title") == name


@pytest.mark.thorough
def test_narrow_page_has_no_overflow(show) -> None:
    page = show(solved("plate"), viewport=(390, 800))
    assert page.js("document.documentElement.scrollWidth") <= 390


# files ------------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", list(BUILDERS))
def test_results_come_back(name: str, tmp_path: Path) -> None:
    result = solved(name)
    path = result.save(tmp_path / "result.nc")
    data = da.load_results(path)
    np.testing.assert_array_equal(data["displacement"], result.displacements)
    np.testing.assert_array_equal(data["external_force"], result.forces)
    again = write_page(report_of(data), tmp_path / "again.html")
    assert again.read_text("utf-8") == result.report(tmp_path / "page.html").read_text("utf-8")
    assert result.to_csv(tmp_path / "r.csv").read_text("utf-8").count("\n") > 2


def test_of_many_cases_some_are_left_out(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(payload_module, "MOST_NUMBERS", 200)
    payload = payload_module.structural_payload(motion())
    names = payload["states"]["names"]
    assert 1 < len(names) < 21
    assert names[-1] == "0.01 s"
    assert "are left out of this page" in json.dumps(payload["diagnosis"])


def test_loads_and_members_tell_their_values(show) -> None:
    page = show(result := da.solve_statics(cantilever().build()))
    before = page.picture("#scene")
    page.js("document.querySelector('#show-values').click()")
    page.frames()
    assert page.picture("#scene") != before
    rows = page.page.locator("#elements tbody tr").count()
    assert rows == sum(block.count for block in result.model.blocks)


@pytest.mark.thorough
def test_shapes_have_no_size(show) -> None:
    """What is told of a mode is in parts of the largest."""
    structure = cantilever()
    structure.elements["beam"].density = da.Expression(7850.0)
    page = show(da.solve_modes(structure.build(), 2))
    most = page.js("Math.max(...dalembert.motion.mesh.fields[0].values[1])")
    assert most == pytest.approx(1)
    assert page.page.locator("#true-scale").count() == 0
    assert "m]" not in page.page.inner_text("#displacements thead").replace("rad/m]", "")


def test_clamps_and_moments_in_space_are_shown() -> None:
    structure = da.Structure("mast")
    foot, top = structure.node("foot", 0, 0, 0), structure.node("top", 0, 0, 3)
    arguments = {"area": 1e-3, "second_moment_y": 1e-6, "second_moment_z": 1e-6}
    arguments |= {"torsion_constant": 1e-6, "modulus": 210e9, "shear_modulus": 80e9}
    structure.add(structures.SpaceFrame("mast", foot, top, **arguments))
    structure.support(foot)
    structure.load(top, fx=100.0, my=-7.0)
    support, force, moment = da.solve_statics(structure.build()).page()["scene"]["symbols"]
    assert support["clamp"] and not support["roller"]
    assert force["force_x"][0] == 100.0
    assert [moment[f"moment_{axis}"][0] for axis in "xyz"] == [0.0, -7.0, 0.0]


def gif_frames(path: Path) -> int:
    return path.read_bytes().count(b"\x21\xf9\x04")


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("make", "frames", "state"),
    [
        (lambda: solved("box"), 8, None),
        (lambda: da.solve_modes(truss(1e-4).build(), count=2), 8, "second"),
        (motion, 8, None),
    ],
)
def test_structures_are_filmed(tmp_path: Path, make, frames: int, state: str | None) -> None:
    page = make().page()
    named = str(page["states"]["names"][1]) if state else None
    short = {"fps": 8, "seconds": 1.0, "width": 160}
    film = write_film(page, tmp_path / "film.gif", state=named, **short)
    assert gif_frames(film) == frames
    with pytest.raises(da.FileError, match="unknown state 'mode 99'"):
        write_film(page, tmp_path / "film.gif", state="mode 99", **short)


@pytest.mark.thorough
def test_two_structures_are_on_one_page(show) -> None:
    """The second one is twice as strong and moves half as far, pale behind the first."""
    runs = [da.solve_statics(truss(area).build()).page() for area in (1e-4, 2e-4)]
    page = show(overlay(*runs, "other.nc"))
    moved = page.js(
        "[dalembert.motion.mesh, dalembert.motion.otherMesh].map((mesh) => mesh.moved[0][4])"
    )
    assert moved[1] == pytest.approx(moved[0] / 2, rel=1e-6)
    chip = page.page.locator("#ghosts")
    assert chip.text_content() == "Other run: other.nc"
    before = page.picture("#scene")
    chip.click()
    page.frames()
    assert page.picture("#scene") != before
    with pytest.raises(da.FileError, match="no common"):
        overlay(runs[0], runs[1] | {"states": {"names": ["snow"]}}, "x")


@pytest.mark.thorough
def test_chosen_units_are_shown(show) -> None:
    page = show(da.solve_statics(truss(1e-4).build()).page(units=["inch", "lbf"]))
    assert "[inch]" in page.js("document.querySelector('#displacements thead').textContent")
    assert "[lbf]" in page.js("document.querySelector('#reactions thead').textContent")


def truss(area: float):
    structure = da.Structure("mast")
    a, b, c = structure.node("a", 0, 0), structure.node("b", 1, 0), structure.node("c", 0, 1)
    for name, ends in (("low", (a, b)), ("high", (c, b))):
        structure.add(structures.Truss(name, *ends, area=area, modulus=1e9, density=1e3))
    structure.support(a)
    structure.support(c)
    structure.load(b, fy=-100.0)
    return structure


@pytest.mark.thorough
def test_states_of_a_load_path_are_not_times(show) -> None:
    """The player shows them one after the other, at multiples of its usual speed."""
    toggle = da.Structure("toggle")
    left, top = toggle.node("left", -1, 0), toggle.node("top", 0, 0.2)
    toggle.add(structures.Truss("bar", left, top, area=1e-4, modulus=1e7))
    toggle.support(left)
    toggle.support(top, ux=0)
    toggle.load(top, fy=-5)
    path = da.ArcLength(stop=lambda point: point["top.uy"] < -0.2).run(toggle.build())
    page = show(path)
    names = page.page.locator("#speed option").all_inner_texts()
    assert "1×" in names and "Real time" not in names
    assert page.page.locator("#speed option:checked").inner_text() == "1×"
    assert "real time" not in page.page.get_attribute("#speed", "title")
    assert page.page.get_attribute("#scrub", "aria-label") == "State"
    moving = show(motion())
    assert "Real time" in moving.page.locator("#speed option").all_inner_texts()


RECORD = """
const write = CanvasRenderingContext2D.prototype.fillText;
window.written = [];
CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...more) {
    const { a, e, f, d } = this.getTransform(), ratio = this.canvas.width / this.canvas.clientWidth;
    const half = this.measureText(text).width / 2;
    const middle = this.textAlign === "left" ? x + half : this.textAlign === "right" ? x - half : x;
    written.push({ text, x: (a * middle + e) / ratio, y: (d * y + f) / ratio, half });
    return write.call(this, text, x, y, ...more);
};
"""
BESIDE_PANELS = """(() => {
    const { marks, panels } = dalembert.scene, { w, h } = marks.paper, wrong = [];
    const touches = (x, y, half) => [...panels].some((p) =>
        x + half > p.offsetLeft + 1 && x - half < p.offsetLeft + p.offsetWidth - 1
        && y > p.offsetTop && y < p.offsetTop + p.offsetHeight);
    for (const half of [8, 30, 60]) for (let x = -50; x <= w + 50; x += 15)
        for (let y = 0; y <= h; y += 15) {
            const free = marks.freeAt(x, y, half);
            const room = () => Array.from({ length: w }, (_, k) => k).some((at) =>
                at >= half && at <= w - half && !touches(at, y, half));
            if (touches(free, y, half) && room()) wrong.push([x, y, half, free]);
            if (!touches(x, y, half) && x >= half && x <= w - half && free !== x
                && ![...panels].some((p) => y > p.offsetTop - 11
                    && y < p.offsetTop + p.offsetHeight + 11)) wrong.push(["moved", x, y, half]);
        }
    const loads = written.filter(({ text }) => / k?N$/.test(text));
    return { wrong, covered: loads.filter(({ x, y, half }) => touches(x, y, half)),
        outside: loads.filter(({ x, half }) => x < half - 1 || x > w - half + 1),
        panels: panels.length, loads: loads.length };
})()"""


@pytest.mark.few(1)
@pytest.mark.parametrize("viewport", [(1440, 900), (390, 844)])
@pytest.mark.parametrize("name", list(BUILDERS))
def test_values_of_loads_are_beside_the_legend_and_the_buttons(show, name: str, viewport) -> None:
    page = show(solved(name), viewport=viewport, before=RECORD)
    page.js("written.length = 0")
    page.js("document.querySelector('#true-scale').click()")
    page.frames()
    seen = page.js(BESIDE_PANELS)
    assert seen["panels"] > 0 and seen["loads"] > 0
    assert (seen["wrong"], seen["covered"], seen["outside"]) == ([], [], [])
    for _ in range(3):
        page.page.keyboard.press("+")
    page.frames()
    zoomed = page.js(BESIDE_PANELS)
    assert (zoomed["covered"], zoomed["outside"]) == ([], [])
