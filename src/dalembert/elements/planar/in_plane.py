"""Elements that hold on points and bodies of the plane only."""

from __future__ import annotations

import dataclasses
from typing import Any

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
