"""``kill -9`` while a file is written: nothing is half-written; the next run clears the rest."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from dalembert.cli import main
from dalembert.files.atomic import clear_left_over

EXAMPLES = Path(__file__).parents[1] / "examples"
KILLED = """
import os, signal, sys, tempfile
module, name = (tempfile, "mkstemp") if sys.argv[1] == "created" else (os, "replace")
act = getattr(module, name)
def killed(*given, **named):
    if name == "mkstemp":
        act(*given, **named)
    os.kill(os.getpid(), signal.SIGKILL)
setattr(module, name, killed)
from dalembert.cli import main
sys.exit(main(sys.argv[2:]))
"""
MODEL = """
format = 1
name = "spring"
gravity = [0, -9.81]
[parameters]
k = { value = 50.0, bounds = [10.0, 100.0] }
[bodies.b]
type = "Particle"
mass = 1.0
position = [0.0, -0.2]
[forces.s]
type = "Spring"
connect = ["ground", "b"]
stiffness = "k"
free_length = 0.1
[analysis]
type = "Dynamics"
duration = 0.1
step = 0.01
[responses.low]
type = "Final"
measure = "b.y"
[optimize]
maximize = "low"
vary = ["k"]
"""
COMMANDS = {
    "run": ["run", "m.toml", "--output", "out", "--quiet"],
    "sensitivity": ["sensitivity", "m.toml", "--output", "out"],
    "optimize": ["optimize", "m.toml", "--output", "out"],
}


@pytest.mark.skipif(os.name == "nt", reason="needs signals")
@pytest.mark.parametrize(
    ("command", "moment"), [("run", "created"), *((command, "complete") for command in COMMANDS)]
)
def test_killed_commands_leave_nothing_half_written(command, moment, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("m.toml").write_text(MODEL, encoding="utf-8")
    source = "import sys; sys.path[:0] = " + repr(sys.path) + KILLED
    arguments = [sys.executable, "-c", source, moment, *COMMANDS[command]]
    done = subprocess.run(arguments, capture_output=True, check=False)
    assert done.returncode == -9, done.stderr
    left = hidden(tmp_path)
    assert len(left) == 1 and shown(tmp_path) == {"m.toml"}
    clear_left_over.cache_clear()
    assert main(COMMANDS[command]) == 0
    assert not hidden(tmp_path) and len(shown(tmp_path)) > 1


def shown(folder: Path) -> set[str]:
    return {p.name for p in folder.rglob("*") if p.is_file() and not p.name.startswith(".")}


def hidden(folder: Path) -> set[str]:
    return {p.name for p in folder.rglob(".*") if p.is_file()}


def test_files_of_others_stay(tmp_path):
    """What is being written by a process that runs, and what only looks alike."""
    kept = [".a.nc", ".git", ".x-dalembert-00000000-1-abc.nc", f".y-dalembert-{1:08x}-2.nc"]
    for name in kept:
        (tmp_path / name).touch()
    clear_left_over.cache_clear()
    clear_left_over(tmp_path)
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(kept)
