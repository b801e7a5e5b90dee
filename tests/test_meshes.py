"""Meshes: from files, meshio and arrays to nodes and elements, with their groups."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert import structures
from dalembert.elements.fem.cells import CELLS, oriented
from dalembert.elements.fem.registry import ELEMENTS, SHAPES, cell_of

STEEL = {"thickness": 0.01, "modulus": 210e9}


def plate(kind: str = "quad", counts: tuple[int, int] = (4, 2)):
    structure = da.Structure("plate")
    data = structures.rectangle_mesh((2.0, 1.0), counts, kind)
    return structure, structure.add_mesh("plate", data, **STEEL)


def pulled(structure: da.Structure, mesh) -> da.results.structural.StructuralResult:
    """The right end pulled by 1 kN, spread as linear edges do."""
    right = mesh.nodes().where(x=2.0)
    order = np.argsort(right.positions[:, 1])
    share = np.full(len(right), 1000.0 / (len(right) - 1))
    share[order[[0, -1]]] /= 2
    if next(iter(mesh.elements.values())).cls.node_count in (6, 8):  # Simpson's rule on each edge
        share[order[::2]] *= 2 / 3
        share[order[1::2]] *= 4 / 3
    structure.support(mesh.nodes().where(x=0), ux=0)
    structure.support(mesh.nodes().nearest(0, 0), uy=0)
    structure.load(right, fx=share)
    return da.solve_statics(structure.build())


@pytest.mark.parametrize("kind", ["quad", "triangle", "quad8", "triangle6"])
def test_uniform_tension_is_exact(kind: str) -> None:
    structure, mesh = plate(kind)
    result = pulled(structure, mesh)
    model = result.model
    assert result["plate.sxx.min"] == pytest.approx(1e5, rel=1e-9)
    assert result["plate.sxx.max"] == pytest.approx(1e5, rel=1e-9)
    corner = mesh.nodes().nearest(2, 1).names[0]
    assert result[f"{corner}.ux"] == pytest.approx(1e5 / 210e9 * 2, rel=1e-9)
    assert len(model.blocks) == 1


@pytest.mark.parametrize(
    ("mesh", "points", "cells", "measure"),
    [
        (structures.line_mesh((0, 0), (3, 4), 5), 6, 5, 5.0),
        (structures.rectangle_mesh((2, 3), (4, 5)), 30, 20, 6.0),
        (structures.rectangle_mesh((2, 3), (4, 5), "triangle"), 30, 40, 6.0),
        (structures.box_mesh((1, 2, 3), (2, 3, 4)), 60, 24, 6.0),
    ],
)
def test_generators_fill_their_shape(mesh, points: int, cells: int, measure: float) -> None:
    assert len(mesh[0]) == points
    assert len(mesh[1]) == cells
    corner = mesh[0][mesh[1]]
    if corner.shape[1] == 2:
        sizes = np.linalg.norm(corner[:, 1] - corner[:, 0], axis=1)
    elif corner.shape[1] == 8:
        sides = [corner[:, k] - corner[:, 0] for k in (1, 3, 4)]
        sizes = np.einsum("ij,ij->i", np.cross(sides[0], sides[1]), sides[2])
    else:
        x, y = corner[..., 0], corner[..., 1]
        sizes = 0.5 * (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(axis=1)
    assert (sizes > 0).all()
    assert sizes.sum() == pytest.approx(measure, rel=1e-12)


@pytest.mark.parametrize("kind", ["quad8", "triangle6", "hexahedron20"])
def test_middles_lie_in_the_middle(kind: str) -> None:
    generator = structures.box_mesh if kind == "hexahedron20" else structures.rectangle_mesh
    points, cells = generator(
        (1, 2, 3)[: CELLS[kind].dimension], (2, 3, 4)[: CELLS[kind].dimension], kind
    )
    assert len(np.unique(points.round(9), axis=0)) == len(points)
    for face in CELLS[kind].faces:
        places = points[cells[:, face]]
        assert places[:, 1::2] == pytest.approx(
            (places[:, ::2] + np.roll(places[:, ::2], -1, 1)) / 2
        )


@pytest.mark.parametrize("name", [n for n, c in CELLS.items() if c.turned])
def test_turning_twice_changes_nothing(name: str) -> None:
    turned = np.array(CELLS[name].turned)
    assert sorted(turned) == list(range(CELLS[name].nodes))
    assert (turned[turned] == np.arange(turned.size)).all()


@pytest.mark.parametrize("name", [n for n, c in CELLS.items() if c.dimension == 3])
def test_faces_close_a_solid(name: str) -> None:
    """Every edge belongs to two faces, which run along it in opposite ways."""
    faces = CELLS[name].faces
    edges = [(i, j) for f in faces for i, j in zip(f, (*f[1:], f[0]), strict=True)]
    assert len(set(edges)) == len(edges)
    assert {(j, i) for i, j in edges} == set(edges)
    assert set(np.concatenate(faces)) == set(range(CELLS[name].nodes))


@pytest.mark.parametrize("name", ["triangle", "quad", "tetra", "hexahedron"])
def test_cells_counted_the_wrong_way_are_turned(name: str) -> None:
    corners = {
        "triangle": [[0, 0], [1, 0], [0, 1]],
        "quad": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "tetra": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "hexahedron": structures.box_mesh((1, 1, 1), (1, 1, 1))[0][[0, 1, 3, 2, 4, 5, 7, 6]],
    }
    points, right = np.asarray(corners[name], dtype=float), np.arange(CELLS[name].nodes)[None]
    wrong = right[:, CELLS[name].turned]
    assert (oriented(name, points, np.concatenate([right, wrong])) == right).all()


@pytest.mark.parametrize("cls", list(ELEMENTS.values()))
def test_elements_fit_their_cells(cls) -> None:
    assert CELLS[cell_of(cls)].nodes == cls.node_count
    assert set(SHAPES) <= set(ELEMENTS.values())


# meshio ------------------------------------------------------------------------------------
def gmsh_like():
    """Two materials side by side, an edge, a spare point: as a mesh generator writes them."""
    meshio = pytest.importorskip("meshio")
    points, quads = structures.rectangle_mesh((2.0, 1.0), (4, 2))
    points = np.column_stack([points, np.zeros(len(points))])
    points = np.vstack([points, [[9.0, 9.0, 0.0]]])
    left = np.flatnonzero(points[:, 0] == 0)
    edge = np.column_stack([left[:-1], left[1:]])
    soft = points[quads].mean(axis=1)[:, 0] < 1.0
    none = np.array([], dtype=int)
    return meshio.Mesh(
        points,
        [("line", edge), ("quad", quads[:, ::-1])],
        point_sets={"corner": np.array([0])},
        cell_sets={
            "left": [np.arange(len(edge)), none],
            "soft": [none, np.flatnonzero(soft)],
            "hard": [none, np.flatnonzero(~soft)],
            "gmsh:bounding_entities": [none, none],
        },
    )


def test_groups_become_selections() -> None:
    structure = da.Structure("two")
    mesh = structure.add_mesh(
        "plate", gmsh_like(), thickness=0.01, modulus={"soft": 1e9, "hard": 2e9}
    )
    assert mesh.nodes().dimension == 2
    assert len(mesh.nodes()) == 15  # without the spare point
    assert set(mesh.selections) == {"left", "corner", "soft", "hard"}
    assert (mesh.nodes("left").positions[:, 0] == 0).all()
    assert len(mesh.nodes("left")) == 3
    assert mesh.nodes("corner").positions.tolist() == [[0.0, 0.0]]
    assert list(mesh.elements) == ["plate"]
    assert (mesh.elements["plate"].centres[mesh.members("hard")["plate"]][:, 0] > 1).all()
    result = pulled(structure, mesh)
    ends = {x: mesh.nodes().nearest(x, 0).names[0] for x in (1, 2)}
    first, both = (result[f"{ends[x]}.ux"] for x in (1, 2))
    assert 1.8 < first / (both - first) < 2.2  # twice the modulus, half the stretch


@pytest.mark.parametrize("suffix", [".vtu", ".msh", ".xdmf", ".inp"])
def test_any_format_of_meshio(suffix: str, tmp_path: Path) -> None:
    meshio = pytest.importorskip("meshio")
    points, cells = structures.rectangle_mesh((2.0, 1.0), (4, 2), "triangle")
    path = tmp_path / f"plate{suffix}"
    flat = np.column_stack([points, np.zeros(len(points))])
    meshio.write(path, meshio.Mesh(flat, [("triangle", cells)]))
    structure = da.Structure("read")
    mesh = structure.add_mesh("plate", path, **STEEL)
    assert mesh.nodes().positions == pytest.approx(points)
    assert pulled(structure, mesh)["plate.sxx.max"] == pytest.approx(1e5, rel=1e-9)


def test_physical_groups_of_gmsh(tmp_path: Path) -> None:
    pytest.importorskip("meshio")
    path = tmp_path / "square.msh"
    path.write_text(GMSH)
    mesh = da.Structure("gmsh").add_mesh("square", path, **STEEL)
    assert set(mesh.selections) == {"wall", "all"}
    assert (mesh.nodes("wall").positions[:, 0] == 0).all()
    assert mesh.members("all")["square"].tolist() == [0, 1]


GMSH = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 1 "wall"
2 2 "all"
$EndPhysicalNames
$Nodes
4
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
3
1 1 2 1 1 4 1
2 2 2 2 1 1 2 3
3 2 2 2 1 1 3 4
$EndElements
"""


