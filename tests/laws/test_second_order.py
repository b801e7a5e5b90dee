"""Hessians of responses times a direction: differences of gradients, symmetry, closed forms."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import CASES, FORMULATIONS, INTEGRATORS, STABILIZATIONS, model_of
from test_derivatives import difference, flat, relative_parameters
from test_statics import propped_bar
from test_structures import CASES as STRUCTURES, model_of as structure_of, triangle, truss

import dalembert as da
from dalembert import planar, structures
from dalembert.model.assembled.model import StructuralModel
from dalembert.responses.base import Response

TIMES = (0.0, 0.033, 0.05, 0.12)
"""Outputs at the beginning, inside and at the end of steps of 0.01 s."""


@functools.cache
def four_bar(driven: bool) -> da.Model:
    """A four-bar with a spring, every number a parameter; free or driven."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    sizes = {"a": (0.3, 1.57), "b": (1.0, 0.2), "c": (0.6, 1.2)}
    number = system.parameter
    speed = number("speed", 2.0)
    bars = [
        system.add(
            planar.Bar(
                name,
                length=number(f"l{name}", length),
                mass=number(f"m{name}", 4.0 * length),
                angle=angle,
                **({"angular_velocity": speed} if name == "a" else {}),
            )
        )
        for name, (length, angle) in sizes.items()
    ]
    ground = system.ground
    width = ground.point(number("w", 1.0), 0.0)
    system.add(planar.Revolute("O", ground.center, bars[0].start))
    system.add(planar.Revolute("A", bars[0].end, bars[1].start))
    system.add(planar.Revolute("B", bars[1].end, bars[2].end))
    system.add(planar.Revolute("D", width, bars[2].start))
    arguments = {"stiffness": number("k", 30.0), "damping": number("d", 1.0)}
    free = number("f", 0.5)
    system.add(
        planar.Spring("S", ground.point(0.2, 1.4), bars[1].center, free_length=free, **arguments)
    )
    if driven:
        law = 1.57 + speed * da.t
        system.add(planar.RotationalDriver("motor", ground, bars[0], law))
    return system.build()


def checked(result, responses, tolerance: float = 1e-6, symmetry: float = 1e-9, h=1e-3) -> None:
    """``H d`` = differences of the adjoint gradient along d, and ``e·H d = d·H e``."""
    rng, p = np.random.default_rng(4), result.parameters
    d, e = relative_parameters(p, rng), relative_parameters(p, rng)

    def gradients(q):
        repeated = result.analysis.replay(result, q)
        return da.sensitivity(repeated, responses, method="adjoint").values.ravel()

    expected = difference(gradients, p, d, h).reshape(len(responses), p.size)
    first = np.abs(gradients(p).reshape(len(responses), p.size)).max(axis=1)
    for response, row, slope in zip(responses, expected, first, strict=True):
        along = da.hessian_product(result, response, d).values
        across = da.hessian_product(result, response, e).values
        # where the Hessian is nearly zero, rounding is that of the gradient
        assert np.abs(along - row).max() <= tolerance * np.abs(along).max() + 1e-9 * slope
        size = np.abs(e) @ np.abs(along) + np.abs(d) @ np.abs(across) + slope
        assert abs(e @ along - d @ across) <= symmetry * size


REDUCTIONS = [
    da.final("b.angle"),
    da.at(0.071, "b.vx"),
    da.integral("B.force_norm"),
    da.mean("c.angle"),
    da.rms("S.force"),
    da.maximum("c.angular_acceleration", smooth="10 rad/s^2"),
    da.minimum("b.angle", smooth=0.1),
    da.maximum("b.angle"),
    da.final("lb*O.force.x + la**2*mb"),
]


@pytest.mark.thorough
@pytest.mark.parametrize("response", REDUCTIONS, ids=lambda r: r.label)
def test_reductions(response):
    """Every reduction, on one run with outputs inside steps."""
    motion = da.solve_dynamics(four_bar(False), 0.12, step=0.01, outputs=TIMES)
    checked(motion, [response])


