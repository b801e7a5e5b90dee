"""Many designs of one four-bar at once: lanes and threads, beside one design after the other.

RK4 with range space and projection, 1,000 steps, lengths and masses drawn at random. ``one by one``
calls ``solve_dynamics`` for each design; ``without lanes`` is a batch in C with one thread;
``Exudyn`` integrates the same mechanism by its implicit generalized-α step, the solver alone.
All are told per design, after everything is compiled, with the time of the processors beside:
on a machine that does other things, too, that is the one to compare.

    pip install "dalembert[bench]" && python -m benchmarks.batches
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

import dalembert as da
from benchmarks.mechanisms import four_bars
from benchmarks.solvers import exudyn as peer, ours

RUN = {"duration": 1.0, "step": 1e-3, "outputs": 11}


def timed(call: Callable[[], object], designs: int, repeats: int) -> tuple[float, float]:
    """Milliseconds for a design, of the clock and of the processors: the best of some."""
    found = []
    for _ in range(repeats):
        begin, busy = time.perf_counter(), time.process_time()
        call()
        found.append((time.perf_counter() - begin, time.process_time() - busy))
    wall, cpu = (1e3 * min(column) / designs for column in zip(*found, strict=True))
    return wall, cpu


def drawn(model: da.Model, count: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    return {name: rng.uniform(0.95, 1.05, count) for name in model.parameters}


def measured(count: int, few: int, repeats: int, exudyn: bool) -> None:
    mechanism, _ = four_bars(1)
    model = ours.build(mechanism)
    designs, some = drawn(model, count), drawn(model, few)
    force = da.maximum("j0.force_norm")

    def single() -> None:
        for k in range(few):
            one = {name: float(column[k]) for name, column in some.items()}
            da.solve_dynamics(model, parameters=one, backend="jit", **RUN)

    def batch(workers: int, backend: str = "jit") -> da.Batch:
        return da.solve_dynamics(model, parameters=designs, workers=workers, backend=backend, **RUN)

    def gradients() -> None:
        da.sensitivity(batch_of_two, force, method="adjoint")

    da.solve_dynamics(model, parameters=some, backend="jit", **RUN)
    da.solve_dynamics(model, parameters=some, backend="c", **RUN)
    single()
    cases: dict[str, tuple[Callable[[], object], int]] = {
        "one by one": (single, few),
        "without lanes, 1 thread": (lambda: batch(1, "c"), count),
        "lanes, 1 thread": (lambda: batch(1), count),
        "lanes, 2 threads": (lambda: batch(2), count),
    }
    batch_of_two = da.solve_dynamics(model, parameters=some, backend="jit", workers=2, **RUN)
    gradients()
    batch_of_two = batch(2)
    print(batch_of_two, batch_of_two.statistics)
    cases["adjoint gradients, 2 threads"] = gradients, count
    if exudyn:
        peer.run(mechanism, 1.0, 100)
        cases["Exudyn, solver alone"] = (lambda: peer.run(mechanism, 1.0, 1000), 1)
    for name, (call, size) in cases.items():
        wall, cpu = timed(call, size, repeats)
        print(f"{name:<30} {wall:>10.3f} {cpu:>12.3f}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=10_000)
    parser.add_argument("--few", type=int, default=40)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--no-exudyn", action="store_true")
    options = parser.parse_args()
    print(f"{options.designs} designs; milliseconds for a design")
    print(f"{'':<30} {'clock':>10} {'processors':>12}")
    measured(options.designs, options.few, options.repeats, not options.no_exudyn)
