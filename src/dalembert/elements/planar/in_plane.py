"""Elements that hold on points and bodies of the plane only."""

from __future__ import annotations

import dataclasses
from typing import Any

from dalembert.elements.pair import need_body, refuse_same_body
from dalembert.elements.planar.body import Body
from dalembert.errors import ModelError


class InPlane:
    """An element of the plane, ahead of its other bases.

    Raises
    ------
    ModelError
        It is given a body or a point in space.
    """

    def __post_init__(self) -> None:
        me: Any = self
        for field in dataclasses.fields(me):
            held = getattr(me, field.name)
            if getattr(held, "dimension", 2) > 2:
                body = getattr(held, "body", held)
                raise ModelError(
                    f"{field.name} ({body.name}) is in space, and {type(self).__name__} is an "
                    "element of the plane; take one of dalembert.spatial",
                    me.name,
                )
        super().__post_init__()  # type: ignore[misc]


@dataclasses.dataclass(eq=False)
class BetweenAngles(InPlane):
    """An element that holds on the angles of two bodies, ahead of its other bases.

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
