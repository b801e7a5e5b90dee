"""Gradients of analyses with independent instants: kinematics, inverse dynamics, equilibrium.

An instant is an implicit function of the parameters; direct differentiation propagates one
parameter at a time through its tangent, the adjoint method one response through its adjoint.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.kinematics.kinematics import measure_rate
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample, weights_change
from dalembert.symbolic.evaluation.kernel import Kernel


class PointwiseGradient:
    """Rows of the gradient for one sampled response."""

    def __init__(self, sample: Sample, shared: dict | None = None):
        self.sample, self.motion = sample, sample.motion
        self.measured = self.motion.record.kernel.measured(sample.measure)

    def _arguments(self) -> tuple:
        s = self.motion.trajectory
        near = self.motion.record.kernel.near(s)
        return s.t, near, np.tile(self.motion.parameters[:, None], s.t.size)

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one adjoint solve per instant."""
        weights = self.sample.weights.reshape(1, -1)
        active = np.flatnonzero(weights.ravel())
        if not active.size:
            return np.zeros(self.motion.parameters.size)
        t, y, p = self._arguments()
        mapped = self.measured.adjoint.map(active.size)
        return (
            mapped(t[active], y[:, active], p[:, active], weights[:, active])[2].full().sum(axis=1)
        )

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one tangent solve per parameter and instant."""
        return self.sample.weights @ self.samples(columns)

    def samples(self, columns: Sequence[int]) -> np.ndarray:
        """(K, columns) derivatives of the samples with nonzero weight."""
        active = np.flatnonzero(self.sample.weights)
        t, y, p = self._arguments()
        derivatives = np.zeros((t.size, len(columns)))
        if not active.size:
            return derivatives
        mapped = Kernel(self.measured.tangent.map(active.size))
        instants = t[active], y[:, active], p[:, active]
        fixed = np.zeros((1, active.size)), np.zeros((y.shape[0], active.size))
        for i, change in enumerate(self.motion.model.tangents(p[:, 0], columns).T):
            direction = np.tile(change[:, None], active.size)
            derivatives[active, i] = mapped(*instants, *fixed, direction)[0].ravel()
        return derivatives

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        """(np,) derivative of the adjoint gradient along a direction of the parameters."""
        t, y, p = self._arguments()
        count, zero_y = t.size, np.zeros_like(y)
        dp = np.tile(direction[:, None], count)
        change = self.measured.tangent.map(count)(t, y, p, np.zeros((1, count)), zero_y, dp)
        dweights = weights_change(self.sample, change.full().ravel())
        active = np.flatnonzero((self.sample.weights != 0) | (dweights != 0))
        if not active.size:
            return np.zeros(direction.size)
        mapped = self.measured.reverse.tangent.map(active.size)
        rates = mapped(
            t[active],
            y[:, active],
            p[:, active],
            self.sample.weights[None, active],
            np.zeros((1, active.size)),
            zero_y[:, active],
            dp[:, active],
            dweights[None, active],
        )
        return rates[2].full().sum(axis=1)


class PointwiseEngine(RowEngine):
    """Engine for analyses with independent instants."""

    row = PointwiseGradient

    def of_samples(self, columns: Sequence[int]) -> list[np.ndarray]:
        return [row.samples(columns) for row in self._rows()]

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.array([row.hessian_product(direction) for row in self._rows()])

    def rate(self, sample: Sample, k: int = -1) -> float:
        return measure_rate(sample.motion, sample.measure, k)
