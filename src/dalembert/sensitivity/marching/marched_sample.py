"""Sampled response of a dynamic run, with the steps and functions of gradient marches."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_outputs import columns_by_mode
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.output_places import OutputPlaces
from dalembert.integrators.marching.march import CHUNK
from dalembert.integrators.marching.steps import even_length, run_length
from dalembert.integrators.step import Step
from dalembert.sensitivity.marching.moving_instants import (
    MovingInstant,
    MovingSteps,
    moving_instants,
    step_slopes,
)
from dalembert.sensitivity.samples import Sample, SampledOutputs
from dalembert.symbolic.equations.implicit import ImplicitFunction


class MarchedSample(SampledOutputs):
    """Common base of direct and adjoint gradients of one sampled response."""

    def __init__(self, sample: Sample):
        super().__init__(sample)
        self.kernel: DynamicsKernel = self.motion.record.kernel
        self.model = self.motion.model
        self.p = self.motion.parameters
        self.modes = self.kernel.modes(self.steps, self.places)
        self.size = self.steps.x.shape[0]

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.steps.count

    def ahead(self, begin: int, longest: int = CHUNK) -> int:
        """Number of the state that one call reaches from state ``begin``."""
        return begin + self._call_length(self.steps.mode[begin:], self.steps.h[begin:], longest)

    def behind(self, end: int) -> int:
        """Number of the state that one backward call reaches from state ``end``."""
        return end - self._call_length(self.steps.mode[:end][::-1], self.steps.h[:end][::-1], CHUNK)

    def _call_length(self, modes: np.ndarray, h: np.ndarray, longest: int) -> int:
        """Number of leading steps that are taken in one call."""
        count = run_length(modes, 0, longest)
        return even_length(h[:count]) if self.kernel.fixed.at_once(int(modes[0])) else count

    def step_data(self, begin: int, end: int, back: bool = False) -> tuple[np.ndarray, ...]:
        """Times, lengths, correction flags and initial states of steps, optionally reversed."""
        part = np.arange(end - 1, begin - 1, -1) if back else slice(begin, end)
        s = self.steps
        return s.t[part], s.h[part], s.corrected[part], s.x[:, part]

    def partial_steps(self, chosen: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
        """Modes, and the indices of chosen outputs that lie inside steps of this mode."""
        inside = np.flatnonzero(self.within[chosen])
        return columns_by_mode(self.steps.mode[self.places.index[chosen[inside]]], inside)

    def partial_step_data(self, part: np.ndarray) -> tuple:
        """Times, lengths, initial states and parameters of the partial steps to these outputs."""
        k, p = self.places.index[part], np.tile(self.p[:, None], part.size)
        return self.steps.t[k], self.places.length[part], self.steps.x[:, k], p

    @cached_property
    def states(self) -> np.ndarray:
        """(n, K) states at the outputs."""
        return self.states_at(np.arange(self.modes.size))

    def states_at(self, chosen: np.ndarray) -> np.ndarray:
        """(n, …) states at the chosen outputs."""
        part = OutputPlaces(self.places.index[chosen], self.places.length[chosen])
        return self.kernel.output_states(self.steps, part, self.p)

    @cached_property
    def moving(self) -> MovingSteps | None:
        """Moving ends of steps; None if they do not depend on parameters."""
        slopes = step_slopes(self.motion)
        if slopes is None:
            return None
        return MovingSteps(self.kernel, self.steps, self.p, slopes)

    @cached_property
    def instants(self) -> list[MovingInstant]:
        """Instants of impacts and switches, which move with the parameters."""
        return moving_instants(self.sample)

    def output_shifts(self, chosen: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Corrections to fixed output times: rates of states (n, …) and slopes (…, np) of times.

        The state before an output may move in time, but the output time itself is fixed.
        """
        assert self.moving is not None
        number = self.number[chosen]
        rates = -self.moving.by_length[:, np.maximum(number - 1, 0)]  # at the ends of steps
        for mode, part in self.partial_steps(chosen):
            function = self.kernel.over(self.step_of(mode).by_times, part.size)
            by_time, by_length = function(*self.partial_step_data(chosen[part]))
            rates[:, part] = by_time - by_length
        return rates, self.moving.slopes[number]

    def step_of(self, mode: int) -> Step:
        return self.kernel.variants[mode].step

    def measured(self, variant: Variant) -> ImplicitFunction:
        """``(t, x, p) → measure``, accelerations and multipliers included."""
        return variant.measured(self.sample.measure)

    @property
    def first_step(self) -> Step:
        return self.step_of(self.steps.mode[0] if self.steps.count else -1)

    def assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Initial poses and speeds of the bodies."""
        state = self.model.assemble(self.p, float(self.steps.t[0]))
        return state.y, state.v
