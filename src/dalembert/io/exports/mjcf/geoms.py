"""Shapes of bodies as geoms of MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any
from xml.etree import ElementTree as xml

import numpy as np

from dalembert.io.exports.mjcf.document import MjcfDocument, texts
from dalembert.io.exports.shapes.scene import scene_size, start_recording
from dalembert.io.exports.shapes.surfaces import BAR, PARTICLE, padded, surface_of
from dalembert.results.pictures.scene import motion_scene

COLOURS = ("0.25 0.5 0.75", "0.8 0.4 0.25", "0.35 0.6 0.4", "0.75 0.6 0.2", "0.55 0.4 0.7")
"""Colours of bodies in turn."""
GREY = "0.6 0.6 0.62"
SMALLEST_VOLUME = 1e-9
"""Threshold of the volume of meshes, relative to the cube of the size; MuJoCo has no sheets."""
Shape = Mapping[str, Any]
Attributes = dict[str, Any]


def add_geoms(document: MjcfDocument, parameters: Mapping[str, float] | None) -> None:
    """Add the shapes of all bodies; they have no mass and no contacts."""
    scene = motion_scene(start_recording(document.model, parameters), np.zeros(1, int), loads=False)
    size = scene_size(scene)
    entries = [{"name": "ground", **scene["ground"]}, *scene["bodies"]]
    for number, entry in enumerate(entries):
        colour = GREY if number == 0 else COLOURS[(number - 1) % len(COLOURS)]
        for k, shape in enumerate(entry["shapes"]):
            label = f"{entry['name']}.shape{k + 1}"
            attributes = _geom(document, shape, size, label)
            if attributes is not None:
                named = texts({"name": label, **attributes, "rgba": f"{colour} 1"})
                xml.SubElement(document.bodies[entry["name"]], "geom", named)


def _geom(document: MjcfDocument, shape: Shape, size: float, label: str) -> Attributes | None:
    """Attributes of a geom; None for curves and sheets."""
    if shape["kind"] in PRIMITIVES:
        return PRIMITIVES[shape["kind"]](shape, size)
    surface = surface_of(shape, size)
    if surface is None or abs(surface.volume) < SMALLEST_VOLUME * size**3:
        return None
    document.add("asset", "mesh", name=label, vertex=surface.vertices, face=surface.triangles)
    return {"type": "mesh", "mesh": label}


def _between(shape: Shape, radius: float, kind: str) -> Attributes:
    ends = np.concatenate([padded(shape["from"]), padded(shape["to"])])
    return {"type": kind, "fromto": ends, "size": radius}


def _about(shape: Shape, kind: str, size: Any) -> Attributes:
    return {"type": kind, "pos": padded(shape["center"]), "size": size}


def _halves(shape: Shape) -> np.ndarray:
    return np.asarray([float(x) for x in shape["size"]]) / 2


PRIMITIVES: dict[str, Callable[[Shape, float], Attributes]] = {
    "bar": lambda shape, size: _between(shape, BAR * size, "capsule"),
    "line": lambda shape, size: _between(shape, BAR * size / 4, "capsule"),
    "capsule": lambda shape, size: _between(shape, float(shape["radius"]), "capsule"),
    "cylinder": lambda shape, size: _between(shape, float(shape["radius"]), "cylinder"),
    "particle": lambda shape, size: _about(shape, "sphere", PARTICLE * size),
    "sphere": lambda shape, size: _about(shape, "sphere", float(shape["radius"])),
    "box": lambda shape, size: _about(shape, "box", _halves(shape)),
    "ellipsoid": lambda shape, size: (
        _about(shape, "ellipsoid", _halves(shape)) | {"quat": np.asarray(shape["turn"])}
    ),
}
"""Kind of a shape → attributes of the geom, for the size of the mechanism."""
