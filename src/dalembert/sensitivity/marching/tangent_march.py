"""Changes of the states of a run along directions of its parameters, in chunks of the graph."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.integrators.marching.march import CHUNK, branches, flagged
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.marched_sample import MarchedSample, memory_tangent
from dalembert.sensitivity.marching.walk import ForwardWalk
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.lane_tangents import LaneTangents
from dalembert.symbolic.evaluation.prelude import Prelude
from dalembert.symbolic.once import once

MOST = 1 << 18
"""Numbers of changes at the steps of a chunk that are held at once."""


class TangentMarch(ForwardWalk[np.ndarray]):
    """``dx`` is carried along with the steps that were taken, in columns.

    Parameters
    ----------
    run : one of the samples of the run
    unit : (np, c) directions
    take : told the number of a state, and the changes (states, c, n) from it on
    """

    def __init__(
        self, run: MarchedSample, unit: np.ndarray, take: Callable[[int, np.ndarray], None]
    ):
        self.run, self.unit, self.take, self.width = run, unit, take, unit.shape[1]
        self._known: dict[int, LaneTangents | None] = {}
        self._ready: tuple[Prelude, np.ndarray, np.ndarray] | None = None

    @property
    def count(self) -> int:
        return self.run.count

    def ahead(self, begin: int) -> int:
        if self.run.moving is not None:
            return begin + 1
        return self.run.ahead(begin, int(np.clip(MOST // (self.run.size * self.width), 1, CHUNK)))

    @cached_property
    def assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Changes of the assembled poses and speeds."""
        run, c = self.run, self.width
        y, t = run.assembled()[0], float(run.steps.t[0])
        tangent, still = run.model.initial_state.tangent.map(c), np.zeros((y.size, c))
        dy, dv = tangent(t, y, run.p, 0, still, self.unit)
        return dy.full(), dv.full()

    def push_start(self) -> np.ndarray:
        """(n, c) changes of the first state."""
        run, c, unit = self.run, self.width, self.unit
        p, t = run.p, float(run.steps.t[0])
        start = run.kernel.start.tangent.map(c)
        dx = start(t, *run.assembled(), p, 0, *self.assembled, unit).full()
        first = run.first_step
        if first.begin is None:
            return dx
        x0 = run.steps.x[: first.state_size, 0]
        memory = first.begin(t, x0, p)
        more = memory_tangent(first).map(c)(t, x0, p, memory, 0, dx, unit)
        return np.vstack([dx, more.full()])

    def push(self, begin: int, end: int, change: np.ndarray) -> np.ndarray:
        out = self._forward(begin, end, change)
        if self.run.moving is not None:
            out = out + self.run.moving.pushed(begin, end, self.unit).transpose(1, 2, 0)
        self.take(begin, np.concatenate([change.T[None], out[:-1]]))
        return out[-1].T

    def arrive(self, change: np.ndarray) -> None:
        self.take(self.count, change.T.reshape(1, self.width, -1))

    def at_outputs(
        self, sample: MarchedSample, chosen: np.ndarray, first: int, changes: np.ndarray
    ) -> np.ndarray:
        """(…, c, n) changes at some outputs, from those of states from a first one on."""
        moved = changes[sample.number[chosen] - first]
        for mode, part in sample.parts_of_steps(chosen):
            tangents = sample.kernel.over(_inside(sample.step_of(mode), self.width), part.size)
            along = beside(moved[part]), np.tile(self.unit, part.size)
            dx = tangents(*sample.partial(chosen[part]), *along)[0]
            moved[part] = dx.reshape(-1, part.size, self.width).transpose(1, 2, 0)
        if sample.moving is not None:
            rates, slopes = sample.held(chosen)
            moved = moved + rates.T[:, None] * (slopes @ self.unit[: slopes.shape[1]])[..., None]
        return moved

    def _forward(self, begin: int, end: int, dx: np.ndarray) -> np.ndarray:
        """(steps, c, n) changes after each of the steps between two states."""
        kernel, p, given = self.run.kernel, self.run.p, self.run.given(begin, end)
        count, mode = end - begin, int(self.run.steps.mode[begin])
        if kernel.fixed.at_once(mode):
            forward = _forward_chunk(self.run.step_of(mode), count, self.width)
            return self._parted(forward(dx, *given, p, self.unit)[0])
        if (lanes := self._lanes(mode)) is not None:
            t, h, _, x = given
            values, rates = self._prepared(self.run.step_of(mode).prelude)
            return lanes(dx, (t[None], h[None], x), values, rates)
        prelude, single = _forward_step(kernel, mode, self.width)
        columns = kernel.marched(single, (5, 6))
        columns.announce(self.count)
        return self._parted(columns(count, dx, *given, *self._prepared(prelude))[0])

    def _parted(self, out: np.ndarray) -> np.ndarray:
        return out.T.reshape(-1, self.width, out.shape[0])

    def _prepared(self, prelude: Prelude) -> tuple[np.ndarray, np.ndarray]:
        """What steps take of the parameters, and its rates along the directions."""
        if self._ready is None or self._ready[0] is not prelude:
            p, c = self.run.p, self.width
            rates = prelude.tangent.map(c)(np.tile(p[:, None], c), self.unit).full()
            self._ready = prelude, prelude.values(p).full().ravel(), rates
        return self._ready[1:]

    def _lanes(self, mode: int) -> LaneTangents | None:
        """What takes steps of a mode along several directions side by side, if anything does."""
        if mode not in self._known:
            kernel, step, found = self.run.kernel, self.run.step_of(mode), None
            possible = kernel.backend.has_lanes and not branches(step, kernel.fixed.period)
            if possible and step.linear is not None:
                found = LaneTangents.of(step.linear, kernel.backend, self.count, self.width)
            self._known[mode] = found
        return self._known[mode]


