"""Time per step and design when several designs of N four-bars march side by side.

RK4, range space and projection as in ``mechanisms.py``; one call for one design beside one call for
several, each lane of the processor with one of them. Numbers agree to the last
digits of sines and cosines.

    python -m benchmarks.lanes
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from collections.abc import Callable

import numpy as np

import dalembert as da
from benchmarks.mechanisms import four_bars
from benchmarks.solvers import ours
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.evaluation.lanes import LaneColumns
from dalembert.symbolic.native.llvm import lane_count

STEPS = 200
LANES = lane_count()


def best(call: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        times.append(time.perf_counter() - begin)
    return min(times) / STEPS


def measured(count: int, repeats: int) -> None:
    model = ours.build(four_bars(count)[0])
    kernel = da.Dynamics(1.0, step=1e-3).kernel(model)
    x, mode = kernel.initial(model.start, 0.0, model.nominal)
    step = kernel.fixed.marched(mode).forms
    q = step.values(model.nominal).full().ravel()
    begin = time.perf_counter()
    lanes = LaneColumns(step.called or step.function, True, (4,))
    assert lanes.side_by_side is not None
    compiled = time.perf_counter() - begin
    alone = BACKENDS["jit"]().columns(step.called or step.function, True, (4,))
    t, h, flag = 1e-3 * np.arange(STEPS), np.full(STEPS, 1e-3), np.ones(STEPS)
    xs, qs = np.tile(x, (LANES, 1)), np.tile(q, (LANES, 1))
    one = best(lambda: alone(STEPS, x, t, h, flag, q), repeats)
    side = best(lambda: lanes(STEPS, xs, t[None], h[None], flag[None], qs), repeats) / LANES
    print(f"{count:>4} {compiled:>13.2f} {one * 1e6:>11.2f} {side * 1e6:>16.2f} {one / side:>6.2f}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[1, 3, 10, 40])
    parser.add_argument("--repeats", type=int, default=15)
    options = parser.parse_args()
    print(f"time per step and design, {LANES} lanes")
    print(f"{'N':>4} {'compiled [s]':>13} {'alone [µs]':>11} {'in lanes [µs]':>16} {'ratio':>6}")
    with tempfile.TemporaryDirectory() as empty:
        os.environ["DALEMBERT_CACHE"] = empty
        for n in options.n:
            measured(n, options.repeats)
