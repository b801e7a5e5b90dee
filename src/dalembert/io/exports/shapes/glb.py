"""Binary glTF 2.0: nodes, meshes, materials and animations in one file.

Khronos Group, glTF 2.0 Specification, sections 3 and 4.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from dalembert.io.exports.shapes.surfaces import Surface

FLOAT, UNSIGNED = 5126, 5125
"""Component types."""
TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
VERTICES, INDICES = 34962, 34963
"""Targets of buffer views."""
TRIANGLES, LINE_STRIP, LINES = 4, 3, 1
"""Modes of primitives."""


class GlbDocument:
    """A glTF document with its binary buffer.

    Attributes
    ----------
    json : properties of the file
    """

    def __init__(self) -> None:
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "dalembert"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "buffers": [{"byteLength": 0}],
            "bufferViews": [],
            "accessors": [],
        }
        self._data = bytearray()

    def add(self, kind: str, entry: dict[str, Any]) -> int:
        """Append an entry to a list of the document; returns its index."""
        entries = self.json.setdefault(kind, [])
        entries.append(entry)
        return len(entries) - 1

    def node(self, entry: dict[str, Any], parent: int | None = None) -> int:
        """Add a node below another one, or to the scene."""
        index = self.add("nodes", entry)
        if parent is None:
            self.json["scenes"][0]["nodes"].append(index)
        else:
            self.json["nodes"][parent].setdefault("children", []).append(index)
        return index

    def accessor(self, values: np.ndarray, target: int | None = None, limits: bool = False) -> int:
        """Store numbers in the buffer; returns the index of their accessor."""
        indices = np.issubdtype(values.dtype, np.integer)
        table = np.ascontiguousarray(values, dtype="<u4" if indices else "<f4")
        view: dict[str, Any] = {
            "buffer": 0,
            "byteOffset": len(self._data),
            "byteLength": table.nbytes,
        }
        self._data += table.tobytes()
        if target is not None:
            view["target"] = target
        width = 1 if table.ndim == 1 else table.shape[1]
        entry: dict[str, Any] = {
            "bufferView": self.add("bufferViews", view),
            "componentType": UNSIGNED if indices else FLOAT,
            "count": len(table),
            "type": TYPES[width],
        }
        if limits:
            rows = table.reshape(len(table), -1)
            entry |= {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()}
        return self.add("accessors", entry)

    def material(self, name: str, colour: tuple[float, float, float]) -> int:
        """A matt material, visible from both sides; the colour is linear."""
        surface = {"baseColorFactor": [*colour, 1.0], "metallicFactor": 0.1, "roughnessFactor": 0.6}
        return self.add(
            "materials", {"name": name, "pbrMetallicRoughness": surface, "doubleSided": True}
        )

    def triangles(self, surface: Surface, material: int) -> dict[str, Any]:
        """A primitive of triangles with normals."""
        attributes = {
            "POSITION": self.accessor(surface.vertices, VERTICES, limits=True),
            "NORMAL": self.accessor(normals(surface), VERTICES),
        }
        indices = self.accessor(surface.triangles.reshape(-1), INDICES)
        return {
            "attributes": attributes,
            "indices": indices,
            "mode": TRIANGLES,
            "material": material,
        }

    def line(self, points: np.ndarray, material: int) -> dict[str, Any]:
        """A primitive of one line through points."""
        place = self.accessor(points, VERTICES, limits=True)
        return {"attributes": {"POSITION": place}, "mode": LINE_STRIP, "material": material}

    def to_bytes(self) -> bytes:
        """The file."""
        while len(self._data) % 4:
            self._data.append(0)
        self.json["buffers"][0]["byteLength"] = len(self._data)
        text = json.dumps(self.json, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(self._data), 0x004E4942) + bytes(self._data)
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def normals(surface: Surface) -> np.ndarray:
    """(n, 3) unit normals of vertices, means of the adjacent triangles by their areas."""
    corners = surface.vertices[surface.triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(surface.vertices)
    for k in range(3):
        np.add.at(total, surface.triangles[:, k], areas)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    unit = np.divide(total, length, out=np.zeros_like(total), where=length > 1e-300)
    unit[length[:, 0] <= 1e-300] = (0.0, 0.0, 1.0)
    return unit
