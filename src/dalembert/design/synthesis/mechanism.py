"""Synthesis of any mechanism with a motor: its parameters from a path, poses or a function.

Positions at the entries of the target are unknowns beside the parameters, and the joints are
equations, so that a mechanism may be open on the way to the solution. What is found is run through
a whole turn: it has to meet the entries there, on one branch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.kinematics import Kinematics
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError, DalembertError
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.symbolic.expression import stack
from dalembert.text.wording import unknown

SAMPLES = 144
"""Positions of a turn among which entries are looked for at first."""
WAY = 24
"""Positions of a turn at which the joints stay closed."""
DRAWS = 40
"""Random mechanisms tried for each one that turns."""
SAME = 1e-5
"""Distance, in natural sizes, up to which a run meets the positions that were found."""


@dataclass(frozen=True, eq=False)
class FoundMechanism:
    """A mechanism and how it meets the target.

    Attributes
    ----------
    parameters : name → value
    crank_angles : (n,) turned by the motor at the entries of the target
    error : sum of squares of what is in the target
    distances : (n,) of the points, or of the outputs
    motion : a turn of the motor
    """

    parameters: dict[str, float]
    crank_angles: np.ndarray
    error: float
    distances: np.ndarray
    motion: Motion


@dataclass(frozen=True, eq=False)
class MechanismTask:
    """What is sought of a mechanism.

    Parameters
    ----------
    model : driven Model
    target : Target
    measures : ``"x"``, ``"y"``, ``"angle"``, ``"output"`` → measure, as far as the target has it
    vary : parameters
    bounds : of them, in their order
    speed : of the motor [rad/s]
    order : free timing passes the entries in their order
    """

    model: Model
    target: Target
    measures: Mapping[str, str]
    vary: tuple[str, ...]
    bounds: np.ndarray
    speed: float
    order: bool
    max_iterations: int = 300

    @property
    def period(self) -> float:
        return 2 * math.pi / abs(self.speed)

    @property
    def free_timing(self) -> bool:
        return self.target.crank_angles is None

    # one turn ------------------------------------------------------------------------------
    def turned(self, q: np.ndarray, times: Any = SAMPLES + 1) -> Motion | None:
        """A turn of the motor with these parameters; None where it cannot be made."""
        try:
            run = Kinematics(self.period, outputs=times).run(
                self.model, dict(zip(self.vary, map(float, q), strict=True))
            )
        except DalembertError:
            return None
        return run if run.status.success else None

    def drawn(self, rng: np.random.Generator) -> tuple[np.ndarray, Motion] | None:
        """A random mechanism within the bounds whose motor turns all the way."""
        for _ in range(DRAWS):
            q = rng.uniform(self.bounds[:, 0], self.bounds[:, 1])
            made = self.turned(q)
            if made is not None:
                return q, made
        return None

    # distances -----------------------------------------------------------------------------
    def off(self, rows: Any, turned: Any, sums: Callable[[Any], Any]) -> Any:
        """Sum of squares of measures in rows, ``x, y, angle, output``, at the entries."""
        target, total = self.target, 0.0
        if target.points is not None:
            total = sums(rows["x"] - target.points[:, 0]) + sums(rows["y"] - target.points[:, 1])
        if target.coupler_angles is not None:
            total += sums(rows["angle"] - turned["angle"] - target.coupler_angles)
        if target.outputs is not None:
            total += sums(rows["output"] - turned["output"] - target.outputs)
        return total

    def _free(self, rows: Mapping[str, np.ndarray]) -> dict[str, float]:
        """From where angles and outputs are counted, as it suits them best."""
        aims = {"angle": self.target.coupler_angles, "output": self.target.outputs}
        return {
            name: float(np.mean(rows[name] - aim)) if aim is not None else 0.0
            for name, aim in aims.items()
        }

    def distance(self, run: Motion) -> tuple[float, np.ndarray]:
        """Error of a run at the entries, and the distances of points or outputs."""
        rows = {name: run.values(m) for name, m in self.measures.items()}
        for name in ("angle", "output"):
            if name in rows:
                rows[name] = np.unwrap(rows[name])
        free = self._free(rows)
        error = float(self.off(rows, free, lambda z: float(np.sum(np.square(z)))))
        if self.target.points is not None:
            two = np.array([rows["x"], rows["y"]]).T - self.target.points
            return error, np.linalg.norm(two, axis=1)
        assert self.target.outputs is not None
        return error, abs(rows["output"] - free["output"] - self.target.outputs)

    # the programme -------------------------------------------------------------------------
    @cached_property
    def programme(self) -> tuple[ca.Function, int, int]:
        """Solver, and numbers of equations and of limits."""
        e, n = self.model.equations, len(self.target)
        q = stack(self.model.parameters[name].sx for name in self.vary)
        order = list(self.model.parameters)
        fixed = [k for k in range(e.p.numel()) if k not in {order.index(v) for v in self.vary}]
        known = e.p[fixed, :], ca.SX(self.model.nominal[fixed])
        asked = stack(self.model.expression(m).sx for m in self.measures.values())
        rows = [ca.substitute(part, *known) for part in (e.constraints, asked)]
        at = ca.Function("at", [e.t, e.y, q], rows, {"cse": True})
        begin, y = ca.SX.sym("begin", n if self.free_timing else 1), ca.SX.sym("y", e.y.numel(), n)
        way, turned = ca.SX.sym("way", e.y.numel(), WAY), ca.SX.sym("turned", 2)
        times = begin if self.free_timing else begin + self._given
        closed, seen = zip(*(at(times[k], y[:, k], q) for k in range(n)), strict=True)
        along = [at(k * self.period / WAY, way[:, k], q)[0] for k in range(WAY)]
        measured = dict(zip(self.measures, ca.vertsplit(ca.horzcat(*seen)), strict=True))
        free = {"angle": turned[0], "output": turned[1]}
        f = self.off({k: v.T for k, v in measured.items()}, free, ca.sumsqr)
        equations = ca.vertcat(*closed, *along)
        limits = []
        if self.order and self.free_timing:
            limits = [ca.diff(times) - 1e-3, self.period - 1e-3 - (times[-1] - times[0])]
        inequalities = ca.vertcat(*limits) if limits else ca.SX(0, 1)
        x = ca.vertcat(q, begin, ca.vec(y), ca.vec(way), turned)
        settings: dict[str, Any] = {
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.max_iter": self.max_iterations,
            "ipopt.tol": 1e-10,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        problem = {"x": x, "f": f, "g": ca.vertcat(equations, inequalities)}
        solver = ca.nlpsol("polish", "ipopt", problem, settings)
        return solver, equations.numel(), inequalities.numel()

    @property
    def _given(self) -> np.ndarray:
        """Times of the entries from the first on."""
        angles = self.target.crank_angles
        assert angles is not None
        return (angles - angles[0]) / self.speed

    def begun(self, run: Motion) -> list[tuple[float, np.ndarray]]:
        """Where the entries may lie on a turn: error and numbers of its positions, best first."""
        rows = {name: run.values(m)[:-1] for name, m in self.measures.items()}
        n, found = len(self.target), []
        if self.free_timing:
            even = np.arange(n) / (n if self.target.closed else max(n - 1, 1))
            pieces = (1.0,) if self.target.closed else (0.1, 0.2, 0.35, 0.5, 0.65, 0.8)
            ways = [sense * even * piece for piece in pieces for sense in (1, -1)]
        else:
            ways = [self._given / self.period]
        for way in ways:
            if self.order and way[-1] < way[0]:
                continue
            for first in np.arange(0, SAMPLES, 4):
                places = first + np.rint(way * SAMPLES).astype(int)
                there = {name: values[places % SAMPLES] for name, values in rows.items()}
                free = self._free(there)
                found.append((float(self.off(there, free, lambda z: np.sum(z**2))), places))
        return sorted(found, key=lambda one: one[0])

    def solved(self, q: np.ndarray, run: Motion) -> FoundMechanism | None:
        """The mechanism that the programme leads to from one that turns; None where it fails."""
        solver, equations, limits = self.programme
        _, places = self.begun(run)[0]
        y, step = run.trajectory.y, self.period / SAMPLES
        times = places * step if self.free_timing else places[:1] * step
        rows = {name: run.values(m)[:-1][places % SAMPLES] for name, m in self.measures.items()}
        free = self._free(rows)
        way = y[:, : SAMPLES : SAMPLES // WAY]
        x0 = np.concatenate(
            [
                q,
                times,
                y[:, places % SAMPLES].ravel(order="F"),
                way.ravel(order="F"),
                [free["angle"], free["output"]],
            ]
        )
        away = np.full(x0.size - q.size, np.inf)
        found = solver(
            x0=x0,
            lbx=np.concatenate([self.bounds[:, 0], -away]),
            ubx=np.concatenate([self.bounds[:, 1], away]),
            lbg=0.0,
            ubg=np.concatenate([np.zeros(equations), np.full(limits, np.inf)]),
        )
        x = np.array(found["x"]).ravel()
        if not np.all(np.isfinite(x)):
            return None
        begin = x[q.size : q.size + times.size]
        return self._checked(x[: q.size], begin if self.free_timing else begin + self._given)

    def _checked(self, q: np.ndarray, times: np.ndarray) -> FoundMechanism | None:
        """What is found, by a run of its own."""
        whole = self.turned(q)
        if whole is None:
            return None
        inside = np.mod(times, self.period)
        run = whole.at(np.clip(inside, 0.0, self.period))
        error, distances = self.distance(run)
        values = dict(zip(self.vary, map(float, q), strict=True))
        return FoundMechanism(values, times * self.speed, error, distances, whole)


def mechanism_task(
    target: Target,
    model: Model,
    point: str,
    body: str,
    output: str,
    vary: Any,
    bounds: Mapping[str, tuple[float, float]] | None,
    speed: float,
    order: bool,
) -> MechanismTask:
    """The task, its names checked.

    Raises
    ------
    AnalysisError
        A parameter without two bounds, or a measure that the target needs and that is not named.
    """
    measures: dict[str, str] = {}
    for needed, given, what, made in (
        (target.points is not None, point, "point", {"x": f"{point}.x", "y": f"{point}.y"}),
        (target.coupler_angles is not None, body, "body", {"angle": f"{body}.angle"}),
        (target.outputs is not None, output, "output", {"output": output}),
    ):
        if needed and not given:
            raise AnalysisError(f"the target needs {what}=: name it, such as point='coupler.P'")
        measures |= made if needed else {}
    for measure in measures.values():
        model.expression(measure)
    names = (
        tuple(vary)
        if vary is not None
        else tuple(
            n
            for n, p in model.parameters.items()
            if np.all(np.isfinite((bounds or {}).get(n, p.bounds)))
        )
    )
    ends = []
    for name in names:
        if name not in model.parameters:
            raise AnalysisError(unknown("parameter", name, model.parameters))
        pair = (bounds or {}).get(name, model.parameters[name].bounds)
        if not np.all(np.isfinite(pair)):
            raise AnalysisError(f"synthesis needs two finite bounds of {name!r}; give bounds=")
        ends.append(pair)
    if not names:
        raise AnalysisError("nothing to vary: give parameters bounds, or vary= and bounds=")
    return MechanismTask(model, target, measures, names, np.array(ends, dtype=float), speed, order)