@pytest.mark.few(1)
@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_inverse_dynamics])
def test_driven_mechanisms(solve):
    """Positions and accelerations, and with inverse dynamics efforts and reactions too."""
    motion = solve(four_bar(True), 0.4, step=0.05)
    measures = ["c.angular_acceleration"]
    measures += ["motor.effort", "B.force_norm"] if solve is da.solve_inverse_dynamics else []
    responses = [da.rms(m, name=f"{m} rms") for m in measures]
    responses += [da.maximum(m, smooth=0.2, name=f"{m} peak") for m in measures]
    checked(motion, responses)


def test_equilibrium():
    rest = da.solve_equilibrium(propped_bar())
    checked(rest, [da.final(m) for m in ("bar.angle", "spring.force", "pin.force_norm")])


def check_implicit(implicit, inputs) -> None:
    """The derivative of the adjoint along changes of inputs and weights, by differences."""
    rng = np.random.default_rng(6)
    inputs = [*inputs, *(rng.standard_normal(n) for n in implicit.output_sizes)]
    rates = [rng.standard_normal(i.size) for i in inputs]
    rates[2] = relative_parameters(inputs[2], rng)
    computed = flat(implicit.reverse.tangent(*inputs, *rates))
    sizes = np.cumsum([i.size for i in inputs])[:-1]
    expected = difference(
        lambda z: flat(implicit.adjoint(*np.split(z, sizes))),
        np.concatenate(inputs),
        np.concatenate(rates),
        h=2e-4,
    )
    np.testing.assert_allclose(computed, expected, atol=1e-8 * (1 + np.abs(computed).max()))


@pytest.mark.few(20)
@pytest.mark.parametrize("name", CASES)
def test_every_element(name):
    """Second derivatives of accelerations and multipliers."""
    model, p = model_of(name), model_of(name).nominal
    e = model.equations
    x = np.concatenate([model.start.y, model.start.v, [0.0, 0.0]])
    accelerations = da.RangeSpace().acceleration(e, e.constraint_acceleration)
    check_implicit(accelerations, [np.array([0.1]), x, p])


@pytest.mark.few(1)
@pytest.mark.parametrize("name", FORMULATIONS)
def test_formulations(name):
    motion = da.solve_dynamics(
        model_of("revolute"),
        0.05,
        step=0.01,
        formulation=FORMULATIONS[name],
        integrator=da.Trapezoidal() if name == "DAE" else da.RK4(),
    )
    checked(motion, [da.final("b.angle")])


@pytest.mark.few(1)
@pytest.mark.parametrize("name", STABILIZATIONS)
def test_stabilizations(name):
    """With corrections after every step and after every third one."""
    chosen = [STABILIZATIONS[name]]
    chosen += [da.Projection(every=3)] if name == "Projection" else []
    for stabilization in chosen:
        motion = da.solve_dynamics(four_bar(False), 0.08, step=0.01, stabilization=stabilization)
        checked(motion, [da.final("b.angle")])


@functools.cache
def swinging_bar() -> da.Model:
    """A bar on a pin and a spring, every number a parameter."""
    system = da.System("bar", gravity=(0.0, -9.81))
    number = system.parameter
    length, mass = number("l", 0.6), number("m", 1.3)
    bar = system.add(planar.Bar("b", length=length, mass=mass, angle=number("start", 0.4)))
    system.add(planar.Revolute("B", system.ground.center, bar.start))
    arguments = {"stiffness": number("k", 30.0), "damping": number("d", 1.0), "free_length": 0.5}
    system.add(planar.Spring("S", system.ground.point(0.2, 1.1), bar.end, **arguments))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "model", [swinging_bar, pytest.param(lambda: four_bar(False), marks=pytest.mark.thorough)]
)
@pytest.mark.parametrize("name", [n for n in INTEGRATORS if n not in ("CVODES", "IDA")])
def test_integrators(name, model):
    """Explicit or implicit, with or without memory and step control: the steps that were taken."""
    integrator = INTEGRATORS[name]
    step = {} if integrator.adaptive else {"step": 0.01}
    motion = da.solve_dynamics(
        model(), 0.06, outputs=(0.0, 0.025, 0.06), integrator=integrator, **step
    )
    checked(motion, [da.final("b.angle"), da.mean("B.force_norm")])


