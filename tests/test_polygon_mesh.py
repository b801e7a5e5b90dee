"""Meshes of drawn regions: they fill them, conform to their edges, and move with their formulas."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from structure_file import written

import dalembert as da
from dalembert import structures

SQUARE = [(0, 0), (2, 0), (2, 1), (0, 1)]
REGIONS = {
    "square": (SQUARE, 0.3, []),
    "clockwise": (SQUARE[::-1], 0.25, []),
    "circle": (SQUARE, 0.2, [((1, 0.5), 0.2)]),
    "small circle": (SQUARE, 0.3, [((1, 0.5), 0.03)]),
    "two holes": (SQUARE, 0.2, [((0.5, 0.5), 0.2), [(1.2, 0.4), (1.6, 0.4), (1.4, 0.7)]]),
    "L": ([(0, 0), (1, 0), (1, 0.3), (0.3, 0.3), (0.3, 1), (0, 1)], 0.08, []),
    "acute": ([(0, 0), (2, 0), (2, 0.25), (0.3, 0.05)], 0.1, []),
}


def cross(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]


def area_of(corners: np.ndarray) -> float:
    return abs(float(cross(corners, np.roll(corners, -1, axis=0)).sum())) / 2


@pytest.mark.parametrize("name", REGIONS)
def test_a_mesh_fills_its_region(name: str) -> None:
    outline, size, holes = REGIONS[name]
    mesh = structures.polygon_mesh(outline, size, holes, "triangle")
    cells, points = mesh.cells["triangle"], mesh.points
    a, b, c = (points[cells[:, k]] for k in range(3))
    areas = cross(b - a, c - a) / 2
    assert areas.min() > 0
    expected = area_of(np.array(outline, dtype=float))
    for k, hole in enumerate(holes):
        if len(hole) == 2:  # a circle is a polygon of the nodes on it
            around = points[mesh.point_groups[f"hole{k + 1}"]] - hole[0]
            np.testing.assert_allclose(np.linalg.norm(around, axis=1), hole[1], rtol=1e-12)
            angles = np.arctan2(around[:, 1], around[:, 0])
            expected -= area_of(around[np.argsort(angles)])
        else:
            expected -= area_of(np.array(hole, dtype=float))
    assert areas.sum() == pytest.approx(expected, rel=1e-12)
    edges = np.sort(np.vstack([cells[:, [i, j]] for i, j in ((0, 1), (1, 2), (2, 0))]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    assert set(count.tolist()) == {1, 2}
    lengths = np.linalg.norm(points[unique[:, 0]] - points[unique[:, 1]], axis=1)
    assert lengths.max() < 1.5 * size
    on_boundary = set(itertools.chain(*(group.tolist() for group in mesh.point_groups.values())))
    assert on_boundary == set(unique[count == 1].ravel().tolist())


@pytest.mark.parametrize("name", [name for name in REGIONS if name != "acute"])
def test_angles_are_not_flat(name: str) -> None:
    outline, size, holes = REGIONS[name]
    mesh = structures.polygon_mesh(outline, size, holes, "triangle")
    corners = mesh.points[mesh.cells["triangle"]]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    angles = np.arctan2(cross(ahead, back), (ahead * back).sum(axis=2))
    assert np.degrees(angles.min()) > 20


@pytest.mark.parametrize("kind", ["triangle", "triangle6"])
def test_groups_are_the_edges(kind: str) -> None:
    mesh = structures.polygon_mesh(SQUARE, 0.2, [((1, 0.5), 0.2)], kind)
    for edge, axis, value in ((1, 1, 0), (2, 0, 2), (3, 1, 1), (4, 0, 0)):
        numbers = mesh.point_groups[f"edge{edge}"]
        on_edge = np.flatnonzero(np.abs(mesh.points[:, axis] - value) < 1e-12)
        np.testing.assert_array_equal(np.sort(numbers), on_edge)
    away = np.linalg.norm(mesh.points[mesh.point_groups["hole1"]] - (1, 0.5), axis=1)
    np.testing.assert_allclose(away, 0.2, rtol=1e-12)  # middles of edges too


@pytest.mark.few(3)
@pytest.mark.parametrize("kind", ["triangle", "triangle6"])
@pytest.mark.parametrize("name", ["two holes", "L", "acute"])
def test_patch(name: str, kind: str) -> None:
    """A linear field on the boundary gives the same field inside, with its constant stress."""
    outline, size, holes = REGIONS[name]
    plate = da.Structure("patch")
    mesh = plate.add_mesh(
        "plate",
        structures.polygon_mesh(outline, size, holes, kind),
        thickness=0.01,
        modulus=70e9,
        poisson=0.3,
    )
    gradient = np.array([[2e-4, 1e-4], [-3e-4, 5e-4]])
    for group in mesh.selections:
        nodes = mesh.nodes(group)
        for k, place in enumerate(nodes.positions):
            ux, uy = gradient @ place
            plate.support(nodes[k], ux=ux, uy=uy)
    result = da.solve_statics(plate.build())
    for node, place in zip(mesh.nodes().names, mesh.nodes().positions, strict=True):
        moved = [float(result[f"{node}.{d}"]) for d in ("ux", "uy")]
        np.testing.assert_allclose(moved, gradient @ place, atol=1e-14)
    factor = 70e9 / (1 - 0.3**2)
    expected = factor * (gradient[0, 0] + 0.3 * gradient[1, 1])
    assert float(result["plate.sxx.max"]) == pytest.approx(expected, rel=1e-3)  # Green's strain
    assert float(result["plate.sxx.max"]) == pytest.approx(float(result["plate.sxx.min"]), rel=1e-9)


FILE = """
format = 1
kind = "structure"
name = "plate with a hole"