def test_mixed_cells_make_two_sets() -> None:
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0.5]]
    cells = {"quad": [[0, 1, 2, 3]], "triangle": [[1, 4, 2]], "line": [[0, 1]]}
    structure = da.Structure("mixed")
    mesh = structure.add_mesh("m", (points, cells), **STEEL)
    assert list(mesh.elements) == ["m_quad", "m_triangle"]
    structure.support(mesh.nodes())
    assert da.solve_statics(structure.build())["m_triangle[0].sxx"] == 0


def test_lines_become_what_is_asked_for() -> None:
    structure = da.Structure("bars")
    mesh = structure.add_mesh(
        "bar", structures.line_mesh((0, 0), (2, 0), 4), structures.Truss, area=1e-4, modulus=1e9
    )
    structure.support(mesh.nodes(), uy=0)
    structure.support(mesh.nodes().where(x=0), ux=0)
    structure.load(mesh.nodes().where(x=2), fx=100)
    assert da.solve_statics(structure.build())["bar_nodes[4].ux"] == pytest.approx(2e-3)


SQUARE = structures.rectangle_mesh((1, 1), (1, 1))


@pytest.mark.parametrize(
    ("mesh", "options", "words"),
    [
        (structures.line_mesh((0, 0), (1, 0), 2), {}, "give element ="),
        (SQUARE, {"element": structures.Triangle}, "4.*element"),
        (SQUARE, {"element": {"tetra": structures.Triangle}}, "has no cells 'tetra'"),
        (SQUARE, {"thickness": {"web": 1.0}}, "no group of elements 'web'"),
        (SQUARE, {"wrong": 1.0, **STEEL}, "has no wrong"),
        (([[0, 0]], [[0, 1, 2, 3]]), STEEL, "count points up to 3, there are 1"),
        (([[0, 0]], {"octagon": [[0]]}), STEEL, "'octagon' are not known"),
        (([[0, 0]], [[0] * 7]), STEEL, "are no cells in 2 dimension"),
        (([[[0]]], [[0, 1]]), STEEL, "points must be an array"),
        (7, STEEL, "a mesh is a meshio.Mesh"),
    ],
)
def test_slips_are_told(mesh, options, words: str) -> None:
    structure = da.Structure("wrong")
    with pytest.raises(da.ModelError, match=words):
        structure.add_mesh("m", mesh, **options)
    assert not structure.nodes and not structure.elements


