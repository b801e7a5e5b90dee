"""Design tasks of the studio in their process: progress, stop, crashes, the end of the server."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest
from processor_times import descendants
from studio_runs import running_studio
from test_studio_server import page, receive, send

from dalembert.errors import ModelError
from dalembert.studio.drawing_edits import apply
from dalembert.studio.pictures import picture_of
from dalembert.studio.preview import Preview, analysis_fields
from dalembert.studio.problems import Problem
from dalembert.studio.task_process import TaskState
from dalembert.studio.tasks import Tasks

EXAMPLES = Path(__file__).parents[1] / "examples"
SLOW = (
    (EXAMPLES / "path_optimization.toml").read_text("utf-8").replace("starts = 12", "starts = 9000")
)


def wait(state: TaskState, until: str, seconds: float = 30.0) -> None:
    """Wait for a status, or for progress."""
    end = time.monotonic() + seconds
    while not (state.status == until or (until == "progress" and state.fraction)):
        assert time.monotonic() < end, state
        time.sleep(0.02)


def test_a_stopped_task_keeps_its_result_and_a_killed_one_is_reported() -> None:
    tasks = Tasks()
    state = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml", 7)
    with pytest.raises(ModelError, match="stop it first"):
        tasks.start("synthesis", SLOW, EXAMPLES / "x.toml", 7)
    wait(state, "progress")
    tasks.stop()
    wait(state, "stopped")
    assert state.revision == 7 and state.outcome.interrupted and state.outcome.cards
    killed = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml", 8)
    wait(killed, "progress")
    assert tasks._process is not None
    tasks._process.process.kill()
    wait(killed, "failed")
    assert "ended unexpectedly (signal 9)" in killed.outcome.sentence
    tasks.close()


def test_wrong_tasks_are_reported_at_their_places() -> None:
    tasks = Tasks()
    with pytest.raises(ModelError, match="no task"):
        tasks.start("system", "", EXAMPLES / "x.toml", 0)
    text = (EXAMPLES / "four_bar.toml").read_text().replace('minimize = "peak"', 'minimize = "pea"')
    state = tasks.start("optimize", text, EXAMPLES / "four_bar.toml", 0)
    wait(state, "failed")
    assert "peak" in state.outcome.sentence and state.outcome.problems[0].line > 0


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="lists processes by /proc")
def test_the_end_of_the_server_ends_the_task(tmp_path: Path) -> None:
    (tmp_path / "model.toml").write_text(SLOW)
    with running_studio(tmp_path, "model.toml") as studio, page(studio) as one, page(studio) as two:
        revision = receive(one, "text")["revision"]
        send(one, kind="start", section="synthesis")
        for socket in (one, two):
            assert receive(socket, "task", status="running")["revision"] == revision
        send(one, kind="text", text=SLOW + "# more\n", revision=revision)
        assert receive(two, "text", changed=True)
        while receive(two, "task")["fraction"] is None:
            pass
        started = list(descendants(studio.process.pid))
        assert len(started) >= 3  # two that make pictures, and the task
        os.kill(studio.process.pid, signal.SIGKILL)
        end = time.monotonic() + 10
        while any(map(runs, started)):
            assert time.monotonic() < end
            time.sleep(0.02)


def runs(process: int) -> bool:
    try:
        return " Z " not in Path(f"/proc/{process}/stat").read_text()
    except OSError:
        return False


ANALYSIS = '[analysis] # own\ntype = "Dynamics"\nduration = 2.0 # s\nstep = 0.01\n'


def test_sections_are_changed_key_by_key() -> None:
    text = f"format = 1\n{ANALYSIS}"
    fields = analysis_fields(
        {"analysis": {"type": "Dynamics", "duration": 2.0, "step": 0.01}}, "Kinematics", {}
    )
    assert fields == {"type": "Kinematics", "step": None}
    operation = {"op": "section", "section": "analysis", "fields": fields}
    changed = apply(text, [operation])
    assert changed == text.replace("Dynamics", "Kinematics").replace("step = 0.01\n", "")
    inline = 'format = 1\nanalysis = { type = "Dynamics", step = 0.01, duration = 1.0 }\n'
    assert 'analysis = { duration = 1.0, type = "Kinematics" }' in apply(inline, [operation])
    new = apply("format = 1\n", [{"op": "section", "section": "sweep", "fields": {"samples": 8}}])
    assert new == "format = 1\n\n[sweep]\nsamples = 8\n"
    for section, key in (("bodies", "a"), ("sweep", "a b"), ("sweep", "x]\n[y")):
        with pytest.raises(ModelError):
            apply(text, [{"op": "section", "section": section, "fields": {key: 1}}])
    with pytest.raises(ModelError, match="Kinematics"):
        analysis_fields({}, "Kinematic", {})


def test_problems_of_a_preview_are_at_their_places_in_the_text() -> None:
    text = f"format = 1\n{ANALYSIS}[report]\ntrace = [1]\n"
    preview = Preview()
    preview.set({"type": "Kinematics", "step": None})
    shown = preview.apply(text)
    at = shown.index("trace")
    (problem,) = preview.in_text([Problem("error", "x", at, at + 5, 6)], text)
    assert text[problem.start : problem.end] == "trace" and problem.line == 7


def test_a_failing_analysis_shows_the_drawn_position() -> None:
    text = (
        (EXAMPLES / "four_bar.toml").read_text().replace('type = "Dynamics"', 'type = "Kinematics"')
    )
    for key in (
        "step = 0.005",
        'formulation = "RangeSpace"',
        'stabilization = "Projection"',
        'integrator = "RK4"',
    ):
        text = text.replace(f"{key}\n", "")
    picture = picture_of(text, EXAMPLES / "four_bar.toml", live=False)
    assert "initial position" in picture.page and picture.facts["free"] == 1
    (error,) = [problem for problem in picture.problems if problem.level == "error"]
    assert "add 1 driver" in error.message and error.line > 0
