"""The studio in a browser: a four-bar is drawn, changed, undone and saved."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import pytest
from studio_desk import UNTITLED, Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

FOUR_BAR = (
    ("b", (0, 0), (0.1, 0.3)),
    ("b", (0.1, 0.3), (0.8, 0.5)),
    ("b", (0.8, 0.5), (0.9, 0)),
    ("o", (0, 0)),
    ("o", (0.9, 0)),
    ("m", (0, 0)),
)
"""Keys of tools and places: three bars, two pins at the ground and a motor."""


@pytest.mark.thorough
def test_a_four_bar_is_drawn_moved_and_saved(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    texts = [visit.text]
    assert texts == [UNTITLED]
    for key, *places in FOUR_BAR:
        visit.draw(key, *places)
        texts.append(visit.text)
    assert visit.page.inner_text("#summary") == "1 degree of freedom, 1 driven, 0 free"
    visit.page.keyboard.press("v")
    visit.page.mouse.move(*visit.place(0.8, 0.5))
    visit.page.mouse.down()
    visit.page.mouse.move(*visit.place(0.85, 0.45), steps=4)
    visit.page.mouse.up()
    visit.settle(visit.base + len(texts))
    texts.append(visit.text)

    visit.page.keyboard.press("Control+s")
    visit.page.keyboard.type(str(tmp_path / "drawn.toml"))
    visit.page.keyboard.press("Enter")
    visit.until("!studio.file.changed", 20)
    assert (tmp_path / "drawn.toml").read_text() == visit.text
    model = load_model_file(tmp_path / "drawn.toml").model()
    motion = da.solve_kinematics(model, 2.0, outputs=5)
    ends = {"bar1": (0, 0, 0.1, 0.3), "bar2": (0.1, 0.3, 0.85, 0.45), "bar3": (0.85, 0.45, 0.9, 0)}
    for name, (x0, y0, x1, y1) in ends.items():
        for end, x, y in (("start", x0, y0), ("end", x1, y1)):
            assert motion[f"{name}.{end}.x"][0].item() == pytest.approx(x, abs=1e-6)
            assert motion[f"{name}.{end}.y"][0].item() == pytest.approx(y, abs=1e-6)
    assert motion["bar1.angle"][-1].item() == pytest.approx(math.atan2(3, 1) + 2 * math.pi)

    for text in reversed(texts[:-1]):
        visit.press("Control+z")
        assert visit.text == text
    for text in texts[1:]:
        visit.press("Control+y")
        assert visit.text == text


@pytest.mark.thorough
def test_plates_springs_forces_and_sliders(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.draw("p", (0.2, 0.2), (0.6, 0.2), (0.6, 0.4), (0.2, 0.4), (0.2, 0.2))
    visit.draw("k", (0.2, 0.4), (0.2, 0.6))
    visit.draw("f", (0.6, 0.4), (0.6, 0.1))
    visit.draw("s", (0.4, 0.3), (0.4, 0.6))
    document = visit.js("studio.file.document")
    plate = document["bodies"]["plate1"]
    assert plate["mass"] == pytest.approx(10 * 0.4 * 0.2)
    assert plate["inertia"] == pytest.approx(10 * 0.4 * 0.2 * (0.4**2 + 0.2**2) / 12)
    assert plate["position"] == pytest.approx([0.4, 0.3])
    assert document["forces"]["force1"]["vector"] == pytest.approx([0, -10])
    assert document["forces"]["spring1"]["free_length"] == pytest.approx(0.2)
    assert document["joints"]["slot1"]["axis"] == pytest.approx([0, 1])
    assert visit.page.inner_text("#summary") == "2 degrees of freedom"
    visit.page.keyboard.press("v")
    visit.click(0.45, 0.25)
    assert visit.js("studio.drawing.selected") == "plate1"
    visit.press("Delete")
    assert visit.js("studio.file.document").get("bodies", {}) == {}
    assert "forces" not in visit.js("studio.file.document")


@pytest.mark.thorough
def test_errors_are_marked_and_the_last_picture_stays(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.draw("b", (0, 0), (0.5, 0))
    shown = visit.shown
    visit.page.click(".cm-content")
    visit.page.keyboard.press("Control+End")
    visit.page.keyboard.type("wrong = 3\n")
    visit.until("document.querySelector('#problems .error')", 20)
    assert "line 7\nbodies.wrong: expected a table" in visit.page.inner_text("#problems")
    assert visit.page.locator(".canvas.outdated").count() == 1 and visit.shown == shown
    visit.page.keyboard.press("Control+z")
    visit.until("!document.querySelector('#problems .error')", 20)
    visit.until("!document.querySelector('.canvas.outdated')", 20)


@pytest.mark.thorough
def test_a_page_shows_changes_of_another(desk: tuple[Desk, Studio], browser: Any) -> None:
    visit, studio = desk
    other = browser.new_page()
    other.goto(studio.address)
    visit.draw("b", (0, 0), (0.5, 0))
    end = time.monotonic() + 20
    while "bar1" not in other.evaluate("studio.editor.text") and time.monotonic() < end:
        time.sleep(0.02)
    assert other.evaluate("studio.editor.text") == visit.text
    other.close()


@pytest.mark.thorough
def test_sliders_write_their_values_into_the_text(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.draw("b", (0, 0), (0.5, 0))
    visit.draw("o", (0, 0))
    text = visit.text
    visit.js("""(() => {
        const { view } = studio.editor, at = studio.editor.text.indexOf("length = 0.5") + 10;
        view.dispatch({ selection: { anchor: at } });
    })()""")
    visit.page.click("text=Parameter")
    visit.until(
        "studio.pictures.page?.design?.parameters.filter(({ drawn }) => !drawn).length === 1", 60
    )
    assert 'length = "bar1_length"' in visit.text
    visit.js("void (window.frameBefore = studio.pictures.frame)")
    visit.js("""(() => {
        const { design } = studio.pictures.page;
        design.set(design.parameters.findIndex(({ name }) => name === "bar1_length"), 0.625);
    })()""")
    visit.until("studio.file.document.parameters.bar1_length.value === 0.625", 20)
    visit.until("studio.described.revision === studio.file.revision", 20)
    assert visit.js("studio.pictures.frame === frameBefore")  # the picture that computes stays
    visit.press("Control+z")
    visit.press("Control+z")
    assert visit.text == text


@pytest.mark.thorough
def test_files_and_examples_are_opened(desk: tuple[Desk, Studio]) -> None:
    visit, studio = desk
    (studio.folder / "beside.toml").write_text(UNTITLED.replace("untitled", "beside"))
    visit.draw("b", (0, 0), (0.5, 0))
    for value, name in (("beside.toml", "beside"), ("example: slider_crank", "slider")):
        visit.page.click("text=Open…")
        visit.page.locator("#sheet input").fill(value)
        visit.page.keyboard.press("Enter")
        visit.until(f"studio.editor.text.includes({name!r})", 20)
    visit.until("studio.described?.summary.includes('driven')", 30)
    visit.page.click("text=Open…")
    visit.page.locator("#sheet input").fill("nothing.toml")
    visit.page.keyboard.press("Enter")
    visit.until("document.getElementById('notice').textContent.includes('no such file')", 20)
    assert "slider" in visit.text


COMPLETED = {
    "[jo": {"joints"},
    '[bodies.new]\ntype = "B': {"Bar", "Body"},
    "[bodies.rod]\nangle = 1\nin": {"inertia"},
    '[joints.A]\ntype = "Revolute"\nconnect = ["ro': {"rod", "rod.start", "rod.end"},
    '[joints]\nA = { type = "Revo': {"Revolute"},
    "[joints]\nA = { co": {"connect"},
    '[analysis]\ntype = "Dynamics"\ninteg': {"integrator"},
    '[analysis]\nintegrator = "Dorm': {"DormandPrince", "DormandPrince853"},
    "gra": {"gravity"},
}
"""End of a text → some of the completions there."""


OFFERED = """(() => {
    const lists = ".cm-tooltip-autocomplete:not(.cm-tooltip-autocomplete-disabled)";
    const chosen = document.querySelector(`${lists} [aria-selected]`);
    const offered = chosen?.textContent.startsWith("inertia");
    window.offered = offered ? (window.offered ?? performance.now()) : null;
    return offered && performance.now() - window.offered > 150;
})()"""
"""The list has been open, by the clock of the page, for twice the 75 ms before which the editor
takes no choice from it."""


@pytest.mark.thorough
def test_completion(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    text = 'format = 1\n[bodies.rod]\ntype = "Bar"\nlength = 0.4\nmass = 1\n'
    visit.page.click(".cm-content")
    visit.page.keyboard.press("Control+a")
    visit.page.keyboard.insert_text(text)
    visit.settle(visit.base + 1)
    visit.until("studio.completion !== null")
    for end, offered in COMPLETED.items():
        whole = end if end == "gra" else f"{text}{end}"
        script = f"studio.completion.options({json.dumps(whole)}, {len(whole)}, true)"
        options = {option["label"].strip('"') for option in visit.js(script)["options"]}
        assert offered <= options, end
        assert not {"Prismatic"} & options or "joints" in end
    visit.page.keyboard.press("Control+End")
    visit.page.keyboard.type("ine")
    visit.until(OFFERED, 30)
    visit.page.keyboard.press("Enter")
    visit.until(f"studio.editor.text === {json.dumps(text + 'inertia')}", 10)


DRAG = """async ([from, to]) => {
    const { pictures, drawing } = studio, { canvas, view } = pictures.page.scene;
    const box = canvas.getBoundingClientRect(), inner = pictures.frame.contentWindow;
    const send = (kind, [x, y], buttons) => {
        const [u, v] = view.screen([x, y]), place = { clientX: u + box.left, clientY: v + box.top };
        const event = { ...place, buttons, altKey: true, bubbles: true };  // without the grid
        canvas.dispatchEvent(new inner.PointerEvent(kind, event));
    };
    send("pointermove", from, 0);
    send("pointerdown", from, 1);
    if (!drawing.drag) throw new Error("nothing is dragged");
    const { solver } = pictures.page, times = [];
    let drawn = () => {};
    solver.onResult.on(() => inner.requestAnimationFrame(() => drawn()));
    for (let k = 1; k <= 40; k++) {
        const at = from.map((start, i) => start + ((to[i] - start) * k) / 40);
        const begin = performance.now();
        await new Promise((done, fail) => {
            drawn = () => done(times.push(performance.now() - begin));
            setTimeout(() => fail(new Error("no picture of a dragged point")), 5000);
            send("pointermove", at, 1);
        });
    }
    const { motion } = pictures.page, point = motion.points.find(({ name }) => name === "bar2.end");
    return { times, place: motion.placed(motion.pose(point.body), point.point) };
}"""
"""Drag a point in steps and wait for the picture of each: times [ms] and the final position."""


@pytest.mark.thorough
def test_a_dragged_point_is_computed_in_the_page(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    for key, *places in FOUR_BAR:
        visit.draw(key, *places)
    visit.until("document.documentElement.dataset.picture?.endsWith('live')", 60)
    visit.until("studio.pictures.page.solver.duration > 0", 20)
    visit.page.keyboard.press("v")
    text, shown = visit.text, visit.shown
    seen = visit.page.evaluate(DRAG, [[0.8, 0.5], [0.7, 0.6]])
    assert seen["place"] == pytest.approx([0.7, 0.6], abs=1e-6)
    assert (visit.text, visit.shown) == (text, shown)  # neither written nor built
    visit.page.keyboard.press("Escape")
    visit.until("!studio.pictures.page.design.changed", 5)
    assert visit.text == text
