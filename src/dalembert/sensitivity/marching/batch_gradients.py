"""Gradients of many designs with common fixed steps, in SIMD lanes like their runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.marches import FixedSteps
from dalembert.analysis.batch.states import MarchedStates, measured
from dalembert.responses.base import Response
from dalembert.results.batch.batch import Batch
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.samples import Sample, take_sample
from dalembert.symbolic.evaluation.parallel import LaneMarch, in_blocks, in_groups

MEMORY = 2.0**26
"""Upper limit of the memory for states and their weights or changes [bytes]."""


class BatchGradients(ABC):
    """Gradients of responses for all designs of a batch with fixed steps.

    Parameters
    ----------
    batch : Batch
    responses : supported responses, see ``serves``
    example : a run of one of the designs
    columns : numbers of the parameters
    """

    def __init__(
        self, batch: Batch, responses: Sequence[Response], example: Any, columns: Sequence[int]
    ):
        self.batch, self.model, self.columns = batch, batch.model, list(columns)
        self.states: MarchedStates = batch.samples  # type: ignore[assignment]
        self.kernel, self.variant = self.states.kernel, self.states.variant
        self.step = self.kernel.fixed.marched(self.states.mode)
        self.samples = [take_sample(example, response) for response in responses]

    @property
    def serves(self) -> bool:
        """True if the responses depend only on states at the ends of common steps."""
        if self.kernel.adaptive is not None:  # steps differ between designs
            return False
        if self.variant.step.begin is not None or self.step.branches:
            return False
        for sample in self.samples:
            marched = MarchedSample(sample)
            if marched.within.any() or sample.final_event is not None:
                return False
        return True

    @abstractmethod
    def _over(self, path: MarchedStates, solved: np.ndarray) -> np.ndarray:
        """(solved, responses, c) derivatives over the paths of all states."""

    def _stored(self, states: int) -> int:
        """Number of arrays of the size of a state to store for a design with ``states`` states."""
        return 4 * states

    def gradients(self, designs: np.ndarray) -> np.ndarray:
        """(designs, responses, c) derivatives; NaN for designs whose run cannot be repeated."""
        steps = MarchedSample(self.samples[0]).steps
        size = self.variant.step.size * self._stored(steps.count + 1)
        width = max(1, int(MEMORY / (8.0 * size)))
        parts = [self._of_group(designs[k : k + width]) for k in range(0, designs.size, width)]
        return np.concatenate(parts)

    def _of_group(self, designs: np.ndarray) -> np.ndarray:
        analysis: Any = replace(self.batch.analysis, outputs=None)  # type: ignore[type-var]
        workers = self.states.workers
        self.again = FixedSteps(analysis, self.model, self.batch.designs.some(designs), workers)  # type: ignore[arg-type]
        path, solved = self.again.march(lambda fraction: None)
        rates = self._over(path, solved)
        gradients = np.full((designs.size, *rates.shape[1:]), np.nan)
        gradients[solved] = rates
        return gradients

    def _weights(
        self, path: MarchedStates, solved: np.ndarray, sample: Sample[Any]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Weights of the states that a response depends on.

        Returns
        -------
        Indices into ``solved``, numbers of the states, their weights (outputs, state), and weights
        (solved, n) of the parameters.
        """
        function = measured(self.model, self.variant.bodies, (sample.measure,))  # type: ignore[arg-type]
        number = MarchedSample(sample).number
        (values,) = path.evaluate(function, solved, number)
        times, reduce = sample.motion.time, sample.response
        weights = np.array([reduce.weights(times, row) for row in values[..., 0]])
        design, output = np.nonzero(weights)
        at = number[output]
        _, x_bar, p_bar = self._evaluate(
            self.variant.measured(sample.measure).adjoint,
            path.time[at][:, None],
            path.x[solved[design], at, : self.variant.step.state_size],
            path.p[solved[design]],
            weights[design, output][:, None],
        )
        parameters = np.zeros((solved.size, path.p.shape[1]))
        np.add.at(parameters, design, p_bar)
        return design, at, x_bar, parameters

    def _march(
        self,
        single: ca.Function,
        shared: Sequence[np.ndarray],
        own: Callable[[np.ndarray], Sequence[np.ndarray]],
        carried: np.ndarray,
        q: np.ndarray,
        chosen: np.ndarray,
    ) -> np.ndarray:
        """(designs, chosen, size) values of ``carried`` after the chosen steps.

        ``shared`` are arguments common to all designs; ``own`` returns further arguments
        (designs, rows, steps) for a group of designs.
        """
        columns = self.kernel.marched(single, (single.n_in() - 1,))
        steps, count = shared[0].size, len(carried)
        march = LaneMarch(single, columns, self.kernel.backend, steps * count)
        common, out = march.shared(*shared), np.empty((count, chosen.size, carried.shape[1]))

        def work(group: np.ndarray) -> None:
            out[group] = march.run(carried[group], [*common, *own(group)], q[group], chosen)

        threads = self.states.workers if march.threaded else 1
        done = in_groups(work, np.arange(count), march.width, threads, lambda fraction: None)
        if not done.all():
            raise KeyboardInterrupt
        return out

    def _evaluate(self, function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
        columns = self.kernel.backend.columns(function)
        return in_blocks(columns, self.states.workers, *arguments)


class BatchDirect(BatchGradients):
    """Direct gradients: one direction for each parameter."""

    @property
    def serves(self) -> bool:
        return super().serves and self.step.linear is not None

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
        step, (count, width, _) = self.step, units.shape
        p, h, n = path.p[solved], np.diff(path.time), path.x.shape[2]
        (q,) = self._evaluate(step.prelude.values, p)
        (rates,) = self._evaluate(step.prelude.tangent, np.repeat(p, width, axis=0), _rows(units))
        first = self._initial_changes(solved, p, units)

        def own(group: np.ndarray) -> list[np.ndarray]:
            return [path.x[solved[group], :-1].transpose(0, 2, 1)]

        tangents = self._march(
            step.stacked_tangents(width),
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


class BatchAdjoint(BatchGradients):
    """Adjoint gradients: one backward march for each response."""

    def _over(self, path: MarchedStates, solved: np.ndarray) -> np.ndarray:
        gradients = [self._gradient(path, solved, sample) for sample in self.samples]
        pairs = zip(path.p[solved], np.stack(gradients, axis=1), strict=True)
        model: Any = self.model
        rows = [model.parameter_gradients(p, full)[:, self.columns] for p, full in pairs]
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
        prelude, single = self.step.prelude, self.step.adjoint(compiled=True)
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
