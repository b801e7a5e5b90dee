"""Machine code of rows of four-bars: time to make it, its size, and how they grow with the row."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import dalembert as da
from benchmarks import mechanisms
from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from benchmarks.solvers import ours
from dalembert.symbolic.evaluation.columns import NativeColumns, compiled_form
from dalembert.symbolic.native.llvm import Llvm
from dalembert.symbolic.native.source import c_source

COUNTS = (10, 40, 200, 1000)
STEP = 1e-3


@dataclass
class Cost:
    """Processor times [s], and bytes.

    Attributes
    ----------
    build : a model of neutral words
    graph : the function of a step
    code : machine code of that
    load : the same from disk, its text written anew to find it
    step : one step
    size : of the code
    """

    build: float
    graph: float
    code: float
    load: float
    step: float
    size: int


def cost(count: int, rounds: int) -> Cost:
    """What a row of so many four-bars costs."""
    mechanism, _ = mechanisms.four_bars(count)
    clock = [time.process_time()]

    def lap() -> float:
        clock.append(time.process_time())
        return clock[-1] - clock[-2]

    model = ours.build(mechanism)
    build = lap()
    kernel = da.Dynamics(1.0, step=STEP).kernel(model)
    x, mode = kernel.initial(model.start, 0.0, model.nominal)
    forms = kernel.fixed.marched(mode).forms
    form = compiled_form(forms.function, forms.called)
    graph = lap()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "step.o"
        Llvm().build(c_source(form) or "", path)
        code = lap()
        c_source(form)
        columns = NativeColumns(form, Llvm().load(path), "LLVM", True, (4,))
        load, size = lap(), path.stat().st_size
    steps, q = max(10, 20_000 // count), forms.values(model.nominal).full().ravel()
    given = x, STEP * np.arange(steps), np.full(steps, STEP), np.ones(steps), q
    laps = []
    for _ in range(rounds + 1):
        lap()
        columns(steps, *given)
        laps.append(lap() / steps)
    return Cost(build, graph, code, load, min(laps[1:]), size)


def measure(effort: Effort) -> Iterator[Row]:
    """A row of the table for each size; growth is told from the smallest on."""
    counts = [n for n in COUNTS if n <= (40 if effort.quick else effort.sizes)]
    costs = {n: cost(n, effort.rounds) for n in counts}
    first = costs[counts[0]]
    names = {
        "build": "build of the model",
        "graph": "the function of a step",
        "code": "its machine code",
        "load": "from disk",
        "step": "one step",
    }
    for n, found in costs.items():
        for field, name in names.items():
            value, note = getattr(found, field), ""
            if n > counts[0]:
                growth = np.log(value / getattr(first, field)) / np.log(n / counts[0])
                note = f"grows with exponent {growth:.2f}"
            if field == "code":
                note = f"{found.size / 1e6:.2f} MB" + (f", {note}" if note else "")
            sample = Sample.of([value], "s", note)
            yield Row(f"{n} four-bars, code", name, {"dalembert, jit": sample})


CASE = Case("code", "machine code of 10 to 1000 four-bars", measure)
"""Processor times of one process."""
