"""Tangents as triangular matrices, and what parameters alone decide, against plain derivatives."""

import casadi as ca
import numpy as np
import pytest

from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.evaluation.prelude import before

T, X, P = ca.SX.sym("t"), ca.SX.sym("x", 3), ca.SX.sym("p", 2)
WEIGHT = ca.sin(P[0]) * P[1]
FUNCTIONS = {
    "time only": [T],
    "constant": [ca.SX(2.0)],
    "a state": [X[1]],
    "a parameter": [P[0] + 3],
    "numbers": [2 * X + 1],
    "one number twice": [ca.vertcat(X[0] - X[1], X[1] - X[2])],
    "both": [ca.vertcat(WEIGHT * X[0] ** 2 + T, ca.cos(X[1] * P[0]) / (1 + P[1] ** 2), WEIGHT)],
    "switched": [ca.if_else(X[0] > 0, X[1] * P[0], X[2] * P[1])],
    "two outputs": [X[0] * P[0], WEIGHT * X],
}
POINT = (0.3, [0.4, -0.7, 1.1], [0.9, 1.7])


@pytest.fixture(params=FUNCTIONS)
def function(request):
    return ImplicitFunction("f", [T, X, P], [], FUNCTIONS[request.param])


@pytest.fixture
def jacobian(function):
    """By states and parameters."""
    outputs = ca.vertcat(*function.outputs)
    exact = ca.Function("J", [T, X, P], [ca.jacobian(outputs, ca.vertcat(X, P))])
    return exact(*POINT).full()


def test_tangents(function, jacobian):
    unit = np.eye(5)
    computed = function.tangents(5)(*POINT, unit[:3], unit[3:])
    assert computed.full() == pytest.approx(jacobian, abs=1e-14)


def test_adjoints(function, jacobian):
    point = [ca.MX.sym("t"), ca.MX.sym("x", 3), ca.MX.sym("p", 2)]
    weight = ca.MX.sym("w", jacobian.shape[0])
    adjoint = ca.Function("a", [*point, weight], [function.at(*point).adjoint(weight)])
    for k, row in enumerate(jacobian):
        computed = adjoint(*POINT, np.eye(len(jacobian))[k])
        assert computed.full().ravel() == pytest.approx(row, abs=1e-14)


def test_adjoints_after_the_prelude(function, jacobian):
    t, x, p = POINT
    prelude, _ = function.prepared
    for k, row in enumerate(jacobian):
        back = function.prepared_adjoint(t, x, prelude.values(p), np.eye(len(jacobian))[k])
        computed = [*back.full().ravel()[:3], *prelude.adjoint(p, back[3:]).full().ravel()]
        assert computed == pytest.approx(row, abs=1e-14)


def test_functions_after_the_prelude(function):
    t, x, p = POINT
    values, rest = before(function.function, 2)
    for exact, computed in zip(
        function.function.call([t, x, p]), rest.call([t, x, values(p)]), strict=True
    ):
        assert computed.full() == pytest.approx(exact.full(), abs=0)


def test_an_unknown_that_is_identically_zero_can_be_eliminated():
    z = ca.SX.sym("z")
    stage = Stage(z, P[0] * z, ca.SX(1, 1), lambda r: r / P[0], lambda w: w / P[0])
    function = ImplicitFunction("f", [T, X, P], [stage], [z + X[0], z * X[1]])
    assert function.function(*POINT)[0] == pytest.approx(0.4) and function.function(*POINT)[1] == 0
    weights = function.adjoint(*POINT, [1.0], [0.0])
    assert weights[1].full().ravel() == pytest.approx([1, 0, 0])
