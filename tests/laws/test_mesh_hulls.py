"""Concave meshes as several hulls: an arch on two legs, and the error without the library."""

import sys
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial
from dalembert.elements.spatial.contact.polyhedron import ConvexHull
from dalembert.errors import ModelError, UnsupportedError

G = 9.81
contact = spatial.contact
LEGS = [((0.1, 0.2, 0.2), (-0.15, 0, 0.1)), ((0.1, 0.2, 0.2), (0.15, 0, 0.1))]
PARTS = [*LEGS, ((0.4, 0.2, 0.1), (0, 0, 0.25))]
"""Sizes and middles of the boxes of an arch."""


@pytest.fixture(scope="module")
def arch_file(tmp_path_factory):
    """The arch as one closed surface: a profile in the x-z plane, along y."""
    trimesh = pytest.importorskip("trimesh")
    outline = [(-2, 0), (-1, 0), (-1, 2), (1, 2), (1, 0), (2, 0), (2, 3), (-2, 3)]
    corners = [(0.1 * x, y, 0.1 * z) for y in (-0.1, 0.1) for x, z in outline]
    n = len(outline)
    front = [(0, 1, 2), (0, 2, 7), (2, 6, 7), (2, 3, 6), (3, 5, 6), (3, 4, 5)]
    back = [(n + c, n + b, n + a) for a, b, c in front]
    sides = [
        triangle
        for k in range(n)
        for triangle in ((k, n + k, n + (k + 1) % n), (k, n + (k + 1) % n, (k + 1) % n))
    ]
    faces = [*front, *back, *((a, b, c) for a, b, c in sides)]
    mesh = trimesh.Trimesh(corners, faces)
    mesh.fix_normals()
    path = tmp_path_factory.mktemp("arch") / "arch.stl"
    mesh.export(path)
    return path


