"""What a field of a registered class holds, told from the types of its annotation.

The schema and the builder both ask here, so that a file is accepted exactly when it can be built.
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

from dalembert.analysis.events import Event, Events
from dalembert.analysis.structural.transient_equation import Rayleigh
from dalembert.design.reliability.distribution import Distribution
from dalembert.elements.base import Constraint, Rows, Vector
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw, Restitution
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.fem.node import Nodal
from dalembert.elements.flexible.body import Interfaces, Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law
from dalembert.elements.point import Point
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.model.coordinates import Coordinates
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.formulas.expression import Expression


class Quantity:
    """A number or a formula."""


class Quantities:
    """As many of them as the field says."""


Points = dict[str, Vector]
Names = tuple[str, ...]
Nodes = tuple[Nodal, ...]
Laws = tuple[Law, ...]
Places = tuple[Point, ...]
Interval = tuple[float, float]
Measured = str | Expression
CountOrTimes = int | Sequence[float]
ATTACHED = (BodyElement, Point, Frame, Nodal, Nodes)
"""What ``connect`` lists, where an element has it first of all."""
KNOWN: dict[Any, Any] = {
    kind: kind
    for kind in (
        *(bool, int, float, str, Path, Rows, Points, Names, Interval, Measured, Events),
        *(Constraint, Law, Laws, Places, ForceLaw, Curve, Rayleigh, StructuralResult, *ATTACHED),
        *(Frames, Orientation, CountOrTimes, Shape, NormalLaw, Friction),
        *(FlexibleStructure, Interfaces, Numbers, Distribution),
        *(Coordinates, Formulation, Stabilization, Integrator),
    )
} | {
    str | Event: Event,
    NormalLaw | Restitution: NormalLaw,
    int | Sequence[float] | np.ndarray: CountOrTimes,
}
"""What an annotation says → the type that files know it by; classes stand for those below them."""
NEEDED = (Law, Laws, Curve, Measured, Event)
"""Types that a file must give, although Python has a default for them."""


@dataclass(frozen=True)
class FileField:
    """A field of a class, as files see it.

    Attributes
    ----------
    holds : one of the types in ``KNOWN``, ``Quantity`` or ``Quantities``
    size : how many numbers or formulas
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
    def least(self) -> int:
        """How many are enough, where the rest follows; 0 if all are needed."""
        return self.field.metadata.get("least", 0)

    @property
    def is_needed(self) -> bool:
        """The file must give it."""
        default, factory = self.field.default, self.field.default_factory
        given = default is not dataclasses.MISSING or factory is not dataclasses.MISSING
        return self.holds in NEEDED or not given


@functools.cache
def fields_of(cls: type) -> list[FileField]:
    """The fields of a class that files can give; functions, only Python can.

    Raises
    ------
    TypeError
        A field that files cannot express: a slip in the class, not in a file.
    """
    if not dataclasses.is_dataclass(cls):
        return []
    hints = typing.get_type_hints(cls, include_extras=True)
    found = [(f, _held(f, hints[f.name])) for f in dataclasses.fields(cls) if f.init]
    return [FileField(cls, field, holds) for field, holds in found if holds is not Callable]


def _held(field: dataclasses.Field, hint: Any) -> Any:
    """The type that files know an annotation by."""
    if field.metadata.get("kind") == "quantity":
        return Quantities if field.metadata["size"] > 1 else Quantity
    if typing.get_origin(hint) is Annotated:
        hint = hint.__metadata__[0]
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        given = (a for a in typing.get_args(hint) if a is not types.NoneType)
        hint = functools.reduce(operator.or_, given)
    for base in hint.__mro__ if isinstance(hint, type) else [hint]:
        if base in KNOWN:
            return KNOWN[base]
    if typing.get_origin(hint) is Callable:
        return Callable
    raise TypeError(f"field {field.name!r}: no file form for the annotation {hint!r}")


def connected(cls: type) -> list[FileField]:
    """The bodies, points, frames and nodes that ``connect`` lists, in order."""
    return [f for f in fields_of(cls) if not f.field.metadata and f.holds in ATTACHED]


def written(cls: type, hidden: frozenset[str] = frozenset({"name"})) -> list[FileField]:
    """The fields that a file gives by their own key."""
    left_out = {f.name for f in connected(cls)} | hidden
    return [f for f in fields_of(cls) if f.name not in left_out]


def given_fields(
    cls: type, table: Any, located: Any, where: tuple[str, ...], value: Callable
) -> dict[str, Any]:
    """The fields that a table gives, as ``value(field, given, where)`` makes them."""
    made = {}
    for field in written(cls):
        if field.name in table.model_fields_set:
            here = (*where, field.name)
            with located(*here):
                made[field.name] = value(field, getattr(table, field.name), here)
    return made


FROM_FILE = {"Table": ("times", "values"), "SplineCurve": ("points",)}
"""Classes whose rows may come from a file of two columns, and the fields it fills."""
