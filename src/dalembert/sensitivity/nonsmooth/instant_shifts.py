"""Instants of impacts in a step that move with its start and with parameters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.sensitivity.nonsmooth.triplets import Triplets


@dataclass(frozen=True, eq=False)
class InstantShifts:
    """Contribution of moving instants to the changes of a step.

    Attributes
    ----------
    instants : (m, n_q) derivatives of the instants by ``q``
    jumps : (m, n_x) derivatives of the state at the end of the step by the instants
    """

    instants: Triplets
    jumps: np.ndarray

    def push(self, dq: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        return np.asarray(self.jumps.T @ (self.instants @ dq))

    def pull(self, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q``."""
        return np.asarray(self.instants.T @ (self.jumps @ weights))
