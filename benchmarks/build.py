"""Seconds of ``build()`` for mechanisms of up to a thousand bodies and more, and how they grow.

Families: closed chains of four-bars (2 N + 1 bodies in N loops) and open chains of bars, both with
every pose given and with angles only, so that positions have to be found through the joints. Every
length and mass is a parameter. The processor's time of this process is counted, on one thread;
``describe`` is what the elements of the mechanism take to be made, before ``build()``.

    python benchmarks/build.py
"""

from __future__ import annotations

import argparse
import math
import os
import time
from collections.abc import Callable

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

import dalembert as da
from dalembert import planar


def four_bars(bodies: int, positions: bool) -> da.System:
    """N vertical cranks, 1 m apart, with couplers between their tops."""
    system = da.System("four-bars", gravity=(0.0, -9.81))
    last = None
    for i in range((bodies + 1) // 2):
        crank = bar(system, f"c{i}", math.pi / 2, (i, 0.5) if positions else None)
        system.add(planar.Revolute(f"O{i}", system.ground.point(i, 0.0), crank.start))
        if last is not None:
            coupler = bar(system, f"b{i}", 0.0, (i - 0.5, 1.0) if positions else None)
            system.add(planar.Revolute(f"A{i}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{i}", coupler.end, crank.end))
        last = crank
    return system


def open_chain(bodies: int, positions: bool) -> da.System:
    """Bars of 1 m, each pinned to the end of the one before, along a bow."""
    system = da.System("chain", gravity=(0.0, -9.81))
    last, corner = system.ground.center, np.zeros(2)
    for k, angle in enumerate(np.linspace(-0.5, -2.0, bodies)):
        along = np.array([math.cos(angle), math.sin(angle)])
        rod = bar(system, f"b{k}", angle, tuple(corner + along / 2) if positions else None)
        system.add(planar.Revolute(f"R{k}", last, rod.start))
        last, corner = rod.end, corner + along
    return system


def bar(system: da.System, name: str, angle: float, position: tuple | None) -> planar.Bar:
    length, mass = system.parameter(f"l_{name}", 1.0), system.parameter(f"m_{name}", 1.0)
    where = {} if position is None else {"position": position}
    return system.add(planar.Bar(name, length=length, mass=mass, angle=float(angle), **where))


FAMILIES: dict[str, Callable[[int], da.System]] = {
    "four-bars, every pose given": lambda n: four_bars(n, True),
    "four-bars, angles given": lambda n: four_bars(n, False),
    "open chain, every pose given": lambda n: open_chain(n, True),
    "open chain, angles given": lambda n: open_chain(n, False),
}


def timed(call: Callable[[], object]) -> tuple[float, object]:
    begin = time.process_time()
    made = call()
    return time.process_time() - begin, made


def exponent(counts: list[int], times: list[float]) -> float:
    """Slope of the straight line through the logarithms."""
    return float(np.polyfit(np.log(counts), np.log(times), 1)[0])


def main(counts: list[int], repeats: int) -> None:
    describe: dict[str, list[float]] = {name: [] for name in FAMILIES}
    build: dict[str, list[float]] = {name: [] for name in FAMILIES}
    for name, family in FAMILIES.items():
        for count in counts:
            runs = []
            for _ in range(repeats):
                made, system = timed(lambda n=count, f=family: f(n))
                runs.append((timed(system.build)[0], made))
            build[name].append(min(seconds for seconds, _ in runs))
            describe[name].append(min(seconds for _, seconds in runs))
    for title, rows in (("describe [s]", describe), ("build() [s]", build)):
        print(f"\n{title:30}" + "".join(f"{f'N = {n}':>10}" for n in counts) + f"{'exponent':>10}")
        for name, times in rows.items():
            growth = f"{exponent(counts, times):10.2f}" if len(counts) > 1 else ""
            print(f"{name:30}" + "".join(f"{t:10.2f}" for t in times) + growth)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[125, 250, 500, 1000])
    parser.add_argument("--repeats", type=int, default=2)
    options = parser.parse_args()
    main(options.n, options.repeats)
