"""Displacement-dependent forces of one load case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from dalembert.structures.evaluation.assembly import Assembly
from dalembert.structures.evaluation.block import ElementBlock


class ConfigurationLoad:
    """Forces of hindered thermal expansion, and of moments about fixed axes.

    They are internal forces, in addition to those of strain; for small displacements those at rest.

    Parameters
    ----------
    expanding : thermal blocks of elements
    moments : blocks of moments about fixed axes
    size : number of displacements
    prescribed : numbers of the prescribed displacements
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

    def configuration(self, u: np.ndarray) -> np.ndarray:
        """Displacements at which the forces are evaluated."""
        return np.zeros_like(u) if self.linear else u

    def forces(self, u: np.ndarray, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) internal forces, in addition to those of strain."""
        return self.assembly.internal_forces(self.configuration(u), p, time)

    def stiffness(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """Derivative of the forces by the displacements."""
        stiffness = self.assembly.stiffness(self.configuration(u), p)
        return 0 * stiffness if self.linear else stiffness

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the forces with the parameters."""
        return self.assembly.push(self.configuration(u), p, dp, time)

    def pull(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, time: float = 0.0
    ) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return self.assembly.pull(self.configuration(u), p, weights, time)


class Expansion:
    """Thermal loads: forces ``−∂V/∂u`` at rest.

    Parameters
    ----------
    internal : internal forces
    """

    def __init__(self, internal: ConfigurationLoad):
        self.internal, self.depends_on_time = internal, internal.depends_on_time
        self.rest = np.zeros(internal.assembly.size)

    def __bool__(self) -> bool:
        return bool(self.internal)

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces."""
        return -self.internal.forces(self.rest, p, time)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) their change with the parameters."""
        return -self.internal.push(self.rest, p, dp, time)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return -self.internal.pull(self.rest, p, weights, time)
