"""Planar nodes of finite elements."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.flexible.nodes import OwnNode
from dalembert.elements.planar.body import Body, Particle


class Node(NodeBody, Body):
    """A node with rotation: a body whose mass may be that of the connected elements.

    It has the parameters of a ``Body``. Elements are free of stress at ``position`` and ``angle``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar, structures
    >>> system = da.System("beam in a mechanism")
    >>> a, b = (system.add(planar.Node(name, position=(x, 0))) for name, x in (("a", 0), ("b", 2)))
    >>> numbers = dict(area=1e-3, second_moment=1e-7, modulus=2e11)
    >>> beam = system.add(structures.Frame("beam", a, b, **numbers))
    >>> clamp, tip = system.support(a), system.load(b, fy=-30)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["b.y"].item() * 1e3, 2)  # -F L³/(3 E I) [mm], slightly less at large rotation
    -4.0
    """

    @property
    def turned_by(self) -> ca.SX:
        angle = self.initial[1]
        return self.pose[2] - (0 if angle is None else angle.sx)


class PointNode(NodeBody, Particle):
    """A node without rotation: a particle whose mass may be that of the connected elements.

    It has the parameters of a ``Particle``. Elements are free of stress at ``position``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar, structures
    >>> system = da.System("bar in a mechanism")
    >>> a = system.add(planar.PointNode("a", position=(0, 0)))
    >>> b = system.add(planar.PointNode("b", position=(2, 0)))
    >>> bar = system.add(structures.Truss("bar", a, b, area=1e-4, modulus=2e11))
    >>> wall, rail, pull = system.support(a), system.support(b, uy=0), system.load(b, fx=1e3)
    >>> rest = da.solve_equilibrium(system.build())
    >>> round((rest["b.x"].item() - 2) * 1e3, 4)  # F L/(E A) [mm]
    0.1
    """


class ElementNode(OwnNode, Node):
    """A node that belongs to an element."""


class ElementPointNode(OwnNode, PointNode):
    """A node without rotation that belongs to an element."""
