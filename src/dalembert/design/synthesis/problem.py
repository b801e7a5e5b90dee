"""The nonlinear programme that polishes a linkage, its derivatives exact.

The loop is closed explicitly, so that only dimensions and crank angles are unknown; where it is
open, the nearest closed one stands for it. Coupler and output angles count from their means, which
solves for their starts. The branch is that of the start. Where the crank turns all the way, the
branch keeps the circuit; crank angles that increase keep the order.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.atlas import Start
from dalembert.design.synthesis.linkage import Direction, Linkage
from dalembert.design.synthesis.target import Target
from dalembert.interrupts import check_ctrl_c

QUIET: dict[str, Any] = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes"}
APART = 1e-3
"""Least turn of the crank between entries [rad]."""
ROUGH = 40
"""Iterations by which starts are compared."""
ALIKE = 1e-2
"""Relative difference of sums of squares up to which two starts count as one."""
HELD = 1e-8
"""Violation of limits, in the size of the target, that counts as none."""


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

    @property
    def free_timing(self) -> bool:
        return self.target.crank_angles is None

    @property
    def _given(self) -> np.ndarray:
        assert self.target.crank_angles is not None
        return self.target.crank_angles

    @cached_property
    def solver(self) -> ca.Function:
        """The programme."""
        return self._solver(self.max_iterations)

    @cached_property
    def rough(self) -> ca.Function:
        """The programme, ended after a few iterations."""
        return self._solver(ROUGH)

    def _solver(self, max_iterations: int) -> ca.Function:
        q = {name: ca.SX.sym(name) for name in self.kind.names()}
        theta = ca.SX.sym("theta", len(self.target) if self.free_timing else 1)
        branch, sense = ca.SX.sym("branch"), ca.SX.sym("sense")
        crank = theta if self.free_timing else theta + self._given
        limits = [] if self.crank_turns else self.kind.closes(q, crank, self._least)
        if self.order and self.free_timing:
            limits.append(sense * ca.diff(theta) - APART)
            limits.append(2 * math.pi - APART - sense * (theta[-1] - theta[0]))
        if self.crank_turns:
            limits += self.kind.turns(q, self._least)
        problem = {
            "x": ca.vertcat(*q.values(), theta),
            "p": ca.vertcat(branch, sense),
            "f": self._distance(q, branch, crank),
            "g": ca.vertcat(*limits),
        }
        own: dict[str, Any] = {
            "ipopt.max_iter": max_iterations,
            "ipopt.tol": 1e-10,
            "error_on_fail": False,
        }
        return ca.nlpsol("polish", "ipopt", problem, QUIET | own)

    @property
    def _least(self) -> float:
        return max(self.transmission, 1e-3)

    def _distance(self, q: Any, branch: ca.SX, crank: ca.SX) -> ca.SX:
        """Sum of squares; angles count as lengths on a circle of unit radius."""
        target, total = self.target, ca.SX(0)
        (c, s), output = self.kind.closed(q, branch, crank)
        if target.points is not None:
            x = q["x"] + q["crank"] * ca.cos(crank) + q["u"] * c - q["v"] * s
            y = q["y"] + q["crank"] * ca.sin(crank) + q["u"] * s + q["v"] * c
            total += ca.sumsqr(x - target.points[:, 0]) + ca.sumsqr(y - target.points[:, 1])
        if target.coupler_angles is not None:
            total += _scatter(_angles((c, s), target.coupler_angles))
        if target.outputs is not None:
            off = (
                _angles(output, target.outputs)
                if isinstance(output, tuple)
                else output - target.outputs
            )
            total += _scatter(off)
        return total

    def _value(self, x: np.ndarray, signs: list[int]) -> float:
        """The sum of squares; infinite where limits do not hold."""
        value, limits = (self.solver.get_function(f"nlp_{name}")(x, signs) for name in "fg")
        least = np.min(np.array(limits), initial=np.inf)
        return float(value) if np.isfinite(float(value)) and least >= -HELD else np.inf

    def selected(self, starts: list[Start], count: int) -> list[Start]:
        """The most promising starts, as they are after a few iterations."""
        if len(starts) <= count:
            return starts
        found = [one for one in (self._improved(start) for start in starts) if one is not None]
        found.sort(key=lambda one: one.distance)
        alike = [k for k in range(1, len(found)) if _alike(found[k], found[k - 1])]
        distinct = [one for k, one in enumerate(found) if k not in alike]
        return (distinct + [found[k] for k in alike])[:count]

    def _improved(self, start: Start) -> Start | None:
        ended = self(start, self.rough)
        if ended is None:
            return None
        linkage, theta = ended
        crank = theta if self.free_timing else theta[:1] - self._given[0]
        x = np.concatenate([list(linkage.numbers.values()), crank])
        value = self._value(x, [linkage.branch, start.sense])
        return Start(linkage, theta, start.sense, value)

    def __call__(
        self, start: Start, solver: ca.Function | None = None
    ) -> tuple[Linkage, np.ndarray] | None:
        """The linkage that the programme leads to, and its crank angles; None where it fails."""
        guess, solver = start.linkage, solver or self.solver
        names = self.kind.names()
        ends = np.array([self.bounds[name] for name in names], dtype=float)
        q0 = np.clip([guess.numbers[name] for name in names], ends[:, 0], ends[:, 1])
        theta = start.theta if self.free_timing else start.theta[:1] - self._given[0]
        away = np.full(theta.size, np.inf)
        begin, signs = np.concatenate([q0, theta]), [guess.branch, start.sense]
        found = solver(
            x0=begin,
            p=signs,
            lbx=np.concatenate([ends[:, 0], -away]),
            ubx=np.concatenate([ends[:, 1], away]),
            lbg=0.0,
            ubg=np.inf,
        )
        check_ctrl_c()  # Ipopt ends without an exception
        # a target may be met better and better by ever longer links: what is reached is a linkage;
        # a start that is an optimum already may be left for a worse one
        ended = np.array(found["x"]).ravel()
        x = min(ended, begin, key=lambda one: self._value(one, signs))
        if not np.isfinite(self._value(x, signs)):
            return None
        made = dict(zip(names, x[: len(names)].tolist(), strict=True))
        crank = x[len(names) :] if self.free_timing else x[len(names)] + self._given
        return self.kind(**made, branch=guess.branch), crank


def _alike(one: Start, other: Start) -> bool:
    """Whether two starts lead to one optimum, by their sums of squares."""
    return abs(one.distance - other.distance) <= ALIKE * max(one.distance, other.distance)


def _angles(direction: Direction, target: np.ndarray) -> ca.SX:
    """Angles less those of the target, without jumps, the first counted from any start."""
    cosine, sine = direction
    c = cosine * np.cos(target) + sine * np.sin(target)
    s = sine * np.cos(target) - cosine * np.sin(target)
    turned = ca.atan2(c[:-1] * s[1:] - s[:-1] * c[1:], c[:-1] * c[1:] + s[:-1] * s[1:])
    return ca.vertcat(0, ca.cumsum(turned))


def _scatter(values: ca.SX) -> ca.SX:
    """Sum of squares about the mean."""
    return ca.sumsqr(values - ca.sum1(values) / values.numel())
