"""Outputs of a run that a sampled response depends on."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.sensitivity.samples import Sample


class SampledOutputs:
    """Outputs of a run that a sampled response depends on.

    Attributes
    ----------
    steps, branches : steps of the run, and the positions of the outputs in them
    ends : (K,) whether an output is the end of its step
    number : (K,) number of the state that an output is or branches from
    within : (K,) whether an output lies inside a step
    active : outputs with nonzero weight, in the order of ``number``
    """

    def __init__(self, sample: Sample):
        self.sample, self.motion = sample, sample.motion
        record = self.motion.record
        self.steps: Steps = record.steps
        self.branches: Branches = record.branches
        self.ends = self.branches.ends_of(self.steps)
        self.number = self.branches.index + self.ends
        self.within = (self.branches.length != 0) & ~self.ends
        active = np.flatnonzero(sample.weights)
        self.active = active[np.argsort(self.number[active], kind="stable")]

    def active_outputs(self, first: int, last: int) -> np.ndarray:
        """Active outputs from state ``first`` up to but excluding state ``last + 1``."""
        begin, end = np.searchsorted(self.number[self.active], [first, last + 1])
        return self.active[begin:end]
