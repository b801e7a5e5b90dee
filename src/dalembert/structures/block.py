"""All elements of one kind in a structure: where they are and what they are made of."""

from __future__ import annotations

import numpy as np

from dalembert.structures.kind import ElementKind
from dalembert.symbolic.parametric_array import ParametricArray


class ElementBlock:
    """Elements of one kind.

    Parameters
    ----------
    kind : ElementKind
    names : (ne,) of the elements
    degrees : (k, ne) numbers of their displacements in the structure
    data : ParametricArray of (m · ne) numbers, element by element
    """

    def __init__(
        self, kind: ElementKind, names: list[str], degrees: np.ndarray, data: ParametricArray
    ):
        self.kind, self.names, self.degrees, self._data = kind, names, degrees, data
        self.count = len(names)

    def data(self, p: np.ndarray) -> np.ndarray:
        """(m, ne) numbers at parameter values ``p``."""
        return self._shaped(self._data.values(p))

    def push_data(self, p: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(m, ne) their change."""
        return self._shaped(self._data.push(p, dp))

    def pull_data(self, p: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weights of the parameters from weights (m, ne)."""
        return self._data.pull(p, weights.ravel(order="F"))

    def gather(self, u: np.ndarray) -> np.ndarray:
        """(k, ne) displacements of the elements."""
        return u[self.degrees]

    def scatter(self, forces: np.ndarray, size: int) -> np.ndarray:
        """(n,) sum of element forces (k, ne) by displacement."""
        return np.bincount(self.degrees.ravel(), forces.ravel(), minlength=size)

    def _shaped(self, flat: np.ndarray) -> np.ndarray:
        return flat.reshape(self.kind.data_count, self.count, order="F")
