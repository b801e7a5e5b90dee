"""Laws of all methods of optimisation: the same optimum, steps back, prices, resumed searches."""

from __future__ import annotations

import itertools
import math
from importlib.util import find_spec

import numpy as np
import pytest
from design_problems import parametric, solve

import dalembert as da
from dalembert import planar, structures
from dalembert.design.methods.base import OptimizerResult
from dalembert.design.methods.registry import OPTIMIZERS
from dalembert.errors import AnalysisError, FileError, ModelError, UnsupportedError

EXTRA = {"ccsaq": "nlopt", "cma-es": "cma"}
QUICK = {
    "differential-evolution": da.DifferentialEvolution(population=4, generations=8),
    "cma-es": da.CMAES(generations=10),
    "multistart": da.Multistart(starts=3),
}
CONSTRAINED = [
    n for n in OPTIMIZERS if n not in ("least-squares", "branch-and-bound", "enumeration")
]
FIVE = {f"x{k}": (5.0, 1.0, 10.0) for k in range(1, 6)}
BENDING = ("61/x1**3 + 37/x2**3 + 19/x3**3 + 7/x4**3 + 1/x5**3", None, 1.0)


def available(name: str) -> None:
    if name in EXTRA and find_spec(EXTRA[name]) is None:
        pytest.skip(f"{EXTRA[name]} is not installed")


@pytest.mark.few(3)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_methods_find_the_same(name):
    """Fleury's cantilever: strictly convex in reciprocal variables, so with one optimum."""
    available(name)
    tolerance = 1e-8 if name == "trust-constr" else 1e-10
    best = solve(
        FIVE,
        "0.0624*(x1 + x2 + x3 + x4 + x5)",
        [BENDING],
        method=QUICK.get(name, name),
        tolerance=tolerance,
    )
    assert best.success, best.message
    assert best.fun == pytest.approx(1.33995636, rel=2e-5)
    assert best.violation <= 1e-6 and best.stationarity <= 1e-3


def test_least_squares():
    """Rosenbrock's residuals; the same sum by SLSQP."""
    model = parametric({"x": (-1.2, -2.0, 2.0), "y": (1.0, -2.0, 2.0)})
    goal = da.SumOfSquares(
        [da.final("y - x**2", name="a"), da.final("x", name="b")], (0, 1), (1 / 10, 1)
    )
    for method in ("least-squares", "slsqp"):
        best = da.optimize(model, goal, analysis=da.Statics(), method=method, tolerance=1e-14)
        np.testing.assert_allclose(list(best.x.values()), 1.0, atol=1e-4)
        assert best.success
    limit = da.Limit(da.final("x"), upper=0.5)
    with pytest.raises(UnsupportedError, match="no limits"):
        da.optimize(model, goal, analysis=da.Statics(), subject_to=[limit], method="least-squares")


def test_cma_es_takes_two_variables_or_more():
    available("cma-es")
    with pytest.raises(UnsupportedError, match="two or more; for one use DifferentialEvolution"):
        solve({"x": (1.0, -2.0, 2.0)}, "(x - 1.2)**2", [], method="cma-es")


def test_prices_are_slopes_of_the_optimum():
    """``df*/d(bound)`` by differences of solved problems, for limits and bounds of parameters."""

    def at(limit: float, lower: float) -> da.OptimizationResult:
        variables = {"x": (3.0, lower, 10.0), "y": (3.0, 0.1, 10.0)}
        return solve(variables, "x**2 + 2*y**2 + x*y", [("x*y", limit, None), ("x + y", None, 9.0)])

    best, h = at(4.0, 2.5), 1e-4
    assert best.active == ["g1"] and best.at_bounds == ["x"]
    slope = (at(4.0 + h, 2.5).fun - at(4.0 - h, 2.5).fun) / (2 * h)
    assert best.limits[0].price == pytest.approx(slope, rel=1e-4)
    slope = (at(4.0, 2.5 + h).fun - at(4.0, 2.5 - h).fun) / (2 * h)
    assert best.variables[0].price == pytest.approx(slope, rel=1e-4)
    assert any("x at its lower bound costs" in text for text in best.prices)
    assert "<table>" in best._repr_html_() and "g1" in best._repr_html_()


