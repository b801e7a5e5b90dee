"""Mass, centre and inertia of shapes against integrals over what they fill."""

from __future__ import annotations

import itertools
import re

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import spatial
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.elements.spatial.surface import SurfaceMesh

DENSITY = 2.7
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def gauss(low, high):
    """Nodes and weights on an interval, or on one for every entry."""
    low, high = np.asarray(low)[..., None], np.asarray(high)[..., None]
    return (low + high) / 2 + (high - low) / 2 * NODES, (high - low) / 2 * WEIGHTS


def box(x, y, z):
    axes = [gauss(-s / 2, s / 2) for s in (x, y, z)]
    points = np.stack(np.meshgrid(*(a for a, _ in axes), indexing="ij"), axis=-1).reshape(-1, 3)
    return points, np.einsum("i,j,k->ijk", *(w for _, w in axes)).ravel()


def revolved(bounds, inner, radius):
    """About z, piece by piece between the bounds, from one radius to another of z."""
    turn = 2 * np.pi * np.arange(16) / 16
    results = []
    for low, high in itertools.pairwise(bounds):
        z, wz = gauss(low, high)
        r, wr = gauss(inner(z), radius(z))
        z, r, w = np.broadcast_arrays(z[:, None], r, wz[:, None] * wr * r)
        ring = [z[..., None], r[..., None], w[..., None] * 2 * np.pi / 16]
        z, r, w, angle = np.broadcast_arrays(*ring, turn)
        results.append((np.stack([r * np.cos(angle), r * np.sin(angle), z], -1), w))
    points = np.concatenate([p.reshape(-1, 3) for p, _ in results])
    return points, np.concatenate([w.ravel() for _, w in results])


def capped(r, half):
    def radius(z):
        return np.sqrt(np.maximum(r**2 - np.maximum(abs(z) - half, 0) ** 2, 0))

    return revolved(
        [-half - r, -half, half, half + r] if half else [-r, 0, r], np.zeros_like, radius
    )


def along_x(points, weights):
    return points[:, [2, 0, 1]], weights


SHAPES = {
    "box": (spatial.Box, {"size": (0.3, 0.5, 0.8)}, box(0.3, 0.5, 0.8)),
    "cylinder": (
        spatial.Cylinder,
        {"radius": 0.3, "length": 0.7},
        revolved([-0.35, 0.35], np.zeros_like, lambda z: 0.3 + 0 * z),
    ),
    "tube": (
        spatial.Cylinder,
        {"radius": 0.3, "length": 0.7, "inner_radius": 0.2},
        revolved([-0.35, 0.35], lambda z: 0.2 + 0 * z, lambda z: 0.3 + 0 * z),
    ),
    "sphere": (spatial.Sphere, {"radius": 0.4}, capped(0.4, 0.0)),
    "capsule": (spatial.Capsule, {"radius": 0.2, "length": 0.6}, capped(0.2, 0.3)),
    "bar": (
        spatial.Bar,
        {"length": 0.9, "radius": 0.1},
        along_x(*revolved([-0.45, 0.45], np.zeros_like, lambda z: 0.1 + 0 * z)),
    ),
}


def integrals(points, weights):
    """Mass, centre, and inertia about the centre."""
    masses = DENSITY * weights
    mass = masses.sum()
    center = masses @ points / mass
    s = points - center
    inertia = np.einsum("i,ij,ij->", masses, s, s) * np.eye(3) - np.einsum("i,ij,ik", masses, s, s)
    return mass, center, inertia


def numbers(*formulas, symbols=(), values=()):
    f = ca.Function("n", [ca.vertcat(*symbols)], [ca.densify(x) for x in formulas])
    return [np.squeeze(x.full()) for x in f.call([ca.DM(list(values))])]


