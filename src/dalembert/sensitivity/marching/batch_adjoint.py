"""Adjoint gradients of many designs: their marches backwards, side by side as forwards."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.batch.states import MarchedStates
from dalembert.sensitivity.marching.adjoint_march import backward_step
from dalembert.sensitivity.marching.batch_gradients import BatchGradients
from dalembert.sensitivity.samples import Sample


class BatchAdjoint(BatchGradients):
    """A march for each response."""

    def _over(self, path: MarchedStates, known: np.ndarray) -> np.ndarray:
        every = [self._of_one(path, known, sample) for sample in self.samples]
        pairs = zip(path.p[known], np.stack(every, axis=1), strict=True)
        model: Any = self.model
        found = [model.gathered(p, rows)[:, self.columns] for p, rows in pairs]
        return np.array(found).reshape(known.size, len(every), len(self.columns))

    def _of_one(self, path: MarchedStates, known: np.ndarray, sample: Sample[Any]) -> np.ndarray:
        """(known, n) gradient of one response."""
        design, at, x_bar, p_bar = self._weighed(path, known, sample)
        seen = np.zeros((known.size, *path.x.shape[1:]))
        if np.unique(design * seen.shape[1] + at).size == at.size:
            seen[design, at, : x_bar.shape[1]] = x_bar
        else:
            np.add.at(seen[..., : x_bar.shape[1]], (design, at), x_bar)
        x_bar, more = self._backward(path, known, seen)
        return p_bar + more + self._through_start(known, path.p[known], x_bar)

    def _backward(
        self, path: MarchedStates, known: np.ndarray, seen: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the first states, and of the parameters by the steps."""
        prelude, single = backward_step(self.kernel, self.states.mode, True)
        h, n = np.diff(path.time)[::-1], path.x.shape[2]
        (q,) = self._evaluate(prelude.values, path.p[known])
        carried = np.zeros((known.size, n + prelude.rate_count))
        carried[:, :n] = seen[:, -1]

        def own(group: np.ndarray) -> list[np.ndarray]:
            pairs = path.x[known[group]], seen[group]
            return [states[:, -2::-1].transpose(0, 2, 1) for states in pairs]

        shared, last = (path.time[:-1][::-1], h, np.ones(h.size)), np.array([h.size - 1])
        end = self._marched(single, shared, own, carried, q, last)[:, 0]
        (p_bar,) = self._evaluate(prelude.adjoint, path.p[known], end[:, n:])
        return end[:, :n], p_bar

    def _through_start(self, known: np.ndarray, p: np.ndarray, x_bar: np.ndarray) -> np.ndarray:
        """Weight of the parameters through the assembled initial states."""
        model: Any = self.model
        t, y = np.full((known.size, 1), self.again.start), self.again.starts.y0[known]
        _, v = self._evaluate(model.initial_state.function, t, y, p)
        _, y_bar, v_bar, by_start = self._evaluate(self.kernel.start.adjoint, t, y, v, p, x_bar)
        parts = self._evaluate(model.initial_state.adjoint, t, y, p, y_bar, v_bar)
        return by_start + parts[2]
