"""Analyses that have one meaning serve mechanisms and structures; others say which they serve."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures


@pytest.fixture(scope="module")
def bar():
    structure = structures.Structure("bar")
    a, b = structure.node("a", 0.0, 0.0), structure.node("b", 1.0, 0.0)
    structure.add(structures.Truss("rod", a, b, area=1e-4, modulus=1e9, density=1000.0))
    structure.support(a)
    structure.support(b, uy=0.0)
    structure.load(b, fx=100.0)
    return structure.build()


@pytest.fixture(scope="module")
def ball():
    system = da.System("ball", gravity=(0, -9.81))
    system.add(planar.Particle("ball", mass=1.0, position=(0.0, 1.0)))
    return system.build()


def test_one_name_for_one_meaning(bar):
    options = {"step": 1e-4, "integrator": da.Newmark()}
    runs = [solve(bar, 1e-3, **options) for solve in (da.solve_dynamics, da.solve_transient)]
    np.testing.assert_array_equal(runs[0]["b.ux"], runs[1]["b.ux"])
    equilibrium, result = da.solve_equilibrium(bar), da.solve_statics(bar, nonlinear=True)
    assert float(equilibrium["b.ux"]) == float(result["b.ux"]) == pytest.approx(1e-3, rel=1e-2)


@pytest.mark.parametrize(
    ("solve", "cure"),
    [
        (da.solve_kinematics, "use solve_statics"),
        (da.solve_inverse_dynamics, "use solve_transient"),
        (da.solve_assembly, "use solve_statics"),
    ],
)
def test_those_of_mechanisms_name_that_of_structures(solve, cure, bar):
    with pytest.raises(da.AnalysisError, match=f"for mechanisms, 'bar' is a structure; .*{cure}"):
        solve(bar)


@pytest.mark.parametrize(
    ("solve", "cure"),
    [
        (da.solve_buckling, "use linearize"),
        (da.solve_load_path, "use solve_equilibrium"),
    ],
)
def test_those_of_structures_name_that_of_mechanisms(solve, cure, ball):
    with pytest.raises(da.AnalysisError, match=f"for structures, 'ball' is a mechanism; {cure}"):
        solve(ball)


@pytest.mark.parametrize("solve", [da.solve_dynamics, da.solve_equilibrium, da.linearize])
def test_what_is_no_model_is_told(solve):
    system = da.System("unbuilt")
    with pytest.raises(da.AnalysisError, match=r"takes a model; got .*build\(\) it first"):
        solve(system)


def test_analyses_of_the_other_kind_are_refused_without_their_verbs_too(bar, ball):
    for analysis in (da.Statics(), da.Buckling(), da.ArcLength()):
        with pytest.raises(da.AnalysisError, match="is for structures, 'ball' is a mechanism; use"):
            analysis.run(ball)
    for analysis in (da.Kinematics(1.0), da.InverseDynamics(1.0), da.Nonsmooth(1.0)):
        with pytest.raises(da.AnalysisError, match="is for mechanisms, 'bar' is a structure; use"):
            analysis.run(bar)
