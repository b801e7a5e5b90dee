"""Choices of coordinates by name, for files, tables and comparisons."""

from __future__ import annotations

from dalembert.model.graph.automatic_coordinates import AutomaticCoordinates
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.model.graph.tree.joint_coordinates import JointCoordinates

COORDINATES: dict[str, type] = {
    "AbsoluteCoordinates": AbsoluteCoordinates,
    "JointCoordinates": JointCoordinates,
    "AutomaticCoordinates": AutomaticCoordinates,
}
