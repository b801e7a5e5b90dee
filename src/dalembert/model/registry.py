"""Choices of coordinates by name, for files, tables and comparisons."""

from __future__ import annotations

from dalembert.model.automatic_coordinates import AutomaticCoordinates
from dalembert.model.coordinates import AbsoluteCoordinates
from dalembert.model.tree.joint_coordinates import JointCoordinates

COORDINATES: dict[str, type] = {
    "AbsoluteCoordinates": AbsoluteCoordinates,
    "JointCoordinates": JointCoordinates,
    "AutomaticCoordinates": AutomaticCoordinates,
}
