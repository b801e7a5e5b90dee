"""Derivatives of a Craig–Bampton reduction by the parameters of a structure.

Only the space spanned by the shapes matters, so that changes of fixed-interface modes are taken
M-orthogonal to all modes: ``(K − ω² M) φ' = −(K' − ω² M') φ``. Coinciding or crossing modes need no
special treatment; the derivatives are those of the reduced matrices for shapes that change in this
way, and of all quantities that do not depend on the basis.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
import scipy

from dalembert.model.assembled.evaluation.inertia import from_rest
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton
from dalembert.model.assembled.reduction.rigid import pull_positions, push_positions, spins
from dalembert.sparse.factorise import general_factors


class ReductionSlopes:
    """Directional derivatives of a Craig–Bampton reduction, forwards and backwards.

    Parameters
    ----------
    reduced : CraigBampton
    degrees : numbers of the displacements
    """

    def __init__(self, reduced: CraigBampton, degrees: Numbering):
        self.reduced, self.degrees = reduced, degrees
        self.assembly, self.p = reduced.assembly, reduced.p
        self.rest = np.zeros(self.assembly.size)
        self.stiffness = self.assembly.stiffness(self.rest, self.p)
        self.mass = self.assembly.mass(self.p)
        self.statics = reduced.shapes.shape[1] - reduced.frequencies.size
        """Number of constraint modes."""

    def push(self, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Changes (r, r) of the reduced stiffness and mass along a change of the parameters."""
        shapes = self.reduced.shapes
        stiffer, heavier = self.push_stiffness(shapes, dp), self.push_mass(shapes, dp)
        shape_changes = self._moved(stiffer, heavier, self.push_motions(dp))
        changes = []
        for matrix, change in ((self.stiffness, stiffer), (self.mass, heavier)):
            half = shape_changes.T @ (matrix @ shapes)
            changes.append(half + half.T + shapes.T @ change)
        return changes[0], changes[1]

    def push_shapes(self, dp: np.ndarray) -> np.ndarray:
        """Changes (n, r) of the shapes, those of modes orthogonal to their space."""
        shapes = self.reduced.shapes
        stiffer, heavier = self.push_stiffness(shapes, dp), self.push_mass(shapes, dp)
        return self._moved(stiffer, heavier, self.push_motions(dp))

    def _moved(self, stiffer: np.ndarray, heavier: np.ndarray, moved: np.ndarray) -> np.ndarray:
        free, first = self.assembly.free, slice(self.statics)
        if self.reduced.factor is not None:
            imbalance = stiffer[:, first] + self.stiffness @ moved[:, first]
            moved[free, first] = -self.reduced.factor.solve(imbalance[free])
            for k, frequency in enumerate(self.reduced.frequencies):
                column = self.statics + k
                load = stiffer[free, column] - frequency**2 * heavier[free, column]
                moved[free, column] = -self._outside(k, load)
        return moved

    def pull(self, stiffness_bar: np.ndarray, mass_bar: np.ndarray) -> np.ndarray:
        """Weights (np,) of the parameters from weights (r, r) of both matrices."""
        k_bar, m_bar = ((bar + bar.T) / 2 for bar in (stiffness_bar, mass_bar))
        shapes = self.reduced.shapes
        v_bar = 2 * (self.stiffness @ shapes @ k_bar + self.mass @ shapes @ m_bar)
        none = np.zeros_like(shapes)
        return self.pull_shapes(v_bar, shapes @ k_bar, shapes @ m_bar, none)

    def pull_shapes(
        self, v_bar: np.ndarray, stiff: np.ndarray, heavy: np.ndarray, motions_bar: np.ndarray
    ) -> np.ndarray:
        """Weights (np,) of the parameters from weights (n, r) of the shapes.

        Parameters
        ----------
        stiff, heavy : further weights of ``K'`` and ``M'`` times each shape
        motions_bar : weights of the unit motions of the interfaces
        """
        shapes, free, v_bar = self.reduced.shapes, self.assembly.free, v_bar.copy()
        if self.reduced.factor is not None:
            first, held = slice(self.statics), self.assembly.prescribed
            eased = np.zeros((self.assembly.size, self.statics))
            eased[free] = self.reduced.factor.solve(v_bar[free, first])
            stiff[:, first] -= eased
            v_bar[held, first] -= (self.stiffness @ eased)[held]
            for k, frequency in enumerate(self.reduced.frequencies):
                column = self.statics + k
                eased_mode = self._outside(k, v_bar[free, column])
                stiff[free, column] -= eased_mode
                heavy[free, column] += frequency**2 * eased_mode
        p_bar = self._pull_motions(v_bar + motions_bar)
        return p_bar + self.pull_stiffness(stiff, shapes) + self.pull_mass(heavy, shapes)

    # fixed-interface modes ----------------------------------------------------------------
    def _outside(self, k: int, load: np.ndarray) -> np.ndarray:
        """``(K − ω² M)⁻¹`` of a load in the space M-orthogonal to all modes; symmetric."""
        modes = self.reduced.shapes[self.assembly.free, self.statics :]
        own = load - self._momenta @ (modes.T @ load)
        solution = self._bordered[k](np.concatenate([own, np.zeros(modes.shape[1])]))
        return solution[: own.size]

    @cached_property
    def _momenta(self) -> np.ndarray:
        modes = self.reduced.shapes[self.assembly.free, self.statics :]
        return self.assembly.inner(self.mass) @ modes

    @cached_property
    def _bordered(self) -> list[Callable[[np.ndarray], np.ndarray]]:
        """Solvers of ``K − ω² M`` bordered by the modes, one per mode."""
        k, m = (self.assembly.inner(matrix) for matrix in (self.stiffness, self.mass))
        border = scipy.sparse.csc_matrix(self._momenta)
        return [
            general_factors(scipy.sparse.bmat([[k - w**2 * m, border], [border.T, None]])).solve
            for w in self.reduced.frequencies
        ]

    # parts --------------------------------------------------------------------------------
    def push_stiffness(self, table: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of ``K`` times each column."""
        arguments = self.rest, self.p, self.rest, dp
        return self._columns(lambda b: self.assembly.push_stiffness(b, *arguments), table)

    def push_mass(self, table: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of ``M`` times each column."""
        return self._columns(lambda b: self.assembly.push_inertia(from_rest(b), self.p, dp), table)

    def pull_stiffness(self, bars: np.ndarray, table: np.ndarray) -> np.ndarray:
        """Weights (np,) of the parameters from weights of ``K`` times each column."""
        p_bar = np.zeros(self.p.size)
        for bar, column in zip(bars.T, table.T, strict=True):
            if bar.any():
                arguments = (
                    np.ascontiguousarray(bar),
                    np.ascontiguousarray(column),
                    self.rest,
                    self.p,
                )
                p_bar += self.assembly.pull_stiffness(*arguments)[1]
        return p_bar

    def pull_mass(self, bars: np.ndarray, table: np.ndarray) -> np.ndarray:
        """Weights (np,) of the parameters from weights of ``M`` times each column."""
        p_bar = np.zeros(self.p.size)
        for bar, column in zip(bars.T, table.T, strict=True):
            if bar.any():
                arguments = (
                    from_rest(np.ascontiguousarray(column)),
                    self.p,
                    np.ascontiguousarray(bar),
                )
                p_bar += self.assembly.pull_inertia(*arguments)
        return p_bar

    @staticmethod
    def _columns(act: Callable[[np.ndarray], np.ndarray], table: np.ndarray) -> np.ndarray:
        products = np.zeros_like(table)
        for k, column in enumerate(table.T):
            products[:, k] = act(np.ascontiguousarray(column))
        return products

    def push_motions(self, dp: np.ndarray) -> np.ndarray:
        """(n, r) change of the unit motions of the interfaces with the positions of their nodes."""
        change, d = np.zeros_like(self.reduced.shapes), self.degrees.dimension
        positions = push_positions(self.assembly.blocks, self.degrees, self.p, dp)
        for interface in self.reduced.interfaces:
            if interface.turns:
                arms = positions[interface.nodes] - positions[interface.nodes].mean(axis=0)
                rows = self.degrees.table[interface.nodes, :d]
                for k, spin in enumerate(spins(d)):
                    change[rows, self._turn(interface.name, k)] = arms @ spin.T
        return change

    def _pull_motions(self, v_bar: np.ndarray) -> np.ndarray:
        d = self.degrees.dimension
        positions = np.zeros((len(self.degrees.table), d))
        for interface in self.reduced.interfaces:
            if interface.turns:
                rows = self.degrees.table[interface.nodes, :d]
                for k, spin in enumerate(spins(d)):
                    bar = v_bar[rows, self._turn(interface.name, k)] @ spin
                    positions[interface.nodes] += bar - bar.mean(axis=0)
        return pull_positions(self.assembly.blocks, self.degrees, self.p, positions)

    def _turn(self, interface: str, axis: int) -> int:
        """Column of a rotation of an interface."""
        return self.reduced.columns[interface].start + self.degrees.dimension + axis
