"""Studies: every design once, whatever happens to those who compute."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.design.studies.folder import StudyFolder
from dalembert.design.studies.task import StudyTask
from dalembert.design.studies.workers import DIED, Chunk, Processes

HERE = Path(__file__)
RANGES = {"length": (0.5, 2.0), "mass": (1.0, 3.0)}


def pendulum() -> da.Model:
    """A mass on a bar, held by a spring that turns: its angle at rest has no failing designs."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    mass = system.parameter("mass", 2.0, "kg", bounds=(1.0, 3.0))
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=-0.3))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    return system.build()


SHORT = da.Dynamics(duration=0.2, step=0.02, backend="vm")
RESPONSES = [da.final("bar.angle", name="angle"), da.maximum("O.force_norm", name="force")]


def study(design: da.DesignTable, **how) -> da.SweepResult:
    return da.sweep(pendulum, design, analysis=SHORT, responses=RESPONSES, **how)


def test_a_study_carries_the_warnings_of_its_extreme_designs():
    design = da.DesignTable.table({"length": [1.0, 0.005, 1.2], "mass": [1.0, 1.0, 1.0]})
    fast = da.sweep(pendulum, design, analysis=da.Dynamics(0.5, step=0.02), responses=RESPONSES)
    assert fast.success.all()
    assert any(text.startswith("design 1: steps of 0.02 s are long") for text in fast.warnings)
    assert fast.summary()["warnings"] == list(fast.warnings)
    controlled = da.sweep(pendulum, design, analysis=da.Dynamics(0.5), responses=RESPONSES)
    assert not list(controlled.warnings)


def test_designs():
    grid = da.DesignTable.grid({"a": [1, 2, 3], "b": [10, 20]})
    assert grid.values.tolist() == [[1, 10], [1, 20], [2, 10], [2, 20], [3, 10], [3, 20]]
    for sample in (da.DesignTable.latin_hypercube, da.DesignTable.sobol):
        computed = sample(RANGES, 16, rng=1)
        for (lower, upper), column in zip(RANGES.values(), computed.values.T, strict=True):
            # one in each sixteenth of the range
            slices = np.floor((column - lower) / (upper - lower) * 16)
            assert sorted(slices) == list(range(16))
        assert np.array_equal(computed.values, sample(RANGES, 16, rng=1).values)
    from scipy import stats

    drawn = da.DesignTable.monte_carlo({"a": stats.norm(3, 2), "b": (0, 1)}, 4000, rng=2)
    assert drawn.values.mean(axis=0) == pytest.approx([3, 0.5], abs=0.1)
    assert len(da.DesignTable.table({"a": [1.0, 2.0]})) == 2


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: da.DesignTable.grid({}), "at least one parameter"),
        (lambda: da.DesignTable.sobol({"a": (2, 1)}, 4), "a: a range"),
        (lambda: da.DesignTable.sobol({"a": (1, 2)}, 0), "number of designs"),
        (lambda: da.DesignTable.table({"a": [1, 2], "b": [1]}), "same length"),
        (lambda: da.DesignTable.table({"a": [1, float("nan")]}), "design 1: a is nan"),
        (lambda: study(da.DesignTable.grid({"lenght": [1]})), "length"),
        (lambda: study(da.DesignTable.grid({"length": [1]}), workers=0), "workers"),
    ],
)
def test_wrong_designs(make, words):
    with pytest.raises(da.DalembertError, match=words):
        make()


def test_each_design_is_its_own_run():
    design = da.DesignTable.grid({"length": [0.8, 1.1], "mass": [2.5]})
    result = study(design)
    model = pendulum()
    for row, values in zip(design.values, result.values, strict=True):
        motion = SHORT.run(model, dict(zip(design.names, row, strict=True)))
        assert [da.evaluate(motion, r) for r in RESPONSES] == values.tolist()
    assert list(result.table.columns) == ["length", "mass", "angle", "force", "reason"]
    assert result.success.all() and result.failures == {}


def test_failed_designs_keep_their_reason():
    result = study(da.DesignTable.grid({"length": [1.0, -1.0, 1.5]}))
    assert result.success.tolist() == [True, False, True]
    assert "length" in result.failures[1]
    assert np.isnan(result.values[1]).all() and np.isfinite(result.values[[0, 2]]).all()


def test_processes_find_the_same():
    design = da.DesignTable.sobol(RANGES, 9, rng=0)
    one, two = study(design), study(design, workers=2, chunk=2)
    assert np.array_equal(one.values, two.values)


