"""Design tasks of the studio in their process: progress, stop, crashes, the end of the server."""

from __future__ import annotations

import math
import os
import re
import signal
import time
from pathlib import Path

import pytest
from processor_times import descendants
from studio_runs import running_studio
from test_studio_server import page, receive, send

from dalembert.errors import ModelError
from dalembert.studio.draft import digest
from dalembert.studio.drawing_edits import apply
from dalembert.studio.pictures import picture_of
from dalembert.studio.preview import Preview, analysis_fields
from dalembert.studio.problems import Problem
from dalembert.studio.task_process import TaskState
from dalembert.studio.task_work import TaskRequest, _run
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
    state = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml")
    with pytest.raises(ModelError, match="stop it first"):
        tasks.start("synthesis", SLOW, EXAMPLES / "x.toml")
    wait(state, "progress")
    tasks.stop()
    wait(state, "stopped")
    assert state.digest == digest(SLOW) and state.outcome.interrupted and state.outcome.cards
    assert re.search(r"interrupted after \d+ of \d+ starts", state.outcome.sentence)
    killed = tasks.start("synthesis", SLOW, EXAMPLES / "x.toml")
    wait(killed, "progress")
    assert tasks._process is not None
    tasks._process.process.kill()
    wait(killed, "failed")
    assert "ended unexpectedly (signal 9)" in killed.outcome.sentence
    tasks.close()


def test_wrong_tasks_are_reported_at_their_places() -> None:
    tasks = Tasks()
    with pytest.raises(ModelError, match="no task"):
        tasks.start("system", "", EXAMPLES / "x.toml")
    text = (EXAMPLES / "four_bar.toml").read_text().replace('minimize = "peak"', 'minimize = "pea"')
    state = tasks.start("optimize", text, EXAMPLES / "four_bar.toml")
    wait(state, "failed")
    assert "peak" in state.outcome.sentence and state.outcome.problems[0].line > 0


@pytest.mark.thorough
@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="lists processes by /proc")
def test_the_end_of_the_server_ends_the_task(tmp_path: Path) -> None:
    (tmp_path / "model.toml").write_text(SLOW)
    with running_studio(tmp_path, "model.toml") as studio, page(studio) as one, page(studio) as two:
        text = receive(one, "text")
        send(one, kind="start", section="synthesis")
        for socket in (one, two):
            assert receive(socket, "task", status="running")["digest"] == text["digest"]
        send(one, kind="text", text=SLOW + "# more\n", revision=text["revision"])
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


ROD = """format = 1
kind = "structure"
parameters = { load = 1e5, area = { value = 1e-3, bounds = [2e-4, 5e-3] } }
nodes = { left = [0, 0], right = [2, 0] }
supports = [{ nodes = "left" }, { nodes = "right", uy = 0 }]
loads = [{ nodes = "right", fx = "load" }]
pareto = { minimize = ["stress", "mass"], points = 5 }
tolerance = { response = "stress", tolerances = { load = 3e3, area = 3e-5 } }
reliability = { limits = [{ response = "stress", upper = 1.5e8 }] }
random = [{ parameter = "load", type = "Normal", mean = 1e5, std = 2e4 }]

[elements]
rod = { type = "Truss", connect = ["left", "right"], area = "area", modulus = 2e11, density = 7850 }

[responses]
stress = { measure = "rod.stress" }
mass = { measure = "mass" }
"""


@pytest.mark.thorough
def test_tasks_agree_with_closed_forms(tmp_path: Path) -> None:
    """Stress F/A and mass ρ A L of a rod: front, first-order deviation, reliability index.

    The front is σ m = ρ F L, from one bound of A to the other; with F and A of relative half
    widths 3 %, σ deviates by 3 % √2; the limit is (1.5 − 1) 1e8 / 2e7 = 2.5 deviations away.
    """
    outcomes = {
        section: _run(TaskRequest(section, ROD, tmp_path / "rod.toml"), lambda message: None)
        for section in ("pareto", "tolerance", "reliability")
    }
    assert all(outcome.ok and outcome.page for outcome in outcomes.values())
    areas = [design["area"] for design in outcomes["pareto"].designs]
    assert [areas[0], areas[2], areas[-1]] == pytest.approx([5e-3, 1e-3, 2e-4], rel=1e-6)
    stress, _, deviation, _ = outcomes["tolerance"].sentence.removeprefix("stress ").split()
    assert float(stress) == pytest.approx(1e8)
    assert float(deviation) == pytest.approx(1e8 * 0.03 * 2**0.5, rel=2e-3)  # three digits
    assert outcomes["reliability"].sentence.startswith("β = 2.5, failure 0.00621;")


@pytest.mark.thorough
def test_an_identified_stiffness_is_that_of_the_data(tmp_path: Path) -> None:
    """x = 0.1 cos(√(k/m) t) with k = 80 N/m and m = 2 kg; the search starts at 60 N/m."""
    times = [0.01 * k for k in range(101)]
    rows = [f"{t},{0.1 * math.cos(math.sqrt(40.0) * t)!r}" for t in times]
    (tmp_path / "measured.csv").write_text("time,mass.x\n" + "\n".join(rows) + "\n")
    text = """format = 1
parameters = { k = { value = 60.0, unit = "N/m", bounds = [40.0, 120.0] } }
identify = { data = "measured.csv" }
analysis = { type = "Dynamics", duration = 1.0 }
[bodies]
mass = { type = "Particle", mass = 2.0, position = [0.1, 0.0] }
[joints]
rail = { type = "PinInSlot", connect = [{ body = "ground", at = [0.0, 0.0] }, "mass"] }
[forces.spring]
type = "Spring"
connect = [{ body = "ground", at = [-1.0, 0.0] }, "mass"]
stiffness = "k"
free_length = 1.0
"""
    outcome = _run(TaskRequest("identify", text, tmp_path / "spring.toml"), lambda message: None)
    assert outcome.ok and outcome.page
    assert outcome.designs[0]["k"] == pytest.approx(80.0, rel=1e-5)


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
    assert 'analysis = { type = "Kinematics", duration = 1.0 }' in apply(inline, [operation])
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
