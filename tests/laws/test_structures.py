"""Structures: laws that every kind of element keeps, and gradients by all three methods."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import structures
from dalembert.analysis import solve_statics


def triangle(dimension: int, make):
    """Three elements between three nodes in general position, every number a parameter."""
    structure = da.Structure(f"triangle in {dimension}-D")
    rng = np.random.default_rng(dimension)
    corners = np.vstack([np.zeros(dimension), np.eye(dimension), 2 * np.eye(dimension)])
    places = corners[: max(dimension + 1, 3)] + rng.uniform(
        -0.2, 0.2, (max(dimension + 1, 3), dimension)
    )
    nodes = [
        structure.node(
            f"n{k}", *(structure.parameter(f"x{k}{i}", float(c)) for i, c in enumerate(place))
        )
        for k, place in enumerate(places)
    ]
    for i in range(len(nodes)):
        for j in range(i):
            make(structure, f"e{j}{i}", nodes[j], nodes[i])
    return structure, nodes


def spring(structure, name, i, j):
    k = structure.parameter(f"k_{name}", 1.0 + len(structure.elements))
    structure.add(structures.AxialSpring(name, i, j, stiffness=k))


def truss(structure, name, i, j):
    n = len(structure.elements)
    area = structure.parameter(f"A_{name}", 0.5 + 0.1 * n)
    modulus = structure.parameter(f"E_{name}", 3.0 + n)
    density = structure.parameter(f"rho_{name}", 2.0)
    structure.add(structures.Truss(name, i, j, area=area, modulus=modulus, density=density))


def frame(structure, name, i, j, kind=structures.Frame, **more):
    n = len(structure.elements)
    given = {"area": 0.5 + 0.1 * n, "second_moment": 0.04, "modulus": 3.0 + n, "density": 2.0}
    numbers = {k: structure.parameter(f"{k}_{name}", v) for k, v in (given | more).items()}
    structure.add(kind(name, i, j, **numbers))


def timoshenko_frame(structure, name, i, j):
    frame(structure, name, i, j, structures.TimoshenkoFrame, shear_modulus=1.3, shear_area=0.3)


CASES = {
    f"{make.__name__} {dimension}-D": (dimension, make)
    for make in (spring, truss)
    for dimension in (1, 2, 3)
} | {"frame 2-D": (2, frame), "timoshenko frame 2-D": (2, timoshenko_frame)}


@functools.cache
def model_of(name: str):
    dimension, make = CASES[name]
    structure, nodes = triangle(dimension, make)
    settlement = structure.parameter("settlement", 0.02)
    structure.support(nodes[0])
    for k, node in enumerate(nodes[1:dimension], 1):  # just enough to hold it
        held = {f"u{'xyz'[i]}": settlement if i == 0 else 0.0 for i in range(k, dimension)}
        structure.support(node, **held)
    for k, node in enumerate(nodes[1:]):
        free = [c for c in "xyz"[:dimension] if (node.name, f"u{c}") not in structure.supports]
        for c in free:
            structure.load(node, **{f"f{c}": structure.parameter(f"F{c}{k}", 0.3 - 0.2 * k)})
    return structure.build()


def places_of(model) -> np.ndarray:
    """(nodes, d) coordinates."""
    numbers = [
        [model.parameters[f"x{name[1:]}{i}"].value for i in range(node.dimension)]
        for name, node in model.structure.nodes.items()
    ]
    return np.array(numbers)


def displaced(model, moved: np.ndarray, angle: float = 0.0) -> np.ndarray:
    """Displacements (n,) that move the nodes by (nodes, d) and turn those that can by an angle."""
    u = np.full(len(model.degrees), angle)
    for k, name in enumerate(model.structure.nodes):
        for i in range(moved.shape[1]):
            u[model.degrees[name, "u" + "xyz"[i]]] = moved[k, i]
    return u


@pytest.mark.parametrize("name", CASES)
def test_stiffness_is_symmetric_and_free_of_rigid_motions(name):
    dimension, make = CASES[name]
    model = triangle(dimension, make)[0].build().linearized
    size = len(model.degrees)
    matrix = model.assembly.stiffness(np.zeros(size), model.nominal).toarray()
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-13)
    place = places_of(model)
    motions = [displaced(model, np.ones((len(place), 1)) * e) for e in np.eye(dimension)]
    for i in range(dimension):
        for j in range(i):
            turn = np.zeros_like(place)
            turn[:, i], turn[:, j] = place[:, j], -place[:, i]
            motions.append(displaced(model, turn, angle=1.0 if (i, j) == (1, 0) else 0.0))
    for motion in motions:
        np.testing.assert_allclose(matrix @ motion, 0.0, atol=1e-12)
    rank = np.linalg.matrix_rank(matrix, tol=1e-9)
    assert rank == size - dimension * (dimension + 1) // 2


@pytest.mark.parametrize("name", CASES)
def test_large_displacements_leave_rigid_motions_without_force(name):
    """The exact energy does not notice a rotation, however large."""
    dimension, make = CASES[name]
    model = triangle(dimension, make)[0].build()
    place, angle = places_of(model), 2.1
    turn = np.eye(dimension)
    if dimension > 1:
        c, s = np.cos(angle), np.sin(angle)
        turn[:2, :2] = [[c, -s], [s, c]]
    u = displaced(model, place @ turn.T - place + 0.7, angle)
    forces = model.assembly.internal_forces(u, model.nominal)
    np.testing.assert_allclose(forces, 0.0, atol=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_equilibrium_and_work(name):
    """Forces and reactions balance; twice the strain energy is the work of the forces."""
    model = model_of(name)
    result = solve_statics(model)
    scale = np.abs(result.forces).max()
    for direction in ("ux", "uy", "uz")[: CASES[name][0]]:
        total = sum(result.forces[k, 0] for p, k in model.degrees.items() if p[1] == direction)
        assert total == pytest.approx(0.0, abs=1e-11 * scale)
    assert result["compliance"] == pytest.approx(2 * result["strain_energy"], rel=1e-12)
    assert result.status.residual < 1e-12


@pytest.mark.parametrize("name", CASES)
def test_direct_adjoint_and_differences_agree(name):
    """Displacements, reactions, element quantities and totals by every parameter."""
    model = model_of(name)
    result = solve_statics(model)
    last = list(model.structure.nodes)[-1]
    element = next(iter(model.structure.elements))
    measures = [f"{last}.ux", "n0.fx", f"{element}.force", "compliance", "strain_energy", "mass"]
    responses = [da.final(m) for m in measures]
    product = model["n0.fx"] * model[f"{last}.ux"] + next(iter(model.parameters.values()))
    responses.append(da.final(product, "product"))
    adjoint, direct, differences = (
        da.sensitivity(result, responses, method=m).values
        for m in ("adjoint", "direct", "finite-difference")
    )
    scale = np.maximum(np.abs(direct).max(axis=1, keepdims=True), 1e-12)
    assert (np.abs(adjoint - direct) / scale).max() < 1e-9
    assert (np.abs(differences - direct) / scale).max() < 1e-6


def test_mechanisms_name_their_nodes():
    structure = da.Structure("hinge")
    a, b, c = (structure.node(n, *p) for n, p in (("a", (0, 0)), ("b", (1, 0)), ("c", (2, 0))))
    for name, i, j in (("ab", a, b), ("bc", b, c)):
        structure.add(structures.Truss(name, i, j, area=1.0, modulus=1.0))
    structure.support(a)
    structure.support(c)
    structure.load(b, fy=1.0)
    with pytest.raises(da.SingularityError, match="b can move without straining"):
        solve_statics(structure.build())


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda s, n: s.node("loose", 3.0, 3.0), "loose: is not connected"),
        (lambda s, n: s.load(n[0], fx=1.0), "the force there is a reaction"),
        (lambda s, n: s.support(n[1], uz=0.0), "unknown direction 'uz'"),
        (lambda s, n: s.load(n[1], mz=1.0), "no element turns this node"),
        (lambda s, n: s.node("flat", 1.0), "has 1 coordinates"),
        (lambda s, n: s.support(n[0], ux=1.0) or s.support(n[0], ux=1.0), "prescribed twice"),
    ],
)
def test_wrong_structures_are_refused(spoil, message):
    structure, nodes = triangle(2, truss)
    structure.support(nodes[0])

    def build():
        spoil(structure, nodes)
        structure.build()

    with pytest.raises(da.ModelError, match=message):
        build()


def test_load_cases_share_one_factorisation():
    structure, nodes = triangle(2, truss)
    structure.support(nodes[0])
    structure.support(nodes[1])
    structure.load(nodes[2], case="push", fx=1.0)
    structure.load(nodes[2], case="pull", fx=-2.0)
    result = solve_statics(structure.build())
    assert result.cases == ["push", "pull"]
    np.testing.assert_allclose(result["n2.ux"][1], -2 * result["n2.ux"][0], rtol=1e-13)
    assert da.evaluate(result, da.at(1, "n2.ux")) == result["n2.ux"][1]
