"""A design task started in the studio: its card, its page, and the result of the same call."""

from __future__ import annotations

from pathlib import Path

import pytest
from studio_desk import WAIT, Desk
from studio_runs import Studio

import dalembert as da
from dalembert.io import load_model_file

FOUR_BAR = """format = 1
name = "four-bar"

[parameters]
a = { value = 0.2, unit = "m", bounds = [0.12, 0.25] }
c = { value = 0.45, unit = "m", bounds = [0.35, 0.6] }

[bodies]
bar1 = { type = "Bar", length = "a", mass = 0.2, angle = 0.7 }
bar2 = { type = "Bar", length = 0.55, mass = 0.55, angle = 0.63 }
bar3 = { type = "Bar", length = "c", mass = 0.45, angle = -1.57 }

[joints]
A = { type = "Revolute", connect = ["bar1.end", "bar2.start"] }
B = { type = "Revolute", connect = ["bar2.end", "bar3.start"] }
C = { type = "Revolute", connect = ["ground", "bar1.start"] }
D = { type = "Revolute", connect = [{ body = "ground", at = [0.6, 0] }, "bar3.end"] }

[drivers]
motor1 = { type = "RotationalDriver", connect = ["ground", "bar1"], law = "0.7 + 2*pi*t" }

[analysis]
type = "Kinematics"
duration = 1.0
step = 0.02

[responses]
top = { type = "Maximum", measure = "bar3.angle", smooth = "1 deg" }
low = { type = "Minimum", measure = "bar3.angle", smooth = "1 deg" }

[optimize]
maximize = "low"
subject_to = [{ response = "top", upper = -0.8 }]
"""
SHOWN = """(() => {
    const { bottom } = document.querySelector('.task').getBoundingClientRect();
    return bottom <= document.querySelector('.sheet.design').getBoundingClientRect().bottom + 1;
})()"""
SEPARATE = """(() => {
    const panel = document.querySelector('.result-panel'), [head, frame] = panel.children;
    const below = frame.getBoundingClientRect().top, top = panel.getBoundingClientRect().top;
    return [...head.children].every((part) => {
        const box = part.getBoundingClientRect();
        return box.top >= top && box.bottom <= below && box.height < 40;
    });
})()"""


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


