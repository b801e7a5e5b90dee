"""Fronts of problems whose fronts are known, by gradients and by evolution; designs for others."""

from __future__ import annotations

import numpy as np
import pytest
from design_problems import parametric

import dalembert as da
from dalembert.design.pareto.pareto_result import distinct
from dalembert.errors import AnalysisError, UnsupportedError

BOX = {"x": (0.5, -1.0, 3.0), "y": (0.3, -1.0, 3.0)}
NEAR, FAR = "x**2 + y**2", "(x - 1)**2 + (y - 1)**2"


def aims():
    return da.final(NEAR, name="near"), da.final(FAR, name="far")


def test_designs_that_differ_by_round_off_are_one():
    values = np.array([[1.0, 8.0], [1.0 + 1e-7, 8.0 - 1e-6], [1.0, 7.0], [5.0, 2.0], [5.0, 2.0]])
    assert distinct(values).tolist() == [0, 2, 3]
    assert distinct(values[3:]).tolist() == [0]


@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["normal-constraint", "epsilon-constraint"])
def test_fronts_by_gradients(method):
    """Two paraboloids: ``√f₁ + √f₂ = √2``; with one aim turned round, the same front."""
    model, (near, far) = parametric(BOX), aims()
    front = da.pareto(model, [near, far], analysis=da.Statics(), method=method, points=7)
    assert len(front) == 7 and not front.failed
    np.testing.assert_allclose(np.sqrt(front.values).sum(axis=1), np.sqrt(2), rtol=2e-4)
    np.testing.assert_allclose(front.designs[:, 0], front.designs[:, 1], atol=2e-3)
    away = da.final(f"-({FAR})", name="minus far")
    turned = da.pareto(
        model, [near], maximize=[away], analysis=da.Statics(), method=method, points=5
    )
    np.testing.assert_allclose(
        np.sqrt(turned.values[:, 0]) + np.sqrt(-turned.values[:, 1]), 2**0.5, rtol=2e-4
    )
    assert 2.5 < front.hypervolume((2.0, 2.0)) < 10 / 3


@pytest.mark.parametrize(
    ("second", "exact"),
    [
        ("{g}*(1 - sqrt(x1/{g}))", lambda f: 1 - f**0.5),
        ("{g}*(1 - (x1/{g})**2)", lambda f: 1 - f**2),
    ],
)
def test_corners_that_leave_variables_to_other_aims(second, exact):
    """ZDT1 and ZDT2 (Zitzler, Deb, Thiele 2000): the first aim sees one variable of three."""
    model = parametric({f"x{k}": (0.5, 1e-6 if k == 1 else 0.0, 1.0) for k in (1, 2, 3)})
    text = second.format(g="(1 + 4.5*(x2 + x3))")
    aims = [da.final("x1", name="first"), da.final(text, name="second")]
    front = da.pareto(model, aims, analysis=da.Statics(), points=5)
    assert len(front) == 5
    np.testing.assert_allclose(front.values[:, 1], exact(front.values[:, 0]), atol=1e-8)


@pytest.mark.thorough
def test_three_aims_within_a_limit():
    """Distances to three corners: best designs lie in their triangle, cut off by a limit."""
    third = da.final("(x - 1)**2 + y**2", name="third")
    limit = da.Limit(da.final("x", name="x"), upper=0.8)
    front = da.pareto(
        parametric(BOX), [*aims(), third], subject_to=[limit], analysis=da.Statics(), points=5
    )
    x, y = front.designs.T
    assert len(front) >= 9
    assert np.all(x <= 0.8 + 1e-6) and np.all((y <= x + 2e-3) | (x > 0.799)) and np.all(y >= -2e-3)


def test_fronts_in_pieces():
    """ZDT3 (Zitzler, Deb, Thiele 2000) along its front: five pieces from five valleys."""
    aims = da.final("x", name="first"), da.final("1 - sqrt(x) - x*sin(10*pi*x)", name="second")
    find = {"model": parametric({"x": (0.5, 1e-6, 1.0)}), "minimize": aims, "points": 2}
    front = da.pareto(**find, starts=9, analysis=da.Statics())
    np.testing.assert_allclose(front.values[-1], [0.8518328, -0.7733690], atol=2e-6)
    near = da.pareto(**find, analysis=da.Statics())
    np.testing.assert_allclose(near.values[-1, 0], 0.4538821, atol=1e-6)  # the third piece
    with pytest.raises(AnalysisError, match="starts is 0"):
        da.pareto(**find, starts=0, analysis=da.Statics())


