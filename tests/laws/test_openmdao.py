"""Mechanisms and structures among components of OpenMDAO: partials, totals, solvers, drivers."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial, structures
from dalembert.errors import AnalysisError

om = pytest.importorskip("openmdao.api")


def vane() -> da.Model:
    """A bar between a spring and its weight."""
    system = da.System("vane", gravity=(0, -9.81))
    k = system.parameter("k", 50.0, "N/m")
    length, mass = system.parameter("length", 0.5, "m"), system.parameter("mass", 2.0, "kg")
    bar = system.add(planar.Bar("bar", length=length, mass=mass, angle=-1.2))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    post = system.ground.point(0.5, 0.3)
    system.add(planar.Spring("spring", post, bar.end, stiffness=k, free_length=0.2))
    return system.build()


def top() -> da.Model:
    """A body on a ball joint between springs: coordinates with bounds."""
    system = da.System("top", gravity=(0, 0, -9.81))
    wind = system.parameter("wind", 3.0, "N")
    body = system.add(spatial.Body("body", mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0, 0, -1)))
    system.add(spatial.Spherical("S", system.ground.point(0, 0, 0), body.point(0, 0, 1)))
    system.add(spatial.Force("push", body.center, (wind, 0.5 * wind, 0)))
    for name, at, to in (("a", (1, 0, -1), (0.3, 0, 0)), ("b", (0, 1, -1), (0, 0.3, 0.1))):
        ends = system.ground.point(*at), body.point(*to)
        system.add(spatial.Spring(name, *ends, stiffness=60.0, free_length=0.3))
    return system.build()


def four_bar() -> da.Model:
    system = da.System("four-bar")
    crank_length = system.parameter("crank_length", 0.1, "m")
    turned = system.parameter("turned", 0.7, "rad")
    crank = system.add(planar.Bar("crank", length=crank_length))
    coupler = system.add(planar.Bar("coupler", length=0.35, angle=0.3))
    rocker = system.add(planar.Bar("rocker", length=0.3, angle=1.4))
    system.add(planar.Revolute("O1", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(0.3, 0), rocker.start))
    system.add(planar.RotationalDriver("motor", system.ground, crank, turned))
    return system.build()


def truss() -> da.StructuralModel:
    """Two bars, a support that gives way and two load cases."""
    structure = da.Structure("truss")
    load, area = structure.parameter("load", 1e3, "N"), structure.parameter("area", 1e-3, "m^2")
    height, sunk = structure.parameter("height", 0.4, "m"), structure.parameter("sunk", 1e-3, "m")
    left, apex, right = (
        structure.node(n, *at) for n, at in (("a", (0, 0)), ("b", (1, height)), ("c", (2, 0)))
    )
    structure.add(structures.Truss("first", left, apex, area=area, modulus=2e9))
    structure.add(structures.Truss("second", apex, right, area=area, modulus=2e9))
    structure.support(left)
    structure.support(right, ux=0, uy=-sunk)
    structure.load(apex, case="down", fy=-load)
    structure.load(apex, case="side", fx=load)
    return structure.build()


CASES = {
    "equilibrium": (vane, ["bar.end.x", "O.force_norm"], da.Equilibrium()),
    "equilibrium in space": (top, ["body.x", "S.force_norm"], da.Equilibrium()),
    "assembly": (four_bar, {"transmission": "rocker.angle - coupler.angle"}, None),
    "statics": (truss, {"stress": "first.stress/1e6", "work": "compliance"}, da.Statics()),
    "large displacements": (truss, {"lift": "c.fy"}, da.Equilibrium()),
}


@pytest.mark.few(2)
@pytest.mark.parametrize("name", CASES)
def test_states_with_their_residuals(name):
    """Partials both ways against differences, totals against our own gradients."""
    from openmdao.utils.assert_utils import assert_check_partials

    make, measures, analysis = CASES[name]
    model = make()
    problem = om.Problem(reports=None)
    component = da.openmdao_implicit_component(model, measures, analysis=analysis)
    problem.model.add_subsystem("it", component, promotes=["*"])
    problem.setup()
    problem.run_model()
    assert_check_partials(problem.check_partials(out_stream=None), atol=1e-5, rtol=1e-5)
    one = next(iter(measures.values())) if isinstance(measures, dict) else measures[-1]
    label = (next(iter(measures)) if isinstance(measures, dict) else one).replace(".", "_")
    names = list(model.parameters)
    result = analysis.run(model) if analysis else da.solve_kinematics(model, 1e-3, outputs=2)
    expected = da.sensitivity(result, da.at(float(result.time[-1]), one), names).values.ravel()
    for mode in ("fwd", "rev"):
        problem.setup(mode=mode)
        problem.run_model()
        computed = problem.compute_totals(of=label, wrt=names, return_format="array")[-1]
        np.testing.assert_allclose(computed, expected, rtol=1e-6, atol=1e-9 * abs(expected).max())


def test_a_load_that_follows_the_state():
    """A weight on a spring whose load grows as it sinks: ``k u = F (1 + u)``, by their Newton."""
    structure = da.Structure("spring")
    load = structure.parameter("load", 1.0, "N")
    end = structure.node("end", 0)
    structure.add(structures.GroundSpring("spring", end, stiffness_x=5.0))
    structure.load(end, fx=load)
    problem = om.Problem(reports=None)
    group = problem.model
    component = da.openmdao_implicit_component(structure.build(), {"u": "end.ux"})
    group.add_subsystem("spring", component, promotes=["*"])
    group.add_subsystem("crowd", om.ExecComp("load = F*(1 + u)", F=2.0), promotes=["*"])
    group.nonlinear_solver = om.NewtonSolver(solve_subsystems=False, iprint=-1)
    group.linear_solver = om.ScipyKrylov()
    problem.setup()
    problem.run_model()
    assert problem["u"] == pytest.approx(2 / 3)
    total = problem.compute_totals(of="u", wrt="F", return_format="array")
    assert total.item() == pytest.approx(5 / (5 - 2) ** 2)


@pytest.mark.parametrize("gradient", ["direct", "adjoint"])
def test_a_design_in_their_driver(gradient):
    """The lightest of two bars that sink no more than so far: ``A = F L³/(2 E h² u)``."""
    rods = da.Structure("two bars")
    area = rods.parameter("area", 2e-4, "m^2", bounds=(1e-5, 1e-2))
    apex = rods.node("apex", 0, 1)
    for k, x in enumerate((-1, 1)):
        foot = rods.node(f"foot{k}", x, 0)
        rods.add(structures.Truss(f"bar{k}", foot, apex, area=area, modulus=2e11, density=7850))
        rods.support(foot)
    rods.load(apex, fy=-1e5)
    responses = [da.final("mass", name="mass"), da.final("-apex.uy*1e3", name="sunk")]
    component = da.openmdao_component(
        rods.build(), responses, analysis=da.Statics(), gradient=gradient
    )
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("design", component, promotes=["*"])
    problem.model.add_design_var("area", lower=1e-5, upper=1e-2, ref=1e-4)
    problem.model.add_objective("mass")
    problem.model.add_constraint("sunk", upper=1.0)
    problem.driver = om.ScipyOptimizeDriver(optimizer="SLSQP", tol=1e-10, disp=False)
    problem.setup()
    problem.run_driver()
    assert problem["area"] == pytest.approx(1e5 * 2 * math.sqrt(2) / (2 * 2e11 * 1e-3), rel=1e-6)
    for entry in problem.check_partials(out_stream=None, step=1e-9)["design"].values():
        np.testing.assert_allclose(entry["J_fwd"], entry["J_fd"], rtol=1e-3, atol=1e-3)


def test_invalid_implicit_components_are_refused():
    with pytest.raises(AnalysisError, match="has no state equations"):
        da.openmdao_implicit_component(vane(), analysis=da.Dynamics(1.0, step=0.1))
    with pytest.raises(AnalysisError, match=r"bar\.end\.vx: an assembled position has no speeds"):
        da.openmdao_implicit_component(vane(), ["bar.end.vx"])
    with pytest.raises(AnalysisError, match="distinct names: k"):
        da.openmdao_implicit_component(vane(), {"k": "bar.x"}, analysis=da.Equilibrium())
    with pytest.raises(da.ModelError, match="unknown parameter 'kk'"):
        da.openmdao_implicit_component(vane(), analysis=da.Equilibrium(), vary=["kk"])
    blocked = da.openmdao_implicit_component(four_bar())
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("it", blocked, promotes=["*"])
    problem.setup()
    problem["crank_length"] = 5.0
    with pytest.raises(om.AnalysisError, match="assembl"):
        problem.run_model()