def four_bar() -> da.Model:
    """A four-bar whose crank turns only if it is short enough."""
    system = da.System("four-bar")
    l1 = system.parameter("l1", 0.3, "m", bounds=(0.1, 0.75))
    crank = system.add(planar.Bar("crank", length=l1, angle=1.57))
    coupler = system.add(planar.Bar("coupler", length=1.0))
    rocker = system.add(planar.Bar("rocker", length=0.6, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 1.57 + 2 * math.pi * da.t))
    return system.build()


@pytest.mark.thorough
def test_designs_beyond_which_others_fail_are_told():
    """The best crank is as long as can turn: no optimum, and why."""
    best = da.optimize(
        four_bar(),
        maximize=da.final("l1 + 0*crank.x", name="length"),
        analysis=da.Kinematics(duration=1.0, outputs=21),
        max_iterations=30,
    )
    assert 0.55 < best.x["l1"] <= 0.6 and best.failed_runs > 0
    assert not best.success and "along it fail" in best.message, best.message


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "method", ["slsqp", "trust-constr", "ipopt", "mma", "differential-evolution"]
)
def test_designs_that_cannot_be_assembled_are_stepped_back_from(method):
    """A steep start throws the first step beyond ``l1 = 0.6``, where the crank locks."""
    goal = da.final("(l1 - 0.5)**2 + 0*crank.x", name="goal")
    options = (
        {"method": da.DifferentialEvolution(population=6, generations=3)} if "-ev" in method else {}
    )
    best = da.optimize(
        four_bar(),
        goal,
        analysis=da.Kinematics(duration=1.0, outputs=21),
        start={"l1": 0.11},
        **({"method": method} | options),
    )
    assert best.x["l1"] == pytest.approx(0.5, abs=0.01) and best.motion.status.success
    if method != "differential-evolution":
        assert best.fun < best.history[0].objective


def test_several_analyses_and_a_chain():
    """A crank's bearing force loads a bar of the same parameters: gradients follow the chain."""
    system = da.System("crank", gravity=(0, -9.81))
    width = system.parameter("w", 0.02, "m", bounds=(0.005, 0.08))
    arm = system.add(planar.Bar("arm", length=0.5, mass=7800 * 0.5 * width**2))
    system.add(planar.Revolute("O", system.ground.point(0, 0), arm.start))
    system.add(planar.RotationalDriver("motor", system.ground, arm, 10 * da.t))
    turn = da.Case(system.build(), da.InverseDynamics(duration=0.6, outputs=31))

    member = da.Structure("member")
    side = member.parameter("w", 0.02, "m", bounds=(0.005, 0.08))
    load = member.parameter("load", 1.0, "N")
    ends = [member.node("a", 0, 0), member.node("b", 0.5, 0)]
    member.add(structures.Truss("bar", *ends, area=side**2, modulus=2e11))
    member.support(ends[0])
    member.support(ends[1], uy=0.0)
    member.load(ends[1], fx=load + 5000.0)
    force = turn[da.rms("O.force_norm", name="force")]
    strength = da.Case(member.build(), da.Statics(), inputs={"load": force})
    stress = strength[da.final("bar.stress", name="stress")]

    goal = da.combined(
        "effort + 1e-3*force", "cost", effort=turn[da.rms("motor.effort")], force=force
    )
    best = da.optimize(minimize=goal, subject_to=[da.Limit(stress, upper=20e6)], vary=["w"])
    assert best.success and best.active == ["stress"] and len(best.results) == 2

    def stress_at(w: float) -> float:
        run = da.solve_inverse_dynamics(turn.model, 0.6, outputs=31, parameters={"w": w})
        pull = float(da.evaluate(run, da.rms("O.force_norm")))
        return (pull + 5000.0) / w**2

    assert stress_at(best.x["w"]) == pytest.approx(20e6, rel=1e-6)
    from dalembert.design.optimize.optimization import design_problem

    problem = design_problem(None, None, [stress], ["w"])
    at = problem.evaluate(np.array([0.03]))
    slope = (stress_at(0.03 + 1e-6) - stress_at(0.03 - 1e-6)) / 2e-6
    assert problem.slope(at, 0)[0] == pytest.approx(slope, rel=1e-6)


