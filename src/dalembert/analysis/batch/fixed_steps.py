"""Batches of dynamics with fixed steps that all designs share."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.batch.dynamics_batch import DynamicsBatch
from dalembert.analysis.batch.states import MarchedStates, check_memory
from dalembert.analysis.output_places import outputs_of
from dalembert.analysis.timeline import uniform_grid
from dalembert.integrators.marching.steps import Steps
from dalembert.model.graph.model import Model
from dalembert.results.batch.designs import Designs
from dalembert.symbolic.evaluation.parallel import LaneMarch


class FixedSteps(DynamicsBatch):
    """Execution of a batch with fixed steps."""

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        super().__init__(analysis, model, designs, workers)
        self.grid = uniform_grid(self.start, self.run.end, self.run.step)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether all designs take the same steps."""
        if analysis.integrator.adaptive:
            return False
        variant, kernel = cls.starting_variant(analysis, model), analysis.kernel(model)
        return variant is not None and not kernel.fixed.at_once(kernel.variants.index(variant))

    @property
    def steps_of_a_design(self) -> int:
        return self.grid.size - 1

    def _march(
        self, started: np.ndarray, report: Callable[[float], None]
    ) -> tuple[MarchedStates, np.ndarray]:
        kernel, x0, h = self.kernel, self.starts.x0, np.diff(self.grid)
        number = np.arange(1, h.size + 1)
        corrected = (number % kernel.fixed.period == 0) | (number == h.size)
        steps = Steps(self.grid[:-1], h, x0[:1].T, corrected, np.full(h.size, self.mode))
        self.times, places = outputs_of(steps, self.run.requested)
        ends = places.index + places.ends_of(steps)
        stored = np.union1d(ends, [0, h.size])
        size = kernel.variants[self.mode].step.size
        check_memory(self.count, self.times.size, size)
        prepared = kernel.fixed.marched(self.mode).forms
        single, columns = prepared.side_by_side, kernel.fixed.columns(self.mode)
        self.marching = march = LaneMarch(single, columns, kernel.backend, h.size * started.size)
        q = self.starts.evaluate(prepared.values, self.starts.p[started])[0]
        x = np.full((self.count, stored.size, size), np.nan)
        x[started, 0] = x0
        shared = march.shared(steps.t, h, corrected.astype(float))

        def work(group: np.ndarray) -> None:
            x[started[group], 1:] = march.run(x0[group], shared, q[group], stored[1:] - 1)

        ended = self._finite(x, self._in_groups(march, work, started, report))
        times = self.grid[stored]
        inside = np.flatnonzero((places.length != 0) & ~places.ends_of(steps))
        if inside.size:
            begins = np.searchsorted(stored, ends[inside])
            partial = np.full((self.count, inside.size, size), np.nan)
            arguments = times[begins], places.length[inside], x[ended][:, begins]
            partial[ended] = self._partial(ended, *arguments)
            times, order = np.unique(np.append(times, self.times[inside]), return_index=True)
            x = np.concatenate([x, partial], axis=1)[:, order]
        return self._marched(times, x), ended
