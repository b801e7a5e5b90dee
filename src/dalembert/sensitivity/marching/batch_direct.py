"""Direct gradients of many designs: changes of their states, side by side as the states."""

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
    """A direction for each parameter."""

    @property
    def serves(self) -> bool:
        return super().serves and self.variant.step.linear is not None

    def _kept(self, states: int) -> int:
        looks = sum(MarchedSample(sample).number.size for sample in self.samples)
        return super()._kept(states) + 2 * len(self.columns) * min(looks, states)

    def _over(self, path: MarchedStates, known: np.ndarray) -> np.ndarray:
        count, width, p = known.size, len(self.columns), path.p[known]
        units = np.array([self.model.tangents(row, self.columns).T for row in p])
        weighed = [self._weighed(path, known, sample) for sample in self.samples]
        wanted = np.unique(np.concatenate([at for _, at, _, _ in weighed]))
        moved = self._forward(path, known, units, wanted)
        found = np.zeros((count, len(weighed), width))
        for r, (design, at, x_bar, p_bar) in enumerate(weighed):
            changes = moved[design, np.searchsorted(wanted, at)][..., : x_bar.shape[1]]
            np.add.at(found[:, r], design, np.einsum("kcn,kn->kc", changes, x_bar))
            found[:, r] += np.einsum("kcn,kn->kc", units, p_bar)
        return found

    def _forward(
        self, path: MarchedStates, known: np.ndarray, units: np.ndarray, wanted: np.ndarray
    ) -> np.ndarray:
        """(known, wanted, c, n) changes of the states with these numbers."""
        step, (count, width, _) = self.variant.step, units.shape
        p, h, n = path.p[known], np.diff(path.time), path.x.shape[2]
        (q,) = self._evaluate(step.prelude.values, p)
        (rates,) = self._evaluate(step.prelude.tangent, np.repeat(p, width, axis=0), _rows(units))
        first = self._started(known, p, units)

        def own(group: np.ndarray) -> list[np.ndarray]:
            return [path.x[known[group], :-1].transpose(0, 2, 1)]

        moved = self._marched(
            _forward_steps(step, width),
            (path.time[:-1], h, np.ones(h.size)),
            own,
            first.reshape(count, -1),
            np.hstack([q, rates.reshape(count, -1)]),
            wanted[wanted > 0] - 1,
        )
        if wanted.size and wanted[0] == 0:
            moved = np.concatenate([first.reshape(count, 1, -1), moved], axis=1)
        return moved.reshape(count, wanted.size, width, n)

    def _started(self, known: np.ndarray, p: np.ndarray, units: np.ndarray) -> np.ndarray:
        """(known, c, n) changes of the first states."""
        width, model = units.shape[1], self.model
        state: Any = model.initial_state  # type: ignore[attr-defined]
        t, y = np.full((known.size, 1), self.again.start), self.again.starts.y0[known]
        _, v = self._evaluate(state.function, t, y, p)
        t, y, v, p = (np.repeat(part, width, axis=0) for part in (t, y, v, p))
        along, still = _rows(units), np.zeros_like(t)
        dy, dv = self._evaluate(state.tangent, t, y, p, still, np.zeros_like(y), along)
        (dx,) = self._evaluate(self.kernel.start.tangent, t, y, v, p, still, dy, dv, along)
        return dx.reshape(known.size, width, -1)


def _rows(units: np.ndarray) -> np.ndarray:
    return units.reshape(-1, units.shape[2])


@once
def _forward_steps(step: Step, width: int) -> ca.Function:
    """``(dx, t, h, flag, x, [q; dq]) → dx`` of one step, directions one below another."""
    linear, prelude, n = step.linear, step.prelude, step.size
    assert linear is not None
    m, r = prelude.value_count, prelude.rate_count
    dx, x, q = (ca.MX.sym(s, k) for s, k in zip("dxq", (n * width, n, m + r * width), strict=True))
    t, h, flag = (ca.MX.sym(s) for s in ("t", "h", "flag"))
    entries = linear.entries(t, h, x, q[:m])
    found = [
        linear.along(dx[k * n : (k + 1) * n], entries, q[m + k * r : m + (k + 1) * r])
        for k in range(width)
    ]
    made = ca.Function("forward_steps", [dx, t, h, flag, x, q], [ca.vertcat(*found)])
    if instructions(made) > LONG:
        return made
    scalar = made.expand()
    return made if scalar.n_instructions() > LONG else scalar
