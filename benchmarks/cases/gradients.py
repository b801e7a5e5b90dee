"""Gradients of a chain of four-bars by all masses: the adjoint beside differences.

The response is the last height of the first crank, half a second from the start. What is told is
run and gradient together, in plain runs of the same solver; Exudyn has no gradients, and central
differences cost it two runs for each parameter, whatever they are worth.
"""

from __future__ import annotations

import time
from collections.abc import Iterator

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.mechanisms import four_bars
from benchmarks.sample import Row, Sample
from benchmarks.solvers import exudyn, ours
from benchmarks.solvers.base import installed

COUNTS = (1, 3, 10, 40)
DURATION = 0.5
HEIGHT = da.final("b0.seen.y")


def measure(effort: Effort) -> Iterator[Row]:
    for count in COUNTS[: 2 if effort.quick else None]:
        if count > effort.sizes:
            return
        mechanism, _ = four_bars(count)
        model, steps = ours.build(mechanism), 100 if effort.quick else max(500, 4000 // count)
        number = len(model.parameters)
        whole = Row(f"{mechanism.name}, {number} parameters", "run and gradient")
        ratio = Row(whole.case, "the same, in plain runs")
        for backend in effort.backends:
            times, ratios = _adjoint(model, steps, backend, effort.rounds)
            name = ours.NAMES[backend]
            whole.samples[name] = Sample.of(times, "s", "adjoint")
            ratio.samples[name] = Sample.of(ratios, "")
        if installed("exudyn"):
            spent = [
                exudyn.run(mechanism, DURATION, steps)[0] for _ in range(min(effort.rounds, 3))
            ]
            note = f"{2 * number + 1} runs, differences"
            whole.samples["Exudyn"] = Sample.of([(2 * number + 1) * s for s in spent], "s", note)
            ratio.samples["Exudyn"] = Sample.of([2 * number + 1.0], "")
        yield whole
        yield ratio


def _adjoint(
    model: da.Model, steps: int, backend: str, rounds: int
) -> tuple[list[float], list[float]]:
    """Seconds of run and gradient, and the same in plain runs."""
    analysis = da.Dynamics(DURATION, step=DURATION / steps, outputs=[DURATION], backend=backend)
    da.sensitivity(analysis.run(model), HEIGHT, method="adjoint")  # compiles
    times, ratios = [], []
    for _ in range(rounds):
        begin = time.perf_counter()
        motion = analysis.run(model)
        middle = time.perf_counter()
        da.sensitivity(motion, HEIGHT, method="adjoint")
        end = time.perf_counter()
        times.append(end - begin)
        ratios.append((end - begin) / (middle - begin))
    return times, ratios


CASE = Case("gradients", "adjoint of chains of four-bars, beside differences", measure)
