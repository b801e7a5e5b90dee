"""Gradients of analyses in which every instant stands for itself: kinematics, inverse dynamics.

An instant is an implicit function of the parameters; direct differentiation propagates one
parameter at a time through its tangent, the adjoint one response through its adjoint.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.implicit import ImplicitFunction


class PointwiseGradient:
    """Rows of the gradient for one sampled response."""

    def __init__(self, sample: Sample):
        motion = sample.motion
        model, kernel = motion.model, motion.record.kernel
        self.sample, self.motion = sample, motion
        self.measured: ImplicitFunction = model.compiled(
            ("measured", kernel, sample.measure),
            lambda: kernel.measured(model.at_ground(sample.measure.sx)),
        )

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
        weights = self.sample.weights
        active = np.flatnonzero(weights)
        t, y, p = self._arguments()
        gradient = np.zeros(len(columns))
        if not active.size:
            return gradient
        mapped = self.measured.tangent.map(active.size)
        still_t, still_y = ca.DM.zeros(1, active.size), ca.DM.zeros(y.shape[0], active.size)
        for i, column in enumerate(columns):
            direction = np.zeros((p.shape[0], active.size))
            direction[column] = 1.0
            rates = mapped(t[active], y[:, active], p[:, active], still_t, still_y, direction)
            gradient[i] = float(rates.full().ravel() @ weights[active])
        return gradient


class PointwiseEngine(Engine):
    """One row after the other."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.array([PointwiseGradient(sample).direct(columns) for sample in self.samples])

    def adjoint(self) -> np.ndarray:
        return np.array([PointwiseGradient(sample).adjoint() for sample in self.samples])
