"""Nodes of finite elements in space."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.fem.node_bodies import NodeBody
from dalembert.elements.flexible.nodes import OwnNode
from dalembert.elements.spatial.body import Body, Particle


class Node(NodeBody, Body):
    """A node that turns: a body whose mass may be that of the elements at it.

    It takes what a ``Body`` takes. Elements are free of stress where ``position`` says, and turned
    by ``rotation``.
    """

    @property
    def turned_by(self) -> ca.SX:
        rotation = self.initial[1]
        return ca.vec(self.axes if rotation is None else ca.mtimes(self.axes, rotation.matrix.T))


class PointNode(NodeBody, Particle):
    """A node that does not turn: a particle whose mass may be that of the elements at it.

    It takes what a ``Particle`` takes. Elements are free of stress where ``position`` says.
    """


class ElementNode(OwnNode, Node):
    """A node that an element brings along."""


class ElementPointNode(OwnNode, PointNode):
    """A node that an element brings along, and that does not turn."""
