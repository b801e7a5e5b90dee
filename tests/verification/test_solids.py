"""Continuum elements: shape functions, patch tests, orders of convergence, NAFEMS LE10."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from cell_meshes import shape_values, unit_mesh, with_middles

import dalembert as da
from dalembert import structures
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS, gauss_box, gauss_simplex
from dalembert.elements.fem.registry import SHAPES

E, NU, RHO = 7.0, 0.3, 2.5
CLASSES = {shape: cls for cls, shape in SHAPES.items() if hasattr(cls, "cell")}
QUADRATIC = ("triangle6", "quad8", "tetra10", "hexahedron20")


def material(cls, **options) -> dict:
    thickness = {"thickness": 1.0} if cls.cell.dimension == 2 else {}
    return {"modulus": E, "poisson": NU, "density": RHO} | thickness | options


def meshed(shape: str, points, cells, **options):
    """Structure and its nodes from a mesh."""
    structure = da.Structure(shape)
    constants = material(CLASSES[shape], **options)
    mesh = structure.add_mesh("m", (points, {shape: cells}), **constants)
    return structure, mesh.nodes()


def hold(structure, nodes, which, field) -> None:
    """Prescribe the displacements of some nodes, (n, d) at (n, d) places."""
    moved = field(nodes.positions[which])
    for i in range(moved.shape[1]):
        structure.support(nodes[which], **{"u" + "xyz"[i]: moved[:, i]})


# reference cells -------------------------------------------------------------------------
@pytest.mark.parametrize("shape", REFERENCE_CELLS)
def test_shape_functions(shape):
    """One at their own node, zero at others; complete: they interpolate all their monomials."""
    cell = REFERENCE_CELLS[shape]
    nodes = np.array(cell.nodes)
    at_nodes = np.array([shape_values(shape, node) for node in nodes])
    np.testing.assert_allclose(at_nodes, np.eye(len(nodes)), atol=1e-14)
    order = 2 if shape in QUADRATIC else 1
    for place in np.random.default_rng(2).uniform(0.1, 0.3, (3, cell.dimension)):
        values = shape_values(shape, place)
        assert values.sum() == pytest.approx(1.0, abs=1e-14)
        for powers in np.ndindex(*[order + 1] * cell.dimension):
            if sum(powers) <= order:
                exact = np.prod(place ** np.array(powers))
                assert values @ np.prod(nodes**powers, axis=1) == pytest.approx(exact, abs=1e-14)


@pytest.mark.parametrize("count", [1, 2, 3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_integration_points(dimension, count):
    """Exact to degree 2 n − 1: monomials on the box and the simplex."""
    from math import factorial

    for rule, exact in (
        (gauss_box, lambda a: np.prod([(1 + (-1) ** k) / (k + 1) for k in a])),
        (
            gauss_simplex,
            lambda a: np.prod([factorial(k) for k in a]) / factorial(sum(a) + dimension),
        ),
    ):
        rows = np.array(rule(dimension, count))
        for powers in np.ndindex(*[2 * count] * dimension):
            if sum(powers) < 2 * count:
                computed = rows[:, -1] @ np.prod(rows[:, :-1] ** powers, axis=1)
                assert computed == pytest.approx(exact(powers), abs=1e-13)


# patch tests ------------------------------------------------------------------------------
@pytest.mark.few(4)
@pytest.mark.parametrize("shape", CLASSES)
def test_linear_fields_are_exact_on_distorted_meshes(shape):
    points, cells = unit_mesh(shape, 2)
    plain = len(np.unique(cells[:, : REFERENCE_CELLS[shape].corner_count]))
    corners = np.arange(len(points)) < plain
    inside = np.all((points > 1e-9) & (points < 1 - 1e-9), axis=1)
    rng, d = np.random.default_rng(3), points.shape[1]
    points[corners & inside] += rng.uniform(-0.1, 0.1, (np.sum(corners & inside), d))
    if shape in QUADRATIC:  # middles follow their corners
        only = cells[:, : REFERENCE_CELLS[shape].corner_count]
        points, cells = with_middles(shape, points[:plain], only)
        inside = np.all((points > 1e-9) & (points < 1 - 1e-9), axis=1)
    structure, nodes = meshed(shape, points, cells)
    gradient = 0.01 * rng.standard_normal((d, d))
    hold(structure, nodes, np.flatnonzero(~inside), lambda x: x @ gradient.T)
    model = structure.build()
    result = da.solve_statics(model)
    place = nodes.positions
    for k in np.flatnonzero(inside):
        computed = [result[f"m_nodes[{k}].u{c}"] for c in "xyz"[:d]]
        np.testing.assert_allclose(computed, gradient @ place[k], atol=1e-14)
    strain = (gradient + gradient.T) / 2
    second = E * NU / (1 - NU**2) if d == 2 else E * NU / ((1 + NU) * (1 - 2 * NU))
    stress = second * np.trace(strain) * np.eye(d) + E / (1 + NU) * strain
    deviator = np.zeros((3, 3))
    deviator[:d, :d] = stress
    deviator -= np.trace(deviator) / 3 * np.eye(3)
    for name in ("m[0]", f"m[{len(cells) - 1}]"):
        for i, j in np.ndindex(d, d):
            if i <= j:
                letters = "xyz"[i] + "xyz"[j]
                for station in ("", "_n0", "_n2"):
                    assert result[f"{name}.s{letters}{station}"] == pytest.approx(
                        stress[i, j], abs=1e-13
                    )
                assert result[f"{name}.e{letters}"] == pytest.approx(strain[i, j], abs=1e-14)
        mises = np.sqrt(1.5 * np.sum(deviator**2))
        assert result[f"{name}.von_mises"] == pytest.approx(mises, rel=1e-11)
    assert result["mass"] == pytest.approx(RHO, rel=1e-12)


@pytest.mark.few(4)
@pytest.mark.parametrize("shape", CLASSES)
def test_a_spinning_cell_has_the_energy_of_the_body(shape):
    """``ω²/2 ρ ∫ r² dV`` of the unit square or cube about the z axis: 2 ρ/3."""
    points, cells = unit_mesh(shape, 1)
    structure, _ = meshed(shape, points, cells)
    model = structure.build()
    v = np.zeros(len(model.degrees))
    for k, (x, y) in enumerate(points[:, :2]):
        v[model.degrees[f"m_nodes[{k}]", "ux"]] = -y
        v[model.degrees[f"m_nodes[{k}]", "uy"]] = x
    assert v @ model.assembly.mass(model.nominal) @ v == pytest.approx(2 * RHO / 3, rel=1e-12)


# convergence ------------------------------------------------------------------------------
def harmonic(x: np.ndarray) -> np.ndarray:
    """Gradient of a harmonic function: in equilibrium, without change of volume."""
    if x.shape[1] == 2:
        return 0.1 * np.exp(x[:, :1]) * np.column_stack([np.cos(x[:, 1]), -np.sin(x[:, 1])])
    a, (s, y, z) = np.sqrt(2), x.T
    rows = [a * np.cos(y) * np.cos(z), -np.sin(y) * np.cos(z), -np.cos(y) * np.sin(z)]
    return 0.1 * np.exp(a * s[:, None]) * np.column_stack(rows)


def error(shape: str, count: int) -> float:
    """Root mean square error of the displacement at a point of every cell."""
    points, cells = unit_mesh(shape, count)
    structure, nodes = meshed(shape, points, cells)
    edge = np.any((points < 1e-9) | (points > 1 - 1e-9), axis=1)
    hold(structure, nodes, np.flatnonzero(edge), harmonic)
    model = structure.build()
    result = da.solve_statics(model)
    block = model.blocks[0]
    u = result.displacements[:, 0][block.degrees].reshape(cells.shape[1], points.shape[1], -1)
    natural = np.array(REFERENCE_CELLS[shape].centre) + 0.13
    values = shape_values(shape, natural)
    places = np.einsum("a,ead->ed", values, nodes.positions[cells])
    computed = np.einsum("a,ade->ed", values, u)
    return float(np.sqrt(np.mean(np.sum((computed - harmonic(places)) ** 2, axis=1))))


@pytest.mark.few(2)
@pytest.mark.parametrize("shape", CLASSES)
def test_order_of_convergence(shape):
    """Displacements of linear cells converge with the square, of quadratic ones with the cube."""
    counts = {"hexahedron20": (6, 8), "tetra10": (2, 4), "tetra": (4, 8), "hexahedron": (4, 8)}
    coarse, fine = counts.get(shape, (6, 12))
    order = np.log(error(shape, coarse) / error(shape, fine)) / np.log(fine / coarse)
    assert order == pytest.approx(3 if shape in QUADRATIC else 2, abs=0.25)


# benchmark --------------------------------------------------------------------------------
def quarter_ring(radial: int, around: int, thick: int):
    """Hexahedra of 20 nodes between the ellipses of LE10, curved; ``x, y, z`` at all nodes."""
    points, cells = structures.box_mesh((1, 1, 1), (radial, around, thick))
    points, cells = with_middles("hexahedron20", points, cells)
    s, angle = points[:, 0], np.pi / 2 * points[:, 1]
    x = ((1 - s) * 2.0 + s * 3.25) * np.cos(angle)
    y = ((1 - s) * 1.0 + s * 2.75) * np.sin(angle)
    return np.column_stack([x, y, 0.6 * points[:, 2]]), cells, points


def pressure_forces(points, cells, pressure: float) -> dict[int, float]:
    """Consistent forces of a pressure on faces of 8 nodes that lie in a plane z = constant."""
    place = ca.SX.sym("place", 2)
    shapes = REFERENCE_CELLS["quad8"].shape_functions(place)
    both = ca.Function("both", [place], [shapes, ca.jacobian(shapes, place)])
    results: dict[int, float] = {}
    for cell in cells:
        for *natural, weight in gauss_box(2, 3):
            values, slopes = (np.array(f) for f in both(natural))
            area = abs(np.linalg.det(points[cell, :2].T @ slopes))
            for node, value in zip(cell, values.ravel(), strict=True):
                results[int(node)] = results.get(int(node), 0.0) - weight * area * value * pressure
    return results


def test_thick_plate():
    """NAFEMS LE10: pressure of 1 MPa on a thick elliptic plate, σ_yy at D = −5.38 MPa."""
    points, cells, natural = quarter_ring(6, 8, 4)
    structure = da.Structure("LE10")
    arguments = {"modulus": 210e9, "poisson": 0.3}
    nodes = structure.add_mesh("m", (points, {"hexahedron20": cells}), **arguments).nodes()
    r, s, t = natural.T
    structure.support(nodes[np.flatnonzero(s > 1 - 1e-9)], ux=0.0)
    structure.support(nodes[np.flatnonzero((s < 1e-9) | (r > 1 - 1e-9))], uy=0.0)
    structure.support(nodes[np.flatnonzero((r > 1 - 1e-9) & (s < 1 - 1e-9))], ux=0.0)
    structure.support(nodes[np.flatnonzero((r > 1 - 1e-9) & (abs(t - 0.5) < 1e-9))], uz=0.0)
    top = [4, 5, 6, 7, 12, 13, 14, 15]
    upper = cells[np.all(t[cells[:, top]] > 1 - 1e-9, axis=1)][:, top]
    for node, force in pressure_forces(points, upper, 1e6).items():
        structure.load(nodes[node], fz=force)
    result = da.solve_statics(structure.build())
    corner = int(np.flatnonzero((r < 1e-9) & (s < 1e-9) & (t > 1 - 1e-9))[0])
    element, place = np.argwhere(cells == corner)[0]
    stress = result[f"m[{element}].syy_n{place}"]
    assert stress == pytest.approx(-5.38e6, rel=0.02)


@pytest.mark.parametrize(
    ("shape", "spoil", "message"),
    [
        ("quad", lambda x: x[[0, 3, 2, 1]], "count them counter-clockwise"),
        ("triangle", lambda x: x[[0, 2, 1]], "turned inside out or degenerate"),
        ("tetra", lambda x: x * [1, 1, 0], r"bad: is turned inside out .*Jacobian 0 "),
        ("hexahedron", lambda x: x[[4, 5, 6, 7, 0, 1, 2, 3]], "in the order of VTK"),
        (
            "quad",
            lambda x: x - 1.9 * (x.min(axis=1) > 0)[:, None],
            "turned inside out or degenerate",
        ),
    ],
)
def test_impossible_cells_are_refused(shape, spoil, message):
    structure, cls = da.Structure("wrong"), CLASSES[shape]
    places = spoil(np.array(cls.cell.nodes))
    nodes = [structure.node(f"n{k}", *place) for k, place in enumerate(places)]
    structure.add(cls("bad", nodes, **material(cls)))
    with pytest.raises(da.ModelError, match=message):
        structure.build()


def test_incompressible_material_is_refused():
    structure, cls = da.Structure("rubber"), structures.Tetrahedron
    poisson = structure.parameter("poisson", 0.4)
    nodes = [structure.node(f"n{k}", *place) for k, place in enumerate(cls.cell.nodes)]
    structure.add(cls("cell", nodes, modulus=E, poisson=poisson))
    model = structure.build()
    with pytest.raises(da.ModelError, match="cell: is incompressible"):
        model.values({"poisson": 0.5})
