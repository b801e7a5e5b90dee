"""Checks of planar elements."""

from __future__ import annotations

import dataclasses
from typing import Any

from dalembert.elements.pair import need_body, refuse_same_body
from dalembert.elements.planar.body import Body
from dalembert.errors import ModelError


class InPlane:
    """Mixin of planar elements, placed before their other bases.

    Raises
    ------
    ModelError
        A body or a point is spatial.
    """

    def __post_init__(self) -> None:
        me: Any = self
        for field in dataclasses.fields(me):
            value = getattr(me, field.name)
            if getattr(value, "dimension", 2) > 2:
                body = getattr(value, "body", value)
                raise ModelError(
                    f"{field.name} ({body.name}) is in space, and {type(self).__name__} is an "
                    "element of the plane; take one of dalembert.spatial",
                    me.name,
                )
        super().__post_init__()  # type: ignore[misc]


@dataclasses.dataclass(eq=False)
class BetweenAngles(InPlane):
    """Mixin of elements between the angles of two bodies, placed before their other bases.

    Parameters
    ----------
    body_i, body_j : first and second body
    """

    body_i: Body
    body_j: Body

    def __post_init__(self) -> None:
        me: Any = self
        self.body_i = need_body(self.body_i, me.name, "body_i")
        self.body_j = need_body(self.body_j, me.name, "body_j")
        refuse_same_body(self.body_i, self.body_j, me.name)
        for body in self.ends():
            if not body.rotates:
                raise ModelError(f"{body.name} is a particle and has no angle", me.name)
        super().__post_init__()

    def ends(self) -> tuple[Body, Body]:
        """First and second body."""
        return self.body_i, self.body_j