def beside(changes: np.ndarray) -> np.ndarray:
    """(n, instants · columns) changes side by side, from (instants, columns, n)."""
    return changes.transpose(2, 0, 1).reshape(changes.shape[2], -1)


@once
def _inside(step: Step, columns: int) -> ca.Function:
    """Tangents over part of a step."""
    return step.tangents(columns)


@once
def _forward_chunk(step: Step, count: int, c: int) -> Kernel:
    """The same of equal steps that are taken at once."""
    n, m = step.size, step.parameter_count
    dx, p, dp = ca.MX.sym("dx", n, c), ca.MX.sym("p", m), ca.MX.sym("dp", m, c)
    xs = ca.MX.sym("xs", n, count)
    times = [ca.MX.sym(s, 1, count) for s in ("t", "h", "flag")]
    out = step.chunk_tangents(count, c)(xs[:, 0], *times, p, dx, dp)
    return Kernel(ca.Function("forward", [dx, *times, xs, p, dp], [out]))


@once
def _forward_step(kernel: DynamicsKernel, mode: int, c: int) -> tuple[Prelude, ca.Function]:
    """The prelude, and ``(dx, t, h, flag, x, q, dq) → dx`` of one step, for ``c`` columns."""
    step, period = kernel.variants[mode].step, kernel.fixed.period
    prelude, wanted = step.prelude, lambda step: step.prepared_tangents(c)
    if branches(step, period):  # two steps, with a prelude each
        prelude, wanted = Prelude.identity(step.parameter_count), lambda step: step.tangents(c)
    call, _ = flagged(step, period, wanted)
    dx, dq = ca.MX.sym("dx", step.size, c), ca.MX.sym("dq", prelude.rate_count, c)
    x, q = ca.MX.sym("x", step.size), ca.MX.sym("q", prelude.value_count)
    t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
    following = ca.densify(call(flag, t, h, x, q, dx, dq))
    return prelude, ca.Function("forward_step", [dx, t, h, flag, x, q, dq], [following])
