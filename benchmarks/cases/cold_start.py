"""Cold start: importing, and from a model file to its report, each in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from benchmarks.solvers.base import installed

EXAMPLE = Path(__file__).parents[2] / "examples" / "four_bar.toml"
PEERS = {
    "dalembert": "dalembert as da; da.System, da.solve_dynamics; from dalembert import planar",
    "Exudyn": "exudyn",
    "MuJoCo": "mujoco",
    "Pinocchio": "pinocchio",
    "SymPy + SciPy": "sympy",
    "scikit-fem": "skfem",
}


def seconds(arguments: list[str], kept: str) -> float:
    """Wall time of a Python process, whose bytecode is kept in a folder."""
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPYCACHEPREFIX"] = kept
    begin = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True, env=environment)
    return time.perf_counter() - begin


def measure(effort: Effort) -> Iterator[Row]:
    there = {name: package for name, package in PEERS.items() if installed(package.split()[0])}
    spent: dict[str, list[float]] = {name: [] for name in there}
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as kept:
        for turn in range(effort.rounds + 1):
            for name, package in there.items():
                taken = seconds(["-c", f"import {package}"], kept)
                if turn:  # the first one writes bytecode
                    spent[name].append(taken)
        yield Row("cold start", "import", {name: Sample.of(s, "s") for name, s in spent.items()})
        arguments = ["-m", "dalembert", "run", str(EXAMPLE), "--output", folder, "--quiet"]
        whole = [seconds(arguments, kept) for _ in range(effort.rounds + 1)][1:]
        yield Row("cold start", "four-bar file to report", {"dalembert": Sample.of(whole, "s")})


CASE = Case("cold-start", "import, and a file to its report", measure)
