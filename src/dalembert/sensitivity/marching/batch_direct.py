"""Direct gradients of many designs by tangent marches in SIMD lanes."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.states import MarchedStates
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.batch_gradients import BatchGradients
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.symbolic.evaluation.columns import LONG, instructions
from dalembert.symbolic.once import once


class BatchDirect(BatchGradients):
    """Direct gradients: one direction for each parameter."""

    @property
    def serves(self) -> bool:
        return super().serves and self.variant.step.linear is not None

    def _stored(self, states: int) -> int:
        outputs = sum(MarchedSample(sample).number.size for sample in self.samples)
        return super()._stored(states) + 2 * len(self.columns) * min(outputs, states)

    def _over(self, path: MarchedStates, solved: np.ndarray) -> np.ndarray:
        count, width, p = solved.size, len(self.columns), path.p[solved]
        units = np.array([self.model.tangents(row, self.columns).T for row in p])
        weights = [self._weights(path, solved, sample) for sample in self.samples]
        numbers = np.unique(np.concatenate([at for _, at, _, _ in weights]))
        tangents = self._forward(path, solved, units, numbers)
        gradients = np.zeros((count, len(weights), width))
        for r, (design, at, x_bar, p_bar) in enumerate(weights):
            changes = tangents[design, np.searchsorted(numbers, at)][..., : x_bar.shape[1]]
            np.add.at(gradients[:, r], design, np.einsum("kcn,kn->kc", changes, x_bar))
            gradients[:, r] += np.einsum("kcn,kn->kc", units, p_bar)
        return gradients

    def _forward(
        self, path: MarchedStates, solved: np.ndarray, units: np.ndarray, numbers: np.ndarray
    ) -> np.ndarray:
        """(solved, numbers, c, n) changes of the states with these numbers."""
        step, (count, width, _) = self.variant.step, units.shape
        p, h, n = path.p[solved], np.diff(path.time), path.x.shape[2]
        (q,) = self._evaluate(step.prelude.values, p)
        (rates,) = self._evaluate(step.prelude.tangent, np.repeat(p, width, axis=0), _rows(units))
        first = self._initial_changes(solved, p, units)

        def own(group: np.ndarray) -> list[np.ndarray]:
            return [path.x[solved[group], :-1].transpose(0, 2, 1)]

        tangents = self._march(
            _forward_steps(step, width),
            (path.time[:-1], h, np.ones(h.size)),
            own,
            first.reshape(count, -1),
            np.hstack([q, rates.reshape(count, -1)]),
            numbers[numbers > 0] - 1,
        )
        if numbers.size and numbers[0] == 0:
            tangents = np.concatenate([first.reshape(count, 1, -1), tangents], axis=1)
        return tangents.reshape(count, numbers.size, width, n)

    def _initial_changes(self, solved: np.ndarray, p: np.ndarray, units: np.ndarray) -> np.ndarray:
        """(solved, c, n) changes of the first states."""
        width, model = units.shape[1], self.model
        state: Any = model.initial_state  # type: ignore[attr-defined]
        t, y = np.full((solved.size, 1), self.again.start), self.again.starts.y0[solved]
        _, v = self._evaluate(state.function, t, y, p)
        t, y, v, p = (np.repeat(part, width, axis=0) for part in (t, y, v, p))
        along, dt = _rows(units), np.zeros_like(t)
        dy, dv = self._evaluate(state.tangent, t, y, p, dt, np.zeros_like(y), along)
        (dx,) = self._evaluate(self.kernel.start.tangent, t, y, v, p, dt, dy, dv, along)
        return dx.reshape(solved.size, width, -1)


def _rows(units: np.ndarray) -> np.ndarray:
    return units.reshape(-1, units.shape[2])


@once
def _forward_steps(step: Step, width: int) -> ca.Function:
    """``(dx, t, h, flag, x, [q; dq]) → dx`` of one step, with stacked directions."""
    linear, prelude, n = step.linear, step.prelude, step.size
    assert linear is not None
    m, r = prelude.value_count, prelude.rate_count
    dx, x, q = (ca.MX.sym(s, k) for s, k in zip("dxq", (n * width, n, m + r * width), strict=True))
    t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
    entries = linear.entries(t, h, x, q[:m])
    changes = [
        linear.along(dx[k * n : (k + 1) * n], entries, q[m + k * r : m + (k + 1) * r])
        for k in range(width)
    ]
    function = ca.Function("forward_steps", [dx, t, h, flag, x, q], [ca.vertcat(*changes)])
    if instructions(function) > LONG:
        return function
    scalar = function.expand()
    return function if scalar.n_instructions() > LONG else scalar
