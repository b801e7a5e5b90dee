"""Synthesis of any mechanism with a motor: its parameters from a path, poses or a function.

Positions at the entries of the target are unknowns beside the parameters, and the joints are
equations, so that a mechanism may be open on the way to the solution. What is found is run through
a whole turn: it has to meet the entries there, on one branch.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.found_mechanism import FoundMechanism
from dalembert.design.synthesis.mechanism_task import SAMPLES, MechanismTask
from dalembert.interrupts import check_ctrl_c
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import stack

WAY = 24
"""Positions of a turn at which the joints stay closed."""
ITERATIONS = 300
"""Of Ipopt at most."""


@dataclass(frozen=True, eq=False)
class MechanismSearch:
    """From mechanisms that turn to those that do the task."""

    task: MechanismTask

    @cached_property
    def programme(self) -> tuple[ca.Function, int, int]:
        """Solver, and numbers of equations and of limits."""
        e, n = self.task.model.equations, len(self.task.target)
        q = stack(self.task.model.parameters[name].sx for name in self.task.vary)
        order = list(self.task.model.parameters)
        fixed = [k for k in range(e.p.numel()) if k not in {order.index(v) for v in self.task.vary}]
        known = e.p[fixed, :], ca.SX(self.task.model.nominal[fixed])
        asked = stack(self.task.model.expression(m).sx for m in self.task.measures.values())
        rows = [ca.substitute(part, *known) for part in (e.constraints, asked)]
        at = ca.Function("at", [e.t, e.y, q], rows, {"cse": True})
        begin, y = (
            ca.SX.sym("begin", n if self.task.free_timing else 1),
            ca.SX.sym("y", e.y.numel(), n),
        )
        way, turned = ca.SX.sym("way", e.y.numel(), WAY), ca.SX.sym("turned", 2)
        times = begin if self.task.free_timing else begin + self.task.given
        closed, seen = zip(*(at(times[k], y[:, k], q) for k in range(n)), strict=True)
        along = [at(k * self.task.period / WAY, way[:, k], q)[0] for k in range(WAY)]
        measured = dict(zip(self.task.measures, ca.vertsplit(ca.horzcat(*seen)), strict=True))
        free = {"angle": turned[0], "output": turned[1]}
        f = self.task.off({k: v.T for k, v in measured.items()}, free, ca.sumsqr)
        equations = ca.vertcat(*closed, *along)
        limits = []
        if self.task.order and self.task.free_timing:
            limits = [ca.diff(times) - 1e-3, self.task.period - 1e-3 - (times[-1] - times[0])]
        inequalities = ca.vertcat(*limits) if limits else ca.SX(0, 1)
        x = ca.vertcat(q, begin, ca.vec(y), ca.vec(way), turned)
        settings: dict[str, Any] = {
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.max_iter": ITERATIONS,
            "ipopt.tol": 1e-10,
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
        }
        problem = {"x": x, "f": f, "g": ca.vertcat(equations, inequalities)}
        solver = ca.nlpsol("polish", "ipopt", problem, settings)
        return solver, equations.numel(), inequalities.numel()

    def begun(self, run: Motion) -> list[tuple[float, np.ndarray]]:
        """Where the entries may lie on a turn: error and numbers of its positions, best first."""
        rows = {name: run.values(m)[:-1] for name, m in self.task.measures.items()}
        n, found = len(self.task.target), []
        if self.task.free_timing:
            even = np.arange(n) / (n if self.task.target.closed else max(n - 1, 1))
            pieces = (1.0,) if self.task.target.closed else (0.1, 0.2, 0.35, 0.5, 0.65, 0.8)
            ways = [sense * even * piece for piece in pieces for sense in (1, -1)]
        else:
            ways = [self.task.given / self.task.period]
        for way in ways:
            if self.task.order and way[-1] < way[0]:
                continue
            for first in np.arange(0, SAMPLES, 4):
                places = first + np.rint(way * SAMPLES).astype(int)
                there = {name: values[places % SAMPLES] for name, values in rows.items()}
                free = self.task.counted_from(there)
                found.append((float(self.task.off(there, free, lambda z: np.sum(z**2))), places))
        return sorted(found, key=lambda one: one[0])

    def solved(self, q: np.ndarray, run: Motion) -> FoundMechanism | None:
        """The mechanism that the programme leads to from one that turns; None where it fails."""
        solver, equations, limits = self.programme
        _, places = self.begun(run)[0]
        y, step = run.trajectory.y, self.task.period / SAMPLES
        times = places * step if self.task.free_timing else places[:1] * step
        rows = {
            name: run.values(m)[:-1][places % SAMPLES] for name, m in self.task.measures.items()
        }
        free = self.task.counted_from(rows)
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
            lbx=np.concatenate([self.task.bounds[:, 0], -away]),
            ubx=np.concatenate([self.task.bounds[:, 1], away]),
            lbg=0.0,
            ubg=np.concatenate([np.zeros(equations), np.full(limits, np.inf)]),
        )
        check_ctrl_c()  # Ipopt ends without an exception
        x = np.array(found["x"]).ravel()
        if not np.all(np.isfinite(x)):
            return None
        begin = x[q.size : q.size + times.size]
        return self._checked(
            x[: q.size], begin if self.task.free_timing else begin + self.task.given
        )

    def _checked(self, q: np.ndarray, times: np.ndarray) -> FoundMechanism | None:
        """What is found, by a run of its own."""
        whole = self.task.turned(q)
        if whole is None:
            return None
        inside = np.mod(times, self.task.period)
        run = whole.at(np.clip(inside, 0.0, self.task.period))
        error, distances = self.task.distance(run)
        values = dict(zip(self.task.vary, map(float, q), strict=True))
        angles = times * self.task.speed
        return FoundMechanism(values, angles, error, distances, whole, run, self.task.measures)
