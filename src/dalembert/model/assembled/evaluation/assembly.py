"""Partitioned assembly (8.14): prescribed displacements first, free ones are solved for."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cached_property

import numpy as np
import scipy

from dalembert.model.assembled.evaluation.block import ElementBlock, Stiffness
from dalembert.model.assembled.evaluation.inertia import Moved
from dalembert.model.assembled.evaluation.pattern import Pattern, with_entries


class Assembly:
    """Sums over elements, and their partition into free (f) and prescribed (p) displacements.

    Parameters
    ----------
    blocks : all elements
    size : number of displacements
    prescribed : numbers of the prescribed displacements
    pattern : pattern of the matrices, if it is that of further blocks
    """

    def __init__(
        self,
        blocks: list[ElementBlock],
        size: int,
        prescribed: np.ndarray,
        pattern: Pattern | None = None,
    ):
        self.blocks, self.size, self.pattern = blocks, size, pattern or Pattern(blocks, size)
        self.prescribed = np.asarray(prescribed, dtype=int)
        self.free = np.setdiff1d(np.arange(size), self.prescribed)

    def split(self, selected: Callable[[ElementBlock], bool]) -> tuple[Assembly, Assembly]:
        """Sums over the blocks that are not selected, and over the selected ones."""
        parts: tuple[list[ElementBlock], list[ElementBlock]] = ([], [])
        for block in self.blocks:
            parts[selected(block)].append(block)
        rest, chosen_part = (
            Assembly(blocks, self.size, self.prescribed, self.pattern) for blocks in parts
        )
        return rest, chosen_part

    @cached_property
    def _slots(self) -> np.ndarray:
        return self.pattern.slots(self.blocks)

    def matrix(self, parts: Iterable[np.ndarray]) -> scipy.sparse.csc_matrix:
        """Sum of element matrices (k, k, ne), one array for each block."""
        entries = np.concatenate([np.zeros(0), *(part.ravel() for part in parts)])
        return self.pattern.matrix(entries, self._slots)

    @cached_property
    def _inner(self) -> tuple[np.ndarray, scipy.sparse.csc_matrix]:
        return self.pattern.part(self.free)

    def inner(self, matrix: scipy.sparse.csc_matrix) -> scipy.sparse.csc_matrix:
        """Rows and columns of the free displacements of a matrix."""
        if not self.pattern.matches(matrix):
            return matrix[self.free][:, self.free].tocsc()
        places, empty = self._inner
        return with_entries(empty, matrix.data[places])

    def arm(self, p: np.ndarray) -> float:
        """Mean length of the elements; one if all are points [m]."""
        lengths = np.concatenate([np.zeros(0), *(b.lengths(p) for b in self.blocks)])
        lengths = lengths[lengths > 0]
        return float(lengths.mean()) if lengths.size else 1.0

    def stiffness(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """Tangent stiffness of the whole structure, ``K`` (8.7) where it is linear."""
        return self.matrix(b.kind.tangents(b.gather(u), b.data(p)) for b in self.blocks)

    def internal_forces(self, u: np.ndarray, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) internal forces of the displaced elements."""
        return self._added(lambda b: b.kind.forces(b.gather(u), b.data(p, time)))

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the internal forces with the parameters, at constant displacements."""
        return self._added(
            lambda b: b.kind.push(b.gather(u), b.data(p, time), b.push_data(p, dp, time))
        )

    def pull(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, time: float = 0.0
    ) -> np.ndarray:
        """Weights of the parameters from weights (n,) of the internal forces."""
        return self._to_parameters(
            p, lambda b: b.kind.pull(b.gather(u), b.data(p, time), b.gather(weights)), time
        )

    def turn(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, du: np.ndarray, dp: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``Kᵀ w`` (n,) and of the result of ``pull``, along ``(du, dp)``."""
        stiffness, p_bar = np.zeros(self.size), np.zeros(p.size)
        for b in self.blocks:
            element_change, parameter_change = b.turn(
                b.gather(u), p, b.gather(weights), b.gather(du), dp
            )
            stiffness += b.scatter(element_change, self.size)
            p_bar += parameter_change
        return stiffness, p_bar

    def mass(self, p: np.ndarray, lumped: bool = False) -> scipy.sparse.csc_matrix:
        """Mass matrix of the whole structure, diagonal if lumped."""
        return self.matrix(b.kind.masses(b.data(p), lumped) for b in self.blocks)

    def inertia_forces(self, motion: Moved, p: np.ndarray, lumped: bool) -> np.ndarray:
        """(n,) inertia forces of displaced elements, ``motion = (u, v, a)``."""
        return self._added(
            lambda b: b.kind.inertia_forces(b.gather_motion(motion), b.data(p), lumped)
        )

    def inertia_slopes(
        self, motion: Moved, p: np.ndarray, lumped: bool
    ) -> list[scipy.sparse.csc_matrix]:
        """Derivatives of the inertia forces by displacements, velocities and accelerations."""
        if not self.blocks:
            return [scipy.sparse.csc_matrix((self.size, self.size))] * 3
        parts = [
            b.kind.inertia_slopes(b.gather_motion(motion), b.data(p), lumped) for b in self.blocks
        ]
        return [self.matrix(by) for by in zip(*parts, strict=True)]

    def push_inertia(
        self, motion: Moved, p: np.ndarray, dp: np.ndarray, lumped: bool = False
    ) -> np.ndarray:
        """(n,) change of the inertia forces with the parameters."""
        return self._added(
            lambda b: b.kind.push_inertia(
                b.gather_motion(motion), b.data(p), b.push_data(p, dp), lumped
            )
        )

    def pull_inertia(
        self, motion: Moved, p: np.ndarray, weights: np.ndarray, lumped: bool = False
    ) -> np.ndarray:
        """Weights of the parameters from weights (n,) of the inertia forces."""
        return self._to_parameters(
            p,
            lambda b: b.kind.pull_inertia(
                b.gather_motion(motion), b.data(p), b.gather(weights), lumped
            ),
        )

    def turn_inertia(
        self, motion: Moved, p: np.ndarray, weights: np.ndarray, dp: np.ndarray
    ) -> np.ndarray:
        """(np,) change of the result of ``pull_inertia`` with the parameters."""
        turned = (
            b.turn_inertia(b.gather_motion(motion), p, b.gather(weights), dp) for b in self.blocks
        )
        return sum(turned, np.zeros(p.size))

    def geometric(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """Geometric stiffness ``σ · ∂²ε/∂u² (0)`` by the stresses ``σ`` of displacements."""
        return self.matrix(b.kind.geometric(b.gather(u), b.data(p)) for b in self.blocks)

    def stiffness_change(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """``∂³W/∂u³ (0) · u`` of the exact energies ``W``."""
        return self.matrix(b.kind.stiffness_change(b.gather(u), b.data(p)) for b in self.blocks)

    def push_stiffness(
        self,
        x: np.ndarray,
        u: np.ndarray,
        p: np.ndarray,
        du: np.ndarray,
        dp: np.ndarray,
        of: Stiffness = "tangent",
    ) -> np.ndarray:
        """(n,) change of ``K(u, p) x`` of a kind of stiffness."""

        def pushed(b: ElementBlock) -> np.ndarray:
            arguments = b.data(p), b.push_data(p, dp), b.gather(du), b.gather(x)
            return b.kind.push_stiffness(b.gather(u), *arguments, of)

        return self._added(pushed)

    def pull_stiffness(
        self,
        a: np.ndarray,
        b: np.ndarray,
        u: np.ndarray,
        p: np.ndarray,
        of: Stiffness = "tangent",
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of displacements and parameters in ``aᵀ K(u, p) b`` of a kind of stiffness."""
        u_bar, p_bar = np.zeros(self.size), np.zeros(p.size)
        for block in self.blocks:
            arguments = block.gather(u), block.data(p), block.gather(a), block.gather(b)
            own, data = block.kind.pull_stiffness(*arguments, of)
            u_bar += block.scatter(own, self.size)
            p_bar += block.pull_data(p, data)
        return u_bar, p_bar

    # sums over the blocks -----------------------------------------------------------------
    def _added(self, forces: Callable[[ElementBlock], np.ndarray]) -> np.ndarray:
        """(n,) sum of forces (k, ne) on the elements of each block."""
        total = np.zeros(self.size)
        for block in self.blocks:
            total += block.scatter(forces(block), self.size)
        return total

    def _to_parameters(
        self, p: np.ndarray, weights: Callable[[ElementBlock], np.ndarray], time: float = 0.0
    ) -> np.ndarray:
        """(np,) weights of the parameters from those of the data (m, ne) of each block."""
        return sum((b.pull_data(p, weights(b), time) for b in self.blocks), np.zeros(p.size))