def test_whole_numbers_and_catalogues():
    """Branch and bound finds what trying all sizes finds; two columns come together."""
    areas, moments = (1.0, 1.7, 2.2, 3.1, 4.0), (0.9, 2.1, 2.9, 5.0, 8.2)
    variables = {
        "n": (4.0, 1.0, 9.0),
        "A": (2.0, 1.0, 4.0),
        "I": (2.0, 0.5, 9.0),
        "x": (1.0, 0.5, 3.0),
    }
    model = parametric(variables)
    best = da.optimize(
        model,
        da.final("n*A + 2*x**2", name="cost"),
        subject_to=[da.Limit(da.final("n*I*x", name="stiffness"), lower=20.0)],
        vary=[da.Integer("n"), da.Catalogue({"A": areas, "I": moments}), "x"],
        analysis=da.Statics(),
    )

    def cost(n: int, k: int) -> float:
        x = max(0.5, 20 / (n * moments[k]))
        return n * areas[k] + 2 * x**2 if x <= 3 else math.inf

    least = min(cost(n, k) for n, k in itertools.product(range(1, 10), range(5)))
    assert best.fun == pytest.approx(least, rel=1e-7) and best.success, best.message
    assert best.x["n"] == round(best.x["n"]) and best.x["A"] in areas
    assert best.x["I"] == moments[areas.index(best.x["A"])]


def test_multistart_lists_distinct_optima():
    """Two of ``x⁴ − 2x² + 0.2x`` between the bounds, the better first."""
    best = solve({"x": (0.5, -2.0, 2.0)}, "x**4 - 2*x**2 + 0.2*x", method=da.Multistart(starts=8))
    computed = [design.parameters["x"] for design in best.optima]
    roots = np.sort(np.roots([4, 0, -4, 0.2]).real)
    np.testing.assert_allclose(computed, roots[[0, 2]], atol=1e-4)
    assert best.success and best.x["x"] == computed[0]


def test_interrupted_searches_go_on(tmp_path):
    """The history file gives the first evaluations; the end is that of a search at one go."""
    file = tmp_path / "search.jsonl"

    def stop(number: int, objective: float) -> None:
        if number == 3:
            raise KeyboardInterrupt

    part = solve(FIVE, "x1+x2+x3+x4+x5", [BENDING], history=file, progress=stop)
    assert part.interrupted and part.runs > 0
    rest = solve(FIVE, "x1+x2+x3+x4+x5", [BENDING], history=file)
    whole = solve(FIVE, "x1+x2+x3+x4+x5", [BENDING])
    assert rest.fun == whole.fun and rest.x == whole.x
    assert rest.runs < whole.runs
    with pytest.raises(FileError, match="another problem"):
        solve(FIVE, "x1+x2+x3+x4+2*x5", [BENDING], history=file)
    file.write_text("[")
    with pytest.raises(FileError, match="not an optimisation history"):
        solve(FIVE, "x1+x2+x3+x4+x5", [BENDING], history=file)


def test_doubts_are_told():
    """Limits that contradict each other, and a kink, are no optimum whatever the optimiser says."""
    box = {"x": (1.0, 0.0, 2.0), "y": (1.0, 0.0, 2.0)}
    best = solve(box, "x + y", [("x + y", 3.0, None), ("x*y + x", None, 0.5)])
    assert not best.success and "limits cannot all be satisfied" in best.message
    best = solve({"x": (1.0, -2.0, 2.0)}, "abs(x - 0.3) + 0.1*x")
    assert not best.success and "kink" in best.message, best.message


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({"method": "slqp"}, AnalysisError, "did you mean 'slsqp'"),
        ({"method": 3}, AnalysisError, "da.Ipopt"),
        ({"vary": ["z"]}, ModelError, "unknown parameter 'z' to vary"),
        ({"vary": []}, AnalysisError, "nothing to vary"),
        ({"vary": [da.Integer("x")], "start": {}}, AnalysisError, "no whole number"),
        ({"vary": [da.Catalogue({"x": (7.0,)})]}, AnalysisError, "no size lies in"),
        ({"vary": [da.Catalogue({"x": (0.3, 0.4), "y": (1.0,)})]}, AnalysisError, "same length"),
        ({"start": {"u": 1.0}}, ModelError, "unknown parameter 'u'"),
        ({"maximize": da.final("x")}, AnalysisError, "one objective"),
        ({"analysis": None}, AnalysisError, "model and analysis"),
    ],
)
def test_bad_input(options, error, words):
    model = parametric({"x": (0.5, 0.2, 0.9), "y": (1.0, 0.0, 2.0)})
    arguments = {"minimize": da.final("x*y"), "analysis": da.Statics()} | options
    with pytest.raises(error, match=words):
        da.optimize(model, **arguments)


