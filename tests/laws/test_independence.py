"""Independent rows and free columns by sparse elimination, against dense linear algebra."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from dalembert.model.graph.assembly.independence import (
    columns_of,
    free_columns,
    independent_rows,
    least_fill,
    rows_of,
)


def matrix(seed: int) -> np.ndarray:
    """A sparse matrix with rows that follow from others, zero rows and zero columns."""
    rng = np.random.default_rng(seed)
    m, n = rng.integers(1, 14, 2)
    a = rng.standard_normal((m, n)) * (rng.random((m, n)) < 0.4)
    for row in range(2, m):
        if rng.random() < 0.4:
            a[row] = a[rng.integers(row)] - 2.0 * a[rng.integers(row)]
    return a


def first_independent(columns: np.ndarray, order) -> list[int]:
    """Columns whose rank grows when they are taken in order, by dense decompositions."""
    selected: list[int] = []
    for k in order:
        if np.linalg.matrix_rank(columns[:, [*selected, k]]) > len(selected):
            selected.append(k)
    return selected


@pytest.mark.parametrize("seed", range(60))
def test_rows_are_taken_in_their_order(seed):
    a = matrix(seed)
    assert independent_rows(a) == first_independent(a.T, range(len(a)))
    assert independent_rows(sparse.csr_array(a)) == independent_rows(a)


@pytest.mark.parametrize("seed", range(60))
def test_first_in_order_stay_free(seed):
    """What is held, as early in the order as possible, completes the rows to a regular matrix."""
    a = matrix(seed)
    a = np.where(np.abs(a) > 0, np.sign(a), 0.0)[independent_rows(np.sign(a))]
    order = np.random.default_rng(seed).permutation(a.shape[1])
    free = free_columns(a, order.tolist())
    square = np.vstack([a, np.eye(a.shape[1])[free]])
    assert np.linalg.matrix_rank(square) == a.shape[1] == square.shape[0]
    determined = first_independent(a, order[::-1])
    assert [k for k in order if k not in determined] == free


@pytest.mark.parametrize("seed", range(60))
def test_kernel(seed):
    a = matrix(seed)
    columns = columns_of(a)
    assert len(columns.free) == a.shape[1] - np.linalg.matrix_rank(a)
    for k in columns.free:
        x = columns.kernel({k: 1.0})
        assert np.abs(a @ x).max(initial=0.0) < 1e-12 * np.abs(x).max() and x[k] == 1.0
    assert np.abs(a @ columns.any_kernel(np.random.default_rng(0))).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("seed", range(60))
def test_a_dependent_row_tells_what_it_is_made_of(seed):
    a = matrix(seed)
    lengths = np.linalg.norm(a, axis=1)
    unit = a[lengths > 0] / lengths[lengths > 0, None]
    rows = rows_of(unit)
    for k in rows.free:
        weights = rows.kernel({k: -1.0})
        weights[k] = 0.0
        np.testing.assert_allclose(weights @ unit, unit[k], atol=1e-10)


def test_no_length_counts():
    a = matrix(3)
    big = a * np.logspace(-9, 9, len(a))[:, None]
    assert independent_rows(big) == independent_rows(a)


def test_any_order_tells_the_rank_and_the_one_of_least_fill_touches_least():
    """A closed net: equations between the nodes of a grid, numbered row after row."""
    size = 12
    number = np.arange(size**2).reshape(size, size)
    pairs = [*zip(number[:, :-1].ravel(), number[:, 1:].ravel(), strict=True)]
    pairs += zip(number[:-1].ravel(), number[1:].ravel(), strict=True)
    net = sparse.lil_array((len(pairs), size**2))
    for k, (i, j) in enumerate(pairs):
        net[k, i], net[k, j] = 1.0, -1.0
    order = least_fill(net.tocsr())
    assert sorted(order) == list(range(size**2))
    plain, ordered = columns_of(net.tocsr()), columns_of(net.tocsr(), order)
    assert len(plain.pivots) == len(ordered.pivots) == size**2 - 1
    touched = [sum(columns.size for _, columns, _ in e._rows) for e in (plain, ordered)]
    assert touched[1] < 0.7 * touched[0]
