"""Memory of a whole process that runs a chain of ten four-bars."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from benchmarks.solvers.base import installed

RUN = """
from benchmarks.cases.memory import peak
from benchmarks.mechanisms import four_bars
from benchmarks.solvers import exudyn, ours
mechanism, _ = four_bars(10)
{run}
print(peak())
"""
RUNS = {
    "dalembert": 'ours.runner(mechanism, 1.0, "vm")({steps})',
    "Exudyn": "exudyn.run(mechanism, 1.0, {steps})",
}
PEAK = re.compile(r"VmHWM:\s+(\d+) kB")
STATUS = Path("/proc/self/status")


def peak() -> int:
    """The most bytes that this process has had.

    What the system tells of its children counts their parent's memory before they began anew.
    """
    if STATUS.exists() and (found := PEAK.search(STATUS.read_text())):
        return 1024 * int(found[1])
    import resource

    units = 1 if sys.platform == "darwin" else 1024
    return units * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def megabytes(run: str) -> float:
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", RUN.format(run=run)],
        check=True,
        capture_output=True,
        text=True,
        cwd=root,
    )
    return int(done.stdout.splitlines()[-1]) / 1e6


def measure(effort: Effort) -> Iterator[Row]:
    steps = 100 if effort.quick else 10_000
    row = Row("10 four-bars", f"memory of a process, {steps} steps")
    for name, run in RUNS.items():
        if name != "Exudyn" or installed("exudyn"):
            found = [megabytes(run.format(steps=steps)) for _ in range(min(effort.rounds, 3))]
            row.samples[name] = Sample.of(found, "MB")
    yield row


CASE = Case("memory", "of a process that runs ten four-bars", measure)
