"""Plane elements: patch tests with exact fields, and convergence to beam theory."""

from __future__ import annotations

import numpy as np
import pytest
from cell_meshes import unit_mesh, with_middles

import dalembert as da
from dalembert import structures

E, NU, T = 7.0, 0.3, 0.4
SHIFTS = {5: (0.06, -0.04), 6: (-0.05, 0.03), 9: (0.04, 0.05), 10: (-0.03, -0.06)}


def patch(kind: str, plane_strain: bool):
    """A distorted mesh of 3 × 3 cells on the unit square."""
    structure = da.Structure("patch")
    nodes = []
    for k in range(16):
        place = np.array([k % 4, k // 4]) / 3 + SHIFTS.get(k, (0.0, 0.0))
        nodes.append(structure.node(f"n{k}", *place))
    arguments = {"thickness": T, "modulus": E, "poisson": NU, "plane_strain": plane_strain}
    for i in range(3):
        for j in range(3):
            a, b = 4 * j + i, 4 * j + i + 1
            corners = (nodes[a], nodes[b], nodes[b + 4], nodes[a + 4])
            if kind == "quadrilateral":
                structure.add(structures.Quadrilateral(f"q{i}{j}", corners, **arguments))
                continue
            structure.add(structures.Triangle(f"a{i}{j}", corners[:3], **arguments))
            structure.add(structures.Triangle(f"b{i}{j}", (corners[0], *corners[2:]), **arguments))
    return structure, nodes


@pytest.mark.parametrize("plane_strain", [False, True])
@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
def test_linear_fields_are_exact(kind, plane_strain):
    """Displacements of the edge by a linear field: the inside follows, stresses by Hooke's law."""
    structure, nodes = patch(kind, plane_strain)
    gradient = np.array([[0.01, 0.004], [-0.002, -0.006]])
    inside = set(SHIFTS)
    for k, node in enumerate(nodes):
        if k not in inside:
            place = np.array([float(c) for c in (node.position.x, node.position.y)])
            u = gradient @ place
            structure.support(node, ux=u[0], uy=u[1])
    result = da.solve_statics(structure.build())
    for k in inside:
        place = np.array([float(c) for c in (nodes[k].position.x, nodes[k].position.y)])
        computed = result[f"n{k}.ux"], result[f"n{k}.uy"]
        np.testing.assert_allclose(computed, gradient @ place, atol=1e-14)
    strain = (gradient + gradient.T) / 2
    second = E * NU / ((1 + NU) * (1 - 2 * NU)) if plane_strain else E * NU / (1 - NU**2)
    stress = second * np.trace(strain) * np.eye(2) + E / (1 + NU) * strain
    for name in structure.elements:
        computed = [result[f"{name}.{s}"] for s in ("sxx", "syy", "sxy")]
        np.testing.assert_allclose(computed, [stress[0, 0], stress[1, 1], stress[0, 1]], atol=1e-13)


@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
def test_uniform_pull_by_forces(kind):
    """Plane stress under forces on an edge: u = σ/E x, contraction ν."""
    structure, nodes = patch(kind, False)
    pull = 0.02 * T  # σ t
    for j in range(4):
        structure.support(nodes[4 * j], ux=0.0)
        share = (0.5 if j in (0, 3) else 1.0) / 3
        structure.load(nodes[4 * j + 3], fx=pull * share)
    structure.support(nodes[0], uy=0.0)
    result = da.solve_statics(structure.build())
    assert result["n15.ux"] == pytest.approx(0.02 / E, rel=1e-12)
    assert result["n15.uy"] == pytest.approx(-NU * 0.02 / E, rel=1e-12)
    assert result["strain_energy"] == pytest.approx(T * 0.02**2 / (2 * E), rel=1e-12)


@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
def test_rigid_rotation_costs_nothing(kind):
    structure, nodes = patch(kind, True)
    model, angle = structure.build(), 1.3
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    u = np.zeros(len(model.degrees))
    for k, node in enumerate(nodes):
        place = np.array([float(c) for c in (node.position.x, node.position.y)])
        u[[model.degrees[f"n{k}", d] for d in ("ux", "uy")]] = turn @ place - place
    np.testing.assert_allclose(model.assembly.internal_forces(u, model.nominal), 0, atol=1e-13)


def bending(kind: str, fine: int) -> float:
    """Tip of a cantilever L = 4, H = 1, parabolic shear, relative to Timoshenko and Goodier."""
    structure, nx, ny = da.Structure("short beam"), 4 * fine, fine
    node = {
        (i, j): structure.node(f"n{i}_{j}", 4 * i / nx, j / ny - 0.5)
        for i in range(nx + 1)
        for j in range(ny + 1)
    }
    arguments = {"thickness": 1.0, "modulus": 1.0, "poisson": NU}
    for i in range(nx):
        for j in range(ny):
            corners = (node[i, j], node[i + 1, j], node[i + 1, j + 1], node[i, j + 1])
            if kind == "quadrilateral":
                structure.add(structures.Quadrilateral(f"q{i}_{j}", corners, **arguments))
            else:
                structure.add(structures.Triangle(f"a{i}_{j}", corners[:3], **arguments))
                structure.add(
                    structures.Triangle(f"b{i}_{j}", (corners[0], *corners[2:]), **arguments)
                )
    second, force, length = 1 / 12, 1.0, 4.0
    for j in range(ny + 1):  # the exact displacements of the clamped end
        y = j / ny - 0.5
        ux = -force * y / (6 * second) * (2 + NU) * (y**2 - 0.25)
        uy = force / (6 * second) * 3 * NU * y**2 * length
        structure.support(node[0, j], ux=ux, uy=uy)
    for j in range(ny):  # τ = P/(2I) (1/4 − y²), lumped consistently by two Gauss points
        for s, w in ((-1 / 3**0.5, 0.5), (1 / 3**0.5, 0.5)):
            y = (j + (1 + s) / 2) / ny - 0.5
            tau = force / (2 * second) * (0.25 - y**2) * w / ny
            structure.load(node[nx, j], fy=tau * (1 - s) / 2)
            structure.load(node[nx, j + 1], fy=tau * (1 + s) / 2)
    result = da.solve_statics(structure.build())
    tip = force / (6 * second) * ((4 + 5 * NU) * length / 4 + 2 * length**3)
    return abs(result[f"n{nx}_{ny // 2}.uy"] / tip - 1)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
def test_errors_fall_with_the_square_of_the_mesh(kind):
    errors = [bending(kind, fine) for fine in (4, 8, 16)]
    slopes = np.diff(np.log(errors)) / np.log(0.5)
    assert slopes[-1] == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 0.03


# benchmarks -------------------------------------------------------------------------------
def curved_ring(fine: int):
    """Quadrilaterals of 8 nodes between the ellipses of LE1, with natural coordinates."""
    points, cells = structures.rectangle_mesh((1, 1), (fine, fine))
    natural, cells = with_middles("quad8", points, cells)
    s, angle = natural[:, 0], np.pi / 2 * natural[:, 1]
    x = ((1 - s) * 2.0 + s * 3.25) * np.cos(angle)
    y = ((1 - s) * 1.0 + s * 2.75) * np.sin(angle)
    return np.column_stack([x, y]), cells, natural


def pressed_edges(points, cells) -> dict[int, np.ndarray]:
    """Consistent forces of a unit traction along the outward normal of edges of 3 nodes."""
    results: dict[int, np.ndarray] = {}
    for edge in cells:
        for s, w in zip(*np.polynomial.legendre.leggauss(3), strict=True):
            shapes = np.array([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s])
            tangent = np.array([s - 0.5, s + 0.5, -2 * s]) @ points[edge]
            for node, value in zip(edge, shapes, strict=True):
                force = w * value * np.array([tangent[1], -tangent[0]])
                results[int(node)] = results.get(int(node), np.zeros(2)) + force
    return results


def test_elliptic_membrane():
    """NAFEMS LE1: 10 MPa outwards on the outer edge, σ_yy at D = 92.7 MPa."""
    points, cells, natural = curved_ring(16)
    structure, thick = da.Structure("LE1"), 0.1
    arguments = {"modulus": 210e9, "poisson": 0.3, "thickness": thick}
    nodes = structure.add_mesh("m", (points, {"quad8": cells}), **arguments).nodes()
    r, s = natural.T
    structure.support(nodes[np.flatnonzero(s > 1 - 1e-9)], ux=0.0)
    structure.support(nodes[np.flatnonzero(s < 1e-9)], uy=0.0)
    outer = cells[r[cells[:, 1]] > 1 - 1e-9][:, [1, 2, 5]]
    free = {k: f * 10e6 * thick for k, f in pressed_edges(points, outer).items()}
    for k, force in free.items():
        if s[k] < 1 - 1e-9:
            structure.load(nodes[k], fx=force[0])
        if s[k] > 1e-9:
            structure.load(nodes[k], fy=force[1])
    result = da.solve_statics(structure.build())
    corner = int(np.flatnonzero((r < 1e-9) & (s < 1e-9))[0])
    element, place = np.argwhere(cells == corner)[0]
    assert result[f"m[{element}].syy_n{place}"] == pytest.approx(92.7e6, rel=0.005)


@pytest.mark.parametrize(
    ("shape", "fine", "tolerance"),
    [("quad", 32, 0.01), ("quad8", 16, 0.002), ("triangle6", 16, 0.002)],
)
def test_cook_membrane(shape, fine, tolerance):
    """Tapered panel under a shear of 1 on its end: its middle rises by 23.96."""
    natural, cells = unit_mesh(shape, fine)
    points = np.column_stack(
        [48 * natural[:, 0], 44 * natural[:, 1] + natural[:, 0] * (44 - 28 * natural[:, 1])]
    )
    structure = da.Structure("Cook")
    arguments = {"modulus": 1.0, "poisson": 1 / 3, "thickness": 1.0}
    nodes = structure.add_mesh("m", (points, {shape: cells}), **arguments).nodes()
    structure.support(nodes[np.flatnonzero(natural[:, 0] < 1e-9)])
    end = np.flatnonzero(natural[:, 0] > 1 - 1e-9)
    end = end[np.argsort(natural[end, 1])]
    share = {"quad": [1 / 2, 1 / 2], "quad8": [1 / 6, 2 / 3, 1 / 6]}
    part = np.array(share["quad" if shape == "quad" else "quad8"])
    step = len(part) - 1
    force = np.zeros(len(end))
    for first in range(0, len(end) - 1, step):
        force[first : first + step + 1] += part * step / (len(end) - 1)
    structure.load(nodes[end], fy=force)
    result = da.solve_statics(structure.build())
    middle = end[len(end) // 2]
    assert result[f"m_nodes[{middle}].uy"] == pytest.approx(23.96, rel=tolerance)
