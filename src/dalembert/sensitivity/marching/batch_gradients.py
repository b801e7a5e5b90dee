"""Gradients of many designs in the same steps: their marches side by side, as of their runs."""

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
from dalembert.symbolic.evaluation.parallel import LaneMarch, in_blocks, in_groups

MEMORY = 2.0**26
"""Bytes of states, and of what is seen of them, at once."""


class BatchGradients(ABC):
    """Gradients of responses of designs in fixed steps.

    Parameters
    ----------
    batch : Batch
    responses : of which ``serves`` is true
    like : a run of one of the designs
    columns : numbers of the parameters
    """

    def __init__(
        self, batch: Batch, responses: Sequence[Response], like: Any, columns: Sequence[int]
    ):
        self.batch, self.model, self.columns = batch, batch.model, list(columns)
        self.states: MarchedStates = batch.samples  # type: ignore[assignment]
        self.kernel, self.variant = self.states.kernel, self.states.variant
        self.samples = [take_sample(like, response) for response in responses]

    @property
    def serves(self) -> bool:
        """Whether the responses look at ends of the steps that all designs take."""
        step = self.variant.step
        if self.kernel.adaptive is not None:  # whose steps differ by design
            return False
        if step.begin is not None or branches(step, self.kernel.fixed.period):
            return False
        for sample in self.samples:
            seen = MarchedSample(sample)
            if seen.within.any() or sample.moves_with is not None:
                return False
        return True

    @abstractmethod
    def _over(self, path: MarchedStates, known: np.ndarray) -> np.ndarray:
        """(known, responses, c) derivatives, over paths of all states."""

    def _kept(self, states: int) -> int:
        """States and what is as long that are kept of a design with so many."""
        return 4 * states

    def gradients(self, designs: np.ndarray) -> np.ndarray:
        """(designs, responses, c) derivatives; NaN where a design cannot be run again."""
        steps = MarchedSample(self.samples[0]).steps
        kept = self.variant.step.size * self._kept(steps.count + 1)
        width = max(1, int(MEMORY / (8.0 * kept)))
        parts = [self._of_some(designs[k : k + width]) for k in range(0, designs.size, width)]
        return np.concatenate(parts)

    def _of_some(self, designs: np.ndarray) -> np.ndarray:
        every: Any = replace(self.batch.analysis, outputs=None)  # type: ignore[type-var]
        workers = self.states.workers
        self.again = FixedSteps(every, self.model, self.batch.designs.some(designs), workers)  # type: ignore[arg-type]
        path, known = self.again.march(lambda fraction: None)
        rates = self._over(path, known)
        found = np.full((designs.size, *rates.shape[1:]), np.nan)
        found[known] = rates
        return found

    def _weighed(
        self, path: MarchedStates, known: np.ndarray, sample: Sample[Any]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """What the response gives the states that it looks at.

        Returns
        -------
        Places in ``known``, numbers of the states, their weights (looks, state), and
        (known, n) those of the parameters.
        """
        function = measured(self.model, self.variant.bodies, (sample.measure,))  # type: ignore[arg-type]
        number = MarchedSample(sample).number
        (values,) = path.evaluate(function, known, number)
        times, reduce = sample.motion.time, sample.response
        weights = np.array([reduce.weights(times, row) for row in values[..., 0]])
        design, output = np.nonzero(weights)
        at = number[output]
        _, x_bar, p_bar = self._evaluate(
            self.variant.measured(sample.measure).adjoint,
            path.time[at][:, None],
            path.x[known[design], at, : self.variant.step.state_size],
            path.p[known[design]],
            weights[design, output][:, None],
        )
        parameters = np.zeros((known.size, path.p.shape[1]))
        np.add.at(parameters, design, p_bar)
        return design, at, x_bar, parameters

    def _marched(
        self,
        single: ca.Function,
        shared: Sequence[np.ndarray],
        own: Callable[[np.ndarray], Sequence[np.ndarray]],
        carried: np.ndarray,
        q: np.ndarray,
        chosen: np.ndarray,
    ) -> np.ndarray:
        """(designs, chosen, size) of what is carried through all steps.

        ``shared`` are columns of all designs, ``own`` tells further ones (designs, rows, steps) of
        some of them.
        """
        columns = self.kernel.marched(single, (single.n_in() - 1,))
        steps, count = shared[0].size, len(carried)
        march = LaneMarch(single, columns, self.kernel.backend, steps * count)
        given, found = march.shared(*shared), np.empty((count, chosen.size, carried.shape[1]))

        def work(group: np.ndarray) -> None:
            found[group] = march.run(carried[group], [*given, *own(group)], q[group], chosen)

        threads = self.states.workers if march.threaded else 1
        done = in_groups(work, np.arange(count), march.width, threads, lambda fraction: None)
        if not done.all():
            raise KeyboardInterrupt
        return found

    def _evaluate(self, function: ca.Function, *arguments: np.ndarray) -> list[np.ndarray]:
        columns = self.kernel.backend.columns(function)
        return in_blocks(columns, self.states.workers, *arguments)