@pytest.mark.thorough
def test_joint_coordinates():
    coordinates = da.JointCoordinates()
    motion = da.solve_dynamics(four_bar(False), 0.08, step=0.01, coordinates=coordinates)
    checked(motion, [da.final("b.angle"), da.mean("B.force_norm")])


@pytest.mark.thorough
def test_variants_that_change():
    """Choices of independent speeds that change during a run."""
    motion = da.solve_dynamics(
        four_bar(False), 2.0, step=0.02, formulation=da.VelocityPartitioning(), outputs=11
    )
    assert np.unique(motion.record.steps.mode).size > 1
    checked(motion, [da.final("b.angle")], h=1e-4)


@pytest.mark.thorough
def test_few_states_kept():
    """A run that keeps few of its states has the same second derivatives."""
    options = {"step": 1 / 5000, "outputs": 5}
    whole = da.solve_dynamics(four_bar(False), 0.3, **options)
    few = da.solve_dynamics(four_bar(False), 0.3, memory=1e4, **options)
    assert few.record.steps.x.stored.size < whole.record.steps.x.size / 4
    computed = [da.hessian_product(m, da.rms("b.angle"), {"la": 1.0}).values for m in (few, whole)]
    np.testing.assert_allclose(*computed, atol=1e-12 * np.abs(computed[1]).max())


def seen(model) -> list[Response]:
    """A displacement, a reaction, a quantity of an element, totals and a formula."""
    last, element = list(model.structure.nodes)[-1], next(iter(model.structure.elements))
    quantity = next(iter(model.blocks[0].kind.measures))
    measures = [f"{last}.ux", "n0.fx", f"{element}.{quantity}", "compliance", "strain_energy"]
    product = model["n0.fx"] * model[f"{last}.ux"] ** 2 + next(iter(model.parameters.values()))
    return [*map(da.final, measures), da.final("mass"), da.final(product, "product")]


LINEAR = ["truss 3-D", "frame 2-D", "Quadrilateral"]


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("name", "nonlinear"), [(n, True) for n in STRUCTURES] + [(n, False) for n in LINEAR]
)
def test_statics(name, nonlinear):
    """Every element at large displacements, some at small ones."""
    model = structure_of(name)
    checked(da.solve_statics(model, nonlinear=nonlinear), seen(model), h=3e-3)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_statics_under_weight_and_line_loads(nonlinear):
    """Masses follow densities, areas and places; the fields are formulas too."""
    structure = da.Structure("arch")
    height, area = structure.parameter("height", 0.4), structure.parameter("area", 0.02)
    g, q = structure.parameter("g", 5.0), structure.parameter("q", 3.0)
    places = (0.0, 0.0), (1.0, height), (2.2, height**2)
    nodes = [structure.node(f"n{k}", *place) for k, place in enumerate(places)]
    section = {"second_moment": area**2 / 12, "modulus": 2e5, "density": 20.0 * (1 + height)}
    for k in range(2):
        ends = nodes[k], nodes[k + 1]
        part = structure.add(structures.Frame(f"e{k}", *ends, area=area, **section))
        structure.line_load(part, qy=-q * height, qx=q**2 / 10)
    structure.gravity(0.1 * g**2, -g * height)
    structure.support(nodes[0])
    structure.support(nodes[2], uy=0.0)
    result = da.solve_statics(structure.build(), nonlinear=nonlinear)
    model = result.model
    seen = [da.final(model[name]) for name in ("n1.uy", "n2.ux", "n0.fy", "e1.force")]
    checked(result, seen, h=3e-3)


