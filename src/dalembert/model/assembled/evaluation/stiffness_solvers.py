"""Direct and iterative solvers of a stiffness, and detection of mechanisms."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import NoReturn

import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.reduction.rigid import node_positions, rigid_motions
from dalembert.sparse import multigrid, pardiso
from dalembert.sparse.factorise import PARDISO_ROWS, pivoted_factors, symmetric_factors
from dalembert.sparse.multigrid import Multigrid
from dalembert.sparse.solver import Factors, SparseSolver

SOFTEST = 1e-14
"""Threshold of the energy of a free motion, relative to the terms whose difference it is."""

BACKWARD = 1e-10
"""Upper limit of the backward error of factors without pivoting."""


def factors_of(matrix, degrees: Numbering, free: np.ndarray) -> Factors | None:
    """Sparse factors of the stiffness of the free displacements.

    Raises
    ------
    SingularityError
        It is singular; names the nodes that can move without strain.
    """
    if not matrix.shape[0]:
        return None
    own = np.abs(matrix.diagonal())
    own[own == 0] = own.max() or 1.0
    factor = _factors(matrix, own)
    motion, error = _softest(factor, matrix, np.sqrt(own))
    if not (error < BACKWARD and SOFTEST * np.linalg.norm(motion) < 1.0):
        factor = _factors(matrix, own, pivoting=True)  # past a limit point pivots may vanish
        motion, error = _softest(factor, matrix, np.sqrt(own))
    if not np.all(np.isfinite(motion)):
        raise SingularityError("the stiffness matrix is singular; support the structure")
    if SOFTEST * np.linalg.norm(motion) > 1.0:
        refuse_motion(motion / np.sqrt(own), degrees, free)
    return factor


def free_displacements(
    factor: SparseSolver | None, free: np.ndarray, forces: np.ndarray
) -> np.ndarray:
    """(n,) displacements under forces (n,), zero where prescribed; ``factor`` of the free part."""
    u = np.zeros_like(forces)
    if factor is not None:
        u[free] = factor.solve(forces[free])
    return u


def refuse_motion(motion: np.ndarray, degrees: Numbering, free: np.ndarray) -> NoReturn:
    """Raise with the nodes that can move; ``motion`` of the free displacements has no strain."""
    shape = np.abs(motion)
    moved = free[shape > 0.1 * shape.max()][:100]
    nodes, directions = (
        list(dict.fromkeys(names))
        for names in zip(*(degrees.place(int(k)) for k in moved), strict=True)
    )
    whole = np.zeros(len(degrees))
    whole[free] = motion
    raise SingularityError(
        f"the structure is a mechanism: {', '.join(nodes[:8])} can move without significant strain "
        f"({', '.join(directions)}); support them or add elements",
        nodes,
        whole,
    )


def _factors(matrix, own: np.ndarray, pivoting: bool = False) -> Factors:
    """Symmetric factors, or with pivoting; of a perturbed matrix where a pivot vanishes."""
    factors = pivoted_factors if pivoting else symmetric_factors
    try:
        return factors(matrix)
    except np.linalg.LinAlgError:
        return factors(matrix + scipy.sparse.diags(0.1 * SOFTEST * own))


def _softest(factor: Factors, matrix, root: np.ndarray) -> tuple[np.ndarray, float]:
    """The softest motion by inverse iteration, scaled by ``root``; its length is the compliance.

    Also returns the backward error of the factors.
    """
    motion = np.random.default_rng(0).standard_normal(root.size)
    for _ in range(2):
        load = root * motion / np.linalg.norm(motion)
        moved = factor.solve(load)
        motion = root * moved
    size = abs(matrix) @ np.abs(moved) + np.abs(load)
    return motion, float((np.abs(matrix @ moved - load) / size).max())


LOOSE = 1e-6
"""Tolerance of the test solution under a random load that detects free motions."""
SOFT = 1e-13
"""Threshold of the energy of a rigid motion, relative to that of its terms."""
FACTORS = {"SuperLU": ((2.7e8, 1.28), (3.0e9, 1.54)), "PARDISO": ((1.6e8, 1.1), (1.0e9, 1.33))}
"""Memory of factors for 1e5 free displacements of plates and solids [bytes], growth exponents."""
SHARE = 0.7
"""Upper limit of the memory of factors, as a share of the free memory."""


def multigrid_of(
    matrix, blocks: Sequence[ElementBlock], degrees: Numbering, free: np.ndarray, p: np.ndarray
) -> Multigrid | None:
    """Conjugate gradients with multigrid for the stiffness of the free displacements.

    Raises
    ------
    SingularityError
        It is singular; names the nodes that can move without strain.
    UnsupportedError
        ``pyamg`` is not installed.
    """
    if not matrix.shape[0]:
        return None
    positions = node_positions(list(blocks), degrees, p)
    motions = rigid_motions(degrees, positions - positions.mean(axis=0))[free]
    own = np.abs(matrix.diagonal())
    if not matrix.diagonal().all():
        refuse_motion(matrix.diagonal() == 0, degrees, free)
    _refuse_rigid(matrix, own, motions, degrees, free)
    used = np.flatnonzero((degrees.table >= 0).any(axis=0))  # plates have no rotations
    table = degrees.table[:, used]
    slots = np.zeros(len(degrees), dtype=np.int64)
    slots[table[table >= 0]] = np.flatnonzero(table.ravel() >= 0)
    solver = Multigrid(matrix, slots[free], used.size, motions)
    root, load = np.sqrt(own), np.random.default_rng(0).standard_normal(own.size)
    motion, residual = solver.attempt(root * load / np.linalg.norm(load), LOOSE)
    if not (residual <= 1 and SOFTEST * np.linalg.norm(root * motion) < 1):
        refuse_motion(motion, degrees, free)
    solver.iterations = 0
    return solver


def _refuse_rigid(matrix, own: np.ndarray, motions: np.ndarray, degrees: Numbering, free) -> None:
    """Raise if the structure has a rigid motion."""
    nonzero = motions[:, np.abs(motions).max(axis=0, initial=0.0) > 0]
    nonzero = nonzero / np.sqrt(np.einsum("fk,f,fk->k", nonzero, own, nonzero))
    basis, sizes, _ = scipy.linalg.svd(np.sqrt(own)[:, None] * nonzero, full_matrices=False)
    basis = basis[:, sizes > 1e-8 * sizes[0]] / np.sqrt(own)[:, None]
    energies, mixed = np.linalg.eigh(basis.T @ (matrix @ basis))
    if energies[0] < SOFT:
        refuse_motion(basis @ mixed[:, 0], degrees, free)


def better_iterative(
    size: int, blocks: Sequence[ElementBlock], memory: float | None = None
) -> bool:
    """Whether factors are estimated to need more memory than is free."""
    if size < PARDISO_ROWS or not multigrid.available():  # a search in all folders of packages
        return False
    memory = free_memory() if memory is None else memory
    if memory is None:
        return False
    solid = any(block.kind.cls.contractible and block.kind.dimension == 3 for block in blocks)
    bytes_, growth = FACTORS["PARDISO" if pardiso.available() else "SuperLU"][solid]
    return bytes_ * (size / 1e5) ** growth > SHARE * memory


def free_memory() -> float | None:
    """Free memory [bytes]; None where the system does not report it."""
    try:
        with open("/proc/meminfo") as lines:
            for line in lines:
                if line.startswith("MemAvailable:"):
                    return 1024.0 * float(line.split()[1])
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (OSError, ValueError, AttributeError):
        return None
