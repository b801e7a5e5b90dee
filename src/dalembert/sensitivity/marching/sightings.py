"""Where a response looks at a run: at states, the ends of steps, and inside of steps."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.sensitivity.samples import Sample


class Sightings:
    """The outputs of a run that a sampled response sees.

    Attributes
    ----------
    steps, branches : of the run, and where the outputs lie among them
    ends : (K,) whether an output is the end of its step
    number : (K,) number of the state that an output is, or branches from
    within : (K,) whether it branches from there, to the inside of a step
    active : outputs with a weight, in the order of ``number``
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

    def seen(self, first: int, last: int) -> np.ndarray:
        """Active outputs at or after the states of these numbers, before the next state."""
        begin, end = np.searchsorted(self.number[self.active], [first, last + 1])
        return self.active[begin:end]