def test_side_by_side_is_one_by_one():
    """The same numbers to round-off, and the same designs fail."""
    design = da.DesignTable.table({"length": [0.5, 0.8, -1.0, 1.1, 1.4, 2.0]})
    numbers = np.arange(len(design))
    tasks = [StudyTask(pendulum(), SHORT, RESPONSES, together=t) for t in (True, False)]
    assert [task.batched for task in tasks] == [True, False]
    computed = [task.answers(numbers, design.names, design.values) for task in tasks]
    together, alone = (np.array([a.values for a in answers]) for answers in computed)
    np.testing.assert_allclose(together, alone, rtol=1e-11)
    assert [bool(a.reason) for a in computed[0]] == [bool(a.reason) for a in computed[1]]


class Deadly(StudyTask):
    """Design 3 takes its process down; design 5 the first time it is run."""

    def answer(self, number, names, values):
        if number == 3:
            os._exit(9)
        if number == 5 and not self.once.exists():
            self.once.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return super().answer(number, names, values)


@pytest.mark.skipif(sys.platform == "win32", reason="processes are not forked there")
def test_dead_workers(tmp_path):
    design = da.DesignTable.sobol(RANGES, 8, rng=0)
    Deadly.once = tmp_path / "died"
    task = Deadly(pendulum(), SHORT, RESPONSES, together=False)
    whole = Chunk(np.arange(8), design.names, design.values)
    chunks = [Chunk(np.r_[[2 * k, 2 * k + 1]], design.names, design.values[2 * k : 2 * k + 2])
              for k in range(4)]  # fmt: skip
    assert whole.split()[3].numbers.tolist() == [3]
    computed = [a for answers in Processes(lambda: task, task, 2).answers(chunks) for a in answers]
    assert sorted(a.number for a in computed) == list(range(8))
    assert [a.number for a in computed if a.reason] == [3]
    assert next(a for a in computed if a.number == 3).reason == DIED


def table_of(folder: Path):
    parquet = pytest.importorskip("pyarrow.parquet")
    return parquet.read_table(folder / "table.parquet")


@pytest.fixture(params=["parquet", "csv"])
def stored(request, monkeypatch) -> str:
    """The format of tables, CSV as without pyarrow."""
    if request.param == "csv":
        monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    else:
        pytest.importorskip("pyarrow")
    return request.param


@pytest.mark.few(1)
def test_folder_goes_on(tmp_path, stored):
    design = da.DesignTable.sobol(RANGES, 8, rng=0)
    whole = study(design, folder=tmp_path / "whole", chunk=3)

    def stop(fraction):
        if fraction > 0.3:
            raise KeyboardInterrupt

    partial = study(design, folder=tmp_path / "parts", chunk=3, progress=stop)
    assert partial.interrupted and partial.sentence == "3 of 8 designs; interrupted"
    assert partial.ok and partial.success.tolist() == 3 * [True] + 5 * [False]
    assert np.array_equal(partial.values[:3], whole.values[:3]) and partial.table_path is None
    assert set(partial.reasons[3:]) == {"interrupted"} and partial.page()
    again = study(design, folder=tmp_path / "parts", chunk=2)
    assert again.reused_count == 3
    assert np.array_equal(whole.values, again.values)
    name = f"table.{stored}"
    assert again.table_path == tmp_path / "parts" / name
    assert bool(again.findings()["note"]) == (stored == "csv")
    if stored == "csv":
        assert (tmp_path / "whole" / name).read_text() == (tmp_path / "parts" / name).read_text()
    else:
        assert table_of(tmp_path / "whole").equals(table_of(tmp_path / "parts"))
    assert study(design, folder=tmp_path / "parts").reused_count == 8


DAMAGE = {
    "empty": lambda content, place: b"",
    "cut": lambda content, place: content[:place],
    "flipped": lambda content, place: (
        content[:place] + bytes([content[place] ^ 1]) + content[place + 1 :]
    ),
    "noise": lambda content, place: bytes(range(256)) * 3,
}


