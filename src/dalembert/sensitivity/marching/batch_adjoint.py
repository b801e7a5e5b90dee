"""Adjoint gradients of many designs: their marches backwards, side by side as forwards."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.fixed_steps import FixedSteps
from dalembert.analysis.batch.states import MarchedStates, measured
from dalembert.integrators.marching.march import branches
from dalembert.responses.base import Response
from dalembert.results.batch.batch import Batch
from dalembert.sensitivity.marching.adjoint_march import backward_step
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.samples import Sample, take_sample
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups
from dalembert.symbolic.evaluation.shared_columns import in_blocks

MEMORY = 2.0**26
"""Bytes of states, and of what is seen of them, at once."""


class BatchAdjoint:
    """Gradients of responses of designs in fixed steps.

    Parameters
    ----------
    batch : Batch
    responses : of which ``serves`` is true
    like : a run of one of the designs
    """

    def __init__(self, batch: Batch, responses: Sequence[Response], like: Any):
        self.batch, self.model = batch, batch.model
        self.states: MarchedStates = batch.samples  # type: ignore[assignment]
        self.kernel, self.variant = self.states.kernel, self.states.variant
        self.samples = [take_sample(like, response) for response in responses]

    @property
    def serves(self) -> bool:
        """Whether the responses look at ends of the steps that all designs take."""
        step = self.variant.step
        if step.begin is not None or branches(step, self.kernel.fixed.period):
            return False
        for sample in self.samples:
            seen = MarchedSample(sample)
            if seen.within.any() or sample.moves_with is not None:
                return False
        return True

    def gradients(self, designs: np.ndarray) -> np.ndarray:
        """(designs, responses, n) by all of the parameter vector."""
        steps = MarchedSample(self.samples[0]).steps
        size = self.variant.step.size
        width = max(1, int(MEMORY / (32.0 * (steps.count + 1) * size)))
        parts = [self._of_some(designs[k : k + width]) for k in range(0, designs.size, width)]
        return np.concatenate(parts)

    def _of_some(self, designs: np.ndarray) -> np.ndarray:
        every: Any = replace(self.batch.analysis, outputs=None)  # type: ignore[type-var]
        workers = self.states.workers
        self.again = FixedSteps(every, self.model, self.batch.designs.some(designs), workers)  # type: ignore[arg-type]
        path, known = self.again.march(lambda fraction: None)
        found = np.full((designs.size, len(self.samples), path.p.shape[1]), np.nan)
        for r, sample in enumerate(self.samples):
            found[known, r] = self._of_one(path, known, sample)
        return found

    def _of_one(self, path: MarchedStates, known: np.ndarray, sample: Sample[Any]) -> np.ndarray:
        """(known, n) gradient of one response, over paths of all states."""
        number, p = MarchedSample(sample).number, path.p[known]
        seen, p_bar = self._seen(path, known, sample, number)
        x_bar, more = self._backward(path, known, seen)
        return p_bar + more + self._through_start(known, p, x_bar)

    def _seen(
        self, path: MarchedStates, known: np.ndarray, sample: Sample[Any], number: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(known, K, size) weights that the response gives the states; (known, n) parameters."""
        function = measured(self.model, self.variant.bodies, (sample.measure,))  # type: ignore[arg-type]
        (values,) = path.evaluate(function, known, number)
        times, reduce = sample.motion.time, sample.response
        weights = np.array([reduce.weights(times, row) for row in values[..., 0]])
        design, output = np.nonzero(weights)
        at = number[output]
        size = self.variant.step.state_size
        _, x_bar, p_bar = self._evaluate(
            self.variant.measured(sample.measure).adjoint,
            path.time[at][:, None],
            path.x[known[design], at, :size],
            path.p[known[design]],
            weights[design, output][:, None],
        )
        seen = np.zeros((known.size, *path.x.shape[1:]))
        if np.unique(number).size == number.size:
            seen[design, at, :size] = x_bar
        else:
            np.add.at(seen[..., :size], (design, at), x_bar)
        parameters = np.zeros((known.size, path.p.shape[1]))
        np.add.at(parameters, design, p_bar)
        return seen, parameters

    def _backward(
        self, path: MarchedStates, known: np.ndarray, seen: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the first states, and of the parameters by the steps."""
        prelude, single = backward_step(self.kernel, self.states.mode, True)
        h, n = np.diff(path.time)[::-1], path.x.shape[2]
        columns = self.kernel.marched(single, (6,))
        march = LaneMarch(single, columns, self.kernel.backend, h.size * known.size)
        shared = march.shared(path.time[:-1][::-1], h, np.ones(h.size))
        (q,) = self._evaluate(prelude.values, path.p[known])
        carried = np.zeros((known.size, n + prelude.rate_count))
        carried[:, :n] = seen[:, -1]

        def work(group: np.ndarray) -> None:
            own = [
                states[:, -2::-1].transpose(0, 2, 1)
                for states in (path.x[known[group]], seen[group])
            ]
            last = np.array([h.size - 1])
            carried[group] = march.run(carried[group], [*shared, *own], q[group], last)[:, 0]

        threads = self.states.workers if march.threaded else 1
        done = in_groups(work, np.arange(known.size), march.width, threads, lambda fraction: None)
        if not done.all():
            raise KeyboardInterrupt
        (p_bar,) = self._evaluate(prelude.adjoint, path.p[known], carried[:, n:])
        return carried[:, :n], p_bar

    def _through_start(self, known: np.ndarray, p: np.ndarray, x_bar: np.ndarray) -> np.ndarray:
        """Weight of the parameters through the assembled initial states."""
        model: Any = self.model
        t, y = np.full((known.size, 1), self.again.start), self.again.starts.y0[known]
        _, v = self._evaluate(model.initial_state.function, t, y, p)
        _, y_bar, v_bar, by_start = self._evaluate(self.kernel.start.adjoint, t, y, v, p, x_bar)
        parts = self._evaluate(model.initial_state.adjoint, t, y, p, y_bar, v_bar)
        return by_start + parts[2]

    def _evaluate(self, function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
        columns = self.kernel.backend.columns(function)
        return in_blocks(columns, self.states.workers, *arguments)