def test_unknown_groups_are_told() -> None:
    _, mesh = plate()
    with pytest.raises(da.ModelError, match="has no group 'left'; known: none"):
        mesh.nodes("left")


def test_files_that_are_no_meshes(tmp_path: Path, monkeypatch) -> None:
    pytest.importorskip("meshio")
    structure = da.Structure("wrong")
    with pytest.raises(da.FileError, match="no such file"):
        structure.add_mesh("m", tmp_path / "none.msh")
    for name in ("text.msh", "text.what"):
        (tmp_path / name).write_text("no mesh")
        with pytest.raises(da.FileError, match=name):
            structure.add_mesh("m", tmp_path / name)
    monkeypatch.setitem(sys.modules, "meshio", None)
    with pytest.raises(da.UnsupportedError, match=r"pip install 'dalembert\[mesh\]'"):
        structure.add_mesh("m", tmp_path / "text.msh")


@pytest.mark.parametrize("counts", [(0, 1), (1.5, 1), (1,)])
def test_generators_refuse_what_is_no_mesh(counts) -> None:
    with pytest.raises(da.ModelError, match="unknown kind 'hexagon'"):
        structures.rectangle_mesh((1, 1), (1, 1), "hexagon")
    with pytest.raises(da.ModelError, match="unknown kind 'tetra'"):
        structures.box_mesh((1, 1, 1), (1, 1, 1), "tetra")
    with pytest.raises(da.ModelError, match="whole number"):
        structures.rectangle_mesh((1, 1), counts)
    with pytest.raises(da.ModelError, match="positive lengths"):
        structures.box_mesh((1, 0, 1), (1, 1, 1))
