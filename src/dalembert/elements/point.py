"""Points fixed in bodies."""

from __future__ import annotations

from typing import Any, Protocol

import casadi as ca

from dalembert.elements.base import Vector
from dalembert.elements.coordinates import rate_of, second_rate_of
from dalembert.elements.representation import brief, short, spot
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.text.arguments import CheckedArguments

AXES = "xyz"


class Carrier(Protocol):
    """A body that points and frames are fixed in."""

    name: str
    dimension: int

    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point in its frame."""

    def turned(self, local: ca.SX) -> ca.SX:
        """Inertial components of a vector in its frame."""


class Point(CheckedArguments):
    """A point fixed in a body, in the plane or in space.

    Parameters
    ----------
    body : the body
    local : (2,) or (3,) coordinates in the body frame [m]; a planar body accepts three for a point
        outside its plane
    name : str, optional

    Examples
    --------
    >>> from dalembert import planar
    >>> plate = planar.Body("plate", points={"corner": (0.2, 0.1)})
    >>> corner = plate.point("corner")
    >>> corner.name, corner.y.name, corner.y.unit
    ('plate.corner', 'plate.corner.y', 'm')
    >>> hole = planar.Point(plate, (0.05, 0.0), "hole")
    >>> hole.name, hole.dimension
    ('plate.hole', 2)
    """

    def __init__(self, body: Carrier, local: Vector, name: str = ""):
        self.body: Any = body
        self.name = f"{body.name}.{name}" if name else ""
        entity = self.name or f"point of {body.name}"
        self.local = as_expression(local, entity, "m", _count(local, body.dimension))

    def __repr__(self) -> str:
        coordinates = short(self.local)
        kind = type(self).__name__
        return brief(kind, self.name, [coordinates]) if self.name else f"<{kind} {spot(self)}>"

    @property
    def dimension(self) -> int:
        """Number of its coordinates."""
        return int(self.local.sx.numel())

    def _measure(self, sx: ca.SX, name: str, unit: str) -> Expression:
        return Expression(sx, f"{self.name}.{name}" if self.name else "", unit)

    @property
    def arm(self) -> ca.SX:
        """Vector from the origin of the body frame to the point, inertial axes."""
        return self.body.turned(self.local.sx)

    @property
    def undeformed(self) -> ca.SX:
        """Its undeformed position in the frame of the body."""
        return self.body.undeformed(self.local.sx)

    @property
    def position(self) -> Expression:
        return self._measure(self.body.locate(self.local.sx), "position", "m")

    @property
    def velocity(self) -> Expression:
        rate = rate_of(self.position.sx, [self.body], t.sx)
        return self._measure(rate, "velocity", "m/s")

    @property
    def acceleration(self) -> Expression:
        second = second_rate_of(self.position.sx, [self.body], t.sx)
        return self._measure(second, "acceleration", "m/s^2")

    @property
    def x(self) -> Expression:
        return self._measure(self.position.sx[0], "x", "m")

    @property
    def y(self) -> Expression:
        return self._measure(self.position.sx[1], "y", "m")

    @property
    def z(self) -> Expression:
        """Third coordinate.

        Raises
        ------
        ModelError
            The point is planar.
        """
        if self.dimension < 3:
            raise ModelError("a planar point has no z", self.name or self.body.name)
        return self._measure(self.position.sx[2], "z", "m")

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        position, velocity = self.position.sx, self.velocity.sx
        acceleration = self.acceleration.sx
        return {
            "position": (position, "m"),
            "velocity": (velocity, "m/s"),
            "acceleration": (acceleration, "m/s^2"),
            **components("", position, "m"),
            **components("v", velocity, "m/s"),
            **components("a", acceleration, "m/s^2"),
            "speed": (ca.sqrt(ca.sumsqr(velocity)), "m/s"),
        }


def components(letter: str, vector: ca.SX, unit: str) -> dict[str, tuple[ca.SX, str]]:
    """Components of a vector as measures: ``x``, or ``vx`` with the letter v."""
    return {f"{letter}{AXES[k]}": (vector[k], unit) for k in range(vector.numel())}


def _count(local: Vector, usual: int) -> int:
    """Number of coordinates of a point; ``usual`` if it cannot be determined."""
    sx = local.sx if isinstance(local, Expression) else local
    size = sx.numel() if isinstance(sx, ca.SX) else _length(sx)
    return size if size in (2, 3) and size >= usual else usual


def _length(values: Vector) -> int:
    try:
        return len(values)
    except TypeError:
        return 0