def boxes(*_, **__) -> list[tuple[np.ndarray, np.ndarray]]:
    """The exact parts of the arch, as a decomposition returns them."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    return [(signs * size + middle, np.zeros((0, 3), dtype=int)) for size, middle in PARTS]


def passage(arch: spatial.Mesh, shapes: list) -> da.Motion:
    """A ball rolls through the arch, which stands on the floor."""
    system = da.System("passage", gravity=(0.0, 0.0, -G))
    system.add(arch)
    ball = spatial.Sphere(
        "ball", radius=0.08, mass=1.0, position=(0, -0.4, 0.08), velocity=(0, 2, 0)
    )
    system.add(ball)
    others = [contact.Sphere(ball.center, 0.08), contact.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("touch", [*shapes, *others]))
    return da.solve_nonsmooth(system.build(), 0.4, step=4e-3)


def test_a_ball_passes_an_arch(arch_file, monkeypatch):
    """The convex hull of the arch would stop it."""
    fake = SimpleNamespace(run_coacd=boxes, Mesh=lambda *_: None, set_log_level=lambda _: None)
    monkeypatch.setitem(sys.modules, "coacd", fake)
    arch = spatial.Mesh("arch", file=arch_file, density=100.0, position=(0, 0, 0))
    motion = passage(arch, [contact.MeshHulls(arch)])
    assert motion.status.success
    assert motion["ball.y"][-1] == pytest.approx(0.4, abs=1e-9)
    assert abs(motion["arch.z"]).max() < 1e-9


def test_hulls_of_a_library_fill_the_mesh(arch_file):
    pytest.importorskip("coacd")
    arch = spatial.Mesh("arch", file=arch_file, density=100.0, position=(0, 0, 0))
    shape = contact.MeshHulls(arch, concavity=0.05)
    assert len(shape.solids()) >= 2
    motion = passage(arch, [shape])
    assert motion.status.success
    assert motion["ball.y"][-1] == pytest.approx(0.4, abs=1e-6)


@pytest.mark.parametrize("ending", ["stl", "obj", "ply"])
@pytest.mark.parametrize("finer", [0, 1])
def test_a_convex_mesh_is_convex_in_single_precision(tmp_path, monkeypatch, ending, finer):
    """Corners of a turned box are rounded in a file, so that its faces are not quite plane."""
    trimesh = pytest.importorskip("trimesh")
    monkeypatch.setitem(sys.modules, "coacd", None)
    mesh = trimesh.creation.box((0.6, 0.5, 0.2))
    for _ in range(finer):
        mesh = mesh.subdivide()
    mesh.apply_transform(trimesh.transformations.rotation_matrix(0.7, (0.3, -0.4, 0.5)))
    mesh.apply_translation((1.3, 0.2, -0.5))
    mesh.export(tmp_path / f"box.{ending}")
    body = spatial.Mesh("m", file=tmp_path / f"box.{ending}", density=1.0)
    (solid,) = contact.MeshHulls(body).solids()
    assert len(solid.hull.corners) <= len(mesh.vertices)


def test_without_the_library(arch_file, monkeypatch):
    monkeypatch.setitem(sys.modules, "coacd", None)
    arch = spatial.Mesh("arch", file=arch_file, density=100.0, position=(0, 0, 0))
    with pytest.raises(UnsupportedError, match=r"pip install 'dalembert\[mesh\]', or give several"):
        contact.MeshHulls(arch)


@pytest.mark.parametrize(
    ("options", "message"), [({"concavity": 0.0}, "from 0.01"), ({"most": 0}, "most")]
)
def test_bad_options(arch_file, options, message):
    arch = spatial.Mesh("arch", file=arch_file, density=100.0, position=(0, 0, 0))
    with pytest.raises(ModelError, match=message):
        contact.MeshHulls(arch, **options)


def test_a_hull_with_too_many_corners_names_its_body(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / "ball.stl")
    body = spatial.Mesh("wheel", file=tmp_path / "ball.stl", density=1.0)
    with pytest.raises(ModelError, match=r"hull of wheel has 162 corners and 40 .* use MeshHulls"):
        contact.Corners(body).hull()
    with pytest.raises(
        ModelError, match=r"of wheel: its 162 corners are convex, and .* up to 0\.057"
    ):
        contact.MeshHulls(body, concavity=0.02)
    assert len(contact.MeshHulls(body, concavity=0.1).forms[0].corners) == 40


@pytest.mark.parametrize("concavity", [0.02, 0.05])
def test_convex_meshes_with_many_corners_are_reduced(tmp_path, concavity):
    """A drum of 60 sides: its reduced hull is inside, by less than the concavity, and stands."""
    trimesh = pytest.importorskip("trimesh")
    drum = trimesh.creation.cylinder(0.1, 0.2, sections=60)
    drum.export(tmp_path / "drum.stl")
    mesh = spatial.Mesh("drum", file=tmp_path / "drum.stl", mass=2.0, position=(0, 0, 0.12))
    shape = contact.MeshHulls(mesh, concavity=concavity)
    (form,) = shape.forms
    directions = np.random.default_rng(1).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    inside = (drum.vertices @ directions.T).max(axis=0) - (form.corners @ directions.T).max(axis=0)
    assert len(form.corners) <= 40
    assert inside.min() > -1e-8 and inside.max() < concavity * 0.2  # single precision
    system = da.System("stand", gravity=(0, 0, -G))
    system.add(mesh)
    shapes = [shape, contact.HalfSpace(system.ground.frame())]
    system.add(spatial.Collisions("floor", shapes, friction=0.5))
    motion = da.solve_nonsmooth(system.build(), 0.3, step=2e-3)
    assert motion["drum.z"][-1].item() == pytest.approx(0.1, abs=1e-6)


def test_faces_of_single_precision_are_flat():
    """A turned box of a binary file has six faces, not twelve triangles."""
    signs = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    turned = Rotation.from_rotvec([0.2, 0.4, 0.5])
    corners = turned.apply(signs * (0.1, 0.2, 0.35)) + np.array([0.3, -0.1, 0.2])
    hull = ConvexHull.of(corners.astype(np.float32).astype(float), "box")
    assert sorted(map(len, hull.faces)) == [4] * 6 and len(hull.edges) == 12
