"""Gradients of dynamics: samples depend on all steps before them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.dynamics.flow import Flow
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.marching.adjoint_march import AdjointMarch
from dalembert.sensitivity.marching.direct_march import DirectMarch
from dalembert.sensitivity.marching.second_march import SecondMarch
from dalembert.sensitivity.samples import Sample


class DynamicsEngine(Engine):
    """Marches over the steps that were taken: forwards, or backwards."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        found = np.zeros((len(self.samples), len(columns)))
        for rows in self._of_same_steps():
            found[rows] = DirectMarch([self.samples[k] for k in rows], columns).gradient()
        return found

    def of_samples(self, columns: Sequence[int]) -> list[np.ndarray]:
        found = [np.zeros((0, 0))] * len(self.samples)
        for rows in self._of_same_steps():
            march = DirectMarch([self.samples[k] for k in rows], columns)
            for row, derivatives in zip(rows, march.samples(), strict=True):
                found[row] = derivatives
        return found

    def _of_same_steps(self) -> list[list[int]]:
        """Numbers of the responses by the steps they look at; integrals may look at shorter."""
        steps = [sample.motion.record.steps for sample in self.samples]
        every = {id(s): s for s in steps}.values()
        return [[k for k, s in enumerate(steps) if s is one] for one in every]

    def adjoint(self) -> np.ndarray:
        return self.gathered([AdjointMarch(sample).gradient() for sample in self.samples])

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.array([SecondMarch(s, direction).product() for s in self.samples])

    def rate(self, sample: Sample, k: int = -1) -> float:
        record = sample.motion.record
        flow = Flow(record.kernel, record.steps, sample.motion.parameters)
        step, length = int(record.branches.index[k]), float(record.branches.length[k])
        if length == 0.0 and step > 0 and record.steps.h[step - 1] > 0:
            step, length = step - 1, float(record.steps.h[step - 1])  # its end
        return flow.rate(sample.measure, step, length)