@pytest.mark.parametrize("method", ["nsga2", "nsga3"])
def test_evolution_comes_near_the_front(method):
    pytest.importorskip("pymoo")
    front = da.pareto(
        parametric(BOX),
        list(aims()),
        analysis=da.Statics(),
        method=method,
        points=12,
        generations=25,
    )
    assert np.median(np.sqrt(front.values).sum(axis=1)) == pytest.approx(np.sqrt(2), rel=0.05)


def test_bad_fronts():
    model, (near, far) = parametric(BOX), aims()
    with pytest.raises(AnalysisError, match="two aims"):
        da.pareto(model, [near], analysis=da.Statics())
    with pytest.raises(AnalysisError, match="did you mean 'nsga"):
        da.pareto(model, [near, far], analysis=da.Statics(), method="nsga4")
    with pytest.raises(UnsupportedError, match="nsga2"):
        da.pareto(model, [near, far], analysis=da.Statics(), vary=[da.Integer("x")])


# for other packages -------------------------------------------------------------------------
def test_plain_functions_for_scipy():
    from scipy.optimize import check_grad, minimize

    limit = da.Limit(da.final("x*y", name="area"), lower=0.5)
    functions = da.DesignFunctions(
        parametric(BOX), list(aims()), analysis=da.Statics(), subject_to=[limit]
    )
    assert check_grad(functions.fun, functions.jac, functions.x0) < 1e-6
    assert functions.jacobian(functions.x0).shape == (2, 2)
    optimum = minimize(
        functions.fun,
        functions.x0,
        jac=functions.jac,
        bounds=functions.bounds,
        constraints=functions.constraints,
        method="SLSQP",
    )
    assert optimum.fun == pytest.approx(1.0, rel=1e-6)


def test_pymoo_problem():
    pytest.importorskip("pymoo")
    limit = da.Limit(da.final("x*y", name="area"), lower=0.5, upper=4.0)
    problem = da.pymoo_problem(
        parametric(BOX), list(aims()), analysis=da.Statics(), subject_to=[limit]
    )
    out = problem.evaluate(np.array([[1.0, 2.0]]), return_as_dictionary=True)
    np.testing.assert_allclose(out["F"], [[5.0, 1.0]])
    np.testing.assert_allclose(out["G"], [[-3.0, -0.5]])


def squared(x):
    """A loss in which the responses stand, by operators alone."""
    return (x**2).sum()


def expected(functions: da.DesignFunctions, x: np.ndarray) -> np.ndarray:
    return 2 * functions.values(x) @ functions.jacobian(x)


def test_jax_differentiates_a_design():
    jax = pytest.importorskip("jax")
    jax.config.update("jax_enable_x64", True)
    functions = da.DesignFunctions(parametric(BOX), list(aims()), analysis=da.Statics())
    slope = jax.grad(lambda x: squared(functions.jax(x)))
    points = np.array([[1.0, 2.0], [0.3, 1.5]])
    for gradient in (slope(points[0]), jax.jit(slope)(points[0]), jax.vmap(slope)(points)[0]):
        np.testing.assert_allclose(gradient, expected(functions, points[0]), rtol=1e-12)


def test_torch_differentiates_a_design():
    torch = pytest.importorskip("torch")
    functions = da.DesignFunctions(parametric(BOX), list(aims()), analysis=da.Statics())
    x = torch.tensor([1.0, 2.0], dtype=torch.float64, requires_grad=True)
    squared(functions.torch(x)).backward()
    np.testing.assert_allclose(x.grad, expected(functions, np.array([1.0, 2.0])), rtol=1e-12)


def test_extras_that_are_missing_are_named(monkeypatch):
    import sys

    functions = da.DesignFunctions(parametric(BOX), list(aims()), analysis=da.Statics())
    for name, call in (("jax", lambda: functions.jax), ("torch", lambda: functions.torch)):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(UnsupportedError, match=f"pip install {name}"):
            call()
    for name, call in (
        (
            "pymoo.core.problem",
            lambda: da.pymoo_problem(parametric(BOX), list(aims()), analysis=da.Statics()),
        ),
        (
            "openmdao.api",
            lambda: da.openmdao_component(parametric(BOX), list(aims()), analysis=da.Statics()),
        ),
    ):
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(UnsupportedError, match="pip install 'dalembert"):
            call()