def test_all_designs_are_compared_whether_by_formulas_or_by_runs():
    """The same objective with and without a measure in it, and a limit that cuts the best off."""
    variables = {"x": (3.0, 1.0, 6.0), "y": (3.0, 1.0, 6.0)}
    sizes = [da.Integer("x"), da.Integer("y")]
    for extra, runs in (("", 2), (" + 0*only_bar.stress", 36)):
        best = solve(
            variables,
            "(x*y - 14.2)**2 + 0.01*x" + extra,
            [("x + y", None, 7.0)],
            vary=sizes,
            method="enumeration",
        )
        assert best.success, best.message
        every = {
            (x, y): (x * y - 14.2) ** 2 + 0.01 * x
            for x, y in itertools.product(range(1, 7), repeat=2)
            if x + y <= 7
        }
        least = min(every, key=lambda design: every[design])
        assert (best.x["x"], best.x["y"]) == least and best.runs <= runs
    with pytest.raises(AnalysisError, match="neither"):
        solve(variables, "x*y", vary=[da.Integer("x"), "y"], method="enumeration")
    method = da.Enumeration(max_designs=20)
    with pytest.raises(AnalysisError, match="36 designs"):
        solve(variables, "x*y", vary=sizes, method=method)


def test_a_start_on_a_limit_that_is_zero():
    """``x + 2 y`` on ``x y ≥ 1``: neither bound nor value there say how large the limit is."""
    for y in (1.0, 1.0 - 1e-13):
        root = solve({"x": (1.0, 0.1, 5), "y": (y, 0.1, 5)}, "x + 2*y", [("x*y - 1", 0.0, None)])
        assert root.success and root.fun == pytest.approx(2 * math.sqrt(2), rel=1e-6)


@pytest.mark.thorough
def test_an_objective_without_gradient_is_told():
    """It does not depend on what varies, or changes in jumps; a start outside of bounds is told."""
    x = {"x": (0.52, 0.0, 1.0), "y": (0.5, 0.0, 1.0)}
    cases = ("y + 0*x", "does not depend on the variables"), ("floor(5*x)", "changes in jumps")
    for objective, words in cases:
        root = solve(x, objective, vary=["x"])
        assert not root.success and words in root.message
    assert solve(x, "(x - 0.52)**2", vary=["x"]).success  # it stands at the optimum
    with pytest.raises(ModelError, match=r"x starts at 2, outside of its bounds \[0, 1\]"):
        solve(x, "x", start={"x": 2.0})
    root = solve(x, "x", [("10*y", None, 2.0)], vary=["x"])
    assert "g1 is 5, above 2" in root.message


class Stalling(da.SLSQP):
    """Reports failure at a design that violates the limit by little, after the optimum itself."""

    def solve(self, program, z, stop):
        optimum, beyond = (program.scaled(np.array([x])) for x in (2.0, 2.0 - 4e-7))
        for design in (beyond, optimum, beyond):
            assert program.point(design) is not None
        return OptimizerResult(beyond, False, "line search fails")


def test_a_violated_limit_is_no_gain_of_the_objective():
    best = solve({"x": (3.0, 1.0, 10.0)}, "x", [("x", 2.0, None)], method=Stalling())
    assert best.success and best.x["x"] == pytest.approx(2.0, abs=1e-15)
    assert best.violation <= 1e-15
