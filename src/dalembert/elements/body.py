"""Common base of planar and spatial bodies: named points, frames and measures."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypedDict, TypeVar, Unpack

import casadi as ca

from dalembert.elements.base import Element, ForceElement, Vector
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.errors import ModelError, UnknownNameError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import check_length, listed, nearest, unknown

V = TypeVar("V")


class Named(dict[str, V]):
    """Named parts of an owner; an unknown name raises an error with the nearest one.

    Parameters
    ----------
    owner : name of the owner
    kind : kind of the parts, as in messages
    """

    def __init__(self, owner: str, kind: str):
        super().__init__()
        self.owner, self.kind = owner, kind

    def __missing__(self, name: str) -> V:
        raise UnknownNameError(f"{self.owner}: {unknown(self.kind, name, self)}", name)


class Axes(TypedDict, total=False):
    """Keywords that specify the axes of a frame."""

    axis: Vector | None
    x: Vector | None
    axes: Any
    rotation: Any


class BodyElement(Element, Coordinates):
    """A body with named points; its measures, such as ``velocity`` and ``x``, are attributes.

    A new kind implements ``locate`` and ``turned``, the wrench of a generalised force, and in
    ``__post_init__`` its coordinates, their initial values and its measures.
    """

    rotates = True
    node = False
    """Whether it is a node of an element, which draws it."""
    has_material_frame = True
    """Whether its frame is fixed in its material, so that joints can be attached to it."""
    dimension = 2
    """Number of coordinates of its points."""
    initial_fields: tuple[str, ...] = ("position", "velocity")
    """Quantities that are initial values, in the order of ``initial``."""

    mass: Expression
    mass_center: ca.SX
    initial: tuple[Any, ...]
    points: dict[str, Point]
    frames: dict[str, Frame]
    _measures: dict[str, tuple[ca.SX, str]]

    @property
    def display_name(self) -> str:
        """Its name in pictures."""
        return self.name

    def named(self, field: str) -> dict[str, Any]:
        """Entries of a field that maps names to places; empty if it is omitted.

        Raises
        ------
        ModelError
            The field is not a mapping of names.
        """
        entries = getattr(self, field) or {}
        if not isinstance(entries, Mapping) or not all(isinstance(key, str) for key in entries):
            message = f"expected a mapping of names to places, got {entries!r:.60}"
            raise ModelError(message, f"{self.name}.{field}")
        return dict(entries)

    # geometry ---------------------------------------------------------------------------------
    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point in the body frame."""
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
        """(3,) velocity of the material of the body at an inertial position."""
        raise NotImplementedError

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        """Force, moment and reference point of a generalised force by speeds; inertial axes."""
        raise NotImplementedError

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        return [(self.mass_center, self.mass.sx)]

    def undeformed(self, local: ca.SX) -> ca.SX:
        """Undeformed position of a point in the frame of the owner's coordinates."""
        return local

    def own_forces(self) -> list[ForceElement]:
        """Internal forces of the body."""
        return []

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            attributes = self.__dict__
            if name.startswith("_") or "points" not in attributes:
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            for kind in ("point", "frame"):
                if name in attributes[f"{kind}s"]:
                    raise AttributeError(
                        f"{attributes['name']} has a {kind} {name!r}: write {kind}({name!r})"
                    )
            known = [*attributes["points"], *attributes["frames"], *attributes["_measures"]]
            raise AttributeError(
                f"{attributes['name']} has no point or measure {name!r}{nearest(name, known)}; "
                f"points: {listed([*attributes['points'], *attributes['frames']])}"
            )

    # named points and measures ----------------------------------------------------------------
    def declare(self, measures: dict[str, tuple[ca.SX, str]], points: Mapping[str, Vector]) -> None:
        """Publish measures as attributes and add named points."""
        self._measures = measures
        for name, (sx, unit) in measures.items():
            setattr(self, name, Expression(sx, f"{self.name}.{name}", unit))
        self.points, self.frames = Named(self.name, "point"), Named(self.name, "frame")
        for name, local in points.items():
            self.add_point(name, local)

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        twist, (mass, _) = self.twist, self.inertia_by_speeds()
        kinetic = ca.mtimes([twist.T, mass, twist]) / 2
        return {**self._measures, "kinetic_energy": (kinetic, "J")}

    def add_point(self, name: str, local: Vector) -> Point:
        """Add a named point to the body; results list it."""
        self._claim("point", name)
        self.points[name] = Point(self, local, name)
        return self.points[name]

    def add_frame(self, name: str, place: Vector = (0.0, 0.0, 0.0), **axes: Unpack[Axes]) -> Frame:
        """Add a named frame to the body, with the arguments of ``frame``."""
        self._claim("frame", name)
        self.frames[name] = Frame(self, place, **axes, name=name)
        return self.frames[name]

    def _claim(self, kind: str, name: str) -> None:
        if not isinstance(name, str) or not name.isidentifier():
            raise ModelError(f"{kind} name {name!r} is not an identifier", self.name)
        check_length(name, self.name)
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
        coordinates = (x, y) if z is None else (x, y, z)
        if len(coordinates) < self.dimension:
            raise ModelError("a point of a spatial body has three coordinates", self.name)
        return Point(self, coordinates)

    def frame(self, place: Vector | str = (0.0, 0.0, 0.0), **axes: Unpack[Axes]) -> Frame:
        """Frame fixed in the body; its z axis is the axis of a joint.

        Parameters
        ----------
        place : (3,) its origin in the body frame [m], or the name of a frame
        axis : (3,) its z axis; x and y are chosen
        x : (3,) x axis, in addition to ``axis``
        axes : (3, 3) its axes as columns
        rotation : its orientation, specified like that of a body
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
        initial = dict(zip(self.initial_fields, self.initial, strict=True))
        quantities = []
        for field, meta in self.quantities():
            value = initial[field] if field in initial else getattr(self, field)
            if isinstance(value, Expression):
                quantities.append((f"{self.name}.{field}", value, meta))
        limits = {"unit": "m", "minimum": -math.inf, "above": -math.inf}
        return quantities + [(p.name, p.local, limits) for p in self.places.values()]

    def parts(self) -> list[Coordinates]:
        return [self]
