"""Design derivatives of element sums over many states of a structure.

A run passes through thousands of states. Terms that are linear in the state, ``K x`` of small
displacements and ``M x``, need only the products of states and weights, summed over the run: the
compiled functions of the elements are then called once per displacement of an element.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import scipy

from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.block import ElementBlock, ElementKind
from dalembert.model.assembled.evaluation.inertia import Moved


class Pulls:
    """Adjoint: weights of the parameters from weights of internal forces at many states.

    Weights of the element data are accumulated and passed to the parameters at the end.

    Parameters
    ----------
    assembly : of the structure
    p : (np,) values of the parameters
    rows : number of separate sums
    """

    def __init__(self, assembly: Assembly, p: np.ndarray, rows: int):
        self.blocks, self.p, self.rows = assembly.blocks, p, rows
        self._data = [b.data(p) for b in self.blocks]
        self._data_bar = [np.zeros((*data.shape, rows)) for data in self._data]

    def forces(self, u: np.ndarray, weights: np.ndarray) -> None:
        """Add ``Σ_s ηᵀ ∂f(u_s)/∂p`` for displacements (n, S) and weights (n, S, rows)."""
        self._add(lambda kind, x, data, eta: kind.pull(x[0], data, eta), (u,), weights)

    def inertia(self, motion: Moved, weights: np.ndarray, lumped: bool) -> None:
        """Add the same for inertia forces of displaced elements, ``(u, v, a)`` each (n, S)."""
        self._add(lambda kind, x, d, eta: kind.pull_inertia(x, d, eta, lumped), motion, weights)

    def _add(self, pull: Callable, motion: tuple[np.ndarray, ...], weights: np.ndarray) -> None:
        states = [np.repeat(x, self.rows, axis=1) for x in motion]
        etas = weights.reshape(weights.shape[0], -1)
        for b, data, data_bar in zip(self.blocks, self._data, self._data_bar, strict=True):
            columns, repeated = (
                tuple(_gathered(b, x) for x in states),
                _repeated(data, etas.shape[1]),
            )
            pulled = pull(b.kind, columns, repeated, _gathered(b, etas))
            data_bar += pulled.reshape(*data.shape, -1, self.rows).sum(axis=2)

    def products(self, products: Products, pull: Callable) -> None:
        """Add ``Σ_s ηᵀ ∂A/∂p x_s`` with ``pull(kind, x, data, η)``, the adjoint of ``A x``.

        States are unit vectors, and weights the sums: small displacements would be lost in the
        rounding of forces at rest.
        """
        for b, data, data_bar, sums in zip(
            self.blocks, self._data, self._data_bar, products.sums, strict=True
        ):
            repeated = _repeated(data, self.rows)
            for j in range(sums.shape[2]):
                unit = np.zeros((sums.shape[2], repeated.shape[1]))
                unit[j] = 1.0
                eta = sums[:, :, :, j].reshape(repeated.shape[1], -1).T
                data_bar += pull(b.kind, unit, repeated, eta).reshape(data_bar.shape)

    @property
    def total(self) -> np.ndarray:
        """(np, rows) weights of the parameters."""
        p_bar = np.zeros((self.p.size, self.rows))
        for block, data in zip(self.blocks, self._data_bar, strict=True):
            for r in range(self.rows):
                p_bar[:, r] += block.pull_data(self.p, data[:, :, r])
        return p_bar


class Products:
    """``Σ_s η_s x_sᵀ`` of every element.

    Parameters
    ----------
    assembly : of the structure
    rows : number of separate sums

    Attributes
    ----------
    sums : (ne, rows, k, k) of each block
    """

    def __init__(self, assembly: Assembly, rows: int):
        self.blocks, self.rows = assembly.blocks, rows
        sizes = [b.kind.displacement_count for b in self.blocks]
        self.sums = [
            np.zeros((b.count, rows, k, k)) for b, k in zip(self.blocks, sizes, strict=True)
        ]

    def add(self, x: np.ndarray, weights: np.ndarray) -> None:
        """Add states (n, S) with weights (n, S, rows)."""
        for b, sums in zip(self.blocks, self.sums, strict=True):
            state = b.gather(x).transpose(1, 2, 0)
            eta = b.gather(weights).transpose(1, 3, 0, 2)
            sums += eta @ state[:, None]


class Pushes:
    """Tangent: changes of internal and inertia forces in many directions of the parameters.

    Parameters
    ----------
    assembly : of the structure
    p : (np,) values of the parameters
    directions : (np, c) changes of the parameters
    """

    def __init__(self, assembly: Assembly, p: np.ndarray, directions: np.ndarray):
        self.assembly, self.count = assembly, directions.shape[1]
        self._data = [b.data(p) for b in assembly.blocks]
        self._changes = [
            np.stack([b.push_data(p, dp) for dp in directions.T], axis=2) for b in assembly.blocks
        ]
        self._sums = [_incidence(b, assembly.size) for b in assembly.blocks]

    def forces(self, u: np.ndarray) -> np.ndarray:
        """(n, c) changes of the internal forces at displacements (n,)."""
        return self._sum(lambda kind, x, *data: kind.push(x[0], *data), (u,))

    def inertia(self, motion: Moved, lumped: bool) -> np.ndarray:
        """(n, c) changes of inertia forces of displaced elements, ``(u, v, a)`` each (n,)."""
        return self._sum(lambda kind, x, *data: kind.push_inertia(x, *data, lumped), motion)

    def _sum(self, push: Callable, motion: tuple[np.ndarray, ...]) -> np.ndarray:
        total = np.zeros((self.assembly.size, self.count))
        states = [np.repeat(x[:, None], self.count, axis=1) for x in motion]
        for b, data, change, summing in self._blocks():
            repeated = _repeated(data, self.count), change.reshape(data.shape[0], -1)
            forces = push(b.kind, tuple(_gathered(b, x) for x in states), *repeated)
            total += summing @ forces.reshape(-1, self.count)
        return total

    def matrices(self, push: Callable) -> scipy.sparse.csr_matrix:
        """(c · n, n) changes of ``A``, with ``push(kind, x, data, change)``, the change of ``A x``.

        Parameters usually change few elements: only nonzero entries are stored.
        """
        matrices = []
        for i in range(self.count):
            parts = [
                _matrices(push, b.kind, data, change[:, :, i])
                for b, data, change, _ in self._blocks()
            ]
            matrices.append(self.assembly.matrix(parts).tocsr())
            matrices[-1].eliminate_zeros()
        empty = scipy.sparse.csr_matrix((0, self.assembly.size))
        return scipy.sparse.vstack([empty, *matrices], format="csr")

    def _blocks(self) -> Iterator:
        return zip(self.assembly.blocks, self._data, self._changes, self._sums, strict=True)


def _matrices(push: Callable, kind: ElementKind, data, change) -> np.ndarray:
    """(k, k, ne) changes of element matrices, column by column."""
    k, count = kind.displacement_count, data.shape[1]
    matrices = np.zeros((k, k, count))
    if change.any():
        for j in range(k):
            unit = np.zeros((k, count))
            unit[j] = 1.0
            matrices[:, j] = push(kind, unit, data, change)
    return matrices


def _repeated(data: np.ndarray, count: int) -> np.ndarray:
    """(m, ne · count): every element repeated ``count`` times."""
    return np.repeat(data, count, axis=1)


def _gathered(block: ElementBlock, columns: np.ndarray) -> np.ndarray:
    """(k, ne · count) of the elements from (n, count)."""
    return block.gather(columns).reshape(block.degrees.shape[0], -1)


def _incidence(block: ElementBlock, size: int) -> scipy.sparse.csr_matrix:
    """Matrix that sums element entries (k · ne) by displacement."""
    numbers = block.degrees.ravel()
    ones = np.ones(numbers.size)
    return scipy.sparse.csr_matrix((ones, (numbers, np.arange(numbers.size))), (size, numbers.size))
