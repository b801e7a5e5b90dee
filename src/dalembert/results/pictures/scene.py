"""The drawing of a mechanism, in the plane or in space."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.planar_scene import PlanarDrawing
from dalembert.results.pictures.spatial_scene import SpatialDrawing


def motion_scene(
    motion: LabelledRecording, keep: np.ndarray, *, loads: bool = True
) -> dict[str, Any]:
    """Drawing and poses at the instants ``keep``.

    Parameters
    ----------
    loads : applied forces and moments, and stops, are drawn too
    """
    kind = SpatialDrawing if is_spatial(motion.model) else PlanarDrawing
    return kind(motion, keep, loads).build()


def standing(body: dict[str, Any], k: int) -> dict[str, Any]:
    """A body of a scene as it stands at one of the instants, for a ghost."""
    poses = {key: body[key][k] for key in body if key not in ("name", "node", "shapes")}
    return {"shapes": body["shapes"], **poses}


def is_spatial(model: Any) -> bool:
    """Some of its bodies are bodies of space."""
    return any(body.dimension == 3 for body in model.bodies)