@pytest.mark.few(4)
@pytest.mark.parametrize("kind", DAMAGE)
def test_damaged_parts_are_evaluated_again(kind, tmp_path, stored):
    """At random places, the last number among them; the damaged part is kept under another name."""
    design = da.DesignTable.table({"length": [1.0, -1.0, 1.5, 0.8]})
    task = StudyTask(pendulum(), SHORT, RESPONSES)
    answers = task.answers(np.arange(4), design.names, design.values)
    about = {"responses": [r.label for r in RESPONSES]}
    folder = StudyFolder(tmp_path, "one", about)
    folder.add(answers)
    (part,) = folder.parts.glob(f"part-*.{stored}")
    content, rng = part.read_bytes(), random.Random(5)
    for place in [len(content) - 3, *rng.sample(range(len(content)), 25)]:
        part.write_bytes(DAMAGE[kind](content, place))
        result = folder.answers()
        assert all(  # what is still read is right
            np.array_equal(result[a.number].values, a.values, equal_nan=True)
            and result[a.number].reason == a.reason
            for a in answers
            if a.number in result
        )
        assert result.keys() <= {a.number for a in answers}
        damaged = part.with_name(f"{part.name}.damaged")
        assert damaged.exists() == (not part.exists())
        damaged.unlink(missing_ok=True)
    folder.close()


def test_a_study_with_a_damaged_part_goes_on(tmp_path, stored):
    design = da.DesignTable.grid({"length": [1.0, 1.5, 0.8]})
    whole = study(design, folder=tmp_path, chunk=1)
    part = sorted((tmp_path / "parts").glob("part-*"))[1]
    part.write_bytes(part.read_bytes()[:-9])
    again = study(design, folder=tmp_path)
    assert again.reused_count == 2 and np.array_equal(whole.values, again.values)
    assert part.exists() and part.with_name(f"{part.name}.damaged").exists()


def test_failures_are_kept(tmp_path, stored):
    design = da.DesignTable.grid({"length": [1.0, -1.0, 1.5]})
    first, again = (study(design, folder=tmp_path) for _ in range(2))
    assert again.reused_count == 3 and again.failures == first.failures
    assert np.array_equal(first.values, again.values, equal_nan=True)


def test_another_mass_is_another_study(tmp_path):
    pytest.importorskip("pyarrow")
    system = da.System("pendulum")
    bar = system.add(planar.Bar("bar", length=system.parameter("length", 1.0), mass=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    design = da.DesignTable.grid({"length": [1.0]})
    task = StudyTask(system.build(), SHORT, RESPONSES)
    other = da.System("pendulum")
    rod = other.add(planar.Bar("bar", length=other.parameter("length", 1.0), mass=2.0))
    other.add(planar.Revolute("O", other.ground.point(0, 0), rod.start))
    assert task.identity(design) == task.identity(design)
    assert task.identity(design) != StudyTask(other.build(), SHORT, RESPONSES).identity(design)


def test_folder_of_another_study(tmp_path):
    pytest.importorskip("pyarrow")
    study(da.DesignTable.grid({"mass": [1, 2]}), folder=tmp_path)
    with pytest.raises(da.FileError, match="another study"):
        study(da.DesignTable.grid({"mass": [1, 3]}), folder=tmp_path)
    with pytest.raises(da.FileError, match="another study"):
        da.sweep(
            pendulum,
            da.DesignTable.grid({"mass": [1, 2]}),
            analysis=da.Dynamics(duration=0.2, step=0.01, backend="vm"),
            responses=RESPONSES,
            folder=tmp_path,
        )


SCRIPT = f"""
import sys; sys.path.insert(0, {str(HERE.parent)!r})
import test_studies as t
design = t.da.DesignTable.sobol(t.RANGES, int(sys.argv[2]), rng=0)
t.study(design, folder=sys.argv[1], workers=2, chunk=3)
"""


def killed_study(folder: Path, count: int, kills: int, rng: random.Random) -> int:
    """A study whose process is killed so often at random times; how many kills met it at work."""
    met = 0
    while True:
        process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(folder), str(count)])
        if met < kills:
            parts = folder / "parts"
            before = len(list(parts.glob("*"))) if parts.exists() else 0
            deadline = time.monotonic() + 60
            while process.poll() is None and time.monotonic() < deadline:
                if parts.exists() and len(list(parts.glob("*"))) > before:
                    break  # it computes
                time.sleep(0.002)
            time.sleep(rng.uniform(0.0, 0.05))
            if process.poll() is None:
                process.kill()
                met += 1
        if process.wait() == 0:
            return met


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL there")
def test_killed_at_random_times(tmp_path):
    pytest.importorskip("pyarrow")
    design = da.DesignTable.sobol(RANGES, 60, rng=0)
    assert killed_study(tmp_path / "killed", 60, 2, random.Random(1)) >= 1
    study(design, folder=tmp_path / "whole")
    assert table_of(tmp_path / "killed").equals(table_of(tmp_path / "whole"))
