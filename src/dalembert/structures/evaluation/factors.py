"""Direct and iterative solvers of a stiffness, and detection of mechanisms."""

from __future__ import annotations

from typing import NoReturn

import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.sparse.factorise import pivoted_factors, symmetric_factors
from dalembert.sparse.solver import Factors, SparseSolver
from dalembert.structures.evaluation.numbering import Numbering

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
    moving = dict.fromkeys(degrees.place(int(k))[0] for k in moved)
    raise SingularityError(
        f"the structure is a mechanism: {', '.join(list(moving)[:8])} can move without "
        "straining anything that counts beside the stiffness of the rest; support them or add "
        "elements"
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
