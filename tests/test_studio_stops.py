"""Tasks and exports that are stopped: presses while they proceed, and results so far."""

from __future__ import annotations

import json
import re
import time
from pathlib import Path
from typing import Any

import pytest
from studio_desk import Desk
from studio_runs import Studio
from test_studio_tasks import ROD, SLOW, wait

from dalembert.studio.tasks import Tasks

EXAMPLES = Path(__file__).parents[1] / "examples"
SENT = """(() => {
    window.sent = [];
    studio.link.send = (request) => { sent.push(request.kind); return true; };
})()"""


@pytest.fixture
def desk(shared_desk: tuple[Desk, Studio]) -> tuple[Desk, Studio]:
    return shared_desk


def running(**fields: Any) -> str:
    task = {
        "kind": "task", "number": 1, "section": "sweep", "digest": "", "status": "running",
        "stopping": False, "fraction": 0.1, "history": [], "text": "", "page": "",
        "designs": [], "cards": [],
    }  # fmt: skip
    return f"studio.handlers.task({json.dumps(task | fields)})"


@pytest.mark.thorough
def test_a_press_of_stop_lasts_while_messages_come(desk: tuple[Desk, Studio]) -> None:
    """A press of a mouse takes 100 ms, and the focus of the keyboard longer."""
    visit, _ = desk
    visit.js(SENT)
    mouse = visit.page.mouse
    export = "studio.exports.receive({ kind: 'export', number: 1, state: 'progress', share: %s })"
    try:
        visit.page.click("#tab-design")
        visit.js(running())
        stop = visit.page.locator(".design .task button", has_text="Stop")
        stop.hover()
        mouse.down()
        visit.js(running(fraction=0.2))
        mouse.up()
        assert visit.js("sent.splice(0)") == ["stop task"]
        stop.focus()
        visit.js(running(fraction=0.3))
        visit.page.keyboard.press("Enter")
        assert visit.js("sent.splice(0)") == ["stop task"]
        visit.js(running(stopping=True))
        card = visit.page.locator(".design .task")
        assert "completes its result" in card.inner_text() and "End at once" in card.inner_text()
        visit.js(running(status="stopped"))
        assert "Stop" not in card.locator("button:visible").all_inner_texts()
        visit.page.locator("button", has_text="Export").first.click()
        visit.page.locator("[data-to=csv]").click()
        visit.js(export % 0.1)
        visit.page.locator(".export-state button", has_text="Stop").hover()
        mouse.down()
        visit.js(export % 0.2)
        mouse.up()
        assert visit.js("sent.splice(0)") == ["export", "stop export"]
        assert visit.js("document.querySelector('.export-state progress').value") == 0.2
    finally:
        visit.js("studio.exports.number = 0; delete studio.link.send")
        visit.page.keyboard.press("Escape")
        visit.page.click("#tab-text")


@pytest.mark.thorough
def test_a_double_click_on_stop_keeps_the_result(monkeypatch: pytest.MonkeyPatch) -> None:
    tasks = Tasks()
    state = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml")
    wait(state, "progress")
    tasks.stop()
    tasks.stop()
    wait(state, "stopped")
    assert state.outcome.cards and not state.stopping
    monkeypatch.setattr("dalembert.studio.task_process.DOUBLE_CLICK", 0.0)
    state = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml")
    wait(state, "progress")
    assert tasks._process is not None
    process = tasks._process.process
    monkeypatch.setattr(tasks._process._connection, "send", lambda message: None)  # it hangs
    tasks.stop()
    time.sleep(0.05)
    assert state.status == "running" and state.message()["stopping"]
    tasks.stop()
    wait(state, "stopped")
    process.join(5.0)
    assert state.outcome.sentence == "ended at once, without its result so far"


def test_a_stopped_sweep_keeps_the_finished_designs() -> None:
    tasks = Tasks()
    count = 200_000
    sweep = f"sweep = {{ samples = {count}, vary = {{ load = [5e4, 2e5] }} }}\n"
    state = tasks.start(
        "sweep", ROD.replace("pareto =", f"{sweep}pareto =", 1), EXAMPLES / "x.toml"
    )
    wait(state, "progress")
    tasks.stop()
    wait(state, "stopped")
    ended = re.fullmatch(r"(\d+) of 200000 designs; interrupted", state.outcome.sentence)
    assert ended and 0 < int(ended[1]) < count
    assert state.outcome.ok and state.outcome.interrupted and state.outcome.page
    tasks.close()
