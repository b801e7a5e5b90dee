"""Forces of one load case that depend on where the structure is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from dalembert.structures.evaluation.assembly import Assembly
from dalembert.structures.evaluation.block import ElementBlock


class ConfigurationLoad:
    """Forces of elements that cannot expand freely, and of moments about fixed axes.

    They hold the structure beside those of strain. For small displacements they are those at rest.

    Parameters
    ----------
    expanding : what temperature adds to blocks of elements
    moments : blocks of moments about fixed axes
    size : number of displacements
    prescribed : numbers of the prescribed ones
    linear : for small displacements
    """

    def __init__(
        self,
        expanding: Sequence[ElementBlock],
        moments: Sequence[ElementBlock],
        size: int,
        prescribed: np.ndarray,
        linear: bool,
    ):
        self.linear, self.symmetric = linear, not moments
        self.assembly = Assembly([*expanding, *moments], size, prescribed)
        self.depends_on_time = any(block.depends_on_time for block in self.assembly.blocks)

    def __bool__(self) -> bool:
        return bool(self.assembly.blocks)

    def place(self, u: np.ndarray) -> np.ndarray:
        """Displacements at which the forces are taken."""
        return np.zeros_like(u) if self.linear else u

    def forces(self, u: np.ndarray, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces that hold the elements, beside those of their strain."""
        return self.assembly.internal_forces(self.place(u), p, time)

    def stiffness(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """Their derivative by the displacements."""
        found = self.assembly.stiffness(self.place(u), p)
        return 0 * found if self.linear else found

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the forces with the parameters."""
        return self.assembly.push(self.place(u), p, dp, time)

    def pull(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, time: float = 0.0
    ) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return self.assembly.pull(self.place(u), p, weights, time)


class Expansion:
    """Forces ``−∂V/∂u`` at rest, with which changes of temperature load a structure.

    Parameters
    ----------
    held : forces that hold it
    """

    def __init__(self, held: ConfigurationLoad):
        self.held, self.depends_on_time = held, held.depends_on_time
        self.rest = np.zeros(held.assembly.size)

    def __bool__(self) -> bool:
        return bool(self.held)

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces."""
        return -self.held.forces(self.rest, p, time)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) their change with the parameters."""
        return -self.held.push(self.rest, p, dp, time)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return -self.held.pull(self.rest, p, weights, time)
