"""File types of the fields of registered classes, derived from their annotations.

The schema and the builder both use them, so that a file is accepted exactly when it can be built.
"""

from __future__ import annotations

import dataclasses
import functools
import operator
import types
import typing
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel

from dalembert.analysis.events import Event, Events
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.design.reliability.distribution import Distribution
from dalembert.elements.base import Constraint, Rows, Vector
from dalembert.elements.blocks.block import Coefficients
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.pairs import Pair
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.flexible.body import Interfaces, Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law
from dalembert.elements.point import Point
from dalembert.elements.rotation import Orientation
from dalembert.elements.spatial.geometry import Geometry
from dalembert.elements.springs import ForceLaw
from dalembert.elements.stateful import SIGNAL
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.model.graph.coordinates import Coordinates
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.formulas.expression import Expression


class Quantity:
    """A number or a formula."""


class Quantities:
    """Several numbers or formulas; the field states how many."""


Points = dict[str, Vector]
Names = tuple[str, ...]
Geometries = Sequence[Geometry]
Nodes = tuple[Nodal, ...]
Laws = tuple[Law, ...]
Places = tuple[Point, ...]
Shapes = tuple[Shape, ...] | dict[str, tuple[Shape, ...]]
Pairs = tuple[Pair, ...]
Interval = tuple[float, float]
Frequencies = Sequence[float]
Amplitudes = dict[str, complex]
Densities = dict[str, object]
Measured = str | Expression
CountOrTimes = int | Sequence[float]
CONNECTABLE = (BodyElement, Point, Frame, Nodal, Nodes)
"""Types of the leading fields that ``connect`` lists."""
FILE_TYPES: dict[Any, Any] = {
    kind: kind
    for kind in (
        *(bool, int, float, str, Path, Rows, Points, Names, Interval, Measured, Events),
        *(Frequencies, Amplitudes, Densities),
        *(Constraint, Law, Laws, Places, ForceLaw, Curve, Rayleigh, StructuralResult, *CONNECTABLE),
        *(
            Frames,
            Orientation,
            CountOrTimes,
            Coefficients,
            Shape,
            Shapes,
            Pairs,
            NormalLaw,
            Friction,
            Geometries,
        ),
        *(Beam, FlexibleStructure, Interfaces, Numbers, Distribution),
        *(Coordinates, Formulation, Stabilization, Integrator, ContactScheme, ContactSolver),
    )
} | {
    str | Event: Event,
    NormalLaw | Restitution: NormalLaw,
    int | Sequence[float] | np.ndarray: CountOrTimes,
}
"""Annotation → file type; a class also stands for its subclasses."""
REQUIRED = (Law, Laws, Curve, Measured, Event)
"""Types that a file must give, although the Python field has a default."""


@dataclass(frozen=True)
class FileField:
    """A field of a class together with its file type.

    Attributes
    ----------
    holds : one of the types in ``FILE_TYPES``, ``Quantity`` or ``Quantities``
    size : number of entries of ``Quantities``
    """

    owner: type
    field: dataclasses.Field
    holds: Any

    @property
    def name(self) -> str:
        return self.field.name

    @property
    def size(self) -> int:
        return self.field.metadata.get("size", 1)

    @property
    def minimum_size(self) -> int:
        """Minimum number of entries if the remaining ones have defaults; 0 if all are needed."""
        return self.field.metadata.get("minimum_size", 0)

    @property
    def is_signal(self) -> bool:
        """Whether it is an input, which may depend on elements that follow."""
        return SIGNAL in self.field.metadata

    @property
    def is_needed(self) -> bool:
        """Whether the file must give the field."""
        default, factory = self.field.default, self.field.default_factory
        has_default = default is not dataclasses.MISSING or factory is not dataclasses.MISSING
        return self.holds in REQUIRED or not has_default


@functools.cache
def fields_of(cls: type) -> list[FileField]:
    """Fields of a class that files can give; fields that hold functions are left out.

    Raises
    ------
    TypeError
        An annotation without a file type: an error of the class, not of a file.
    """
    if not dataclasses.is_dataclass(cls):
        return []
    hints = typing.get_type_hints(cls, include_extras=True)
    typed = [(f, _file_type(f, hints[f.name])) for f in dataclasses.fields(cls) if f.init]
    return [FileField(cls, field, holds) for field, holds in typed if holds is not Callable]


def _file_type(field: dataclasses.Field, hint: Any) -> Any:
    """File type of an annotation."""
    if field.metadata.get("kind") == "quantity":
        return Quantities if field.metadata["size"] > 1 else Quantity
    if typing.get_origin(hint) is Annotated:
        hint = hint.__metadata__[0]
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        members = (a for a in typing.get_args(hint) if a is not types.NoneType)
        hint = functools.reduce(operator.or_, members)
    for base in hint.__mro__ if isinstance(hint, type) else [hint]:
        if base in FILE_TYPES:
            return FILE_TYPES[base]
    if typing.get_origin(hint) is Callable:
        return Callable
    raise TypeError(f"field {field.name!r}: no file form for the annotation {hint!r}")


def connected_fields(cls: type) -> list[FileField]:
    """Fields listed by ``connect``, in order: bodies, points, frames and nodes."""
    return [f for f in fields_of(cls) if not f.field.metadata and f.holds in CONNECTABLE]


def keyed_fields(cls: type, hidden: frozenset[str] = frozenset({"name"})) -> list[FileField]:
    """Fields that a file gives by their own key."""
    excluded = {f.name for f in connected_fields(cls)} | hidden
    return [f for f in fields_of(cls) if f.name not in excluded]


def read_fields(
    cls: type,
    table: BaseModel,
    located: Any,
    where: tuple[str | int, ...],
    value: Callable,
    chosen: Callable[[FileField], bool] = lambda field: True,
) -> dict[str, Any]:
    """Values of the chosen fields in a table, converted by ``value(field, entry, where)``."""
    values = {}
    for field in keyed_fields(cls):
        if field.name in table.model_fields_set and chosen(field):
            here = (*where, field.name)
            with located(*here):
                values[field.name] = value(field, getattr(table, field.name), here)
    return values


FROM_FILE: dict[str, dict[str, tuple[str, ...]]] = {
    "Table": {"times": ("s",), "values": ("",)},
    "SplineCurve": {"points": ("m", "m")},
}
"""Classes whose rows may come from a file of two columns → fields, with units of their columns."""