def springs() -> StructuralModel:
    """Example 8.9: two springs in a row, k = (1, 2), P = (1, 2), so that U = (3, 4)."""
    structure = da.Structure("example 8.9")
    nodes = [structure.node(f"n{k}", float(k)) for k in range(3)]
    for k in (1, 2):
        stiffness = structure.parameter(f"k{k}", float(k))
        spring = structures.AxialSpring(f"s{k}", nodes[k - 1], nodes[k], stiffness=stiffness)
        structure.add(spring)
        structure.load(nodes[k], fx=structure.parameter(f"P{k}", float(k)))
    structure.support(nodes[0])
    return structure.build()


def test_compliance_of_two_springs():
    """Θ = (P₁ + P₂)²/k₁ + P₂²/k₂ = 11 and its Hessian by hand."""
    result = da.solve_statics(springs())
    response = da.final("compliance")
    assert da.evaluate(result, response) == pytest.approx(11.0, rel=1e-14)
    names = ["k1", "k2", "P1", "P2"]
    columns = [da.hessian_product(result, response, {n: 1.0}, names).values for n in names]
    expected = [[18, 0, -6, -6], [0, 1, 0, -1], [-6, 0, 2, 2], [-6, -1, 2, 3]]
    np.testing.assert_allclose(columns, expected, atol=1e-12)


def test_several_load_cases_and_smooth_extremes():
    """A smooth maximum over load cases of a smooth maximum over elements."""
    structure, nodes = triangle(2, truss)
    structure.support(nodes[0])
    structure.support(nodes[1])
    for k, force in enumerate((0.3, -0.2, 0.25)):
        structure.load(nodes[2], case=f"case {k}", fx=structure.parameter(f"F{k}", force), fy=0.1)
    result = da.solve_statics(structure.build())
    checked(result, [da.maximum("e12.stress", smooth=0.2), da.rms("n2.uy"), da.mean("n0.fx*n2.ux")])


def test_directions_and_rows():
    """A direction by names or numbers, rows for some parameters, a unit vector gives a column."""
    motion = da.solve_dynamics(four_bar(False), 0.05, step=0.01)
    response = da.final("b.angle")
    names = ["la", "k"]
    by_name = da.hessian_product(motion, response, {"la": 2.0, "k": -1.0})
    by_number = da.hessian_product(motion, response, [2.0, -1.0], wrt=names)
    np.testing.assert_allclose(by_name.sel(parameter=names), by_number, rtol=1e-12)
    columns = [da.hessian_product(motion, response, {n: 1.0}).values for n in names]
    np.testing.assert_allclose(by_name, 2.0 * columns[0] - columns[1], rtol=1e-9, atol=1e-12)


def test_unsupported_second_derivatives_are_refused():
    model = four_bar(False)
    motion = da.solve_dynamics(model, 0.02, step=0.01)
    with pytest.raises(da.AnalysisError, match=r"2 component\(s\)"):
        da.hessian_product(motion, da.final("b.angle"), [1.0, 2.0])
    with pytest.raises(da.AnalysisError, match="unknown parameter 'q'"):
        da.hessian_product(motion, da.final("b.angle"), {"q": 1.0})
    modes = da.linearize(propped_bar())
    with pytest.raises(da.UnsupportedError, match="second derivatives of Modal"):
        da.hessian_product(modes, da.at(1.0, "frequency"), {"length": 1.0})
    sundials = da.solve_dynamics(model, 0.02, step=0.01, integrator=da.CVODES())
    with pytest.raises(da.UnsupportedError, match="CVODES"):
        da.hessian_product(sundials, da.final("b.angle"), {"la": 1.0})
