"""Least-squares solutions of minimum norm are those of the pseudoinverse."""

from __future__ import annotations

import numpy as np
import pytest

from dalembert.sensitivity.nonsmooth.smallest_solution import SmallestSolution


@pytest.mark.parametrize(("size", "rank"), [(1, 0), (1, 1), (7, 7), (40, 37), (90, 60)])
def test_pseudoinverse(size, rank):
    """Of a matrix with different null spaces on both sides, and of its transpose."""
    rng = np.random.default_rng(0)
    matrix = rng.normal(size=(size, rank)) @ rng.normal(size=(rank, size))
    right, inverse = rng.normal(size=(size, 2)), np.linalg.pinv(matrix, rcond=1e-9)
    solution = SmallestSolution(matrix)
    np.testing.assert_allclose(solution(right, False), inverse @ right, atol=1e-9)
    np.testing.assert_allclose(solution(right, True), inverse.T @ right, atol=1e-9)
