"""Outputs of a linear structure: derivatives of measures at the operating state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.model.assembled.measures import State, Weights
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.measured_states import MeasuredStates


@dataclass(frozen=True, eq=False)
class StructureState(MeasuredStates):
    """The operating state, at which measures are linearised.

    Attributes
    ----------
    operating : State
    """

    model: StructuralModel  # type: ignore[misc]
    parameters: np.ndarray  # type: ignore[misc]
    operating: State = None  # type: ignore[assignment]

    @property
    def time(self) -> np.ndarray:
        return np.zeros(1)

    def state(self, k: int) -> State:
        return self.operating


@dataclass(frozen=True)
class StructureRow:
    """Derivatives of an output by displacements and forces (n,), and by the inputs directly.

    Attributes
    ----------
    system : LinearStructure
    weights : Weights
    """

    system: Any
    weights: Weights

    def at(self, omega: np.ndarray, motions: np.ndarray) -> np.ndarray:
        """(K, columns) outputs of harmonic motions (K, n, columns)."""
        output = np.einsum("n,kni->ki", self.weights.u, motions)
        if self.weights.forces.any():
            for k, w in enumerate(omega):
                output[k] += self.weights.forces @ (self.system.dynamic(w) @ motions[k])
        return output + self.weights.p @ self.system.directions

    def rate(self, omega: np.ndarray, motions: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """(K, columns) derivatives of the outputs by ``ω``, from those of the motions."""
        output = np.einsum("n,kni->ki", self.weights.u, rates)
        if self.weights.forces.any():
            for k, w in enumerate(omega):
                change = (
                    self.system.dynamic_rate(w) @ motions[k] + self.system.dynamic(w) @ rates[k]
                )
                output[k] += self.weights.forces @ change
        return output
