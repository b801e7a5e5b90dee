"""Velocities of shapes by the speeds of their bodies, and of gaps by those of two shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import scipy

from dalembert.symbolic.evaluation.kernel import Kernel, Matrix
from dalembert.symbolic.formulas.expression import stack

TWIST = 6
"""Components of a velocity and an angular velocity."""
DENSE = 100
"""Upper limit of speeds for which directions of gaps are arrays: handling patterns costs more."""
MOST = 20_000
"""Upper limit of pairs of a shape and a speed for the same."""


class ShapeVelocities:
    """``J`` of all shapes, each with the columns of its own speeds, or of all speeds if these are
    few.

    Parameters
    ----------
    moving : (6 n,) twists of the shapes
    speeds : (n_v,) symbols of the speeds
    inputs : other symbols
    """

    def __init__(self, moving: ca.SX, speeds: ca.SX, inputs: Sequence[ca.SX]):
        jacobian = ca.sparsify(ca.jacobian(moving, speeds))
        row = np.array(jacobian.sparsity().row(), dtype=int)
        starts = np.array(jacobian.sparsity().colind(), dtype=int)
        column = np.repeat(np.arange(speeds.numel()), np.diff(starts))
        shape, self._count = row // TWIST, moving.numel() // TWIST
        self._speeds = speeds.numel()
        self._dense = self._speeds <= DENSE and self._count * self._speeds <= MOST
        moved = np.zeros((self._count, self._speeds), dtype=bool) if self._dense else None
        if moved is not None:
            moved[shape, column] = True
            self._width, within = self._speeds, column
        else:
            within = self._own_columns(shape, column)
        self._moved, self._places = moved, (shape, row % TWIST, within)
        entries = ca.densify(stack(jacobian.nonzeros()))  # type: ignore[arg-type]
        self._entries = Kernel(ca.Function("velocities", list(inputs), [entries]))
        fixed = not ca.depends_on(entries, ca.vertcat(*inputs))
        self._constant = self._assembled(self._entries(*([0.0] * len(inputs)))) if fixed else None

    def _own_columns(self, shape: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Places of entries among the speeds of their shapes, which are listed."""
        own = np.unique(np.stack([shape, column]), axis=1)
        sizes = np.bincount(own[0], minlength=self._count)
        self._width = int(sizes.max(initial=1))
        self._used = np.arange(self._width) < sizes[:, None]
        self._columns = np.zeros((self._count, self._width), dtype=int)
        place = np.arange(own.shape[1]) - (np.cumsum(sizes) - sizes)[own[0]]
        self._columns[own[0], place] = own[1]
        order = {(int(s), int(c)): int(k) for s, c, k in zip(*own, place, strict=True)}
        within = [order[int(s), int(c)] for s, c in zip(shape, column, strict=True)]
        return np.array(within, dtype=int)

    def __call__(self, *arguments) -> np.ndarray:
        """(n, 6, c) derivatives of the twists by the own speeds of the shapes, or by all."""
        if self._constant is not None:
            return self._constant
        return self._assembled(self._entries(*arguments))

    def _assembled(self, entries: list[np.ndarray]) -> np.ndarray:
        derivatives = np.zeros((self._count, TWIST, self._width))
        derivatives[self._places] = entries[0].ravel()
        return derivatives

    def fastest(self, derivatives: np.ndarray, travels: np.ndarray) -> float:
        """The largest displacement of a shape by displacements (n_v, m) of the bodies."""
        moved = self.displacements(derivatives[:, :3], travels)
        return float(np.sqrt(np.einsum("scm,scm->sm", moved, moved).max(initial=0.0)))

    def displacements(self, derivatives: np.ndarray, travels: np.ndarray) -> np.ndarray:
        """(n, 6, m) displacements and rotations of the shapes by those of the bodies."""
        moved: np.ndarray = derivatives @ (travels if self._dense else travels[self._columns])
        return moved

    def gap_derivatives(
        self, blocks: np.ndarray, first: np.ndarray, second: np.ndarray, derivatives: np.ndarray
    ) -> GapDerivatives:
        """``W = K J`` of pairs with derivatives ``blocks`` (n, k, 12) by both twists."""
        return GapDerivatives(self, blocks, np.stack([first, second], axis=1), derivatives)

    def rows(self, blocks: np.ndarray, shapes: np.ndarray, derivatives: np.ndarray) -> Matrix:
        """``W`` (n k, n_v) of pairs of shapes (n, 2), dense for few speeds."""
        count, components = blocks.shape[:2]
        own = derivatives[shapes]
        if self._dense:
            rows = blocks @ own.reshape(count, 2 * TWIST, self._speeds)
            return rows.reshape(count * components, self._speeds)
        by_twists = blocks.reshape(count, components, 2, TWIST).swapaxes(1, 2)
        values = (by_twists @ own).swapaxes(1, 2)
        return self._compressed(values, self._columns[shapes], self._used[shapes])

    def moved(self, shapes: np.ndarray) -> np.ndarray | None:
        """(n, n_v) mask of the speeds that move pairs of shapes (n, 2); None for many speeds."""
        if self._moved is None:
            return None
        moved: np.ndarray = self._moved[shapes].any(axis=1)
        return moved

    def _compressed(
        self, values: np.ndarray, columns: np.ndarray, used: np.ndarray
    ) -> scipy.sparse.csr_array:
        """``W`` compressed by rows, of values (n, k, 2, c) for speeds (n, 2, c)."""
        count, components = values.shape[:2]
        starts = np.zeros(count * components + 1, dtype=np.int32)
        np.cumsum(np.repeat(used.sum(axis=(1, 2)), components), out=starts[1:])
        inside = np.repeat(used[:, None], components, axis=1)
        indices = np.repeat(columns[:, None], components, axis=1)[inside].astype(np.int32)
        shape = count * components, self._speeds
        return scipy.sparse.csr_array((values[inside], indices, starts), shape=shape)


@dataclass(frozen=True, eq=False)
class GapDerivatives:
    """Derivatives of gap velocities by the speeds of two shapes each.

    Attributes
    ----------
    velocities : ShapeVelocities
    blocks : (n, k, 12) derivatives by both twists
    shapes : (n, 2) numbers of the shapes
    derivatives : (s, 6, c) of the twists by the speeds of the shapes
    """

    velocities: ShapeVelocities
    blocks: np.ndarray
    shapes: np.ndarray
    derivatives: np.ndarray

    def rows(self, selected: np.ndarray | slice = slice(None)) -> Matrix:
        """``W`` (m k, n_v) of selected gaps, of all by default."""
        blocks, shapes = self.blocks[selected], self.shapes[selected]
        return self.velocities.rows(blocks, shapes, self.derivatives)

    def moved(self, selected: np.ndarray | slice = slice(None)) -> np.ndarray | None:
        """(m, n_v) mask of the speeds that move the shapes of selected gaps, of all by default;
        None for many speeds."""
        return self.velocities.moved(self.shapes[selected])
