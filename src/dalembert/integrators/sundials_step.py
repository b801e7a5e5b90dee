"""Chunks of intervals that CVODES and IDAS integrate without restart.

A restart costs many short steps of low order and adds an error of its own, so a chunk of equal
intervals is one call that returns the states at their ends. Corrections are applied to these states
and fed back only at the next chunk. Gradients propagate the weights or changes of all states of a
chunk through its sensitivity equations, those of ``ẋ = F(t, x, z(t, x, p), p)``: IDAS cannot
restart its backward problem at intermediate weights.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.integrators.base import Problem
from dalembert.integrators.step import GraphStep, StepChunk

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

    chunked = True

    def chunk(self, count: int) -> SundialsChunk:
        return SundialsChunk(self, count)

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


class SundialsChunk(StepChunk):
    """A chunk of equal intervals.

    Parameters
    ----------
    step : SundialsStep
    count : number of intervals
    """

    def __init__(self, step: SundialsStep, count: int):
        self.step, self.count = step, count
        self.size, self.parameter_count = step.size, step.parameter_count
        _, self.correction = step.parts

    @cached_property
    def _smooth(self) -> ca.Function:
        """Integrator for gradients."""
        return self.step.smooth(self.count)

    def _symbols(self) -> tuple[list[ca.MX], ca.MX, ca.MX]:
        """Symbols of times, lengths and flags, of the states before, and of the parameters."""
        times = [ca.MX.sym(name, 1, self.count) for name in ("t", "h", "flag")]
        return times, ca.MX.sym("x", self.size, self.count), ca.MX.sym("p", self.parameter_count)

    def _arguments(
        self, times: list[ca.MX], x: ca.MX, p: ca.MX, first: int = 0
    ) -> tuple[list[ca.MX], ca.MX, ca.MX]:
        """Arguments of a flow, times and parameters at all ends, from interval ``first`` on."""
        begin, length = times[0][first], ca.sum2(times[1]) / self.count
        ends = begin + length * ca.DM(np.arange(1, self.count + 1)).T
        return [begin, length, x[:, first], p], ends, ca.repmat(p, 1, self.count)

    @cached_property
    def function(self) -> ca.Function:
        times, _, p = self._symbols()
        x = ca.MX.sym("x", self.size)
        arguments, ends, same = self._arguments(times, x, p)
        states = self.step.flow(self.count)(*arguments)
        if self.correction is not None:
            states = self.correction.function.map(self.count)(ends, states, same)
        return ca.Function("chunk", [x, *times, p], [states])

    def tangents(self, columns: int) -> ca.Function:
        (times, x, p), count = self._symbols(), self.count
        arguments, ends, same = self._arguments(times, x, p)
        dx = ca.MX.sym("dx", self.size, columns)
        dp = ca.MX.sym("dp", self.parameter_count, columns)
        states, zero = self._smooth(*arguments), ca.MX(1, columns)
        changes = self._smooth.forward(columns)(*arguments, states, zero, zero, dx, dp)
        # reorder from direction-major to interval-major
        order = [k + count * i for k in range(count) for i in range(columns)]
        changes = ca.densify(changes)[:, order]
        if self.correction is not None:
            repeated = [k for k in range(count) for _ in range(columns)]
            point = [ends[:, repeated], states[:, repeated], same[:, repeated]]
            zero, along = ca.MX(1, count * columns), ca.repmat(dp, 1, count)
            changes = self.correction.tangent.map(count * columns)(*point, zero, changes, along)
        return ca.Function("chunk_tangents", [dx, *times, x, p, dp], [ca.densify(changes)])

    @cached_property
    def adjoint(self) -> ca.Function:
        (times, x, p), n = self._symbols(), self.size
        arguments, ends, same = self._arguments(times, x, p, first=self.count - 1)
        carried = ca.MX.sym("c", n + self.parameter_count)
        inject, p_bar = ca.MX.sym("i", n, self.count), carried[n:]
        forwards = list(reversed(range(self.count)))
        seeds = ca.horzcat(inject[:, forwards[1:]], carried[:n])
        states = self._smooth(*arguments)
        if self.correction is not None:
            back = self.correction.adjoint.map(self.count)(ends, states, same, seeds)
            seeds, p_bar = back[1], p_bar + ca.sum2(back[2])
        _, _, x_bar, more = self._smooth.reverse(1)(*arguments, states, seeds)
        following = ca.densify(ca.vertcat(x_bar + inject[:, -1], p_bar + more))
        return ca.Function("chunk_adjoint", [carried, *times, x, inject, p], [following])
