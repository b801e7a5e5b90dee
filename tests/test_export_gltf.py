"""glTF animations: transforms of nodes are the poses of the result, files are valid glTF 2.0."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from example_runs import EXAMPLES

import dalembert as da
from dalembert import planar
from dalembert.io import load_model_file

KINDS = {5126: ("<f4", 4), 5125: ("<u4", 4), 5123: ("<u2", 2)}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Glb:
    """A binary glTF file, read by its specification."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size, kind = struct.unpack_from("<I4s", data, 12)
        assert kind == b"JSON" and size % 4 == 0
        self.json: dict[str, Any] = json.loads(data[20 : 20 + size])
        binary, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert kind == b"BIN\0" and binary % 4 == 0
        self.data = data[28 + size : 28 + size + binary]
        assert self.json["asset"]["version"] == "2.0"

    def array(self, number: int) -> np.ndarray:
        """Values of an accessor, whose stated limits hold."""
        accessor = self.json["accessors"][number]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind, size = KINDS[accessor["componentType"]]
        width = WIDTHS[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        assert start % size == 0 and view.get("byteOffset", 0) + view["byteLength"] <= len(
            self.data
        )
        values = np.frombuffer(self.data, kind, accessor["count"] * width, start)
        values = values.reshape(-1, width)
        for key, limit in (("min", values.min(axis=0)), ("max", values.max(axis=0))):
            if key in accessor:
                np.testing.assert_array_equal(np.float32(accessor[key]), limit)
        return values

    def node(self, name: str) -> int:
        return [node.get("name") for node in self.json["nodes"]].index(name)

    def channels(self, name: str) -> tuple[np.ndarray, dict[str, np.ndarray]]:
        """Times of the animation of a node, and path → values."""
        (animation,) = self.json["animations"]
        values, time = {}, np.zeros(0)
        for channel in animation["channels"]:
            if channel["target"]["node"] == self.node(name):
                sampler = animation["samplers"][channel["sampler"]]
                time = self.array(sampler["input"])[:, 0]
                values[channel["target"]["path"]] = self.array(sampler["output"])
        return time, values

    @property
    def upright(self) -> np.ndarray:
        """Rotation of the root node."""
        (root,) = self.json["scenes"][0]["nodes"]
        return rotation(self.json["nodes"][root].get("rotation", (0, 0, 0, 1)))


def rotation(quaternion: Any) -> np.ndarray:
    """Rotation matrix of a quaternion, scalar last."""
    x, y, z, w = np.asarray(quaternion, float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def check_turns(turns: np.ndarray) -> None:
    """Quaternions have unit length and take the short way from each to the next."""
    np.testing.assert_allclose(np.linalg.norm(turns, axis=1), 1, atol=1e-6)
    assert np.all(np.sum(turns[1:] * turns[:-1], axis=1) > 0)


@pytest.mark.parametrize("name", ["four_bar", "quick_return_shaper"])
def test_planar_poses(tmp_path: Path, name: str) -> None:
    model = load_model_file(EXAMPLES / f"{name}.toml").model()
    motion = (da.solve_dynamics if name == "four_bar" else da.solve_kinematics)(
        model, 1.0, outputs=41
    )
    (path,) = da.export(motion, tmp_path / "motion.glb").files
    glb = Glb(path)
    np.testing.assert_array_equal(glb.upright, np.eye(3))  # y is upward in both
    for body in (b.name for b in model.bodies if b.name != "ground"):
        time, values = glb.channels(body)
        np.testing.assert_allclose(time, motion["time"].values, atol=1e-6)
        place = motion[f"{body}.position"].values
        np.testing.assert_allclose(values["translation"][:, :2], place, atol=1e-6)
        assert not values["translation"][:, 2].any()
        check_turns(values["rotation"])
        for turn, angle in zip(values["rotation"], motion[f"{body}.angle"].values, strict=True):
            c, s = np.cos(angle), np.sin(angle)
            expected = [[c, -s, 0], [s, c, 0], [0, 0, 1]]
            np.testing.assert_allclose(rotation(turn), expected, atol=1e-6)


def test_spatial_poses_stand_upright(tmp_path: Path) -> None:
    model = load_model_file(EXAMPLES / "heavy_top.toml").model()
    motion = da.solve_dynamics(model, 0.5, outputs=101)
    (path,) = da.export(motion, tmp_path / "top.glb").files
    glb = Glb(path)
    gravity = np.asarray(load_model_file(EXAMPLES / "heavy_top.toml").document.gravity, float)
    np.testing.assert_allclose(glb.upright @ gravity, [0, gravity.sum(), 0], atol=1e-6)
    (body,) = (b.name for b in model.bodies if b.name != "ground")
    _, values = glb.channels(body)
    check_turns(values["rotation"])
    turned = np.array([rotation(turn) for turn in values["rotation"]])
    np.testing.assert_allclose(
        turned, motion[f"{body}.rotation"].values.reshape(-1, 3, 3), atol=1e-6
    )
    place = motion[f"{body}.position"].values
    np.testing.assert_allclose(values["translation"], place, atol=1e-6)


@pytest.mark.parametrize("name", ["four_bar", "heavy_top", "rolling_disc", "crates_and_ball"])
def test_surfaces_are_closed_and_face_outward(tmp_path: Path, name: str) -> None:
    model = load_model_file(EXAMPLES / f"{name}.toml").model()
    (path,) = da.export(model, tmp_path / "model.glb").files
    glb = Glb(path)
    meshes = 0
    for mesh in glb.json.get("meshes", []):
        for primitive in mesh["primitives"]:
            if primitive.get("mode", 4) != 4:
                continue
            corners = glb.array(primitive["attributes"]["POSITION"]).astype(float)
            triangles = glb.array(primitive["indices"]).reshape(-1, 3)
            assert triangles.max() < len(corners)
            normals = np.cross(
                corners[triangles[:, 1]] - corners[triangles[:, 0]],
                corners[triangles[:, 2]] - corners[triangles[:, 0]],
            )
            area = np.linalg.norm(normals, axis=1).sum()
            assert np.linalg.norm(normals.sum(axis=0)) < 1e-5 * area, mesh["name"]  # closed
            volume = np.sum(normals * corners[triangles[:, 0]]) / 6
            assert volume > 0, mesh["name"]  # outward
            if "NORMAL" in primitive["attributes"]:
                stored = glb.array(primitive["attributes"]["NORMAL"])
                face = stored[triangles[:, 0]]
                assert np.all(np.sum(face * normals, axis=1) > -1e-12 * area)
            meshes += 1
    assert meshes


def test_trimesh_reads_it(tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    system = da.System("bar")
    system.add(planar.Bar("bar", length=0.5, mass=1.0, position=(1.0, 2.0), angle=0.3))
    (path,) = da.export(system.build(), tmp_path / "bar.glb").files
    low, high = trimesh.load(path).bounds
    np.testing.assert_allclose((low + high)[:2] / 2, [1.0, 2.0], atol=1e-6)
    size = 0.5 * np.array([np.cos(0.3), np.sin(0.3)])
    assert np.all(high[:2] - low[:2] >= size - 1e-6) and np.all(high[:2] - low[:2] < size + 0.1)