@pytest.mark.parametrize("name", SHAPES)
def test_mass_and_inertia_are_the_integrals(name):
    kind, sizes, filled = SHAPES[name]
    body = kind("b", density=DENSITY, **sizes)
    computed = numbers(body.mass.sx, body.center_of_mass.sx, tensor(body.inertia.sx))
    for value, wanted in zip(computed, integrals(*filled), strict=True):
        np.testing.assert_allclose(value, wanted, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize("name", SHAPES)
def test_a_mass_gives_the_inertia_of_its_density(name):
    kind, sizes, _ = SHAPES[name]
    one = kind("one", density=DENSITY, **sizes)
    other = kind("other", mass=float(one.mass), **sizes)
    np.testing.assert_allclose(*numbers(one.inertia.sx, other.inertia.sx), rtol=1e-14)


@pytest.mark.parametrize("name", SHAPES)
def test_gradients_go_through_sizes_and_density(name):
    """Twice the length: mass ×8, inertia ×32; so their logarithmic derivatives are 3 and 5."""
    kind, sizes, _ = SHAPES[name]
    system = da.System("s")
    scale = system.parameter("scale", 1.3)
    rho = system.parameter("rho", DENSITY)
    scaled = {n: [x * scale for x in v] if np.ndim(v) else v * scale for n, v in sizes.items()}
    body = kind("b", density=rho, **scaled)
    p = ca.vertcat(scale.sx, rho.sx)
    whole = ca.vertcat(body.mass.sx, body.inertia.sx[:3])
    slope, value = numbers(ca.jacobian(whole, p), whole, symbols=[p], values=[1.3, DENSITY])
    powers = slope * [1.3, DENSITY] / value[:, None]
    np.testing.assert_allclose(powers, [[3, 1], [5, 1], [5, 1], [5, 1]], rtol=1e-12)


# solids made of triangles --------------------------------------------------------------------
CORNERS = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float)
QUADS = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
TRIANGLES = np.array([t for a, b, c, d in QUADS for t in ([a, b, c], [a, c, d])])


def written(path, corners, triangles):
    """As an OBJ file, which counts from one."""
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    path.write_text("\n".join(lines + [f"f {i + 1} {j + 1} {k + 1}" for i, j, k in triangles]))
    return path


def test_volume_and_inertia_of_triangles_are_those_of_the_solid():
    """A cube under any linear map: ``∫ s sᵀ dV = V A Aᵀ/12``."""
    rng = np.random.default_rng(1)
    for _ in range(3):
        a, shift = rng.standard_normal((3, 3)), 5 * rng.standard_normal(3)
        a *= np.sign(np.linalg.det(a))
        volume, center, second = SurfaceMesh(CORNERS @ a.T + shift, TRIANGLES).enclosed()
        assert volume == pytest.approx(np.linalg.det(a), rel=1e-12)
        np.testing.assert_allclose(center, a.sum(axis=1) / 2 + shift, rtol=1e-12)
        np.testing.assert_allclose(second, volume * a @ a.T / 12, atol=1e-12)


@pytest.mark.parametrize("outwards", [True, False])
def test_a_mesh_is_the_body_it_encloses(tmp_path, outwards):
    trimesh = pytest.importorskip("trimesh")
    triangles = TRIANGLES if outwards else TRIANGLES[:, ::-1]
    path = written(tmp_path / "box.obj", CORNERS * [300, 500, 800], triangles)
    mesh = spatial.Mesh("m", file=path, scale=0.001, density=DENSITY)
    same = spatial.Box("b", size=(0.3, 0.5, 0.8), density=DENSITY)
    center, *pair = numbers(mesh.center_of_mass.sx, *(b.inertia.sx for b in (mesh, same)))
    np.testing.assert_allclose(center, [0.15, 0.25, 0.4], rtol=1e-12)
    np.testing.assert_allclose(*pair, atol=1e-12)
    peer = trimesh.creation.icosphere(subdivisions=2).apply_scale([1.0, 0.6, 0.3])
    peer.density = DENSITY
    for ending in ("stl", "glb"):
        peer.export(tmp_path / f"ball.{ending}")
        ball = spatial.Mesh("ball", file=tmp_path / f"ball.{ending}", density=DENSITY)
        mass, inertia = numbers(ball.mass.sx, tensor(ball.inertia.sx))
        assert mass == pytest.approx(peer.mass, rel=1e-6)
        np.testing.assert_allclose(inertia, peer.moment_inertia, rtol=1e-5, atol=1e-9)


