"""Bodies of triangulated surfaces in STL, OBJ, PLY, OFF and glTF files."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.elements.spatial.surface import WEIGHT, SurfaceMesh, read_surface, refuse_open
from dalembert.errors import FileError, ModelError
from dalembert.files import readable
from dalembert.io.imports.imported import Imported
from dalembert.io.imports.solids.solid import Solid, imported_file, imported_solids, length_of
from dalembert.io.omission import Omission
from dalembert.packages import optional_package

SUFFIXES = (".stl", ".obj", ".ply", ".off", ".glb", ".gltf")
SCENES = (".glb", ".gltf")
"""Suffixes of files that may contain several parts, in metres."""


def read_mesh(
    path: Path,
    *,
    unit: str | None = None,
    density: float | str | None = None,
    mass: float | str | None = None,
) -> Imported:
    """Bodies of the closed surfaces in a file; each part of a glTF scene is one.

    Parameters
    ----------
    path : of the file
    unit : of its coordinates; millimetres by default, metres for glTF
    density : of all parts; that of steel by default [kg/m³]
    mass : of all parts together, in place of the density [kg]

    Raises
    ------
    FileError, ModelError
        The file is unreadable, or a surface open; names the file and a fix.
    UnsupportedError
        trimesh is not installed.
    """
    path, is_scene = Path(path), Path(path).suffix.lower() in SCENES
    scale = length_of(unit or ("m" if is_scene else "mm"))
    if readable(path, WEIGHT) == 0:
        raise FileError(f"{path}: the file is empty; export the solid again")
    if is_scene:
        _refuse_other_files(path)
        parts = _parts(path)
        if len(parts) > 1:
            solids = [_solid(path, name, *triangles, scale) for name, triangles in parts]
            reason = "its parts are bodies without a picture; save each part as a file for pictures"
            return imported_solids(
                path, solids, density, mass, [Omission(str(path), "surfaces", reason)]
            )
    volume = read_surface(path, "surface").volume * scale**3
    return imported_file(path, scale, density, mass, volume)


def _parts(path: Path) -> list[tuple[str, tuple[np.ndarray, np.ndarray]]]:
    """Names of the parts of a scene, with corners and triangles in its axes."""
    trimesh = optional_package("trimesh", f"reading {path}")
    try:
        scene: Any = trimesh.load_scene(path)
        parts = []
        for node in scene.graph.nodes_geometry:
            transform, geometry = scene.graph[node]
            mesh = scene.geometry[geometry].copy()
            if hasattr(mesh, "faces"):
                mesh.apply_transform(transform)
                mesh.merge_vertices(merge_tex=True, merge_norm=True)
                parts.append((str(node), (np.asarray(mesh.vertices), np.asarray(mesh.faces))))
    except Exception as error:  # readers of many formats with various errors
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise FileError(f"{path}: cannot be read as glTF ({reason}); export it again") from None
    return parts


def _solid(
    path: Path, name: str, corners: np.ndarray, triangles: np.ndarray, scale: float
) -> Solid:
    place = f"{path}: part {name!r}"
    if not len(triangles) or not np.isfinite(corners).all():
        raise ModelError("has no triangles with finite corners", place)
    refuse_open(triangles, path, f"part {name!r}")
    surface = SurfaceMesh(corners * scale, triangles)
    if surface.volume < 0:
        surface = SurfaceMesh(surface.corners, triangles[:, ::-1])
    volume, center, second = surface.enclosed()
    return Solid(name, place, float(volume), center, np.trace(second) * np.eye(3) - second)


def _refuse_other_files(path: Path) -> None:
    """Refuse references of a scene to other folders and to servers.

    Raises
    ------
    FileError
        Names the reference.
    """
    data = path.read_bytes()
    if data[:4] == b"glTF":
        length = struct.unpack("<I", data[12:16])[0] if len(data) >= 20 else 0
        data = data[20 : 20 + length]
    try:
        scene = json.loads(data)
        entries = [*scene.get("buffers", []), *scene.get("images", [])]
        references = [entry.get("uri") for entry in entries]
    except (ValueError, AttributeError, TypeError, RecursionError):
        raise FileError(f"{path}: is no glTF scene; export it again") from None
    for reference in references:
        is_inside = reference is None or str(reference).startswith("data:")
        if not is_inside and Path(str(reference)).name != reference:
            raise FileError(
                f"{path}: refers to {str(reference)[:100]!r}, which is not in its folder; save the "
                "scene as one .glb file"
            )
