"""Dimensional synthesis of any driven mechanism for a path, poses or a function.

Positions at the entries of the target are unknowns in addition to the parameters, and the joints
are equality constraints, so that a mechanism may be open during the search. Every solution is
verified by a run over one revolution, on one branch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.synthesis.linkage_fit import QUIET
from dalembert.design.synthesis.mechanism_task import (
    MAX_DRAWS,
    SAMPLES,
    MechanismTask,
    mechanism_task,
)
from dalembert.design.synthesis.starts import check_starts, no_convergence
from dalembert.design.synthesis.synthesis_result import MechanismSolution, MechanismSynthesisResult
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError
from dalembert.interrupts import check_ctrl_c, interruptible, searching
from dalembert.model.graph.model import Model
from dalembert.options import random_generator
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import stack

POSITIONS = 24
"""Number of positions per revolution at which the joints are closed."""
MAX_ITERATIONS = 300
"""Upper limit of iterations of Ipopt."""


@interruptible
def synthesize_mechanism(
    target: Target,
    model: Model,
    *,
    point: str = "",
    body: str = "",
    output: str = "",
    vary: Sequence[str] | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    speed: float = 1.0,
    order: bool = True,
    starts: int = 8,
    rng: int | None = 0,
    progress: Reported = False,
) -> MechanismSynthesisResult:
    """Parameters of a mechanism of any topology for a path, a motion or a function.

    Least squares by Ipopt with exact derivatives, from the model itself and from random mechanisms
    with fully rotating motors; every solution is verified by a run over one revolution. Ctrl-C
    returns the solutions computed so far.

    Parameters
    ----------
    target : ``Target.path``, ``Target.motion`` or ``Target.function``
    model : driven by one motor of constant speed, such as ``da.six_bar(...).build()``
    point, body, output : names of the model for the target: a point, the guided body, an angle or a
        displacement
    vary, bounds : varied parameters, by default all with two bounds
    speed : of the motor [rad/s]
    order : for free timing, the entries are passed in their order
    starts : number of optimised starts, the model itself first
    progress : True for a bar, or a function of the fraction done
    rng : seed of the starts

    Raises
    ------
    AnalysisError
        A measure that the target needs is missing, a parameter has no bounds, or no start converges
        to a mechanism with a fully rotating motor.

    Examples
    --------
    >>> import dalembert as da
    >>> chain = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}
    >>> joints = {"A": (0, 0), "B": (0, 1), "C": (3, 2.5), "D": (3, 0)}
    >>> tip = {"coupler": {"P": (1.5, 3)}}
    >>> system = da.linkage_from_chain(chain, joints, "frame", "crank", tip, reach=0.5)
    >>> aim = da.Target.path([(1.5, 3.0), (1.0, 3.1), (0.5, 3.0)])
    >>> result = da.synthesize_mechanism(aim, system.build(), point="coupler.P", starts=1)
    >>> result.best.error < 1e-12  # it passes the three points
    True
    """
    check_starts(starts)
    task = mechanism_task(target, model, point, body, output, vary, bounds, speed, order)
    search, solutions, attempts, done = MechanismSearch(task), list[MechanismSolution](), 0, 0
    generator = random_generator(rng)
    with progress_reporter(progress, "mechanisms") as report:
        try:
            with searching():
                for k in range(starts):
                    start = _start(task, generator, k)
                    solution = None if start is None else search.solve(*start)
                    attempts += start is not None
                    solutions += [] if solution is None else [solution]
                    done += 1
                    report(done / starts)
        except KeyboardInterrupt:
            if not solutions:
                raise
    if not solutions:
        failed = f"{no_convergence(attempts)} to a mechanism with a fully rotating motor"
        if not attempts:
            failed = f"no mechanism of {starts * MAX_DRAWS} random ones has a fully rotating motor"
        raise AnalysisError(f"{failed}; give more starts, or a model closer to the target")
    solutions.sort(key=lambda solution: solution.error)
    return MechanismSynthesisResult(
        target,
        _distinct(solutions),
        attempts,
        str(model.name),
        interrupted=done < starts,
        planned=starts,
    )


def _start(
    task: MechanismTask, rng: np.random.Generator, k: int
) -> tuple[np.ndarray, Motion] | None:
    """The model itself first, if its motor rotates fully; then random mechanisms."""
    nominal = np.array([task.model.parameters[n].value for n in task.vary])
    run = task.run_revolution(nominal) if k == 0 else None
    return task.draw(rng) if run is None else (nominal, run)


def _distinct(solutions: list[MechanismSolution]) -> list[MechanismSolution]:
    distinct: list[MechanismSolution] = []
    for solution in solutions:
        values = list(solution.parameters.values())
        if not any(
            np.allclose(values, list(other.parameters.values()), rtol=1e-4, atol=1e-6)
            for other in distinct
        ):
            distinct.append(solution)
    return distinct


@dataclass(frozen=True, eq=False)
class MechanismSearch:
    """Local search from mechanisms with fully rotating motors."""

    task: MechanismTask

    @cached_property
    def programme(self) -> tuple[ca.Function, int, int]:
        """Solver, number of equations, and number of limits."""
        e, n = self.task.model.equations, len(self.task.target)
        q = stack(self.task.model.parameters[name].sx for name in self.task.vary)
        order = list(self.task.model.parameters)
        fixed = [k for k in range(e.p.numel()) if k not in {order.index(v) for v in self.task.vary}]
        fixed_values = e.p[fixed, :], ca.SX(self.task.model.nominal[fixed])
        measures = stack(self.task.model.expression(m).sx for m in self.task.measures.values())
        rows = [ca.substitute(part, *fixed_values) for part in (e.constraints, measures)]
        at = ca.Function("at", [e.t, e.y, q], rows, {"cse": True})
        start, y = (
            ca.SX.sym("start", n if self.task.free_timing else 1),
            ca.SX.sym("y", e.y.numel(), n),
        )
        path, origins = ca.SX.sym("path", e.y.numel(), POSITIONS), ca.SX.sym("origins", 2)
        times = start if self.task.free_timing else start + self.task.entry_times
        closures, outputs = zip(*(at(times[k], y[:, k], q) for k in range(n)), strict=True)
        path_closures = [
            at(k * self.task.period / POSITIONS, path[:, k], q)[0] for k in range(POSITIONS)
        ]
        measured = dict(zip(self.task.measures, ca.vertsplit(ca.horzcat(*outputs)), strict=True))
        origin_values = {"angle": origins[0], "output": origins[1]}
        f = self.task.squared_error({k: v.T for k, v in measured.items()}, origin_values, ca.sumsqr)
        equations = ca.vertcat(*closures, *path_closures)
        limits = []
        if self.task.order and self.task.free_timing:
            limits = [ca.diff(times) - 1e-3, self.task.period - 1e-3 - (times[-1] - times[0])]
        inequalities = ca.vertcat(*limits) if limits else ca.SX(0, 1)
        x = ca.vertcat(q, start, ca.vec(y), ca.vec(path), origins)
        settings = QUIET | {
            "ipopt.max_iter": MAX_ITERATIONS,
            "ipopt.tol": 1e-10,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        problem = {"x": x, "f": f, "g": ca.vertcat(equations, inequalities)}
        solver = ca.nlpsol("mechanism", "ipopt", problem, settings)
        return solver, equations.numel(), inequalities.numel()

    def entry_candidates(self, run: Motion) -> list[tuple[float, np.ndarray]]:
        """Assignments of entries to positions of a revolution, as error and indices, sorted."""
        rows = {name: run.values(m)[:-1] for name, m in self.task.measures.items()}
        n, candidates = len(self.task.target), []
        if self.task.free_timing:
            even = np.arange(n) / (n if self.task.target.closed else max(n - 1, 1))
            lengths = (1.0,) if self.task.target.closed else (0.1, 0.2, 0.35, 0.5, 0.65, 0.8)
            patterns = [sense * even * length for length in lengths for sense in (1, -1)]
        else:
            patterns = [self.task.entry_times / self.task.period]
        for pattern in patterns:
            if self.task.order and pattern[-1] < pattern[0]:
                continue
            for first in np.arange(0, SAMPLES, 4):
                indices = first + np.rint(pattern * SAMPLES).astype(int)
                sampled = {name: values[indices % SAMPLES] for name, values in rows.items()}
                origins = self.task.origins(sampled)
                candidates.append(
                    (
                        float(self.task.squared_error(sampled, origins, lambda z: np.sum(z**2))),
                        indices,
                    )
                )
        return sorted(candidates, key=lambda entry: entry[0])

    def solve(self, q: np.ndarray, run: Motion) -> MechanismSolution | None:
        """The optimised mechanism from an initial one; None if it fails."""
        solver, equations, limits = self.programme
        _, indices = self.entry_candidates(run)[0]
        y, step = run.trajectory.y, self.task.period / SAMPLES
        times = indices * step if self.task.free_timing else indices[:1] * step
        rows = {
            name: run.values(m)[:-1][indices % SAMPLES] for name, m in self.task.measures.items()
        }
        origins = self.task.origins(rows)
        path = y[:, : SAMPLES : SAMPLES // POSITIONS]
        x0 = np.concatenate(
            [
                q,
                times,
                y[:, indices % SAMPLES].ravel(order="F"),
                path.ravel(order="F"),
                [origins["angle"], origins["output"]],
            ]
        )
        infinity = np.full(x0.size - q.size, np.inf)
        result = solver(
            x0=x0,
            lbx=np.concatenate([self.task.bounds[:, 0], -infinity]),
            ubx=np.concatenate([self.task.bounds[:, 1], infinity]),
            lbg=0.0,
            ubg=np.concatenate([np.zeros(equations), np.full(limits, np.inf)]),
        )
        check_ctrl_c()  # Ipopt returns without an exception
        x = np.array(result["x"]).ravel()
        if not np.all(np.isfinite(x)):
            return None
        start = x[q.size : q.size + times.size]
        return self._verify(
            x[: q.size], start if self.task.free_timing else start + self.task.entry_times
        )

    def _verify(self, q: np.ndarray, times: np.ndarray) -> MechanismSolution | None:
        """Verify a solution by a run over one revolution; None if the run fails."""
        revolution = self.task.run_revolution(q)
        if revolution is None:
            return None
        wrapped = np.mod(times, self.task.period)
        run = revolution.at(np.clip(wrapped, 0.0, self.task.period))
        error, distances = self.task.distance(run)
        values = dict(zip(self.task.vary, map(float, q), strict=True))
        angles = times * self.task.speed
        return MechanismSolution(
            values, angles, error, distances, revolution, run, self.task.measures
        )
