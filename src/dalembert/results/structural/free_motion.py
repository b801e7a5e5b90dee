"""Page of a structure whose stiffness is singular: it swings in the motion without strain."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import SingularityError
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.files.tables import diagnosis, parameter_rows
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.scene import automatic_scale, structural_scene


def undeformed_payload(
    model: StructuralModel, error: Exception, values: np.ndarray | None = None
) -> dict[str, Any]:
    """Payload of the page of a structure whose analysis fails.

    The structure is drawn undeformed with supports and the loads of the first case; a mechanism
    swings in its free motion ``u``, for which ``K u = 0``.

    Parameters
    ----------
    model : StructuralModel
    error : of the analysis
    values : (np,) parameters; nominal ones by default
    """
    linear = model.linearized
    p = model.values(None) if values is None else values
    drawing = StructuralDrawing(linear, p)
    size = len(linear.degrees)
    known = error.motion if isinstance(error, SingularityError) else ()
    motion = np.asarray(known, dtype=float) if len(known) == size else np.zeros(size)
    moved = drawing.displaced(motion)
    loads = np.zeros((size, 1))
    for case in list(linear.loads.values())[:1]:
        loads[:, 0] = case.values(p, 0.0)
    loads[linear.assembly.prescribed] = 0.0
    scene = structural_scene(drawing, [moved], [automatic_scale(drawing, moved)], loads)
    scene["fields"] = []
    name = "free motion" if motion.any() else "undeformed"
    return {
        "format": 2,
        "kind": "structure",
        "title": model.name,
        "subtitle": f"{name}: the analysis failed",
        "states": {
            "kind": "state",
            "names": [name],
            "times": [],
            "relative": True,
            "numbers": [1],
            "unit": "",
            "values": [0.0],
        },
        "scene": scene,
        "directions": list(linear.degrees.directions),
        "numbers": linear.degrees.table.ravel(),
        "displacements": [motion],
        "reactions": [],
        "units": {},
        "diagnosis": diagnosis(name, [], [("error", str(error))]),
        "statistics": [],
        "parameters": parameter_rows(model.parameters, p),
    }
