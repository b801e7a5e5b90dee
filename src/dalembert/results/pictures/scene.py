"""Scene of a planar or spatial mechanism."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.model.graph.description import Description
from dalembert.model.graph.model import Model
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.mechanism_scene import MechanismScene
from dalembert.results.pictures.planar_scene import PlanarScene


def motion_scene(
    motion: LabelledRecording, keep: np.ndarray, *, loads: bool = True
) -> dict[str, Any]:
    """Bodies, symbols and poses at the instants ``keep``.

    Parameters
    ----------
    loads : whether applied forces, moments and stops are drawn
    """
    kind: type[MechanismScene] = PlanarScene
    if is_spatial(motion.model):
        from dalembert.results.pictures.spatial_scene import SpatialScene

        kind = SpatialScene
    return kind(motion, keep, loads).build()


def standing(body: dict[str, Any], k: int) -> dict[str, Any]:
    """Pose of a body of a scene at one instant, drawn as a ghost."""
    poses = {key: body[key][k] for key in body if key not in ("name", "node", "shapes")}
    return {"shapes": body["shapes"], **poses}


def is_spatial(model: Model | Description) -> bool:
    """Whether some of its bodies are spatial."""
    return any(body.dimension == 3 for body in model.bodies)
