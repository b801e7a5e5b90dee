"""Spatial nodes of finite elements."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.flexible.nodes import OwnNode
from dalembert.elements.spatial.body import Body, Particle


class Node(NodeBody, Body):
    """A node with rotation: a body whose mass may be that of the connected elements.

    It has the parameters of a ``Body``. Elements are free of stress at ``position`` and
    ``rotation``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial, structures
    >>> system = da.System("shaft")
    >>> a = system.add(spatial.Node("a", position=(0, 0, 0)))
    >>> b = system.add(spatial.Node("b", position=(2, 0, 0)))
    >>> steel, profile = structures.Material(2.6e11, poisson=0.3), structures.circle(0.02)
    >>> numbers = steel.of(structures.SpaceFrame) | profile.of(structures.SpaceFrame)
    >>> shaft = system.add(structures.SpaceFrame("shaft", a, b, **numbers))
    >>> clamp, torque = system.support(a), system.load(b, mx=5.0)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["b.bryant"][0, 0].item() * 1e11 * float(profile.torsion_constant), 4)  # M L
    10.0
    """

    @property
    def turned_by(self) -> ca.SX:
        rotation = self.initial[1]
        return ca.vec(self.axes if rotation is None else ca.mtimes(self.axes, rotation.matrix.T))


class PointNode(NodeBody, Particle):
    """A node without rotation: a particle whose mass may be that of the connected elements.

    It has the parameters of a ``Particle``. Elements are free of stress at ``position``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial, structures
    >>> system = da.System("stay")
    >>> a = system.add(spatial.PointNode("a", position=(0, 0, 0)))
    >>> b = system.add(spatial.PointNode("b", position=(0, 0, -2)))
    >>> stay = system.add(structures.Truss("stay", a, b, area=1e-4, modulus=2e11))
    >>> top, guide = system.support(a), system.support(b, ux=0, uy=0)
    >>> weight = system.load(b, fz=-1e3)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round((rest["b.z"].item() + 2) * 1e3, 4)  # -F L/(E A) [mm]
    -0.1
    """


class ElementNode(OwnNode, Node):
    """A node that belongs to an element."""


class ElementPointNode(OwnNode, PointNode):
    """A node without rotation that belongs to an element."""
