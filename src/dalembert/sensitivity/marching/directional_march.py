"""The change of a run along a direction of its parameters, by one march over its steps."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.integrators.march import CHUNK, flagged
from dalembert.integrators.steps import run_length
from dalembert.sensitivity.marching.marched_sample import MarchedSample, memory_tangent
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.columns import Columns
from dalembert.symbolic.once import once


class DirectionalMarch(MarchedSample):
    """``ẋ`` of the states that a sampled response sees, along one direction.

    Parameters
    ----------
    sample : Sample
    direction : (np,) ``d``
    """

    def __init__(self, sample: Sample, direction: np.ndarray):
        super().__init__(sample)
        self.direction = direction

    @cached_property
    def moved(self) -> tuple[np.ndarray, np.ndarray]:
        """Change of the assembled poses and speeds."""
        t, y = float(self.steps.t[0]), self.assembled()[0]
        tangent = self.model.initial_state.tangent
        found = tangent(t, y, self.p, 0, np.zeros(y.size), self.direction)
        return found[0].full().ravel(), found[1].full().ravel()

    @cached_property
    def first(self) -> np.ndarray:
        """(n, 1) ``ẋ`` at the start, memory included."""
        t, p, d = float(self.steps.t[0]), self.p, self.direction
        dx = self.kernel.start.tangent(t, *self.assembled(), p, 0, *self.moved, d).full()
        memory = self.first_step.begin
        if memory is None:
            return dx
        x0 = self.steps.x[: dx.size, 0]
        more = memory_tangent(self.first_step)(t, x0, p, memory(t, x0, p), 0, dx, d)
        return np.vstack([dx, more.full()])

    def changes(self) -> np.ndarray:
        """(n, steps + 1) ``ẋ`` at the ends of all steps."""
        steps, p, d = self.steps, self.p, self.direction
        columns, begin = [self.first], 0
        while begin < steps.count:
            count = run_length(steps.mode, begin, CHUNK)
            part = slice(begin, begin + count)
            given = (steps.t[part], steps.h[part], steps.corrected[part], steps.x[:, part])
            forward = self._forward(int(steps.mode[begin]))
            (out,) = forward(count, columns[-1][:, -1], *given, p, d)
            columns.append(out)
            begin += count
        return np.hstack(columns)

    def _forward(self, mode: int) -> Columns:
        return repeated(self.kernel, _along(self.kernel, mode))

    def sampled(self, changes: np.ndarray) -> np.ndarray:
        """(n, K) ``ẋ`` at the outputs."""
        k = self.branches.index
        sampled = changes[:, k].copy()
        sampled[:, self.ends] = changes[:, k[self.ends] + 1]
        for mode, part in self.inside():
            along = np.tile(self.direction[:, None], part.size)
            (sampled[:, part],) = self.kernel.over(self.step_of(mode).tangent, part.size)(
                *self.partial(part), changes[:, k[part]], along
            )
        return sampled

    def inside(self) -> Iterator[tuple[int, np.ndarray]]:
        """Modes, and the outputs inside steps that were taken in them."""
        k = self.branches.index
        inside = np.flatnonzero((self.branches.length > 0) & ~self.ends)
        for mode in np.unique(self.steps.mode[k[inside]]) if inside.size else ():
            yield int(mode), inside[self.steps.mode[k[inside]] == mode]

    def partial(self, part: np.ndarray) -> tuple:
        """Where the partial steps to these outputs begin, and how long they are."""
        k, p = self.branches.index[part], np.tile(self.p[:, None], part.size)
        return self.steps.t[k], self.branches.length[part], self.steps.x[:, k], p


@once
def _along(kernel: DynamicsKernel, mode: int) -> ca.Function:
    """``(ẋ, t, h, flag, x, p, ṗ) → ẋ`` of one step."""
    step = kernel.variants[mode].step
    call, symbolic = flagged(step, kernel.fixed.period, lambda s: s.tangent)
    kind: Any = ca.SX if symbolic else ca.MX
    dx, x = kind.sym("dx", step.size), kind.sym("x", step.size)
    p, dp = kind.sym("p", step.parameter_count), kind.sym("dp", step.parameter_count)
    t, h, flag = (kind.sym(s) for s in ("t", "h", "flag"))
    return ca.Function("along", [dx, t, h, flag, x, p, dp], [call(flag, t, h, x, p, dx, dp)])


def repeated(kernel: DynamicsKernel, single: ca.Function) -> Columns:
    """Calls, each with the result of the one before; p and ṗ come last."""
    last = single.n_in()
    return kernel.marched(single, (last - 2, last - 1))
