"""Nodes that are bodies, on which joints and forces of a mechanism hold."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.look import Ball
from dalembert.errors import ModelError, UnsupportedError


class NodeBody(Nodal):
    """A node of finite elements, ahead of the body that it is in the plane or in space.

    Elements are free of stress where its ``position`` says, and turned by its ``angle``.
    """

    @property
    def natural(self) -> ca.SX:  # type: ignore[override]
        """Where elements are free of stress.

        Raises
        ------
        ModelError
            Nobody said so.
        """
        body: Any = self
        given = body.initial[0]
        if given is None:
            raise ModelError("needs a position, where its elements are free of stress", self.name)
        return given.sx

    @property
    def place(self) -> ca.SX:
        """Where it is."""
        body: Any = self
        return body.mass_center

    def displaced(self, turns: bool, entity: str) -> ca.SX:
        """Its displacement, and its rotation for an element that turns it.

        Raises
        ------
        ModelError, UnsupportedError
            It does not turn; or in space, where no element turns bodies.
        """
        body: Any = self
        moved = self.place - self.natural
        if not turns:
            return moved
        if self.dimension == 3:
            raise UnsupportedError(
                f"{entity}: elements that turn nodes in space are not part of mechanisms yet; use "
                "spatial.Beam"
            )
        if not body.rotates:
            raise ModelError(f"turns its node {self.name}, a point; take planar.Node", entity)
        angle = body.initial[1]
        return ca.vertcat(moved, body.pose[2] - (0 if angle is None else angle.sx))

    def look(self) -> list[Look]:
        body: BodyElement = self  # type: ignore[assignment]
        return [Ball(body.center)]
