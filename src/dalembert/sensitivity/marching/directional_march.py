"""The change of a run along a direction of its parameters, by one march over its steps."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.integrators.march import flagged
from dalembert.sensitivity.marching.marched_sample import MarchedSample, memory_tangent
from dalembert.sensitivity.marching.walk import ForwardWalk
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.columns import Columns
from dalembert.symbolic.once import once


class DirectionalMarch(MarchedSample, ForwardWalk[np.ndarray]):
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

    def push_start(self) -> np.ndarray:
        return self.first

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
        self._columns = [self.first]
        self.forwards()
        return np.hstack(self._columns)

    def push(self, begin: int, end: int, change: np.ndarray) -> np.ndarray:
        forward, given = self._forward(int(self.steps.mode[begin])), self.given(begin, end)
        (out,) = forward(end - begin, change[:, -1], *given, self.p, self.direction)
        self._columns.append(out)
        return out

    def arrive(self, change: np.ndarray) -> None:
        """What is seen is taken from all changes, afterwards."""

    def _forward(self, mode: int) -> Columns:
        return repeated(self.kernel, _along(self.kernel, mode))

    def sampled(self, changes: np.ndarray) -> np.ndarray:
        """(n, K) ``ẋ`` at the outputs."""
        k = self.branches.index
        sampled = changes[:, k].copy()
        sampled[:, self.ends] = changes[:, k[self.ends] + 1]
        for mode, part in self.parts_of_steps(np.arange(k.size)):
            along = np.tile(self.direction[:, None], part.size)
            (sampled[:, part],) = self.kernel.over(self.step_of(mode).tangent, part.size)(
                *self.partial(part), changes[:, k[part]], along
            )
        return sampled


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