@pytest.mark.thorough
def test_an_optimum_is_that_of_python(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    visit.show(FOUR_BAR)
    visit.page.click("#tab-design")
    visit.page.click("#start-task")
    visit.until("studio.insight.design.tasks.optimize?.status === 'done'", WAIT)
    assert visit.js(SHOWN)
    [design] = visit.js("studio.insight.design.tasks.optimize.designs")
    visit.page.click("text=Show the result")
    assert visit.js(SEPARATE)
    result = "document.querySelector('.result-panel iframe').contentWindow.dalembert"
    visit.until(f"{result}?.table?.values.length", WAIT)
    value = f"{result}.table.body.rows[0].cells[1].textContent"
    assert visit.js(value) not in ("…", "–")
    assert visit.js(f"{result}.table.show([]), {value}") == "…"  # before the first result
    visit.page.click(".result-panel >> text=Close")
    path = tmp_path / "four.toml"
    path.write_text(FOUR_BAR, encoding="utf-8")
    top, low = (
        reduction("bar3.angle", smooth="1 deg", name=name)
        for reduction, name in ((da.maximum, "top"), (da.minimum, "low"))
    )
    best = da.optimize(
        load_model_file(path).model(),
        maximize=low,
        subject_to=[da.Limit(top, upper=-0.8)],
        analysis=da.Kinematics(duration=1.0, step=0.02),
    )
    assert best.success and best.active == ["top"]
    assert design == pytest.approx(best.x, rel=1e-6)


TOLERANCE = '[tolerance]\nresponse = "top"\nsamples = 20\ntolerances = { a = 1e-3 }\n'
BACKDROP = "getComputedStyle(document.querySelector('{}'), '::backdrop').backgroundColor"
AGE = "document.querySelector('.task small').textContent"


@pytest.mark.thorough
def test_a_result_belongs_to_a_text_not_to_its_revision(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(FOUR_BAR)
    visit.page.click("#tab-design")
    visit.page.click("#start-task")
    visit.until("studio.insight.design.tasks.optimize?.status === 'done'", WAIT)
    assert visit.js(AGE) == "of the present text"
    operation = "{ op: 'parameter', name: 'a', value: 0.21 }"
    revision = visit.revision
    visit.js(f"studio.change({{ label: 'set a', operations: [{operation}] }})")
    visit.settle(revision + 1)
    assert visit.js(AGE) == "of a former text"
    visit.press("Control+z")
    assert visit.js(AGE) == "of the present text"
    visit.press("Control+y")
    assert visit.js(AGE) == "of a former text"
    visit.show(FOUR_BAR)
    assert visit.js(AGE) == "of the present text"


@pytest.mark.thorough
def test_sliders_of_a_result_are_written_into_the_text(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(
        FOUR_BAR + '[tolerance]\nresponse = "top"\nsamples = 20\ntolerances = { a = 1e-3 }\n'
    )
    page = "document.querySelector('.result-panel iframe').contentWindow.dalembert"
    button = visit.page.locator(".result-panel .title-row .primary")
    visit.page.click("#tab-design")
    for section in ("optimize", "tolerance"):
        visit.page.click(f".picks >> text={'Optimise' if section == 'optimize' else 'Tolerance'}")
        visit.page.click("#start-task")
        visit.until(f"studio.insight.design.tasks.{section}?.status === 'done'", WAIT)
        visit.page.click("text=Show the result")
        visit.until(f"{page}?.design && studio.insight.result.design", WAIT)
        assert button.is_visible() == (section == "optimize")
        assert visit.js(BACKDROP.format(".result-panel")) == visit.js(BACKDROP.format(".picker"))
        name = "a"
        k = f"{page}.design.parameters.findIndex((p) => p.name === '{name}')"
        value = 0.135 if section == "optimize" else 0.2005
        visit.js(f"{page}.design.begin(), {page}.design.set({k}, {value})")
        assert button.inner_text() == "Write the values of the sliders into the text"
        others = visit.js(f"studio.insight.design.tasks.{section}.designs[0]") or {}
        before = {key: visit.document["parameters"][key]["value"] for key in ("a", "c")}
        revision = visit.revision
        button.click()
        visit.settle(revision + 1)
        after = {key: visit.document["parameters"][key]["value"] for key in ("a", "c")}
        assert after == pytest.approx(before | others | {name: value}, rel=1e-12)
        assert visit.document["parameters"]["a"]["bounds"] == [0.12, 0.25]
        visit.press("Control+z")
        assert {key: visit.document["parameters"][key]["value"] for key in before} == before


def test_responses_are_listed_in_words(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    before, after = FOUR_BAR.split("[responses]\n", 1)
    more = """late = { type = "At", measure = "bar1.end.x", time = 0.5 }
last = { type = "Final", measure = "bar1.end.y" }
root = { type = "RMS", measure = "bar1.end.y" }
"""
    visit.show(f"{before}[responses]\n{more}{after}")
    visit.page.click("#tab-design")
    listed = [
        text.removesuffix("×").strip()
        for text in visit.page.locator(".design .plain li").all_inner_texts()
    ]
    for line in (
        "late: bar1.end.x at t = 0.5 s",
        "last: final value of bar1.end.y",
        "root: RMS of bar1.end.y",
    ):
        assert line in [" ".join(text.split()) for text in listed]


@pytest.mark.thorough
def test_a_start_beside_a_running_task_is_not_offered(desk: tuple[Desk, Studio]) -> None:
    visit, _ = desk
    visit.show(FOUR_BAR)
    visit.page.click("#tab-design")
    task = visit.js(
        "JSON.stringify({ kind: 'task', number: 1, section: 'sweep', "
        "status: 'running', stopping: false, fraction: 0.5, history: [], text: '', page: '', "
        "designs: [], cards: [], digest: '' })"
    )
    visit.js(f"studio.handlers.task({task})")
    assert visit.page.locator("#start-task").is_disabled()
    assert "Sweep runs; stop it" in visit.page.inner_text(".design .form")
    assert "Sweep: runs" in visit.page.inner_text(".design .states")
    visit.page.click("#tab-synthesis")
    assert "Sweep: runs" in visit.page.inner_text(".synthesis .states")
    visit.js(f"studio.handlers.task({{ ...{task}, status: 'stopped' }})")
    visit.page.click("#tab-design")
    assert visit.page.locator("#start-task").is_enabled()
    assert "stop it" not in visit.page.inner_text(".design .form")
