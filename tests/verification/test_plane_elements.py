"""Plane elements: patch tests with exact fields, and convergence to beam theory."""

from __future__ import annotations

import numpy as np
import pytest

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
    given = {"thickness": T, "modulus": E, "poisson": NU, "plane_strain": plane_strain}
    for i in range(3):
        for j in range(3):
            a, b = 4 * j + i, 4 * j + i + 1
            corners = (nodes[a], nodes[b], nodes[b + 4], nodes[a + 4])
            if kind == "quadrilateral":
                structure.add(structures.Quadrilateral(f"q{i}{j}", corners, **given))
                continue
            structure.add(structures.Triangle(f"a{i}{j}", corners[:3], **given))
            structure.add(structures.Triangle(f"b{i}{j}", (corners[0], *corners[2:]), **given))
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
        found = result[f"n{k}.ux"], result[f"n{k}.uy"]
        np.testing.assert_allclose(found, gradient @ place, atol=1e-14)
    strain = (gradient + gradient.T) / 2
    second = E * NU / ((1 + NU) * (1 - 2 * NU)) if plane_strain else E * NU / (1 - NU**2)
    stress = second * np.trace(strain) * np.eye(2) + E / (1 + NU) * strain
    for name in structure.elements:
        found = [result[f"{name}.{s}"] for s in ("sxx", "syy", "sxy")]
        np.testing.assert_allclose(found, [stress[0, 0], stress[1, 1], stress[0, 1]], atol=1e-13)


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
    given = {"thickness": 1.0, "modulus": 1.0, "poisson": NU}
    for i in range(nx):
        for j in range(ny):
            corners = (node[i, j], node[i + 1, j], node[i + 1, j + 1], node[i, j + 1])
            if kind == "quadrilateral":
                structure.add(structures.Quadrilateral(f"q{i}_{j}", corners, **given))
            else:
                structure.add(structures.Triangle(f"a{i}_{j}", corners[:3], **given))
                structure.add(structures.Triangle(f"b{i}_{j}", (corners[0], *corners[2:]), **given))
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


@pytest.mark.parametrize("kind", ["triangle", "quadrilateral"])
def test_errors_fall_with_the_square_of_the_mesh(kind):
    errors = [bending(kind, fine) for fine in (4, 8, 16)]
    slopes = np.diff(np.log(errors)) / np.log(0.5)
    assert slopes[-1] == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 0.03
