"""Adjoint gradients of many designs by backward marches in SIMD lanes."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.batch.states import MarchedStates
from dalembert.sensitivity.marching.adjoint_march import backward_step
from dalembert.sensitivity.marching.batch_gradients import BatchGradients
from dalembert.sensitivity.samples import Sample


class BatchAdjoint(BatchGradients):
    """Adjoint gradients: one backward march for each response."""

    def _over(self, path: MarchedStates, solved: np.ndarray) -> np.ndarray:
        gradients = [self._gradient(path, solved, sample) for sample in self.samples]
        pairs = zip(path.p[solved], np.stack(gradients, axis=1), strict=True)
        model: Any = self.model
        rows = [model.gathered(p, full)[:, self.columns] for p, full in pairs]
        return np.array(rows).reshape(solved.size, len(gradients), len(self.columns))

    def _gradient(self, path: MarchedStates, solved: np.ndarray, sample: Sample[Any]) -> np.ndarray:
        """(solved, n) gradient of one response."""
        design, at, x_bar, p_bar = self._weights(path, solved, sample)
        injected = np.zeros((solved.size, *path.x.shape[1:]))
        if np.unique(design * injected.shape[1] + at).size == at.size:
            injected[design, at, : x_bar.shape[1]] = x_bar
        else:
            np.add.at(injected[..., : x_bar.shape[1]], (design, at), x_bar)
        x_bar, more = self._backward(path, solved, injected)
        return p_bar + more + self._through_start(solved, path.p[solved], x_bar)

    def _backward(
        self, path: MarchedStates, solved: np.ndarray, injected: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the first states, and of the parameters through the steps."""
        prelude, single = backward_step(self.kernel, self.states.mode, True)
        h, n = np.diff(path.time)[::-1], path.x.shape[2]
        (q,) = self._evaluate(prelude.values, path.p[solved])
        carried = np.zeros((solved.size, n + prelude.rate_count))
        carried[:, :n] = injected[:, -1]

        def own(group: np.ndarray) -> list[np.ndarray]:
            pairs = path.x[solved[group]], injected[group]
            return [states[:, -2::-1].transpose(0, 2, 1) for states in pairs]

        shared, last = (path.time[:-1][::-1], h, np.ones(h.size)), np.array([h.size - 1])
        end = self._march(single, shared, own, carried, q, last)[:, 0]
        (p_bar,) = self._evaluate(prelude.adjoint, path.p[solved], end[:, n:])
        return end[:, :n], p_bar

    def _through_start(self, solved: np.ndarray, p: np.ndarray, x_bar: np.ndarray) -> np.ndarray:
        """Weights of the parameters through the assembled initial states."""
        model: Any = self.model
        t, y = np.full((solved.size, 1), self.again.start), self.again.starts.y0[solved]
        _, v = self._evaluate(model.initial_state.function, t, y, p)
        _, y_bar, v_bar, by_start = self._evaluate(self.kernel.start.adjoint, t, y, v, p, x_bar)
        parts = self._evaluate(model.initial_state.adjoint, t, y, p, y_bar, v_bar)
        return by_start + parts[2]
