"""``kill -9`` while a file is written: nothing is half-written; the next run clears the rest."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from dalembert.design.optimize.evaluation_log import EvaluationLog
from dalembert.files import atomic_path, clear_left_over


@pytest.mark.thorough
@pytest.mark.skipif(os.name == "nt", reason="needs signals")
def test_killed_commands_leave_nothing_half_written():
    """A sample of ``python -m tests.killed_commands``, two kills."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.killed_commands", "1", "4", "run", "examples"],
        cwd=Path(__file__).parents[1],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("1 kills") == 2


@pytest.mark.parametrize(
    "name", ["a.nc", "film.gif", "b", ".hidden", "c.tar.gz", "d.é-1", "x" * 250]
)
def test_temporary_files_of_a_killed_process_are_cleared(name, tmp_path, monkeypatch):
    """Whatever the name of the file that it was writing."""
    with atomic_path(tmp_path / name) as temporary:
        left = [temporary, temporary.with_name(f"{temporary.name}.gif")]  # libraries add endings
        renamed = {path.name: path.name.replace(f"-{os.getpid()}-", "-4194305-") for path in left}
    for dead in renamed.values():
        (tmp_path / dead).touch()
    clear_left_over.cache_clear()
    clear_left_over(tmp_path)
    assert not list(tmp_path.glob(".*-dalembert-*"))


def test_files_of_others_stay(tmp_path):
    """What is being written by a process that runs, and what only looks alike."""
    unrelated = [".a.nc", ".git", ".x-dalembert-00000000-1-abc.nc", f".y-dalembert-{1:08x}-2.nc"]
    for name in unrelated:
        (tmp_path / name).touch()
    clear_left_over.cache_clear()
    clear_left_over(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(unrelated)


def test_a_log_that_ends_within_a_line_goes_on(tmp_path):
    """Every whole line counts, also those after the half one."""
    path = tmp_path / "log.jsonl"
    log = EvaluationLog(path, {"problem": 1})
    begin = path.stat().st_size
    designs = [np.array([k / 7]) for k in range(4)]
    for k, x in enumerate(designs[:3]):
        log.append(x, terms=[1.5 * k])
    content = path.read_bytes()
    for cut in range(begin, len(content), 5):
        path.write_bytes(content[:cut])
        EvaluationLog(path, {"problem": 1}).append(designs[3], terms=[9.0])
        again = EvaluationLog(path, {"problem": 1})
        whole = content[begin:cut].count(b"}")
        expected = [again.find(x) is not None for x in designs]
        assert expected == [*(k < whole for k in range(3)), True]
