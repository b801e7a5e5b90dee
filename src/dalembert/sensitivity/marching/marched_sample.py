"""A sampled response of a dynamic run, with the steps and functions that gradients march over."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.branches import Branches
from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.analysis.variant import Variant
from dalembert.integrators.step import Step
from dalembert.integrators.steps import Steps
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.once import once


class MarchedSample:
    """What direct and adjoint gradients of one sampled response have in common.

    Attributes
    ----------
    ends : (K,) whether an output is the end of its step
    number : (K,) number of the state that an output is, or branches from
    active : outputs with a weight, in the order of ``number``
    """

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.kernel: DynamicsKernel = record.kernel
        self.steps: Steps = record.steps
        self.branches: Branches = record.branches
        self.model = self.motion.model
        self.p = self.motion.parameters
        self.modes = self.kernel.modes(self.steps, self.branches)
        self.size = self.steps.x.shape[0]
        self.ends = self.branches.ends_of(self.steps)
        self.number = self.branches.index + self.ends
        active = np.flatnonzero(sample.weights)
        self.active = active[np.argsort(self.number[active], kind="stable")]

    @cached_property
    def states(self) -> np.ndarray:
        """(n, K) states at the outputs."""
        return self.states_at(np.arange(self.modes.size))

    def states_at(self, chosen: np.ndarray) -> np.ndarray:
        """(n, …) states at some of the outputs."""
        part = Branches(self.branches.index[chosen], self.branches.length[chosen])
        return self.kernel.branch_states(self.steps, part, self.p)

    def seen(self, first: int, last: int) -> np.ndarray:
        """Active outputs at or after the states of these numbers, before the next state."""
        begin, end = np.searchsorted(self.number[self.active], [first, last + 1])
        return self.active[begin:end]

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


@once
def memory_tangent(step: Step) -> ca.Function:
    """``(t, x, p, m, dt, dx, dp) → dm`` of the memory ``m(t, x, p)`` at the start."""
    assert step.begin is not None
    return step.begin.forward(1)


@once
def memory_adjoint(step: Step) -> ca.Function:
    """``(t, x, p, m, m̄) → (t̄, x̄, p̄)``."""
    assert step.begin is not None
    return step.begin.reverse(1)
