"""Nodes that are bodies of a mechanism."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.look import Ball
from dalembert.errors import ModelError


class NodeBody(Nodal):
    """Mixin of bodies that are nodes of finite elements, placed before the body class.

    Elements are free of stress at its ``position`` and its ``angle`` or ``rotation``.
    """

    turning: ca.SX
    spin: ca.SX
    turned: Callable[[ca.SX], ca.SX]

    @property
    def natural(self) -> ca.SX:  # type: ignore[override]
        """Stress-free position.

        Raises
        ------
        ModelError
            The body has no ``position``.
        """
        body: Any = self
        position = body.initial[0]
        if position is None:
            raise ModelError("needs a position, where its elements are free of stress", self.name)
        return position.sx

    @property
    def place(self) -> ca.SX:
        """Current position."""
        body: Any = self
        return body.mass_center

    def displaced(self, turns: bool, entity: str) -> ca.SX:
        """Its displacement, followed by its rotation for elements with rotations.

        Raises
        ------
        ModelError
            It is a particle, which has no rotation.
        """
        body: Any = self
        displacement = self.place - self.natural
        if not turns:
            return displacement
        if not body.rotates:
            kind = "planar.Node" if self.dimension == 2 else "spatial.Node"
            raise ModelError(f"turns its node {self.name}, a point; take {kind}", entity)
        return ca.vertcat(displacement, self.turned_by)

    @property
    def turned_by(self) -> ca.SX:
        """Its rotation: the angle in the plane, the entries of the matrix in space."""
        raise NotImplementedError

    def look(self) -> list[Look]:
        body: BodyElement = self  # type: ignore[assignment]
        return [Ball(body.center)]
