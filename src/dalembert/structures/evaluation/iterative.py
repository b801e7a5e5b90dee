"""Solving with a stiffness without factors of it, and when that is better."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np
import scipy

from dalembert.sparse import multigrid, pardiso
from dalembert.sparse.factorise import PARDISO_ROWS
from dalembert.sparse.multigrid import Multigrid
from dalembert.structures.evaluation.block import ElementBlock
from dalembert.structures.evaluation.factors import SOFTEST, refuse_motion
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.reduction.rigid import node_places, rigid_motions

LOOSE = 1e-6
"""Residual to which a random load is balanced, to see whether anything moves freely."""
SOFT = 1e-13
"""Energy of a rigid motion that counts as none, relative to that of its terms."""
FACTORS = {"SuperLU": ((2.7e8, 1.28), (3.0e9, 1.54)), "PARDISO": ((1.6e8, 1.1), (1.0e9, 1.33))}
"""Bytes of factors for 1e5 free displacements of plates and of solids, and their growth."""
SHARE = 0.7
"""Share of the free memory that factors may take."""


def multigrid_of(
    matrix, blocks: Sequence[ElementBlock], degrees: Numbering, free: np.ndarray, p: np.ndarray
) -> Multigrid | None:
    """Conjugate gradients for the stiffness of free displacements, which have these numbers.

    Raises
    ------
    SingularityError
        It is singular: names the nodes that can move without straining anything.
    UnsupportedError
        ``pyamg`` is not installed.
    """
    if not matrix.shape[0]:
        return None
    places = node_places(list(blocks), degrees, p)
    motions = rigid_motions(degrees, places - places.mean(axis=0))[free]
    own = np.abs(matrix.diagonal())
    if not matrix.diagonal().all():
        refuse_motion(matrix.diagonal() == 0, degrees, free)
    _refuse_rigid(matrix, own, motions, degrees, free)
    used = np.flatnonzero((degrees.table >= 0).any(axis=0))  # plates have no rotations
    table = degrees.table[:, used]
    slots = np.zeros(len(degrees), dtype=np.int64)
    slots[table[table >= 0]] = np.flatnonzero(table.ravel() >= 0)
    solver = Multigrid(matrix, slots[free], used.size, motions)
    root, pushed = np.sqrt(own), np.random.default_rng(0).standard_normal(own.size)
    moved, residual = solver.attempt(root * pushed / np.linalg.norm(pushed), LOOSE)
    if not (residual <= 1 and SOFTEST * np.linalg.norm(root * moved) < 1):
        refuse_motion(moved, degrees, free)
    solver.iterations = 0
    return solver


def _refuse_rigid(matrix, own: np.ndarray, motions: np.ndarray, degrees: Numbering, free) -> None:
    """Raise where the structure can move as a whole."""
    kept = motions[:, np.abs(motions).max(axis=0, initial=0.0) > 0]
    kept = kept / np.sqrt(np.einsum("fk,f,fk->k", kept, own, kept))
    basis, sizes, _ = scipy.linalg.svd(np.sqrt(own)[:, None] * kept, full_matrices=False)
    basis = basis[:, sizes > 1e-8 * sizes[0]] / np.sqrt(own)[:, None]
    energies, mixed = np.linalg.eigh(basis.T @ (matrix @ basis))
    if energies[0] < SOFT:
        refuse_motion(basis @ mixed[:, 0], degrees, free)


def better_iterative(
    size: int, blocks: Sequence[ElementBlock], memory: float | None = None
) -> bool:
    """Whether factors would need more memory than is free, so far as that can be told before."""
    memory = free_memory() if memory is None else memory
    if not multigrid.available() or memory is None or size < PARDISO_ROWS:
        return False
    solid = any(block.kind.cls.contractible and block.kind.dimension == 3 for block in blocks)
    bytes_, growth = FACTORS["PARDISO" if pardiso.available() else "SuperLU"][solid]
    return bytes_ * (size / 1e5) ** growth > SHARE * memory


def free_memory() -> float | None:
    """Bytes that could be taken now, None where the system does not tell."""
    try:
        with open("/proc/meminfo") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return 1024.0 * float(line.split()[1])
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError, AttributeError):
        return None
