"""Speeds and joint multipliers of a step for given momenta, body by body where bodies are free."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.nonsmooth.saddle import Entries, SaddlePattern, saddle, stored_entries
from dalembert.errors import SingularityError
from dalembert.integrators.contact.block_ordering import BlockOrderings
from dalembert.integrators.contact.delassus import DENSE, Delassus
from dalembert.sparse.factorise import general_factors
from dalembert.symbolic.evaluation.kernel import Matrix

WIDEST = 6
"""Largest number of coupled speeds without joints whose matrix is inverted as a block."""
PATTERNS = 3
"""Upper limit of the stored patterns of matrices: those of steps, and of mass alone."""
WHOLE = 40
"""Upper limit of speeds and joints that are factorised together, as this costs less than blocks."""
SINGULAR = "inertia and joints of a step have no solution; look for a singular position"
COLUMNS = 256
"""Right-hand sides solved at once with the factors of coupled bodies."""


@dataclass(frozen=True, eq=False)
class Coupling:
    """Independent groups of speeds.

    Attributes
    ----------
    group, position : (n,) number of the block of a speed, and its position in the block; -1 for
        speeds outside of blocks
    members : (groups, w) speeds of each block; the last one is repeated in shorter blocks
    sizes : (groups,) numbers of speeds of the blocks
    coupled : speeds in larger groups or with joints
    orderings : orders of elimination of the speeds of free bodies; None with joints
    entries : rows and columns of the entries of the matrix and of the joints
    patterns : the last ones of the matrix of the coupled speeds with their joints
    """

    group: np.ndarray
    position: np.ndarray
    members: np.ndarray
    sizes: np.ndarray
    coupled: np.ndarray
    orderings: BlockOrderings | None = None
    entries: tuple[Entries, Entries] | None = None
    patterns: list[SaddlePattern] = field(default_factory=list)

    def saddle(self, matrix: Matrix, joints: Matrix) -> Matrix:
        """``[[A, Cᵀ], [C, 0]]`` of the coupled speeds."""
        if not self.coupled.size and not joints.shape[0]:
            return np.zeros((0, 0))
        if not (scipy.sparse.issparse(matrix) or scipy.sparse.issparse(joints)):
            speeds = self.coupled
            if speeds.size < matrix.shape[0]:
                matrix, joints = matrix[speeds][:, speeds], joints[:, speeds]
            return saddle(matrix, joints)
        for pattern in self.patterns:
            if pattern.fits(matrix, joints):
                return pattern.filled(matrix, joints)
        assert self.entries is not None
        pairs = zip((matrix, joints), self.entries, strict=True)
        first, second = (stored_entries(part, entries) for part, entries in pairs)
        pattern = SaddlePattern.of((first, second), self.coupled, joints.shape)
        self.patterns[:] = [pattern, *self.patterns][:PATTERNS]
        return pattern.filled(matrix, joints)

    @classmethod
    def of(
        cls,
        pattern: ca.Sparsity,
        joints: ca.Sparsity,
        bodies: Sequence[int] = (),
        whole: int = 0,
    ) -> Coupling:
        """Groups of speeds connected by a matrix (n, n) or by joints (m, n).

        Parameters
        ----------
        bodies : numbers of consecutive speeds of bodies, if there are such
        whole : limit of ``n + m`` up to which all speeds count as coupled, if there are joints
        """
        rows, columns = np.array(joints.row(), dtype=int), _columns(joints)
        n = pattern.size2()
        own = np.array(pattern.row(), dtype=int), _columns(pattern)
        row, column = (np.concatenate(p) for p in zip(own, (n + rows, columns), strict=True))
        size = n + joints.size1()
        graph = scipy.sparse.coo_array((np.ones(row.size), (row, column)), shape=(size, size))
        labels = scipy.sparse.csgraph.connected_components(graph, directed=False)[1][:n]
        sizes = np.bincount(labels, minlength=labels.max(initial=-1) + 1)
        joined = np.zeros(sizes.size, dtype=bool)
        joined[labels[columns]] = True
        blocked = (sizes <= WIDEST) & ~joined
        if joints.size1() and size <= whole:
            blocked[:] = False
        order = np.argsort(labels, kind="stable")
        order = order[blocked[labels[order]]]
        numbers = np.cumsum(blocked) - 1
        group, position = np.full(n, -1), np.full(n, -1)
        group[order] = numbers[labels[order]]
        first = np.cumsum(sizes[blocked]) - sizes[blocked]
        position[order] = np.arange(order.size) - first[group[order]]
        width = int(sizes[blocked].max(initial=1))
        last = sizes[blocked] - 1
        place = first[:, None] + np.minimum(np.arange(width), last[:, None])
        orderings = None
        if sum(bodies) == n and not joints.size1():
            orderings = BlockOrderings(np.array(bodies, dtype=int), np.stack(own))
        coupled = np.flatnonzero(group < 0)
        entries = own, (rows, columns)
        return cls(group, position, order[place], sizes[blocked], coupled, orderings, entries)

    @cached_property
    def free(self) -> np.ndarray:
        """(n,) mask of the speeds in blocks."""
        return self.group >= 0

    @cached_property
    def inside(self) -> np.ndarray:
        """(groups, w, w) mask of the entries of blocks that are no padding."""
        inside = np.arange(self.members.shape[1]) < self.sizes[:, None]
        return np.asarray(inside[:, :, None] & inside[:, None])

    @cached_property
    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """Blocks of the speeds in blocks, and their positions in these."""
        return self.group[self.free], self.position[self.free]

    def repeated(self, count: int) -> Coupling:
        """Groups of the speeds of several steps that follow one another, all in blocks."""
        assert not self.coupled.size
        step, (groups, width) = np.arange(count), self.members.shape
        group = (self.group + groups * step[:, None]).ravel()
        members = self.members + self.group.size * step[:, None, None]
        position, sizes = np.tile(self.position, count), np.tile(self.sizes, count)
        own = members.reshape(-1, width), sizes, self.coupled
        orderings = None if self.orderings is None else self.orderings.repeated(count)
        return Coupling(group, position, *own, orderings)


class Mobility:
    """Solution of ``A x + Cᵀ λ = r``, ``C x = s``, for many right-hand sides.

    Parameters
    ----------
    matrix : (n, n) ``A``
    joints : (m, n) ``C``
    coupling : groups of speeds

    Raises
    ------
    SingularityError
        The matrix has no inverse.
    """

    def __init__(self, matrix: Matrix, joints: Matrix, coupling: Coupling):
        self.matrix, self.coupling = matrix, coupling
        self.plain = not coupling.coupled.size and coupling.members.shape[1] == 1
        try:
            if self.plain:
                self._diagonal = matrix.diagonal()
                if not self._diagonal.all():
                    raise np.linalg.LinAlgError("singular")
            else:
                self._inverses = self._inverted()
        except np.linalg.LinAlgError:
            raise SingularityError(SINGULAR) from None
        self._constrain(joints)

    def with_joints(self, joints: Matrix) -> Mobility:
        """The solution with other constraints of the same speeds."""
        if not (joints.shape[0] or self.joints.shape[0]):
            return self
        mobility = copy(self)
        mobility._constrain(joints)
        return mobility

    def _constrain(self, joints: Matrix) -> None:
        self.joints = joints
        if self.plain:
            return
        try:
            self._factors = general_factors(self.coupling.saddle(self.matrix, joints))
        except np.linalg.LinAlgError:
            raise SingularityError(SINGULAR) from None

    def __call__(
        self, right: np.ndarray, below: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Speeds and multipliers for momenta ``right`` and rates ``below`` of the joints, 0 by
        default."""
        m, shape = self.joints.shape[0], right.shape[1:]
        if self.plain:
            return (right.T / self._diagonal).T, np.zeros((m, *shape))
        below = np.zeros((m, *shape)) if below is None else below
        n, coupled = right.shape[0], self.coupling.coupled
        if coupled.size == n:
            solution = self._factors.solve(np.concatenate([right, below]))
            return solution[:n], solution[n:]
        speeds = np.zeros(right.shape)
        if self._inverses.size:
            members, free = self.coupling.members, self.coupling.free
            own = self._inverses @ right[members].reshape(*members.shape, -1)
            speeds[free] = own[self.coupling.places].reshape(-1, *shape)
        solution = self._factors.solve(np.concatenate([right[coupled], below]))
        speeds[coupled] = solution[: coupled.size]
        return speeds, solution[coupled.size :]

    def responses(self, directions: Matrix) -> Matrix:
        """(r, n) speeds by unit impulses along the rows of ``directions`` (r, n)."""
        if not scipy.sparse.issparse(directions):
            return self(directions.T)[0].T
        if self.plain:
            responses = directions.copy()  # with its own indices, as SciPy may sort them in place
            responses.data /= self._diagonal[directions.indices]
            return responses
        row = np.repeat(np.arange(directions.shape[0]), np.diff(directions.indptr))
        group = self.coupling.group[directions.indices]
        free = group >= 0
        parts = [self._free(row[free], directions.indices[free], directions.data[free])]
        rows, number = np.unique(row[~free], return_inverse=True)
        own = np.searchsorted(self.coupling.coupled, directions.indices[~free])
        values = directions.data[~free]
        for start in range(0, rows.size, COLUMNS):
            some = rows[start : start + COLUMNS]
            right = np.zeros((self.coupling.coupled.size + self.joints.shape[0], some.size))
            inside = (number >= start) & (number < start + COLUMNS)
            np.add.at(right, (own[inside], number[inside] - start), values[inside])
            speeds = self._factors.solve(right)[: self.coupling.coupled.size]
            place, column = np.nonzero(speeds)
            parts.append((some[column], self.coupling.coupled[place], speeds[place, column]))
        rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
        return scipy.sparse.csr_array((values, (rows, columns)), shape=directions.shape)

    def _free(
        self, row: np.ndarray, column: np.ndarray, value: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, columns and values of responses of free bodies."""
        group, members = self.coupling.group[column], self.coupling.members
        width = members.shape[1]
        inverse = self._inverses[group, :, self.coupling.position[column]]
        inside = np.arange(width) < self.coupling.sizes[group, None]
        rows = np.repeat(row, width).reshape(-1, width)[inside]
        return rows, members[group][inside], (value[:, None] * inverse)[inside]

    def _inverted(self) -> np.ndarray:
        """(groups, w, w) inverses of the blocks of free bodies."""
        members = self.coupling.members
        count, width = members.shape
        blocks = np.zeros((count, width, width))
        if not count:
            return blocks
        blocks[:] = np.eye(width)
        if isinstance(self.matrix, np.ndarray):
            own = self.matrix[members[:, :, None], members[:, None]]
            if width == 1 and own.all():
                return 1.0 / own
            return np.linalg.inv(np.where(self.coupling.inside, own, blocks))
        row, column, value = _entries(self.matrix)
        free = self.coupling.group[row] >= 0
        row, column = row[free], column[free]
        place = self.coupling.group[row], self.coupling.position[row]
        blocks[(*place, self.coupling.position[column])] = value[free]
        return np.linalg.inv(blocks)


def delassus(directions: Matrix, mobility: Mobility) -> Delassus:
    """``W A⁻¹ Wᵀ``; directions that are arrays are compressed by rows for many contacts."""
    if isinstance(directions, np.ndarray) and directions.shape[0] > DENSE:
        directions = scipy.sparse.csr_array(directions)
    responses = mobility.responses(directions)
    none = np.zeros(directions.shape[0])
    matrices = mobility.matrix, mobility.joints
    orderings = mobility.coupling.orderings
    return Delassus(directions, responses, *matrices, none, orderings=orderings)


def _columns(pattern: ca.Sparsity) -> np.ndarray:
    return np.repeat(np.arange(pattern.size2()), np.diff(np.array(pattern.colind(), dtype=int)))


def _entries(matrix: Matrix) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, columns and values of the entries of a sparse matrix."""
    entries = matrix.tocoo()
    return entries.row, entries.col, entries.data
