"""What elements attach to, in the plane and in space: bodies, points and frames fixed in them."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from dalembert.symbolic.expression import Expression


class RigidBody:
    """A rigid body, or the ground."""

    name: str
    points: dict[str, Any]
    """Named points."""
    frames: Mapping[str, Any] = MappingProxyType({})
    """Named frames, of bodies that have them."""


class BodyPoint:
    """A point fixed in a body, at ``local`` in the body's own axes [m]."""

    name: str
    body: RigidBody
    local: Expression


class BodyFrame(BodyPoint):
    """A point with axes, fixed in a body."""
