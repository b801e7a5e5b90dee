"""Structures at the edges: sizes of any unit, stiff beside soft, indefinite tangents, wrong use."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import structures
from dalembert.results.status import Outcome


def cantilever(length: float, slenderness: float, count: int = 4):
    """A cantilever with a load at its tip; its deflection and that of the formula P L³/(3 E I)."""
    structure = da.Structure("cantilever")
    depth, modulus = length / slenderness, 2e11
    area, bend = depth**2, depth**4 / 12
    nodes = structure.add_nodes("n", [[length * k / count, 0.0] for k in range(count + 1)])
    cells = [[k, k + 1] for k in range(count)]
    numbers = {"area": area, "second_moment": bend, "modulus": modulus}
    structure.add_elements("e", structures.Frame, nodes, cells, **numbers)
    structure.support(nodes[0])
    load = 1e-6 * modulus * bend / length**2
    structure.load(nodes[-1], fy=load)
    computed = da.solve_statics(structure.build())[f"n[{count}].uy"]
    return computed, load * length**3 / (3 * modulus * bend)


@pytest.mark.parametrize("slenderness", [10.0, 1e3, 1e5])
@pytest.mark.parametrize("length", [1e-9, 1e-6, 1e-3, 1.0, 1e6])
def test_the_size_of_a_frame_makes_no_mechanism(length, slenderness):
    np.testing.assert_allclose(*cantilever(length, slenderness), rtol=1e-12)


def test_a_beam_of_many_elements_is_no_mechanism():
    np.testing.assert_allclose(*cantilever(1.0, 100.0, 1000), rtol=1e-4)  # condition n⁴


def springs(first: float, second: float, nonlinear: bool):
    structure = da.Structure("springs")
    a, b, c = (structure.node(name, x) for name, x in (("a", 0.0), ("b", 1.0), ("c", 2.0)))
    structure.add(structures.AxialSpring("ab", a, b, stiffness=first))
    structure.add(structures.AxialSpring("bc", b, c, stiffness=second))
    structure.support(a)
    structure.load(c, fx=1.0)
    return da.solve_statics(structure.build(), nonlinear=nonlinear)


@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize(("stiff", "soft", "error"), [(1e15, 1.0, 1e-12), (1.0, 1e11, 1e-4)])
def test_stiff_beside_soft(stiff, soft, error, nonlinear):
    result = springs(stiff, soft, nonlinear)
    assert result.status.outcome is Outcome.COMPLETED
    np.testing.assert_allclose(result["c.ux"], 1 / stiff + 1 / soft, rtol=error)


def test_a_mass_alone_is_a_mechanism():
    structure = da.Structure("mass")
    structure.add(structures.PointMass("m", structure.node("a", 0.0, 0.0), mass=1.0))
    with pytest.raises(da.SingularityError, match="a can move"):
        da.solve_statics(structure.build())


def test_supports_may_turn_a_body_without_straining_it():
    structure = da.Structure("turned")
    points, cells = structures.box_mesh((2.0, 1.0, 1.0), (2, 1, 1), "hexahedron")
    nodes = structure.add_nodes("p", points)
    structure.add_elements("e", structures.Hexahedron, nodes, cells, modulus=1e6)
    turn = Rotation.from_rotvec([0.5, -0.8, 0.3])
    moved = turn.apply(points) - points + [0.1, 0.2, 0.3]
    face = nodes.where(x=0.0)
    structure.support(face, **dict(zip(("ux", "uy", "uz"), moved[face.index].T, strict=True)))
    result = da.solve_statics(structure.build(), nonlinear=True)
    assert result.status.outcome is Outcome.COMPLETED
    np.testing.assert_allclose(result.displacement_of(nodes), moved, atol=1e-12)


def test_a_beam_in_space_rolls_up_past_where_it_could_leave_the_plane():
    """The tangent is indefinite there, and elimination without pivots fails."""
    structure, count, length, bend = da.Structure("roll"), 20, 10.0, 1e2
    nodes = structure.add_nodes("n", [[length * k / count, 0.0, 0.0] for k in range(count + 1)])
    cells = [[k, k + 1] for k in range(count)]
    numbers = {"area": 0.1, "modulus": 1e6, "shear_modulus": 5e5, "torsion_constant": 1e-4}
    numbers |= {"second_moment_y": 1e-4, "second_moment_z": 1e-4}
    structure.add_elements("e", structures.SpaceFrame, nodes, cells, **numbers)
    structure.support(nodes[0])
    angle = 0.9 * 2 * np.pi
    structure.load(nodes[-1], mz=angle * bend / length)
    result = da.solve_statics(structure.build(), nonlinear=True, steps=20)
    assert result.status.outcome is Outcome.COMPLETED
    np.testing.assert_allclose(result[f"n[{count}].rz"], angle, rtol=1e-9)


def plate():
    structure = da.Structure("plate")
    points, cells = structures.rectangle_mesh((2.0, 1.0), (2, 2))
    nodes = structure.add_nodes("p", points)
    elements = structure.add_elements(
        "e", structures.Quadrilateral, nodes, cells, modulus=1.0, thickness=1.0
    )
    structure.support(nodes.where(x=0.0))
    return structure, nodes, elements


def test_loads_take_meshes():
    results = []
    for whole in (True, False):
        structure = da.Structure("plate")
        numbers = {"modulus": 1e6, "thickness": 0.1, "expansion": 1e-4}
        mesh = structure.add_mesh("p", structures.rectangle_mesh((2.0, 1.0), (2, 2)), **numbers)
        structure.support(mesh.nodes().where(x=0.0))
        part = mesh if whole else mesh.elements["p"]
        structure.traction(part, mesh.nodes().where(x=2.0), tx=5.0)
        structure.heat(part, temperature=10.0)
        results.append(da.solve_statics(structure.build()).displacements)
    np.testing.assert_array_equal(*results)
    points = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [2, 0]])
    cells = {"quad": np.array([[0, 1, 2, 3]]), "triangle": np.array([[1, 4, 2]])}
    mixed = da.Structure("mixed")
    mesh = mixed.add_mesh("m", (points, cells), modulus=1e6, thickness=0.1)
    with pytest.raises(da.ModelError, match="m: has several sets; take one of its elements: m_"):
        mixed.traction(mesh, mesh.nodes(), tx=1.0)


def test_tractions_act_on_the_surface_only():
    """Where all nodes of a cell are chosen, edges between cells are not loaded twice."""
    structure, nodes, cells = plate()
    structure.traction(cells, nodes, tx=1.0)
    model = structure.build()
    applied = model.loads[""].values(model.nominal)
    assert np.isclose(applied[[model.degrees[f"p[{k}]", "ux"] for k in range(9)]].sum(), 6.0)
    with pytest.raises(da.ModelError, match="on the surface"):
        structure.traction(cells, nodes.where(x=1.0), tx=1.0)


def test_points_and_quantities_of_formulas():
    structure = da.Structure("formulas")
    a = structure.parameter("a", 2.0)
    assert np.array([[a, a], [a, 2 * a]]).shape == (2, 2)
    nodes = structure.add_nodes("p", [[a, a], [2 * a, a], [2 * a, 2 * a], [a, 2 * a]])
    numbers = {"modulus": [3 * a], "thickness": np.array([a / 2]), "density": 3.0}
    structure.add_elements("e", structures.Quadrilateral, nodes, [[0, 1, 2, 3]], **numbers)
    structure.support(nodes)
    assert np.isclose(da.solve_statics(structure.build())["mass"], 3.0 * 2.0**2 * 1.0)


def measured(name):
    structure, nodes, _ = plate()
    structure.load(nodes.where(x=2.0), fx=1.0)
    return da.solve_statics(structure.build())[name]


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda s, n, e: s.load(n[8], ux=1.0), "unknown direction 'ux'; known: fx, fy, mz"),
        (lambda s, n, e: s.load(n[8]), "gets no load"),
        (lambda s, n, e: s.load("p", fx=1.0), "expected nodes"),
        (lambda s, n, e: s.support("p"), "expected nodes"),
        (lambda s, n, e: s.node("bare"), "needs 1, 2 or 3 coordinates"),
        (lambda s, n, e: s.traction(e, n.where(x=2.0)), "has no value"),
        (lambda s, n, e: s.traction(e, n.where(x=2.0), tz=1.0), "has no tz"),
        (lambda s, n, e: s.traction("e", n, tx=1.0), "needs a set of cells"),
        (lambda s, n, e: s.line_load([], qx=1.0), "needs elements"),
        (lambda s, n, e: s.line_load("e", qx=1.0), "needs elements"),
        (lambda s, n, e: s.line_load(e, qz=1.0), "no direction z"),
        (lambda s, n, e: n.nearest(1.0), "a place has 2 coordinates"),
        (lambda s, n, e: n.where(lambda x, y: x[:2] > 0), "one truth value for each"),
        (lambda s, n, e: s.add_nodes("r", [[0, 1], [0]]), "as many coordinates"),
        (lambda s, n, e: s.add_nodes("r", np.zeros((0, 2))), "must be an array"),
        (lambda s, n, e: s.add_elements("f", "quad", n, [[0, 1, 4, 3]]), "a class of structural"),
        (lambda s, n, e: set_of(s, n, cells=[[0, 1, 4], [0, 1, 4, 3]]), "must all have 4 nodes"),
        (lambda s, n, e: set_of(s, n, thickness=np.ones((1, 2))), "for 1 elements"),
        (lambda s, n, e: set_of(s, n, thickness=["x"]), "expected a number"),
        (lambda s, n, e: set_of(s, n, thickness=[None]), "expected a number"),
        (lambda s, n, e: set_of(s, n, plane_strain="no"), "must be True or False"),
    ],
)
def test_wrong_use_is_refused(wrong, message):
    with pytest.raises(da.ModelError, match=message):
        wrong(*plate())


def set_of(structure, nodes, cells=((0, 1, 4, 3),), **numbers):
    arguments = {"modulus": 1.0, "thickness": 1.0} | numbers
    structure.add_elements("f", structures.Quadrilateral, nodes, list(cells), **arguments)


def test_missing_numbers_are_refused():
    structure = da.Structure("bar")
    a, b = structure.node("a", 0.0), structure.node("b", 1.0)
    with pytest.raises(da.ModelError, match=r"bar\.area: expected a number"):
        structures.Truss("bar", a, b, area=None, modulus=1.0)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("e.sxx.max(0)", r"^no measure 'e.sxx.max\(0\)'; nearest: "),
        ("e.sxx.max(1e400)", r"^no measure 'e.sxx.max\(1e400\)'; nearest: "),
        (3, "a measure is a name, a formula or an expression, got 3"),
        (None, "a measure is a name, a formula or an expression, got None"),
    ],
)
def test_measures_that_are_none(name, message):
    with pytest.raises(da.ExpressionError, match=message):
        measured(name)


def test_unbuilt_models_are_refused():
    for verb, argument in (
        (da.solve_statics, da.Structure("s")),
        (da.solve_kinematics, da.System("m")),
    ):
        with pytest.raises(da.AnalysisError, match=r"takes a model; .* build\(\) it first"):
            verb(argument)


@pytest.mark.parametrize("counts", [2, ("a", 2), (1.5, 2), (0, 2), (1, 2, 3)])
def test_meshes_need_whole_numbers(counts):
    with pytest.raises(da.ModelError, match="positive whole number"):
        structures.rectangle_mesh((1.0, 1.0), counts)


def test_no_force_may_stand_on_a_support():
    """Loads of many nodes are arrays, with zeros where nodes are held."""
    truss = da.Structure("held")
    a, b = truss.node("a", 0.0, 0.0), truss.node("b", 1.0, 0.0)
    truss.add(structures.Truss("t", a, b, area=1.0, modulus=2.0))
    truss.support(a)
    truss.support(b, uy=0.0)
    truss.load(b, fx=1.0, fy=0.0)
    assert float(da.solve_statics(truss.build())["b.ux"]) == pytest.approx(0.5)
    truss.load(b, fy=1.0)
    with pytest.raises(da.ModelError, match="reaction"):
        truss.build()
