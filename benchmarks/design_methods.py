"""What gradients save: runs of a mechanism with twenty parameters until one optimum.

A planar arm of ten links reaches a place with least bend and size; the same search with exact
gradients, with differences, and by evolution, which is stopped within a part in a hundred of the
optimum, or after a hundred times the analyses.

    python benchmarks/design_methods.py
"""

from __future__ import annotations

import math
import time
from importlib.util import find_spec

import dalembert as da
from dalembert import planar

N = 10


def arm() -> da.Model:
    system = da.System("arm")
    before = system.ground.point(0, 0)
    for k in range(N):
        length = system.parameter(f"l{k}", 0.2, "m", bounds=(0.05, 0.5))
        angle = system.parameter(f"a{k}", 0.1 * k, "rad", bounds=(-1.5, 1.5))
        place = (0.2 * sum(math.cos(0.1 * j) for j in range(k)) + 0.1, 0.3)
        link = system.add(planar.Bar(f"link{k}", length=length, position=place, angle=angle))
        system.add(planar.Revolute(f"J{k}", before, link.start))
        system.add(planar.RotationalDriver(f"motor{k}", system.ground, link, angle))
        before = link.end
    return system.build()


def task() -> dict:
    last = f"link{N - 1}.end"
    bend = " + ".join(f"(a{k} - a{k - 1})**2" for k in range(1, N))
    size = " + ".join(f"l{k}" for k in range(N))
    miss = f"1e3*(({last}.x - 1.2)**2 + ({last}.y - 0.9)**2)"
    goal = da.final(f"{bend} + 0.1*({size}) + {miss}", name="bend, size and miss")
    return {"minimize": goal, "analysis": da.Kinematics(t_span=(0.0, 1e-3), outputs=2)}


def squares() -> da.SumOfSquares:
    """The same objective as a sum of squares, for least squares."""
    last, names = f"link{N - 1}.end", range(N)
    rows = [f"a{k} - a{k - 1}" for k in names[1:]] + [f"sqrt(0.1*l{k})" for k in names]
    rows += [f"sqrt(1e3)*({last}.x - 1.2)", f"sqrt(1e3)*({last}.y - 0.9)"]
    return da.SumOfSquares([da.final(row, name=f"r{k}") for k, row in enumerate(rows)])


class Counted:
    """Counts the analyses, whoever asks for them; stops a search that has had its share."""

    def __init__(self, most: int) -> None:
        self.count, self.most = 0, most
        self.honest = {name: getattr(da.Kinematics, name) for name in ("run", "replay")}
        for name, method in self.honest.items():
            setattr(da.Kinematics, name, self._counting(method))

    def _counting(self, method):
        def called(analysis, *given, **options):
            self.count += 1
            if self.count == self.most + 1:
                raise KeyboardInterrupt
            return method(analysis, *given, **options)

        return called


def main(most: int = 10_000) -> None:
    counted, model = Counted(most), arm()

    def search(name: str, **options) -> da.OptimizationResult:
        counted.count, begun = 0, time.perf_counter()
        best = da.optimize(model, **(task() | options))
        spent = time.perf_counter() - begun
        print(f"{name:24} {best.fun:.8f}  {counted.count:6} analyses  {spent:6.1f} s", flush=True)
        return best

    exact = search("exact gradients", tolerance=1e-10)
    squared = {"minimize": squares(), "method": "least-squares"}
    search("least squares", tolerance=1e-10, **squared)
    search("differences", tolerance=1e-10, gradient="finite-difference")

    def near(number: int, objective: float) -> None:
        if objective < 1.01 * exact.fun:
            raise KeyboardInterrupt

    evolution = da.DifferentialEvolution(population=5, generations=10_000, polish=None)
    search("differential evolution", method=evolution, progress=near)
    if find_spec("cma") is not None:
        strategy = da.CMAES(generations=10_000, polish=None)
        search("CMA-ES", method=strategy, progress=near)
    if find_spec("pymoo") is not None:
        genetic(counted, model, 1.01 * exact.fun)


def genetic(counted: Counted, model: da.Model, enough: float) -> None:
    """pymoo's genetic algorithm as it comes, a hundred designs in a generation."""
    from pymoo.algorithms.soo.nonconvex.ga import GA

    asked, counted.count, begun = task(), 0, time.perf_counter()
    problem = da.pymoo_problem(model, [asked["minimize"]], analysis=asked["analysis"])
    search, best = GA(pop_size=100), math.inf
    search.setup(problem, termination=("n_gen", counted.most), seed=0, verbose=False)
    try:
        while best > enough:
            search.next()
            best = float(search.opt[0].F[0])
    except KeyboardInterrupt:
        pass
    spent = time.perf_counter() - begun
    print(f"{'genetic algorithm':24} {best:.8f}  {counted.count:6} analyses  {spent:6.1f} s")


if __name__ == "__main__":
    main()