TURNED = np.vstack([TRIANGLES[:1, ::-1], TRIANGLES[1:]])
WRONG = {
    "open": (TRIANGLES[1:], "is no closed surface: 3 edges"),
    "a triangle turned over": (
        np.vstack([TRIANGLES[:1, ::-1], TRIANGLES[1:]]),
        "is no closed surface: 3 edges",
    ),
    "flat": (np.vstack([TRIANGLES[:2], TRIANGLES[:2, ::-1]]), "encloses no volume"),
    "nothing": (TRIANGLES[:0], "has no triangles|cannot be read"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_meshes_that_are_no_solid_are_refused(tmp_path, wrong):
    pytest.importorskip("trimesh")
    triangles, message = WRONG[wrong]
    path = written(tmp_path / "bad.obj", CORNERS, triangles)
    with pytest.raises(da.ModelError, match=rf"^m\.file: .*bad\.obj ({message})"):
        spatial.Mesh("m", file=path, density=1.0)


PARTS = {
    "beside each other": (1, (2, 0, 0), 1.0, 2.0),
    "a cavity": (-1, (0.25, 0.25, 0.25), 0.5, 7 / 8),
    "inside out": (-1, (2, 0, 0), 0.5, "with inward normals that is no cavity"),
    "overlapping": (1, (0.5, 0, 0), 1.0, "overlaps another part"),
    "a cavity with outward normals": (1, (0.25, 0.25, 0.25), 0.5, "overlaps another part"),
}
"""Sign of the normals of a second cube, its place and size, and the volume or the message."""


@pytest.mark.parametrize("name", PARTS)
def test_parts_of_meshes_are_solids_apart_or_cavities(tmp_path, name):
    """Overlaps would count twice, and parts that are turned inside out would be subtracted."""
    pytest.importorskip("trimesh")
    sign, place, size, expected = PARTS[name]
    corners = np.vstack([CORNERS, size * CORNERS + place])
    path = written(tmp_path / "two.obj", corners, np.vstack([TRIANGLES, 8 + TRIANGLES[:, ::sign]]))
    if isinstance(expected, float):
        mesh = spatial.Mesh("m", file=path, density=1.0)
        assert float(mesh.mass) == pytest.approx(expected, rel=1e-12)
    else:
        with pytest.raises(da.ModelError, match=rf"^m\.file: .*two\.obj .*{expected}"):
            spatial.Mesh("m", file=path, density=1.0)


def test_unreadable_meshes_are_refused(tmp_path, monkeypatch):
    pytest.importorskip("trimesh")
    for name, content in {"noise.stl": b"\x00\xff" * 50, "text.txt": b"solid"}.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(da.ModelError, match=rf"^m\.file: .*{name} .*STL, OBJ"):
            spatial.Mesh("m", file=tmp_path / name, density=1.0)
    with pytest.raises(da.DalembertError, match=r"none\.stl: no such file"):
        spatial.Mesh("m", file=tmp_path / "none.stl", density=1.0)


def test_without_trimesh_the_cure_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    with pytest.raises(da.UnsupportedError, match=re.escape("pip install 'dalembert[mesh]'")):
        spatial.Mesh("m", file=tmp_path / "any.stl", density=1.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: spatial.Sphere("b", radius=1.0, mass=1.0, density=1.0), "b: give mass= or"),
        (lambda: spatial.Bar("b", length=1.0, density=1.0), "b: density= needs a radius"),
        (lambda: spatial.Sphere("b", radius=-1.0, mass=1.0), "b.radius: is -1 m, but it must be"),
        (lambda: spatial.Box("b", size=(1, 0, 1), mass=1.0), "b.size: is 0 m, but it must be"),
        (lambda: spatial.Box("b", size=(1, 1), mass=1.0), "b.size: expected 3 component(s), got 2"),
        (
            lambda: spatial.Cylinder("b", radius=1.0, length=1.0, inner_radius=1.1, mass=1.0),
            "b.radius − inner_radius: is -0.1 m, but it must not be negative",
        ),
        (
            lambda: spatial.Cylinder("b", radius=1.0, length=1.0, inner_radius=1.1, density=1.0),
            "b.radius − inner_radius: is -0.1 m",
        ),
        (lambda: spatial.Sphere("b", radius=-1.0, density=1.0), "b.radius: is -1 m, but it must"),
    ],
)
def test_wrong_sizes_are_refused(make, message):
    def built():
        system = da.System("s")
        system.add(make())
        return system.build()

    with pytest.raises(da.ModelError, match=re.escape(message)):
        built()