[parameters]
r = { value = 0.2, unit = "m", bounds = [0.05, 0.4] }
l = { value = 2.0, unit = "m", bounds = [1.5, 3.0] }

[meshes.plate]
type = "Triangle6"
thickness = 0.01
modulus = 70e9
density = 2700

[meshes.plate.polygon]
vertices = [[0, 0], ["l", 0], ["l", 1], [0, 1]]
size = 0.1
holes = [{ center = ["l/2", 0.5], radius = "r" }, [[0.2, 0.2], ["l/8", 0.2], [0.2, 0.3]]]

[[supports]]
nodes = "plate.edge4"

[[tractions]]
elements = "plate"
nodes = "plate.edge2"
tx = 1e6
"""


@pytest.mark.thorough
def test_formulas_move_the_boundary(tmp_path: Path) -> None:
    """Other values move the nodes of the boundary to it, and the derivative is that of the area."""
    model = da.load_model(written(tmp_path, FILE)).build()
    new = {"r": 0.25, "l": 2.4}
    result = da.solve_statics(model, parameters=new)
    assert result.status.success
    count = 13  # arcs of the circle, as parabolas through three nodes: Simpson's rule
    half = np.pi / count
    circle = count * 0.25**2 * np.sin(half) * (np.cos(half) + 4 / 3 * (1 - np.cos(half)))
    area = 2.4 - circle - 0.5 * (2.4 / 8 - 0.2) * 0.1
    assert float(result["mass"]) == pytest.approx(27 * area, rel=1e-9)
    slopes = da.sensitivity(da.solve_statics(model), da.final("mass"))
    exact = {"r": -27 * 2 * np.pi * 0.2, "l": 27 * (1 - 0.05 / 8)}
    for name, slope in exact.items():
        assert float(slopes.sel(parameter=name).squeeze()) == pytest.approx(slope, rel=2e-4)


def test_shape_gradients_are_those_of_differences(tmp_path: Path) -> None:
    model = da.load_model(written(tmp_path, FILE)).build()
    compliance = da.final("strain_energy")
    slopes = da.sensitivity(da.solve_statics(model), compliance)
    for name, value, step in (("r", 0.2, 1e-4), ("l", 2.0, 1e-3)):
        ends = [
            float(da.solve_statics(model, parameters={name: value + s})["strain_energy"])
            for s in (-step, step)
        ]
        difference = (ends[1] - ends[0]) / (2 * step)
        assert float(slopes.sel(parameter=name).squeeze()) == pytest.approx(difference, rel=1e-5)


@pytest.mark.thorough
def test_a_plate_in_tension(tmp_path: Path) -> None:
    """Kirsch: a small hole in a wide plate triples the stress beside it."""
    text = FILE.replace("size = 0.1", "size = 0.05").replace("value = 0.2", "value = 0.05")
    text = text.replace(', [[0.2, 0.2], ["l/8", 0.2], [0.2, 0.3]]', "")
    text = text.replace("density = 2700", "density = 2700\npoisson = 0.3")
    text = text.replace('nodes = "plate.edge4"', 'nodes = "plate.edge4"\nux = 0')
    text += '\n[[supports]]\nnodes = "plate"\nnearest = [0, 0]\nuy = 0\n'
    text = text.replace('"l", ', "2, ").replace('"l/2"', "1").replace('"r"', "0.05")
    model = da.load_model(written(tmp_path, text)).build()
    result = da.solve_statics(model)
    count = sum(block.count for block in model.blocks)
    most = max(float(result[f"plate[{k}].sxx_n{n}"]) for k in range(count) for n in range(3))
    assert most == pytest.approx(3e6, rel=0.05)


@pytest.mark.thorough
def test_a_file_as_python_makes_the_same_mesh(tmp_path: Path) -> None:
    from dalembert.io import load_model_file
    from dalembert.io.exports.export import export

    path = written(tmp_path, FILE)
    export(load_model_file(path), tmp_path / "script.py")
    namespace: dict = {"__name__": "script", "__file__": str(tmp_path / "model.py")}
    script = tmp_path / "script.py"
    exec(compile(script.read_text(), str(script), "exec"), namespace)
    one, two = (
        da.solve_statics(m) for m in (namespace["build"]().build(), da.load_model(path).build())
    )
    np.testing.assert_allclose(one.displacements, two.displacements, rtol=1e-12)


WRONG = {
    "two vertices": ([(0, 0), (1, 0)], 0.1, [], "an area needs three"),
    "crossing": ([(0, 0), (1, 1), (1, 0), (0, 1)], 0.1, [], "edges cross or touch"),
    "a spike": ([(0, 0), (1, 0), (0.5, 0), (0.5, 1)], 0.1, [], "edges cross or touch"),
    "a line": ([(0, 0), (1, 0), (2, 0)], 0.1, [], "edges cross or touch"),
    "twice": ([(0, 0), (1, 0), (1, 0), (0, 1)], 0.1, [], "same place"),
    "hole outside": (SQUARE, 0.1, [((3, 0.5), 0.1)], "not within the outline"),
    "hole on the edge": (SQUARE, 0.1, [((1, 0.5), 0.5)], "touches the outline"),
    "hole in a hole": (SQUARE, 0.1, [((1, 0.5), 0.3), ((1, 0.5), 0.1)], "touches holes"),
    "no radius": (SQUARE, 0.1, [((1, 0.5), 0)], "positive length"),
    "no size": (SQUARE, 0, [], "positive length"),
    "too small": (SQUARE, 1e-6, [], "raise the size"),
    "three coordinates": ([(0, 0, 0), (1, 0, 0), (0, 1, 0)], 0.1, [], "two coordinates"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_regions_are_refused(name: str) -> None:
    outline, size, holes, text = WRONG[name]
    with pytest.raises(da.DalembertError, match=text):
        structures.polygon_mesh(outline, size, holes)


def test_formulas_need_their_parameters() -> None:
    system = da.Structure("plate")
    width = system.parameter("width", 2.0, unit="m")
    corners = [(0, 0), (width, 0), (width, 1), (0, 1)]
    with pytest.raises(da.ModelError, match="give parameters="):
        structures.polygon_mesh(corners, 0.5)
    mesh = structures.polygon_mesh(corners, 0.5, parameters=system.parameters)
    assert mesh.points.shape[1] == 2


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ('["l/2", 0.5]', "[5.0, 0.5]", r"holes\[0\]: is not within the outline"),
        ('[[0, 0], ["l", 0]', '[[0, 0], [0, 0], ["l", 0]', r"vertices\[1\]: is at the same place"),
        ('"r" }', "0.5 }", r"holes\[0\]: crosses or touches the outline"),
        ("size = 0.1", "size = 0", "size: .*positive length"),
    ],
)
def test_errors_of_files_name_the_corner_or_the_hole(
    old: str, new: str, place: str, tmp_path: Path
) -> None:
    path = written(tmp_path, FILE.replace(old, new))
    with pytest.raises(da.ModelError, match=rf"meshes\.plate\.polygon\.{place}"):
        da.load_model(path)
