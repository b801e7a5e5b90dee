"""What bodies of the plane and of space share: points, measures and the frame they carry."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

import casadi as ca

from dalembert.elements.base import Element, ForceElement, Vector
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.frame import Frame
from dalembert.elements.named import Named
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import listed, nearest, unknown


class Axes(TypedDict, total=False):
    """How the axes of a frame are given."""

    axis: Vector | None
    x: Vector | None
    axes: Any
    rotation: Any


class BodyElement(Element, Coordinates):
    """A body with named points; ``velocity``, ``x`` … become its measures once it is made.

    To write a new kind, give ``locate`` and ``turned``, the wrench of a generalised force, and in
    ``__post_init__`` its coordinates, their initial values and its measures.
    """

    rotates = True
    node = False
    """A node of an element that is drawn by this."""
    tangible = True
    """Whether its frame is fixed in its matter, so that joints can hold on it."""
    dimension = 2
    """Number of coordinates of its points."""
    initial_fields: tuple[str, ...] = ("position", "velocity")
    """Quantities that are initial values, in the order in which ``initial`` keeps them."""

    mass: Expression
    mass_center: ca.SX
    initial: tuple[Any, ...]
    points: dict[str, Point]
    frames: dict[str, Frame]
    _measures: dict[str, tuple[ca.SX, str]]

    @property
    def shown(self) -> str:
        """Its name in drawings."""
        return self.name

    def named(self, field: str) -> dict[str, Any]:
        """Entries of a field that maps names to places; none where it is left out.

        Raises
        ------
        ModelError
            No mapping of names.
        """
        entries = getattr(self, field) or {}
        if not isinstance(entries, Mapping) or not all(isinstance(key, str) for key in entries):
            told = f"expected a mapping of names to places, got {entries!r:.60}"
            raise ModelError(told, f"{self.name}.{field}")
        return dict(entries)

    # where things on it are -------------------------------------------------------------------
    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a place in the body frame."""
        raise NotImplementedError

    def turned(self, local: ca.SX) -> ca.SX:
        """Inertial components of a vector in the body frame."""
        raise NotImplementedError

    @property
    def orientation(self) -> ca.SX:
        """(4,) Euler parameters."""
        raise NotImplementedError

    @property
    def turning(self) -> ca.SX:
        """(3,) angular velocity in inertial axes."""
        raise NotImplementedError

    def velocity_at(self, place: ca.SX) -> ca.SX:
        """(3,) velocity of the matter of the body at an inertial place."""
        raise NotImplementedError

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Force, moment and where it is taken, of a generalised force by speeds; inertial axes."""
        raise NotImplementedError

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        return [(self.mass_center, self.mass.sx)]

    def undeformed(self, local: ca.SX) -> ca.SX:
        """Where a place is in the frame of the owner's coordinates while nothing is deformed."""
        return local

    def own_forces(self) -> list[ForceElement]:
        """Forces within it that it brings along."""
        return []

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            own = self.__dict__
            if name.startswith("_") or "points" not in own:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            for kind in ("point", "frame"):
                if name in own[f"{kind}s"]:
                    raise AttributeError(
                        f"{own['name']} has a {kind} {name!r}: write {kind}({name!r})"
                    )
            known = [*own["points"], *own["frames"], *own["_measures"]]
            raise AttributeError(
                f"{own['name']} has no point or measure {name!r}{nearest(name, known)}; "
                f"points: {listed([*own['points'], *own['frames']])}"
            )

    # names on it ------------------------------------------------------------------------------
    def declare(self, named: dict[str, tuple[ca.SX, str]], given: Mapping[str, Vector]) -> None:
        """Publish measures as attributes, and name the points given."""
        self._measures = named
        for name, (sx, unit) in named.items():
            setattr(self, name, Expression(sx, f"{self.name}.{name}", unit))
        self.points, self.frames = Named(self.name, "point"), Named(self.name, "frame")
        for name, local in given.items():
            self.add_point(name, local)

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        twist, (mass, _) = self.twist, self.inertia_by_speeds()
        kinetic = ca.mtimes([twist.T, mass, twist]) / 2
        return {**self._measures, "kinetic_energy": (kinetic, "J")}

    def add_point(self, name: str, local: Vector) -> Point:
        """Name a point of the body, so that results list it."""
        self._claim("point", name)
        self.points[name] = Point(self, local, name)
        return self.points[name]

    def add_frame(self, name: str, place: Vector = (0.0, 0.0, 0.0), **axes: Unpack[Axes]) -> Frame:
        """Name a frame of the body; it takes what ``frame`` takes."""
        self._claim("frame", name)
        self.frames[name] = Frame(self, place, **axes, name=name)
        return self.frames[name]

    def _claim(self, kind: str, name: str) -> None:
        if not isinstance(name, str) or not name.isidentifier():
            raise ModelError(f"{kind} name {name!r} is not an identifier", self.name)
        if name in self._measures or name in self.points or name in self.frames:
            raise ModelError(f"{kind} name {name!r} is taken; choose another", self.name)

    @property
    def places(self) -> dict[str, Point]:
        """Named points and frames."""
        return {**self.points, **self.frames}

    def point(self, x, y=None, z=None) -> Point:
        """Point at body coordinates [m], or the named point ``point("P")``."""
        if y is None:
            if x not in self.points:
                raise ModelError(unknown("point", x, self.points), self.name)
            return self.points[x]
        given = (x, y) if z is None else (x, y, z)
        if len(given) < self.dimension:
            raise ModelError("a point of a body in space has three coordinates", self.name)
        return Point(self, given)

    def frame(self, place: Vector | str = (0.0, 0.0, 0.0), **axes: Unpack[Axes]) -> Frame:
        """Frame fixed in the body; its z axis is the axis of a joint.

        Parameters
        ----------
        place : (3,) its origin in the body frame [m], or the name of a frame
        axis : (3,) its z axis; x and y are chosen
        x : (3,) its x axis, beside ``axis``
        axes : (3, 3) its axes as columns
        rotation : its orientation, as that of a body
        """
        if isinstance(place, str):
            if place not in self.frames:
                raise ModelError(unknown("frame", place, self.frames), self.name)
            return self.frames[place]
        return Frame(self, place, **axes)

    @property
    def center(self) -> Point:
        """The origin of the body frame."""
        return Point(self, (0.0,) * self.dimension)

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        given = dict(zip(self.initial_fields, self.initial, strict=True))
        found = []
        for field, meta in self.quantities():
            value = given[field] if field in given else getattr(self, field)
            if isinstance(value, Expression):
                found.append((f"{self.name}.{field}", value, meta))
        where = {"unit": "m", "minimum": -math.inf, "above": -math.inf}
        return found + [(p.name, p.local, where) for p in self.places.values()]

    def parts(self) -> list[Coordinates]:
        return [self]
