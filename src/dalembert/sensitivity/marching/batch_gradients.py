"""Gradients of many designs with common fixed steps, in SIMD lanes example their runs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.fixed_steps import FixedSteps
from dalembert.analysis.batch.states import MarchedStates, measured
from dalembert.integrators.marching.march import branches
from dalembert.responses.base import Response
from dalembert.results.batch.batch import Batch
from dalembert.sensitivity.marching.marched_sample import MarchedSample
from dalembert.sensitivity.samples import Sample, take_sample
from dalembert.symbolic.evaluation.lane_march import LaneMarch, in_groups
from dalembert.symbolic.evaluation.shared_columns import in_blocks

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
        self.samples = [take_sample(example, response) for response in responses]

    @property
    def serves(self) -> bool:
        """True if the responses depend only on states at the ends of common steps."""
        step = self.variant.step
        if self.kernel.adaptive is not None:  # steps differ between designs
            return False
        if step.begin is not None or branches(step, self.kernel.fixed.period):
            return False
        for sample in self.samples:
            marched = MarchedSample(sample)
            if marched.within.any() or sample.moves_with is not None:
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
