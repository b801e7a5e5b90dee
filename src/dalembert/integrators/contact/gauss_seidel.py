"""Projected Gauss–Seidel over coloured contacts."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from dalembert.integrators.contact.friction_problem import FrictionProblem, limited

Parts = list[tuple[np.ndarray, sparse.csr_array]]
"""Contacts that do not act on each other, with their rows of ``H``."""


def gauss_seidel(
    problem: FrictionProblem, impulses: np.ndarray, parts: Parts, sweeps: int
) -> np.ndarray:
    """So many sweeps from some impulses; contacts of one colour are corrected at once.

    Each takes its normal impulse first, then friction with it (Jourdan, Alart & Jean 1998).
    """
    found, k = impulses.copy(), problem.shape[1]
    normal, along = problem.mobility
    for _ in range(sweeps):
        for part, rows in parts:
            speeds = (rows @ found.ravel()).reshape(-1, k) + problem.velocity[part]
            before = found[part, 0]
            pressed = np.maximum(0.0, before - speeds[:, 0] / normal[part])
            found[part, 0] = pressed
            if k > 1:
                speeds = (rows @ found.ravel()).reshape(-1, k) + problem.velocity[part]
                rubbed = found[part, 1:] - speeds[:, 1:] / along[part, None]
                found[part, 1:] = limited(rubbed, problem.friction[part] * pressed)
    return found


def coloured(problem: FrictionProblem) -> Parts:
    """Contacts apart by colours: of two that act on each other, one is corrected first.

    Each round colours those whose number, drawn once, is the largest among their neighbours
    (Jones & Plassmann 1993).
    """
    count, k = problem.shape
    entries = problem.matrix.tocoo()
    row, column = entries.row // k, entries.col // k
    row, column = row[row != column], column[row != column]
    drawn = 1.0 + np.random.default_rng(0).permutation(count)
    parts = []
    while (drawn > 0).any():
        largest = np.zeros(count)
        np.maximum.at(largest, row, drawn[column])
        part = np.flatnonzero((drawn > 0) & (drawn > largest))
        drawn[part] = 0.0
        components = (part[:, None] * k + np.arange(k)).ravel()
        parts.append((part, problem.matrix[components]))
    return parts
