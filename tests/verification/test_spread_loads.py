"""Loads spread over elements: weight, line loads, tractions; totals, closed forms, gradients."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import dalembert as da
from dalembert import structures

G = 9.81


def cantilever(count: int = 4, dimension: int = 2):
    """A beam along x of length 2 m, every number a parameter."""
    s = da.Structure("cantilever")
    length = s.parameter("L", 2.0)
    values = {"area": 1e-3, "modulus": 2e11, "density": 7800.0}
    values |= {"second_moment": 8e-7} if dimension == 2 else {
        "second_moment_y": 8e-7, "second_moment_z": 8e-7, "torsion_constant": 1e-6,
        "shear_modulus": 8e10,
    }  # fmt: skip
    numbers = {name: s.parameter(name, value) for name, value in values.items()}
    rest = (0.0,) * (dimension - 1)
    nodes = [s.node(f"n{k}", length * (k / count), *rest) for k in range(count + 1)]
    cls = structures.Frame if dimension == 2 else structures.SpaceFrame
    beams = [s.add(cls(f"b{k}", i, j, **numbers)) for k, (i, j) in enumerate(pairwise(nodes))]
    s.support(nodes[0])
    return s, beams


@pytest.mark.parametrize("dimension", [2, 3])
def test_cantilever_under_a_line_load(dimension):
    """``q L⁴/(8 E I)`` and ``q L²/2``, exact at the nodes for any number of elements."""
    s, beams = cantilever(dimension=dimension)
    q = s.parameter("q", -500.0)
    s.line_load(beams, qy=q)
    result = da.solve_statics(s.build())
    assert result["n4.uy"] == pytest.approx(-500 * 2**4 / (8 * 2e11 * 8e-7), rel=1e-10)
    assert result["n4.rz"] == pytest.approx(-500 * 2**3 / (6 * 2e11 * 8e-7), rel=1e-10)
    assert result["n0.fy"] == pytest.approx(1000.0, rel=1e-10)
    assert result["n0.mz"] == pytest.approx(1000.0, rel=1e-10)


@pytest.mark.parametrize("dimension", [2, 3])
def test_a_beam_under_its_weight(dimension):
    s, _ = cantilever(dimension=dimension)
    s.gravity(*((0, -G) + (0,) * (dimension - 2)))
    result = da.solve_statics(s.build())
    q = 7800 * 1e-3 * G
    assert result["n4.uy"] == pytest.approx(-q * 2**4 / (8 * 2e11 * 8e-7), rel=1e-9)
    assert result["n0.fy"] == pytest.approx(2 * q, rel=1e-10)


@pytest.mark.few(1)
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("method", ["adjoint", "direct"])
def test_gradients_under_spread_loads(nonlinear, method):
    s, beams = cantilever()
    s.line_load(beams, qy=s.parameter("q", -9e3), qx=4e2)
    s.gravity(0, -s.parameter("g", G))
    s.support(s.nodes["n4"], uy=0)
    result = da.solve_statics(s.build(), nonlinear=nonlinear)
    responses = [da.final(name) for name in ("n2.uy", "n0.fy", "n0.mz", "n4.fy", "b1.moment_i")]
    gradient = da.sensitivity(result, responses, method=method).values
    near = da.sensitivity(result, responses, method="finite-difference").values
    computed, near = gradient * result.parameters, near * result.parameters
    scale = np.abs(near).max(axis=1, keepdims=True)
    np.testing.assert_allclose(computed / scale, near / scale, atol=1e-6)


SOLIDS = {
    "triangle": structures.Triangle, "triangle6": structures.Triangle6,
    "quad": structures.Quadrilateral, "quad8": structures.Quadrilateral8,
    "tetra": structures.Tetrahedron, "tetra10": structures.Tetrahedron10,
    "hexahedron": structures.Hexahedron, "hexahedron20": structures.Hexahedron20,
}  # fmt: skip


def one_cell(cls):
    """One reference cell, held nowhere."""
    s = da.Structure("cell")
    places = np.array(cls.cell.nodes)
    nodes = s.add_nodes("n", places)
    more = {"thickness": s.parameter("h", 0.3)} if places.shape[1] == 2 else {}
    cells = s.add_elements(
        "e", cls, nodes, np.arange(len(places))[None], modulus=1.0, poisson=0.2, density=2.0, **more
    )
    return s, nodes, cells, places


@pytest.mark.parametrize("name", SOLIDS)
def test_pressure_all_around_is_in_balance(name):
    """Its resultant and moment vanish, and the cell is pressed together evenly."""
    s, nodes, cells, places = one_cell(SOLIDS[name])
    s.traction(cells, nodes, pressure=s.parameter("p", 0.01))
    model = s.build()
    d = places.shape[1]
    force = model.loads[""].values(model.nominal).reshape(-1, d)
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-15)
    np.testing.assert_allclose(force.T @ places, (force.T @ places).T, atol=1e-15)
    volume = model.linearized.assembly.mass(model.nominal).sum() / (2.0 * d)
    np.testing.assert_allclose(force.T @ places, -0.01 * volume * np.eye(d), atol=1e-14)


@pytest.mark.parametrize("name", SOLIDS)
def test_traction_and_weight_by_their_totals(name):
    s, nodes, cells, places = one_cell(SOLIDS[name])
    d = places.shape[1]
    side = nodes.where(y=places[:, 1].min())
    s.traction(cells, side, "pull", ty=2.0)
    s.gravity(*np.arange(1.0, d + 1), case="weight")
    model = s.build()
    pull, weight = (model.loads[c].values(model.nominal).reshape(-1, d) for c in ("pull", "weight"))
    low, high = places.min(), places.max()
    box = name.startswith(("quad", "hexa"))
    length = high - low
    area = length * 0.3 if d == 2 else length**2 if box else length**2 / 2
    np.testing.assert_allclose(pull.sum(axis=0), [0, 2 * area, 0][:d], atol=1e-13)
    assert not pull[np.setdiff1d(np.arange(len(nodes)), side.index)].any()
    volume = length**d * (1 if box else 1 / (2 if d == 2 else 6)) * (0.3 if d == 2 else 1)
    np.testing.assert_allclose(weight.sum(axis=0), 2 * volume * np.arange(1, d + 1), rtol=1e-12)


def test_reactions_balance_what_acts_on_supports_too():
    points, cells = structures.rectangle_mesh((2.0, 1.0), (4, 2))
    s = da.Structure("plate")
    nodes = s.add_nodes("n", points)
    skin = s.add_elements("e", structures.Quadrilateral, nodes, cells, thickness=0.1, modulus=1.0)
    left = nodes.where(x=0.0)
    s.support(left)
    s.traction(skin, nodes.where(y=1.0), ty=-3.0)
    result = da.solve_statics(s.build())
    held = result.model.loads[""].values(result.parameters)[result.model.assembly.prescribed]
    assert held.sum() == pytest.approx(-0.3 * 0.25)  # half of the first edge's
    assert sum(result[f"{n}.fy"] for n in left.names) == pytest.approx(0.6, rel=1e-10)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda s, n, e: s.gravity(0, 0, -9.81), "gravity: needs 2 numbers, got 3"),
        (lambda s, n, e: s.traction(e, n[[0]], tx=1), "no edge has all its nodes there"),
        (lambda s, n, e: s.traction(e, n, push=1), "has no push"),
        (lambda s, n, e: s.line_load(e, qx=1), "carries no line load"),
        (lambda s, n, e: s.gravity(0, da.Parameter("alien", 1.0)) or s.build(), "alien"),
    ],
)
def test_wrong_loads_are_refused(wrong, message):
    s, nodes, cells, _ = one_cell(structures.Quadrilateral)
    with pytest.raises(da.DalembertError, match=message):
        wrong(s, nodes, cells)
