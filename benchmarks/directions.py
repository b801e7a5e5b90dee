"""Direct gradients of rows of four-bars by more and more parameters, in plain runs.

RK4, range space and projection as in ``mechanisms.py``, by LLVM, with directions in lanes and
without. Processor time, the least of several rounds.

    python -m benchmarks.directions
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from unittest.mock import patch

import dalembert as da
from benchmarks.mechanisms import four_bars
from benchmarks.solvers import ours
from dalembert.symbolic.evaluation.lane_tangents import LaneTangents

HEIGHT = da.final("b0.seen.y")
DURATION = 0.5
NUMBERS = (1, 2, 4, 8, 16, 32, 64)


def best(call: Callable[[], object], repeats: int) -> float:
    call()
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        call()
        times.append(time.process_time() - begin)
    return min(times)


def measured(count: int, repeats: int) -> None:
    model, steps = ours.build(four_bars(count)[0]), max(500, 4000 // count)
    analysis = da.Dynamics(DURATION, step=DURATION / steps, outputs=[DURATION], backend="jit")
    motion, names = analysis.run(model), list(model.parameters)
    run = best(lambda: analysis.run(model), repeats)
    numbers = sorted({n for n in NUMBERS if n <= len(names)} | {min(len(names), 64)})

    def told(few: int) -> list[float]:
        return [
            best(partial(da.sensitivity, motion, HEIGHT, names[:n], "direct"), repeats) / run
            for n in numbers[:few]
        ]

    lanes = told(len(numbers))
    with patch.object(LaneTangents, "of", lambda *given: None):
        alone = told(5)
    for name, ratios in (("in lanes", lanes), ("one by one", alone)):
        spread = max(1, numbers[len(ratios) - 1] - 1)
        further = (ratios[-1] - ratios[0]) / spread
        text = "".join(f"{n:>5}: {ratio:>5.2f}" for n, ratio in zip(numbers, ratios, strict=False))
        print(f"{count:>4} {name:<12} {1e3 * run:>8.1f} {further:>8.3f} {text}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[1, 3, 10, 40])
    parser.add_argument("--repeats", type=int, default=7)
    options = parser.parse_args()
    print(f"{'N':>4} {'':<12} {'run [ms]':>8} {'further':>8}  parameters: gradient in runs")
    with tempfile.TemporaryDirectory() as empty:
        os.environ["DALEMBERT_CACHE"] = empty
        for n in options.n:
            measured(n, options.repeats)
