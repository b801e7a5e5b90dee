"""Lowest modes of ``K φ = ω² M φ``, also of structures without supports."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.modes.spectrum import VANISHES
from dalembert.model.assembled.evaluation.eigenpairs import nearest
from dalembert.sparse.factorise import indefinite_factors

FREE = 1e-4
"""Negative shift of an unsupported structure, relative to ``tr K/tr M`` [-]."""
SINGULAR = 1e-12
"""Right-hand side relative to the terms of its row below which ``K`` is singular [-]."""


def lowest_modes(k: Any, m: Any, count: int) -> tuple[np.ndarray, np.ndarray]:
    """(m,) ``ω²`` and (f, m) shapes, ``φᵀ M φ = 1``; zero for rigid motions.

    Parameters
    ----------
    k, m : (f, f) sparse
    count : number of modes
    """
    try:
        solve = indefinite_factors(k).solve
        terms = abs(k) @ np.abs(solve(np.ones(k.shape[0])))
        free = not np.all(np.isfinite(terms)) or (1 / np.maximum(terms, 1.0)).max() < SINGULAR
    except np.linalg.LinAlgError:
        free = True
    shift = 0.0
    if free:
        shift = -FREE * float(k.diagonal().sum() / m.diagonal().sum())
        solve = indefinite_factors((k - shift * m).tocsc()).solve
    values, vectors = nearest(k, m, count, shift, solve)
    size = np.einsum("fk,fk->k", abs(vectors), abs(k) @ abs(vectors))
    return np.where(values > VANISHES * size, values, 0.0), vectors
