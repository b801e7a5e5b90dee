"""Nodes in space."""

from __future__ import annotations

from dalembert.elements.flexible.nodes import NodeBody
from dalembert.elements.spatial.body import Body, Particle


class Node(NodeBody, Body):
    """A node that turns."""


class PointNode(NodeBody, Particle):
    """A node that does not."""
