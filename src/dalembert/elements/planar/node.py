"""Nodes of finite elements in the plane."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.fem.node_bodies import NodeBody
from dalembert.elements.flexible.nodes import OwnNode
from dalembert.elements.planar.body import Body, Particle


class Node(NodeBody, Body):
    """A node that turns: a body whose mass may be that of the elements at it.

    It takes what a ``Body`` takes. Elements are free of stress where ``position`` says, and turned
    by ``angle``.
    """

    @property
    def turned_by(self) -> ca.SX:
        angle = self.initial[1]
        return self.pose[2] - (0 if angle is None else angle.sx)


class PointNode(NodeBody, Particle):
    """A node that does not turn: a particle whose mass may be that of the elements at it.

    It takes what a ``Particle`` takes. Elements are free of stress where ``position`` says.
    """


class ElementNode(OwnNode, Node):
    """A node that an element brings along."""


class ElementPointNode(OwnNode, PointNode):
    """A node that an element brings along, and that does not turn."""
