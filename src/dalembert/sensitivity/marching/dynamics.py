"""Gradient engine of dynamics."""

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
    """Direct and adjoint marches over the recorded steps."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        gradients = np.zeros((len(self.samples), len(columns)))
        for rows in self._rows_by_steps():
            gradients[rows] = DirectMarch([self.samples[k] for k in rows], columns).gradient()
        return gradients

    def of_samples(self, columns: Sequence[int]) -> list[np.ndarray]:
        of_samples = [np.zeros((0, 0))] * len(self.samples)
        for rows in self._rows_by_steps():
            march = DirectMarch([self.samples[k] for k in rows], columns)
            for row, derivatives in zip(rows, march.samples(), strict=True):
                of_samples[row] = derivatives
        return of_samples

    def _rows_by_steps(self) -> list[list[int]]:
        """Responses grouped by their steps; integrals may use shorter steps."""
        steps = [sample.motion.record.steps for sample in self.samples]
        distinct = {id(s): s for s in steps}.values()
        return [[k for k, s in enumerate(steps) if s is own] for own in distinct]

    def adjoint(self) -> np.ndarray:
        return self.parameter_gradients(
            [AdjointMarch(sample).gradient() for sample in self.samples]
        )

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.array([SecondMarch(s, direction).product() for s in self.samples])

    def rate(self, sample: Sample, k: int = -1) -> float:
        record = sample.motion.record
        flow = Flow(record.kernel, record.steps, sample.motion.parameters)
        step, length = int(record.places.index[k]), float(record.places.length[k])
        if length == 0.0 and step > 0 and record.steps.h[step - 1] > 0:
            step, length = step - 1, float(record.steps.h[step - 1])  # the end of the step before
        return flow.rate(sample.measure, step, length)
