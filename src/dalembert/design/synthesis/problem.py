"""The nonlinear programme that polishes a linkage, its derivatives exact.

Crank, coupler and output at every entry of the target are variables and the loop is an equation,
so that a linkage may be open on the way. The sign of the sine of the transmission angle keeps the
branch, and with it, where the crank turns all the way, the circuit; angles of the crank that grow
keep the order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.atlas import Start
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.target import Target
from dalembert.interrupts import check_ctrl_c

QUIET: dict[str, Any] = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes"}
APART = 1e-3
"""Least turn of the crank between entries [rad]."""
HELD = 1e-8
"""Violation of equations and limits, in the size of the target, that counts as none."""


@dataclass(frozen=True, eq=False)
class Polish:
    """Least squares over the dimensions of a linkage, within limits.

    Parameters
    ----------
    kind, target : what is sought
    bounds : dimension → lower, upper; equal ends hold it
    crank_turns : the crank turns all the way
    transmission : least transmission angle [rad]
    order : entries are passed in their order
    """

    kind: type[Linkage]
    target: Target
    bounds: Mapping[str, tuple[float, float]]
    crank_turns: bool
    transmission: float
    order: bool
    max_iterations: int = 300
    _parts: dict[str, Any] = field(default_factory=dict)

    @property
    def free_timing(self) -> bool:
        return self.target.crank_angles is None

    @property
    def _given(self) -> np.ndarray:
        assert self.target.crank_angles is not None
        return self.target.crank_angles

    @cached_property
    def solver(self) -> ca.Function:
        n = len(self.target)
        q = {name: ca.SX.sym(name) for name in self.kind.names()}
        theta = ca.SX.sym("theta", n if self.free_timing else 1)
        phi, output = ca.SX.sym("phi", n), ca.SX.sym("output", n)
        turned, start = ca.SX.sym("turned"), ca.SX.sym("start")
        branch, sense = ca.SX.sym("branch"), ca.SX.sym("sense")
        crank = theta if self.free_timing else theta + self._given
        x = ca.vertcat(*q.values(), theta, phi, output, turned, start)
        limits = [branch * self.kind.transmission_sine(q, phi, output) - self._least]
        if self.order and self.free_timing:
            limits.append(sense * ca.diff(theta) - APART)
            limits.append(2 * math.pi - APART - sense * (theta[-1] - theta[0]))
        if self.crank_turns:
            limits += self.kind.turns(q, max(self.transmission, 1e-3))
        equations = ca.vertcat(*self.kind.closure(q, crank, phi, output))
        inequalities = ca.vertcat(*limits)
        self._parts.update(equations=equations.numel(), limits=inequalities.numel())
        problem = {
            "x": x,
            "p": ca.vertcat(branch, sense),
            "f": self._distance(q, crank, phi, output, turned, start),
            "g": ca.vertcat(equations, inequalities),
        }
        own: dict[str, Any] = {
            "ipopt.max_iter": self.max_iterations,
            "ipopt.tol": 1e-10,
            "error_on_fail": False,
        }
        return ca.nlpsol("polish", "ipopt", problem, QUIET | own)

    @property
    def _least(self) -> float:
        return math.sin(max(self.transmission, 1e-3))

    def _distance(
        self, q: Any, crank: ca.SX, phi: ca.SX, output: ca.SX, turned: ca.SX, start: ca.SX
    ) -> ca.SX:
        """Sum of squares; angles count as lengths on a circle of unit radius."""
        target, total = self.target, ca.SX(0)
        if target.points is not None:
            c, s = ca.cos(phi), ca.sin(phi)
            x = q["x"] + q["crank"] * ca.cos(crank) + q["u"] * c - q["v"] * s
            y = q["y"] + q["crank"] * ca.sin(crank) + q["u"] * s + q["v"] * c
            total += ca.sumsqr(x - target.points[:, 0]) + ca.sumsqr(y - target.points[:, 1])
        if target.coupler_angles is not None:
            total += ca.sumsqr(phi - turned - target.coupler_angles)
        if target.outputs is not None:
            total += ca.sumsqr(output - start - target.outputs)
        return total

    def _holds(self, g: ca.DM) -> bool:
        """Whether equations and limits hold where a search has come to no end.

        A target may be met better and better by ever longer links; what was reached is a linkage.
        """
        left, count = g.full().ravel(), self._parts["equations"]
        return bool(np.all(abs(left[:count]) < HELD) and np.all(left[count:] > -HELD))

    def __call__(self, start: Start) -> tuple[Linkage, np.ndarray] | None:
        """The linkage that the programme leads to, and its crank angles; None where it fails."""
        guess, target = start.linkage, self.target
        solver, n = self.solver, len(target)
        phi, output = guess.loop(guess.numbers, guess.branch, start.theta)
        phi = np.unwrap(np.nan_to_num(phi))
        output = np.nan_to_num(output)
        output = np.unwrap(output) if self.kind.output_is_angle else output
        turned = 0.0 if target.coupler_angles is None else np.mean(phi - target.coupler_angles)
        begin = 0.0 if target.outputs is None else np.mean(output - target.outputs)
        names = self.kind.names()
        ends = np.array([self.bounds[name] for name in names], dtype=float)
        q0 = np.clip([guess.numbers[name] for name in names], ends[:, 0], ends[:, 1])
        theta = start.theta if self.free_timing else start.theta[:1] - self._given[0]
        x0 = np.concatenate([q0, theta, phi, output, [turned, begin]])
        away = np.full(x0.size - len(names), np.inf)
        found = solver(
            x0=x0,
            p=[guess.branch, start.sense],
            lbx=np.concatenate([ends[:, 0], -away]),
            ubx=np.concatenate([ends[:, 1], away]),
            lbg=0.0,
            ubg=np.concatenate(
                [np.zeros(self._parts["equations"]), np.full(self._parts["limits"], np.inf)]
            ),
        )
        check_ctrl_c()  # Ipopt ends without an exception
        x = np.array(found["x"]).ravel()
        if not np.all(np.isfinite(x)) or not (solver.stats()["success"] or self._holds(found["g"])):
            return None
        made = dict(zip(names, x[: len(names)].tolist(), strict=True))
        crank = x[len(names) :][: n if self.free_timing else 1]
        crank = crank if self.free_timing else crank + self._given
        return self.kind(**made, branch=guess.branch), crank
