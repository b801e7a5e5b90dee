"""Nodes that are bodies, on which joints and forces of a mechanism hold."""

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
    """A node of finite elements, ahead of the body that it is in the plane or in space.

    Elements are free of stress where its ``position`` says, and turned as its ``angle`` or
    ``rotation`` does.
    """

    turning: ca.SX
    spin: ca.SX
    turned: Callable[[ca.SX], ca.SX]

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
        ModelError
            It is a point, which does not turn.
        """
        body: Any = self
        moved = self.place - self.natural
        if not turns:
            return moved
        if not body.rotates:
            kind = "planar.Node" if self.dimension == 2 else "spatial.Node"
            raise ModelError(f"turns its node {self.name}, a point; take {kind}", entity)
        return ca.vertcat(moved, self.turned_by)

    @property
    def turned_by(self) -> ca.SX:
        """How it has turned: the angle in the plane, the entries of the matrix in space."""
        raise NotImplementedError

    def look(self) -> list[Look]:
        body: BodyElement = self  # type: ignore[assignment]
        return [Ball(body.center)]
