"""Direct gradients of dynamics: ``∂x/∂p`` is carried along, in chunks of the graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.analysis.step_outputs import alike
from dalembert.integrators.march import CHUNK, branches, flagged
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.marched_sample import MarchedSample, memory_tangent
from dalembert.sensitivity.marching.walk import ForwardWalk
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.kernel import Kernel
from dalembert.symbolic.once import once
from dalembert.symbolic.prelude import Prelude

Take = Callable[[int, int, np.ndarray], None]
MOST = 1 << 18
"""Numbers of ``∂x/∂p`` at the steps of a chunk that are held at once."""


class DirectMarch(ForwardWalk[np.ndarray]):
    """Gradients of sampled responses of one run with respect to chosen parameters.

    Parameters
    ----------
    samples : of the same steps
    columns : numbers of the parameters
    """

    def __init__(self, samples: Sequence[Sample], columns: Sequence[int]):
        self.seen = [MarchedSample(sample) for sample in samples]
        self.columns = tuple(columns)
        self.width = len(self.columns)

    @property
    def count(self) -> int:
        return self.run.count

    def gradient(self) -> np.ndarray:
        """(responses, columns) by one march over the steps with all columns."""
        gradient = np.zeros((len(self.seen), self.width))

        def add(row: int, k: int, rates: np.ndarray) -> None:
            gradient[row] += self.seen[row].sample.weights[k] * rates

        self._march(add)
        return gradient

    def samples(self) -> list[np.ndarray]:
        """(K, columns) derivatives of the samples that have a weight, for each response."""
        found = [np.zeros((sample.modes.size, self.width)) for sample in self.seen]

        def keep(row: int, k: int, rates: np.ndarray) -> None:
            found[row][k] = rates

        self._march(keep)
        return found

    def _march(self, take: Take) -> None:
        """One march over the steps; ``take`` is told row, sample and its derivatives."""
        if not (self.seen and self.width):
            return
        self.run, self._take = self.seen[0], take
        self.unit = self.run.model.tangents(self.run.p, self.columns)
        self.forwards()

    def ahead(self, begin: int) -> int:
        return self.run.ahead(begin, int(np.clip(MOST // (self.run.size * self.width), 1, CHUNK)))

    def push(self, begin: int, end: int, change: np.ndarray) -> np.ndarray:
        out = self._forward(begin, end, change)
        changes = np.hstack([change, out]).T.reshape(end - begin + 1, self.width, -1)
        self._look(begin, changes[:-1])
        return out[:, -self.width :]

    def arrive(self, change: np.ndarray) -> None:
        self._look(self.count, change.T.reshape(1, self.width, -1))

    def _look(self, first: int, changes: np.ndarray) -> None:
        """Take what the responses see of ``∂x/∂p``, (states, columns, n), from a state on."""
        n, kernel = self.run.size, self.run.kernel
        for row, sample in enumerate(self.seen):
            chosen = sample.seen(first, first + len(changes) - 1)
            if not chosen.size:
                continue
            states = sample.states_at(chosen)
            moved = changes[sample.number[chosen] - first]
            for mode, part in sample.parts_of_steps(chosen):
                tangents = kernel.over(_inside(sample.step_of(mode), self.width), part.size)
                along = _beside(moved[part]), np.tile(self.unit, part.size)
                dx = tangents(*sample.partial(chosen[part]), *along)[0]
                moved[part] = dx.reshape(n, part.size, self.width).transpose(1, 2, 0)
            for mode, part in alike(sample.modes[chosen], np.arange(chosen.size)):
                size = sample.step_of(mode).state_size
                measured = _measured(sample.measured(kernel.variants[mode]), self.width)
                rates = kernel.over(measured, part.size)(
                    sample.motion.time[chosen[part]],
                    states[:size, part],
                    np.tile(self.run.p[:, None], part.size),
                    _beside(moved[part][:, :, :size]),
                    np.tile(self.unit, part.size),
                )[0]
                for j, row_rates in zip(part, rates.reshape(part.size, -1), strict=True):
                    self._take(row, int(chosen[j]), row_rates)

    def push_start(self) -> np.ndarray:
        """(n, columns) ``∂x/∂p`` of the first state."""
        run, c = self.run, self.width
        p, t = run.p, float(run.steps.t[0])
        y, v = run.assembled()
        unit = self.unit
        still = np.zeros((y.size, c))
        dy, dv = run.model.initial_state.tangent.map(c)(t, y, p, 0, still, unit)
        dx = run.kernel.start.tangent.map(c)(t, y, v, p, 0, dy, dv, unit).full()
        first = run.first_step
        if first.begin is None:
            return dx
        x0 = run.steps.x[: first.state_size, 0]
        memory = first.begin(t, x0, p)
        more = memory_tangent(first).map(c)(t, x0, p, memory, 0, dx, unit)
        return np.vstack([dx, more.full()])

    def _forward(self, begin: int, end: int, dx: np.ndarray) -> np.ndarray:
        """Tangents of the steps between two states in one call."""
        kernel, p, given = self.run.kernel, self.run.p, self.run.given(begin, end)
        count, mode = end - begin, int(self.run.steps.mode[begin])
        if kernel.fixed.at_once(mode):
            forward = _forward_chunk(self.run.step_of(mode), count, self.width)
            return forward(dx, *given, p, self.unit)[0]
        prelude, single = _forward_step(kernel, mode, self.width)
        values = prelude.values(p).full()
        rates = prelude.tangent.map(self.width)(np.tile(p[:, None], self.width), self.unit).full()
        columns = kernel.marched(single, (5, 6))
        columns.announce(self.count)
        return columns(count, dx, *given, values, rates)[0]


def _beside(changes: np.ndarray) -> np.ndarray:
    """(n, instants · columns) changes side by side, from (instants, columns, n)."""
    return changes.transpose(2, 0, 1).reshape(changes.shape[2], -1)


@once
def _inside(step: Step, columns: int) -> ca.Function:
    """Tangents over part of a step."""
    return step.tangents(columns)


@once
def _measured(function: ImplicitFunction, columns: int) -> ca.Function:
    return function.tangents(columns)


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
