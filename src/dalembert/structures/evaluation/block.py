"""All elements of one kind in a structure: connectivity and data."""

from __future__ import annotations

import numpy as np

from dalembert.structures.evaluation.inertia import Moved
from dalembert.structures.evaluation.kind import ElementKind
from dalembert.structures.evaluation.numbering import Spans
from dalembert.symbolic.parametric_array import ParametricArray


class ElementBlock:
    """Elements of one kind.

    Parameters
    ----------
    kind : ElementKind
    names : names of the elements by row
    nodes : (nodes of an element, ne) numbers of the nodes
    degrees : (k, ne) numbers of the displacements in the structure
    data : ParametricArray of (m · ne) numbers, element by element
    """

    def __init__(
        self,
        kind: ElementKind,
        names: Spans,
        nodes: np.ndarray,
        degrees: np.ndarray,
        data: ParametricArray,
    ):
        self.kind, self.names, self.nodes = kind, names, nodes
        self.degrees, self._data = degrees, data
        self._cache: tuple[tuple[bytes, float], np.ndarray] | None = None
        self.count = degrees.shape[1]

    @property
    def depends_on_time(self) -> bool:
        """Whether the data depend on time."""
        return self._data.depends_on_time

    def data(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m, ne) data at parameter values ``p``, read-only; the last result is cached."""
        key = p.tobytes(), time if self.depends_on_time else 0.0
        if self._cache is None or self._cache[0] != key:
            self._cache = key, self._shaped(self._data.values(p, time))
            self._cache[1].flags.writeable = False
        return self._cache[1]

    def lengths(self, p: np.ndarray) -> np.ndarray:
        """(ne,) largest distances of the nodes from the first one [m]."""
        d, n = self.kind.dimension, self.kind.node_count
        positions = self.data(p)[: n * d].reshape(n, d, self.count)
        return np.linalg.norm(positions - positions[0], axis=1).max(axis=0)

    def push_data(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m, ne) change of the data."""
        return self._shaped(self._data.push(p, dp, time))

    def pull_data(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """Weights of the parameters from weights (m, ne) of the data."""
        return self._data.pull(p, weights.ravel(order="F"), time)

    def turn_data(self, p: np.ndarray, weights: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of the result of ``pull_data`` with the parameters."""
        return self._data.turn(p, weights.ravel(order="F"), dp)

    def turn(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, du: np.ndarray, dp: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``Kᵀ w`` (k, ne), and of the weights of the parameters in ``wᵀ`` forces."""
        data, change = self.data(p), self.push_data(p, dp)
        own, turned = self.kind.turn(u, data, weights, du, change)
        bar = self.kind.pull(u, data, weights)
        return own, self.pull_data(p, turned) + self.turn_data(p, bar, dp)

    def turn_inertia(
        self, motion: Moved, p: np.ndarray, weights: np.ndarray, dp: np.ndarray
    ) -> np.ndarray:
        """Change of the weights of the parameters in ``wᵀ`` inertia forces."""
        data, change = self.data(p), self.push_data(p, dp)
        turned = self.kind.turn_inertia(motion, data, weights, change)
        bar = self.kind.pull_inertia(motion, data, weights, lumped=False)
        return self.pull_data(p, turned) + self.turn_data(p, bar, dp)

    def gather(self, u: np.ndarray) -> np.ndarray:
        """(k, ne) displacements of the elements."""
        return u[self.degrees]

    def gather_motion(self, motion: Moved) -> Moved:
        """(k, ne) displacements, velocities and accelerations of the elements."""
        u, v, a = motion
        return self.gather(u), self.gather(v), self.gather(a)

    def scatter(self, forces: np.ndarray, size: int) -> np.ndarray:
        """(n,) sum of element forces (k, ne) by displacement."""
        return np.bincount(self.degrees.ravel(), forces.ravel(), minlength=size)

    def _shaped(self, flat: np.ndarray) -> np.ndarray:
        return flat.reshape(self.kind.data_count, self.count, order="F")
