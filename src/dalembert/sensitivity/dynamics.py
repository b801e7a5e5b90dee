"""Gradients of dynamics: samples depend on all steps before them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.sensitivity.adjoint_march import AdjointMarch
from dalembert.sensitivity.direct_march import DirectMarch
from dalembert.sensitivity.engine import Engine


class DynamicsEngine(Engine):
    """Marches over the steps that were taken: forwards, or backwards."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        marches = [DirectMarch(sample) for sample in self.samples]
        changes = marches[0].changes() if marches else []
        return np.array([march.gradient(changes) for march in marches])[:, list(columns)]

    def adjoint(self) -> np.ndarray:
        return np.array([AdjointMarch(sample).gradient() for sample in self.samples])
