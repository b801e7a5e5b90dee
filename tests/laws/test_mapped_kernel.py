"""Functions on arrays: mapped over columns, and with memory that remains from call to call."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from dalembert.errors import SolverFailure
from dalembert.symbolic.evaluation import kernel
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel


def function() -> ca.Function:
    """``(x, y; p) → p x yᵀ, |x|²``."""
    x, y, p = ca.SX.sym("x", 3), ca.SX.sym("y", 2), ca.SX.sym("p", 2)
    return ca.Function("f", [x, y, p], [ca.mtimes(x, y.T) * p[0] + p[1], ca.sumsqr(x)])


def test_columns_of_any_number_are_those_of_single_calls():
    mapped, rng = MappedKernel(function(), common=[2]), np.random.default_rng(1)
    for count in (40, 1, 0, 16, 17, 3):
        x, y, p = rng.normal(size=(3, count)), rng.normal(size=(2, count)), rng.normal(size=2)
        products, squares = mapped(x, [y[:1], y[1:]], p)
        assert products.shape == (count, 3, 2) and squares.shape == (count, 1, 1)
        assert products == pytest.approx(np.einsum("in,jn->nij", x, y) * p[0] + p[1])
        assert squares.ravel() == pytest.approx((x**2).sum(axis=0))


@pytest.mark.parametrize("limit", [100, 0])
def test_results_belong_to_their_call(limit, monkeypatch):
    """Whether memory is used again or not."""
    monkeypatch.setattr(kernel, "REUSED", limit)
    call = Kernel(function())
    first = call(np.ones(3), np.ones(2), 1.0)
    again = call(2 * np.ones((3, 1)), [1.0, 2.0], np.array([1.0, 0.0]))
    assert first[0] == pytest.approx(np.full((3, 2), 2.0))
    assert again[0] == pytest.approx(np.tile([2.0, 4.0], (3, 1)))
    assert (first[1], again[1]) == (3, 12)
    with pytest.raises(ValueError, match="argument 1 has 3 entries, needs 2"):
        call(np.ones(3), np.ones(3), 1.0)
    assert call(np.zeros(3), np.ones(2), 1.0)[1] == 0


def test_failures_inside_leave_the_function_usable():
    x, a = ca.SX.sym("x"), ca.SX.sym("a")
    root = ca.rootfinder("root", "newton", {"x": x, "p": a, "g": x**2 - a}, {"max_iter": 50})
    start, value = ca.MX.sym("start"), ca.MX.sym("value")
    call = Kernel(ca.Function("solve", [start, value], [root(start, value)]))
    assert call(1.0, 4.0)[0] == pytest.approx(2.0)
    with pytest.raises(SolverFailure):
        call(1.0, -4.0)
    assert call(1.0, 9.0)[0] == pytest.approx(3.0)
