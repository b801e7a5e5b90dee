"""Geometry of bodies in pictures: true sizes, coarser meshes, refused sizes."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import spatial
from dalembert.elements.spatial.look import Surface

SOLIDS = {
    "Box": {"size": (0.2, 0.4, 0.6)},
    "Ellipsoid": {"size": (0.2, 0.4, 0.6)},
    "Sphere": {"radius": 0.3},
    "Cylinder": {"radius": 0.1, "length": 0.5},
    "Capsule": {"radius": 0.1, "length": 0.5},
}


@pytest.mark.parametrize("kind", SOLIDS)
def test_solids_are_drawn(kind):
    system = da.System("solid", gravity=(0, 0, -9.81))
    solid = spatial.Geometry(kind, at=(0.1, 0, 0), axis=(1, 0, 0), x=(0, 0, 1), **SOLIDS[kind])
    body = system.add(spatial.Body("body", mass=1.0, inertia=(1, 1, 1), geometry=[solid]))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    (look,) = body.look()
    if isinstance(look, Surface):
        extent = np.ptp(look.corners, axis=0)
        np.testing.assert_allclose(extent, (0.6, 0.4, 0.2), rtol=0.05)
        np.testing.assert_allclose(look.corners.mean(axis=0), (0.1, 0, 0), atol=0.02)
    assert motion.model.bodies


def test_fine_meshes_become_coarser(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.icosphere(subdivisions=5, radius=2.0).export(tmp_path / "ball.stl")
    mesh = spatial.Geometry("Mesh", file=tmp_path / "ball.stl", scale=(0.1, 0.1, -0.1))
    body = spatial.Body("ball", mass=1.0, inertia=(1, 1, 1), geometry=[mesh])
    (look,) = body.look()
    assert len(look.triangles) < 6000
    np.testing.assert_allclose(np.ptp(look.corners, axis=0), 0.4, rtol=0.15)


def test_unreadable_meshes_are_not_drawn(tmp_path):
    (tmp_path / "bad.stl").write_text("nothing", encoding="utf-8")
    mesh = spatial.Geometry("Mesh", file=tmp_path / "bad.stl")
    with pytest.warns(UserWarning, match="not drawn"):
        assert spatial.Body("b", mass=1.0, inertia=(1, 1, 1), geometry=[mesh]).look() == []


@pytest.mark.parametrize(
    "keys",
    [
        {"type": "Cone", "radius": 1.0},
        {"type": "Sphere"},
        {"type": "Sphere", "radius": -1.0},
        {"type": "Box", "size": (1, 2)},
        {"type": "Box", "size": (1, 2, 3), "radius": 1.0},
    ],
)
def test_wrong_geometry_is_refused(keys):
    with pytest.raises(da.ModelError, match="geometry"):
        spatial.Geometry(**keys)
