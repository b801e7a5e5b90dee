"""Chunks of intervals that CVODES and IDAS integrate without restart.

A restart costs many short steps of low order and adds an error of its own, so a chunk of equal
intervals is one call that returns the states at their ends. Corrections are applied to these states
and fed back only at the next chunk. Gradients propagate the weights or changes of all states of a
chunk through its sensitivity equations, those of ``ẋ = F(t, x, z(t, x, p), p)``: IDAS cannot
restart its backward problem at intermediate weights.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import numpy as np

from dalembert.integrators.base import Problem
from dalembert.integrators.step import GraphStep

MAX_STEPS = 50_000
"""Upper limit of SUNDIALS steps within one interval."""
Flow = Callable[[int], ca.Function]
"""Number of intervals → ``(t, h, x, p) → states`` (n, count) at their ends."""


class SundialsStep(GraphStep):
    """One interval or a chunk of equal intervals.

    Parameters
    ----------
    problem : Problem
    flow : integrator of the run
    smooth : integrator for gradients
    """

    def __init__(self, problem: Problem, flow: Flow, smooth: Flow):
        self.problem, self.flow, self.smooth = problem, flow, smooth
        single = flow(1)
        size = single.numel_in(2)
        super().__init__(single, size, correction=problem.correction, upkeep=problem.upkeep)

    @property
    def chunked(self) -> bool:
        return True

    def explain(self, reason: str) -> str:
        if "IDA" in reason and ("CONV_FAIL" in reason or "LINESEARCH_FAIL" in reason):
            return (
                "IDAS cannot solve for accelerations and multipliers to its tolerance: the "
                "mechanism is at a singular position, or rounding alone is larger, as with a "
                "large factor of Penalty. Use a larger rtol, CVODES() or Radau()"
            )
        if "TOO_MUCH_WORK" not in reason:
            return ""
        return (
            f"SUNDIALS took {MAX_STEPS} steps (max_num_steps) in one interval without reaching "
            "its end: the solution varies that fast, jumps, or grows without bound. Use shorter "
            "intervals (step), larger tolerances, or Radau()"
        )

    def _chunk(self, count: int) -> tuple[list[ca.MX], list[ca.MX], ca.MX, ca.MX]:
        """Symbols ``x, t, h, flag, p``, arguments of a flow, times and parameters at all ends."""
        x, p = ca.MX.sym("x", self.size), ca.MX.sym("p", self.parameter_count)
        t, h, flag = (ca.MX.sym(name, 1, count) for name in ("t", "h", "flag"))
        begin, length = t[0], ca.sum2(h) / count
        ends = begin + length * ca.DM(np.arange(1, count + 1)).T
        return [x, t, h, flag, p], [begin, length, x, p], ends, ca.repmat(p, 1, count)

    def chunk(self, count: int) -> ca.Function:
        symbols, arguments, ends, same = self._chunk(count)
        states = self.flow(count)(*arguments)
        if self._finish is not None:
            states = self._finish.function.map(count)(ends, states, same)
        return ca.Function("chunk", symbols, [states])

    def chunk_adjoint(self, count: int) -> ca.Function:
        (x, t, h, flag, p), arguments, ends, same = self._chunk(count)
        weights, p_bar = ca.MX.sym("w", self.size, count), ca.MX(self.parameter_count, 1)
        flow, seeds = self.smooth(count), weights
        states = flow(*arguments)
        if self._finish is not None:
            back = self._finish.adjoint.map(count)(ends, states, same, weights)
            seeds, p_bar = back[1], ca.sum2(back[2])
        _, _, x_bar, more = flow.reverse(1)(*arguments, states, seeds)
        out = [ca.densify(x_bar), ca.densify(p_bar + more)]
        return ca.Function("chunk_adjoint", [x, t, h, flag, p, weights], out)

    def chunk_tangents(self, count: int, columns: int) -> ca.Function:
        (x, t, h, flag, p), arguments, ends, same = self._chunk(count)
        dx = ca.MX.sym("dx", self.size, columns)
        dp = ca.MX.sym("dp", self.parameter_count, columns)
        flow = self.smooth(count)
        states, zero = flow(*arguments), ca.MX(1, columns)
        changes = flow.forward(columns)(*arguments, states, zero, zero, dx, dp)
        # reorder from direction-major to interval-major
        order = [k + count * i for k in range(count) for i in range(columns)]
        changes = ca.densify(changes)[:, order]
        if self._finish is not None:
            repeated = [k for k in range(count) for _ in range(columns)]
            point = [ends[:, repeated], states[:, repeated], same[:, repeated]]
            zero, along = ca.MX(1, count * columns), ca.repmat(dp, 1, count)
            changes = self._finish.tangent.map(count * columns)(*point, zero, changes, along)
        return ca.Function("chunk_tangents", [x, t, h, flag, p, dx, dp], [ca.densify(changes)])
