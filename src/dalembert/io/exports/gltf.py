"""glTF animations: mechanisms with nodes per body, structures with morph targets."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.io.exports.exported import Files
from dalembert.io.exports.rigid.start import Start
from dalembert.io.exports.shapes.glb import INDICES, LINES, TRIANGLES, VERTICES, GlbDocument
from dalembert.io.exports.shapes.scene import MovingBody, moving_scene, start_recording
from dalembert.io.exports.shapes.surfaces import Surface
from dalembert.io.exports.shapes.swing import swings
from dalembert.io.omission import Omission
from dalembert.model.graph.model import Model
from dalembert.results.modes import Modes, Numbered
from dalembert.results.pictures.scene import is_spatial
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.scene import automatic_scale
from dalembert.results.structural.states import StructuralStates

COLOURS = (
    (0.06, 0.22, 0.48),
    (0.62, 0.13, 0.07),
    (0.10, 0.35, 0.13),
    (0.52, 0.31, 0.04),
    (0.25, 0.12, 0.42),
    (0.04, 0.36, 0.38),
)
"""Linear colours of bodies in turn."""
GREY = (0.32, 0.32, 0.34)
FRAMES = 1000
"""Upper limit of instants of a motion by default."""
SHAPES = 60
"""Upper limit of instants of the motion of a structure by default."""


def gltf_file(
    source: Any, name: str, frames: int | None = None, scale: float | None = None
) -> Files:
    """A binary glTF 2.0 file of a mechanism, or of a structure.

    Bodies are nodes with animated translation and rotation. Modes are one animation each, a period
    of one second. Displacements of structures are morph targets with animated weights.

    Parameters
    ----------
    frames : upper limit of the instants
    scale : factor of the displacements of a structure, by default one that makes them visible
    """
    document = GlbDocument()
    if isinstance(source, StructuralStates):
        omissions = _add_structure(document, source, frames or SHAPES, scale)
    else:
        if scale is not None:
            raise UnsupportedError("scale= is for structures; mechanisms move to scale")
        _add_mechanism(document, source, frames or FRAMES)
        omissions = []
    return Files({f"{name}.glb": document.to_bytes()}, omissions)


# mechanisms -----------------------------------------------------------------------------------
def _add_mechanism(document: GlbDocument, source: Any, frames: int) -> None:
    model = source if isinstance(source, Model) else source.model
    if isinstance(source, Numbered):
        recordings = swings(source) if isinstance(source, Modes) else []
    else:
        recording = start_recording(source) if isinstance(source, Model) else source
        recordings = [("motion", recording)]
    if not recordings:
        raise UnsupportedError(f"{model.name!r} has no modes to animate")
    root = document.node({"name": model.name, **_upright(model)})
    nodes: list[int] = []
    for label, recording in recordings:
        scene = moving_scene(recording, _some(recording.time.size, frames))
        if not nodes:
            nodes = [_add_body(document, body, k, root) for k, body in enumerate(scene.bodies)]
        if scene.time.size > 1:
            time = scene.time - scene.time[0]
            _animate(document, label, time, nodes[1:], scene.bodies[1:])


def _some(count: int, limit: int) -> np.ndarray:
    """Numbers of at most ``limit`` instants, the first and the last included."""
    return np.unique(np.linspace(0, count - 1, min(count, max(2, limit))).round().astype(int))


def _upright(model: Model) -> dict[str, Any]:
    """Rotation that makes the upward axis y, which glTF prescribes."""
    gravity = model.parts.gravity
    upward = 2 if is_spatial(model) else 1
    if gravity is not None and is_spatial(model):
        (values,) = Start(model).values(gravity.sx)
        upward = int(np.argmax(np.abs(values))) if np.any(values) else 2
    half = float(np.sqrt(0.5))
    return {"rotation": [-half, 0.0, 0.0, half]} if upward == 2 else {}


def _add_body(document: GlbDocument, body: MovingBody, number: int, root: int) -> int:
    colour = GREY if number == 0 else COLOURS[(number - 1) % len(COLOURS)]
    entry: dict[str, Any] = {"name": body.name}
    if body.surfaces or body.lines:
        material = document.material(body.name, colour)
        primitives = [document.triangles(_joined(body.surfaces), material)] if body.surfaces else []
        primitives += [document.line(line, material) for line in body.lines]
        entry["mesh"] = document.add("meshes", {"name": body.name, "primitives": primitives})
    entry["translation"] = body.positions[0].tolist()
    entry["rotation"] = np.roll(body.quaternions[0], -1).tolist()
    if body.lengths is not None:
        entry["scale"] = [1.0, 1.0, float(body.lengths[0])]
    return document.node(entry, root)


def _joined(surfaces: list[Surface]) -> Surface:
    """Several surfaces as one."""
    starts = np.cumsum([0, *(len(s.vertices) for s in surfaces)])
    triangles = [s.triangles + start for s, start in zip(surfaces, starts, strict=False)]
    return Surface(np.vstack([s.vertices for s in surfaces]), np.vstack(triangles))


def _animate(
    document: GlbDocument, name: str, time: np.ndarray, nodes: list[int], bodies: list[MovingBody]
) -> None:
    """An animation of translations and rotations; those that do not change are left out."""
    clock = document.accessor(time, limits=True)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for node, body in zip(nodes, bodies, strict=True):
        turns = np.roll(body.quaternions, -1, axis=1)
        paths = [("translation", body.positions), ("rotation", turns)]
        if body.lengths is not None:
            one = np.ones(time.size)
            paths.append(("scale", np.column_stack([one, one, body.lengths])))
        for path, values in paths:
            output = document.accessor(values)
            channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
            samplers.append({"input": clock, "output": output, "interpolation": "LINEAR"})
    document.add("animations", {"name": name, "samplers": samplers, "channels": channels})


# structures -----------------------------------------------------------------------------------
def _add_structure(
    document: GlbDocument, result: StructuralStates, frames: int, scale: float | None
) -> list[Omission]:
    drawing = StructuralDrawing(result.model, result.parameters)
    index = _some(len(result.cases), frames)
    moved = [drawing.displaced(result.state(int(k)).u, result.large) for k in index]
    factors = _factors(drawing, moved, result.in_sequence, scale)
    targets = [factor * displacement for factor, displacement in zip(factors, moved, strict=True)]
    material = document.material(result.model.name, COLOURS[0])
    primitives = _cells(document, drawing, targets, material)
    if not primitives:
        raise UnsupportedError(f"{result.model.name!r} has no lines or faces to draw")
    names = [result.state_names[int(k)] for k in index]
    extras = {"targetNames": names, "displacement_scales": [float(f) for f in factors]}
    weights = [0.0] * len(targets)
    mesh = {"name": result.model.name, "primitives": primitives, "weights": weights}
    number = document.add("meshes", mesh | {"extras": extras})
    half = float(np.sqrt(0.5))
    turned = {"rotation": [-half, 0.0, 0.0, half]} if drawing.dimension == 3 else {}
    root = document.node({"name": result.model.name, **turned})
    node = document.node({"name": f"{result.model.name} mesh", "mesh": number}, root)
    if result.in_sequence:
        time = np.asarray(result.time)[index]
        _weigh(document, "motion", time - time[0], np.eye(len(index)), node)
    else:
        phase = np.linspace(0.0, 1.0, 25)
        swing = np.sin(2 * np.pi * phase) if result.of_any_size else np.sin(np.pi * phase) ** 2
        for k, name in enumerate(names):
            table = np.zeros((phase.size, len(names)))
            table[:, k] = swing
            _weigh(document, name, phase, table, node)
    return [
        Omission(name, "point element", "it has no surface")
        for cells in drawing.points
        for name in np.asarray(drawing.element_names)[cells.elements][:1]
    ]


def _factors(
    drawing: StructuralDrawing, moved: list[np.ndarray], in_sequence: bool, scale: float | None
) -> list[float]:
    """Factor of the displacements of each state; the same one for consecutive states."""
    if scale is not None:
        return [float(scale)] * len(moved)
    if in_sequence:
        largest = max(moved, key=lambda u: float(np.abs(u).max(initial=0.0)))
        return [automatic_scale(drawing, largest)] * len(moved)
    return [automatic_scale(drawing, u) for u in moved]


def _cells(
    document: GlbDocument, drawing: StructuralDrawing, targets: list[np.ndarray], material: int
) -> list[dict[str, Any]]:
    """Primitives of the faces and lines of a structure, with morph targets."""
    faces = [_fan(cells.vertices) for cells in drawing.faces]
    lines = [
        np.column_stack([cells.vertices[:, k], cells.vertices[:, k + 1]])
        for cells in drawing.lines
        for k in range(cells.vertices.shape[1] - 1)
    ]
    place = document.accessor(drawing.rest, VERTICES, limits=True)
    morphs = [{"POSITION": document.accessor(u, VERTICES, limits=True)} for u in targets]
    primitives = []
    for parts, mode in ((faces, TRIANGLES), (lines, LINES), ([drawing.outline()], LINES)):
        table = np.concatenate([np.zeros(0, dtype=int), *(part.reshape(-1) for part in parts)])
        if table.size:
            indices = document.accessor(table, INDICES)
            primitive = {"attributes": {"POSITION": place}, "indices": indices, "mode": mode}
            primitives.append(primitive | {"material": material, "targets": morphs})
    return primitives


def _fan(vertices: np.ndarray) -> np.ndarray:
    """(m, 3) triangles of convex polygons (n, k)."""
    count = vertices.shape[1]
    return np.vstack([vertices[:, [0, k, k + 1]] for k in range(1, count - 1)])


def _weigh(
    document: GlbDocument, name: str, time: np.ndarray, weights: np.ndarray, node: int
) -> None:
    """An animation of the weights (K, targets) of morph targets."""
    sampler = {
        "input": document.accessor(time, limits=True),
        "output": document.accessor(weights.reshape(-1)),
        "interpolation": "LINEAR",
    }
    channel = {"sampler": 0, "target": {"node": node, "path": "weights"}}
    document.add("animations", {"name": name, "samplers": [sampler], "channels": [channel]})
