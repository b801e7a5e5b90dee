"""A sampled response of a dynamic run, with the steps and functions that gradients march over."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.analysis.variant import Variant
from dalembert.integrators.step import Step
from dalembert.integrators.steps import Steps
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction


class MarchedSample:
    """What direct and adjoint gradients of one sampled response have in common."""

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.kernel: DynamicsKernel = record.kernel
        self.steps: Steps = record.steps
        self.branches = record.branches
        self.model = self.motion.model
        self.p = self.motion.parameters
        self.states = self.kernel.branch_states(self.steps, self.branches, self.p)
        self.modes = self.kernel.modes(self.steps, self.branches)
        self.size = self.steps.x.shape[0]

    def step_of(self, mode: int) -> Step:
        return self.kernel.variants[mode].step

    def measured(self, variant: Variant) -> ImplicitFunction:
        """``(t, x, p) → measure``, accelerations and multipliers included."""
        measure = self.sample.measure
        return self.model.compiled(
            ("measured", variant, measure),
            lambda: variant.measured([self.model.at_ground(measure.sx)]),
        )

    @property
    def first_step(self) -> Step:
        return self.step_of(self.steps.mode[0] if self.steps.count else -1)

    def assembled(self) -> tuple[np.ndarray, np.ndarray]:
        """Initial poses and speeds of the bodies."""
        state = self.model.assemble(self.p, float(self.steps.t[0]))
        return state.y, state.v
