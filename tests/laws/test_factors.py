"""Factors in the graph, where numbers are hardly any."""

import casadi as ca
import numpy as np
import pytest

from dalembert.formulations.orthogonal_bases import HouseholderBasis
from dalembert.symbolic.equations.factor import LdlFactor, QrFactor

POWERS = pytest.mark.parametrize("power", [20, 80, 154, 158, 161, 163, 200])


@POWERS
def test_reflections_by_entries_whose_squares_vanish(power):
    """What Newton's method leaves of an angle that is zero, after a few products."""
    matrix = ca.SX.sym("A", 3, 3)
    rhs, tiny = np.array([1.0, 2.0, 3.0]), 3 * 10.0**-power
    solve = ca.Function("solve", [matrix], [QrFactor(matrix).solve(ca.SX(ca.DM(rhs)))])
    first, second = [[1, 1, 0], [tiny, 1, 2], [0, tiny, 1]], [[2, 0, 1], [0, 1, 0], [tiny, 1, 3]]
    for entries in np.array([first, second]):
        np.testing.assert_allclose(entries @ solve(entries).full().ravel(), rhs, rtol=1e-15)


@POWERS
def test_null_space_beside_entries_whose_squares_vanish(power):
    tiny, jacobian = 3 * 10.0**-power, ca.SX.sym("C", 2, 3)
    basis = ca.Function("basis", [jacobian], [HouseholderBasis(jacobian).matrix])
    entries = np.array([[1.0, tiny, 0.0], [1.0, 1.0, tiny]])
    free = basis(entries).full()
    np.testing.assert_allclose(entries @ free, 0.0, atol=1e-15)
    np.testing.assert_allclose(free.T @ free, np.eye(1), rtol=1e-15)


def test_factors_where_one_entry_cancels():
    """Of a symmetric matrix: an expression is zero in value, its transpose left out."""
    x = ca.SX.sym("x")
    zero = ca.sin(x) - 2 * ca.sin(x / 2) * ca.cos(x / 2)
    matrix = ca.sparsify(ca.blockcat([[2, 0, 1], [zero, 3, 0], [1, 0, 4]]))
    assert not matrix.sparsity().is_symmetric()
    for each in (matrix, matrix.T):
        solved = ca.Function("s", [x], [LdlFactor(each).solve(ca.SX([1, 2, 3]))])(0.3)
        np.testing.assert_allclose(solved.full().ravel(), [1 / 7, 2 / 3, 5 / 7], rtol=1e-14)
