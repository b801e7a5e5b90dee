"""Least-squares programme of a single-loop linkage, with exact derivatives.

The loop is closed explicitly, so that only dimensions and crank angles are unknown; an open loop is
replaced by the nearest closed one. Coupler and output angles are relative to their means, which
eliminates their origins. The branch is that of the start. If the crank rotates fully, the branch
determines the circuit; increasing crank angles preserve the order.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
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
"""Options of CasADi that suppress the output of Ipopt."""
MIN_ROTATION = 1e-3
"""Lower limit of the crank rotation between entries [rad]."""
PRESELECTION_ITERATIONS = 40
"""Number of iterations before starts are compared."""
SAME_OPTIMUM = 1e-2
"""Threshold for equal optima: relative difference of the sums of squares."""
FEASIBLE = 1e-8
"""Upper limit of violations of limits, relative to the size of the target."""


@dataclass(frozen=True, eq=False)
class LinkageFit:
    """Least squares over the dimensions of a linkage, subject to limits.

    Parameters
    ----------
    kind, target : class of the linkage, and target
    bounds : dimension → lower, upper; equal bounds fix it
    crank_turns : whether the crank rotates fully
    transmission : minimum transmission angle [rad]
    order : whether entries are passed in their order
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
    def _timing(self) -> np.ndarray:
        assert self.target.crank_angles is not None
        return self.target.crank_angles

    @cached_property
    def solver(self) -> ca.Function:
        """The solver of the programme."""
        return self._solver(self.max_iterations)

    @cached_property
    def preselection_solver(self) -> ca.Function:
        """The solver with a few iterations, for preselection."""
        return self._solver(PRESELECTION_ITERATIONS)

    def _solver(self, max_iterations: int) -> ca.Function:
        q = {name: ca.SX.sym(name) for name in self.kind.names()}
        theta = ca.SX.sym("theta", len(self.target) if self.free_timing else 1)
        branch, sense = ca.SX.sym("branch"), ca.SX.sym("sense")
        crank = theta if self.free_timing else theta + self._timing
        limits = (
            []
            if self.crank_turns
            else self.kind.closure_conditions(q, crank, self._min_transmission)
        )
        if self.order and self.free_timing:
            limits.append(sense * ca.diff(theta) - MIN_ROTATION)
            limits.append(2 * math.pi - MIN_ROTATION - sense * (theta[-1] - theta[0]))
        if self.crank_turns:
            limits += self.kind.rotation_conditions(q, self._min_transmission)
        problem = {
            "x": ca.vertcat(*q.values(), theta),
            "p": ca.vertcat(branch, sense),
            "f": self._distance(q, branch, crank),
            "g": ca.vertcat(*limits),
        }
        settings: dict[str, Any] = {
            "ipopt.max_iter": max_iterations,
            "ipopt.tol": 1e-10,
            "error_on_fail": False,
        }
        return ca.nlpsol("linkage", "ipopt", problem, QUIET | settings)

    @property
    def _min_transmission(self) -> float:
        return max(self.transmission, 1e-3)

    def _distance(self, q: Any, branch: ca.SX, crank: ca.SX) -> ca.SX:
        """Sum of squared deviations; angles are arc lengths on a unit circle."""
        target, total = self.target, ca.SX(0)
        (c, s), output = self.kind.closed(q, branch, crank)
        if target.points is not None:
            x = q["x"] + q["crank"] * ca.cos(crank) + q["u"] * c - q["v"] * s
            y = q["y"] + q["crank"] * ca.sin(crank) + q["u"] * s + q["v"] * c
            total += ca.sumsqr(x - target.points[:, 0]) + ca.sumsqr(y - target.points[:, 1])
        if target.coupler_angles is not None:
            total += _scatter(_angles((c, s), target.coupler_angles))
        if target.outputs is not None:
            deviation = (
                _angles(output, target.outputs)
                if isinstance(output, tuple)
                else output - target.outputs
            )
            total += _scatter(deviation)
        return total

    def _value(self, x: np.ndarray, signs: list[int]) -> float:
        """Sum of squares; infinite if limits are violated."""
        value, limits = (self.solver.get_function(f"nlp_{name}")(x, signs) for name in "fg")
        margin = np.min(np.array(limits), initial=np.inf)
        return float(value) if np.isfinite(float(value)) and margin >= -FEASIBLE else np.inf

    def select(
        self,
        starts: list[Start],
        count: int,
        report: Callable[[float], None] = lambda fraction: None,
    ) -> list[Start]:
        """The best starts after a few iterations, distinct optima first.

        Parameters
        ----------
        count : upper limit of their number
        report : called with the completed fraction
        """
        if len(starts) <= count:
            return starts
        improved = []
        for number, start in enumerate(starts):
            report(number / len(starts))
            candidate = self._improve(start)
            improved += [] if candidate is None else [candidate]
        improved.sort(key=lambda start: start.distance)
        alike = [k for k in range(1, len(improved)) if _alike(improved[k], improved[k - 1])]
        distinct = [start for k, start in enumerate(improved) if k not in alike]
        return (distinct + [improved[k] for k in alike])[:count]

    def _improve(self, start: Start) -> Start | None:
        result = self(start, self.preselection_solver)
        if result is None:
            return None
        linkage, theta = result
        crank = theta if self.free_timing else theta[:1] - self._timing[0]
        x = np.concatenate([list(linkage.numbers.values()), crank])
        value = self._value(x, [linkage.branch, start.sense])
        return Start(linkage, theta, start.sense, value)

    def __call__(
        self, start: Start, solver: ca.Function | None = None
    ) -> tuple[Linkage, np.ndarray] | None:
        """The fitted linkage and its crank angles; None if the fit fails."""
        guess, solver = start.linkage, solver or self.solver
        names = self.kind.names()
        bounds = np.array([self.bounds[name] for name in names], dtype=float)
        q0 = np.clip([guess.numbers[name] for name in names], bounds[:, 0], bounds[:, 1])
        theta = start.theta if self.free_timing else start.theta[:1] - self._timing[0]
        infinity = np.full(theta.size, np.inf)
        initial, signs = np.concatenate([q0, theta]), [guess.branch, start.sense]
        result = solver(
            x0=initial,
            p=signs,
            lbx=np.concatenate([bounds[:, 0], -infinity]),
            ubx=np.concatenate([bounds[:, 1], infinity]),
            lbg=0.0,
            ubg=np.inf,
        )
        check_ctrl_c()  # Ipopt returns without an exception
        # The infimum may be at infinite link lengths, so an unconverged result is accepted; an
        # optimal start is preferred to a worse result.
        final = np.array(result["x"]).ravel()
        x = min(final, initial, key=lambda point: self._value(point, signs))
        if not np.isfinite(self._value(x, signs)):
            return None
        dimensions = dict(zip(names, x[: len(names)].tolist(), strict=True))
        crank = x[len(names) :] if self.free_timing else x[len(names)] + self._timing
        return self.kind(**dimensions, branch=guess.branch), crank


def _alike(start: Start, other: Start) -> bool:
    """Whether two starts have the same optimum, by their sums of squares."""
    return abs(start.distance - other.distance) <= SAME_OPTIMUM * max(
        start.distance, other.distance
    )


def _angles(direction: Direction, target: np.ndarray) -> ca.SX:
    """Unwrapped angles minus those of the target, relative to the first entry."""
    cosine, sine = direction
    c = cosine * np.cos(target) + sine * np.sin(target)
    s = sine * np.cos(target) - cosine * np.sin(target)
    increments = ca.atan2(c[:-1] * s[1:] - s[:-1] * c[1:], c[:-1] * c[1:] + s[:-1] * s[1:])
    return ca.vertcat(0, ca.cumsum(increments))


def _scatter(values: ca.SX) -> ca.SX:
    """Sum of squared deviations from the mean."""
    return ca.sumsqr(values - ca.sum1(values) / values.numel())
