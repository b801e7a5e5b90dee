"""Bodies, joints, drivers and forces of a model file."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.elements.base import Constraint, ForceElement, Rows
from dalembert.elements.blocks.block import Coefficients
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.flexible.body import Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law
from dalembert.elements.point import Point
from dalembert.elements.registry import (
    BLOCKS,
    CONTACT_LAWS,
    CONTACT_PAIRS,
    FRICTIONS,
    SHAPES,
    elements_of,
)
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.elements.user_constraint import UserConstraint
from dalembert.errors import ModelError
from dalembert.io.declarations import (
    declare_history,
    ordered,
)
from dalembert.io.documents import Document
from dalembert.io.fields import (
    FileField,
    Geometries,
    Pairs,
    Places,
    Points,
    Quantities,
    Quantity,
    Shapes,
    connected_fields,
    keyed_fields,
    read_fields,
)
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.laws_and_curves import LawReader, construct
from dalembert.io.location import Located
from dalembert.io.orientations import read_frame, read_geometry, read_orientation
from dalembert.io.references import References
from dalembert.io.values import short_repr
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import Expression

INPUTS = " inputs"
"""Ending of the node of the inputs of an element in the graph of dependence."""


class MechanismElements:
    """Reader of the elements of a mechanism.

    Parameters
    ----------
    document : Document
    system : builder that gets the elements
    located : for messages
    formulas : reads numbers
    structure : returns the model of finite elements in another file
    """

    def __init__(
        self,
        document: Document,
        system: System,
        located: Located,
        formulas: Formulas,
        structure: Callable[[Path], StructuralModel],
    ):
        self.document, self.system = document, system
        self.located, self.formulas, self.structure = located, formulas, structure
        self.folder: Path = located.source.parent
        self.references = References(document, system, formulas)
        self.laws = LawReader(located, formulas)

    def histories(self) -> None:
        """Declare unknown functions of time, for forces and drivers."""
        tables: dict[str, Any] = self.document.histories
        for name, table in tables.items():
            with self.located("histories", name):
                declared = declare_history(self.system, name, table)
            self.formulas.histories[name] = declared.value
            self.laws.histories[name] = declared.law

    def ground(self) -> None:
        """Add points and frames of the ground."""
        for name, at in self.document.ground.points.items():
            with self.located("ground", "points", name):
                self.system.ground.add_point(name, self.vector(at, Scope.PARAMETERS))
        for name, frame in self.document.ground.frames.items():
            with self.located("ground", "frames", name):
                self.system.ground.add_frame(name, **read_frame(frame, self.formulas))

    def section(self, name: str) -> None:
        """Add the elements of a section."""
        for element in getattr(self.document, name):
            self.add(name, element)

    def vector(self, entries: list, scope: Scope) -> list:
        return [self.formulas.read(entry, scope) for entry in entries]

    def row(self, entry: Any, where: tuple[str | int, ...]) -> list:
        if not isinstance(entry, list):
            with self.located(*where):
                raise ModelError(f"expected a list of numbers, got {short_repr(entry)}")
        return self.vector(entry, Scope.PARAMETERS)

    def blocks(self) -> None:
        """Add blocks without their inputs, which may be formulas of all other elements."""
        for name in self.document.blocks:
            self.add("blocks", name)

    def forces_and_inputs(self) -> None:
        """Add forces, then inputs of blocks and forces, each after those that it depends on."""
        tables: dict[str, tuple[str, Any]] = {}
        for section in ("blocks", "forces"):
            tables |= {n: (section, t) for n, t in getattr(self.document, section).items()}
        with self.located():
            for name, part in self.order(tables):
                section, table = tables[name]
                if part == INPUTS:
                    self._connect(section, name, table)
                elif section == "forces":
                    self.add("forces", name)

    def order(self, tables: dict[str, tuple[str, Any]]) -> list[tuple[str, str]]:
        """Names of forces and blocks, and which part of them, in order of dependence.

        A state of an element needs only the element, other measures its inputs, too.
        """
        names = "|".join(map(re.escape, tables)) or "(?!)"
        used = re.compile(rf"(?<![\w.])({names})\b(?:\.(\w+))?")
        needs: dict[str, set[str]] = {}
        inputs = {name: self._inputs(*entry) for name, entry in tables.items()}

        def needed(texts: list[str]) -> set[str]:
            uses = {match.groups() for text in texts for match in used.finditer(text)}
            return {
                other + INPUTS
                if inputs[other] and quantity not in self._states(other, *tables[other])
                else other
                for other, quantity in uses
            }

        for name, (section, table) in tables.items():
            cls = self.class_of(section, table)
            needs[name] = needed(_formula_texts(cls, table, inputs[name], False))
            if inputs[name]:
                needs[name + INPUTS] = {name} | needed(_formula_texts(cls, table, inputs[name]))
        order = ordered({name: section for name, (section, _) in tables.items()}, needs)
        return [(n.removesuffix(INPUTS), INPUTS if n.endswith(INPUTS) else "") for n in order]

    def class_of(self, section: str, table: Any) -> Any:
        """Class of an element."""
        space = self.document.space
        classes = BLOCKS if section == "blocks" else elements_of(space, section)
        return classes[table.type]

    def _inputs(self, section: str, table: Any) -> list[str]:
        """Inputs of an element in the file."""
        fields = keyed_fields(self.class_of(section, table))
        return [f.name for f in fields if f.is_signal and f.name in table.model_fields_set]

    def _states(self, name: str, section: str, table: Any) -> tuple[str, ...]:
        """Names of the states of an element."""
        if section == "blocks":
            return self.system.elements[name].states.coordinate_names  # type: ignore[attr-defined]
        return getattr(self.class_of(section, table), "fixed_states", ())

    def _connect(self, section: str, name: str, table: Any) -> None:
        """Assign the inputs of an element."""
        cls, where = self.class_of(section, table), (section, name)
        keys = read_fields(
            cls,
            table,
            self.located,
            where,
            lambda field, value, here: self.value(field, value, Scope.MOTION, here),
            lambda field: field.is_signal,
        )
        for field, value in keys.items():
            with self.located(*where, field):
                setattr(self.system.elements[name], field, value)

    def add(self, section: str, name: str) -> None:
        table = getattr(self.document, section)[name]
        cls, where = self.class_of(section, table), (section, name)
        moving = issubclass(cls, (ForceElement, UserConstraint)) and section != "beams"
        scope = Scope.MOTION if moving else Scope.PARAMETERS
        with self.located(*where):
            ties = []
            ends = getattr(table, "connect", None) or ()
            connections = connected_fields(cls) if ends else []
            for k, (field, end) in enumerate(zip(connections, ends, strict=True)):
                with self.located(*where, "connect", k):
                    ties.append(self.references.end(field.holds, end))
            keys = read_fields(
                cls,
                table,
                self.located,
                where,
                lambda field, value, here: self.value(field, value, scope, here),
                lambda field: not field.is_signal,
            )
            self.system.add(construct(cls, name, *ties, **keys))

    def value(
        self, field: FileField, entry: Any, scope: Scope, where: tuple[str | int, ...]
    ) -> Any:
        readers: dict[Any, Callable[[], Any]] = {
            Quantity: lambda: self.formulas.read(entry, scope),
            Quantities: lambda: self.vector(_as_list(entry), scope),
            Points: lambda: {n: self.vector(at, Scope.PARAMETERS) for n, at in entry.items()},
            Frames: lambda: {n: read_frame(at, self.formulas) for n, at in entry.items()},
            Orientation: lambda: read_orientation(entry, self.formulas),
            Places: lambda: [self.references.end(Point, end) for end in entry],
            Law: lambda: self.laws.law(entry, where),
            Curve: lambda: self.laws.curve(entry, where),
            ForceLaw: lambda: self.force_law(entry, scope),
            Constraint: lambda: self.references.joint(entry),
            Beam: lambda: self.references.beam(entry),
            Shape: lambda: self.shape(entry, where),
            Shapes: lambda: self.shapes(entry, where),
            Pairs: lambda: self.pairs(entry, where),
            Geometries: lambda: [read_geometry(table, self.folder) for table in entry],
            NormalLaw: lambda: self.component(CONTACT_LAWS, entry, where),
            Friction: lambda: self.component(FRICTIONS, entry, where),
            Coefficients: lambda: self.vector(entry, scope),
            Rows: lambda: [self.row(row, (*where, k)) for k, row in enumerate(entry)],
            Path: lambda: self.folder / entry,
            Numbers: lambda: {n: self.formulas.read(v, Scope.PARAMETERS) for n, v in entry.items()},
            FlexibleStructure: lambda: self.structure(self.folder / entry),
            **dict.fromkeys(
                (BodyElement, Point, Frame), lambda: self.references.end(field.holds, entry)
            ),
        }
        return readers[field.holds]() if field.holds in readers else entry

    def shape(self, entry: Any, where: tuple[str | int, ...]) -> Any:
        """A contact shape, or the point or body that replaces it."""
        if isinstance(entry, str):
            return self.references.end(Point, entry)
        with self.located(*where):
            return self.component(SHAPES[self.document.space.dimension], entry, where)

    def shapes(self, entry: list | dict[str, list], where: tuple[str | int, ...]) -> Any:
        """Contact shapes, or lists of these by the names of groups."""
        if isinstance(entry, dict):
            return {group: self.shapes(listed, (*where, group)) for group, listed in entry.items()}
        return [self.shape(shape, (*where, k)) for k, shape in enumerate(entry)]

    def pairs(self, entry: list, where: tuple[str | int, ...]) -> list:
        """Coefficients of contacts between groups of shapes."""
        pairs = []
        for k, table in enumerate(entry):
            with self.located(*where, k):
                pairs.append(self.component(CONTACT_PAIRS, table, (*where, k)))
        return pairs

    def component(self, registry: dict[str, type], table: Any, where: tuple[str | int, ...]) -> Any:
        """Component object of an element, such as a contact law, from its table."""
        cls = registry[table.type]
        keys = read_fields(
            cls,
            table,
            self.located,
            where,
            lambda field, value, here: self.value(field, value, Scope.PARAMETERS, here),
        )
        return construct(cls, **keys)

    def force_law(self, text: float | str, scope: Scope) -> Callable:
        """The function (extension, rate) → force that a formula describes."""

        def law(extension: Expression, rate: Expression) -> float | Expression:
            return self.formulas.read(text, scope, {"extension": extension, "rate": rate})

        law(Expression(0.0), Expression(0.0))  # raise errors now, not when the model is built
        return law


def _formula_texts(
    cls: type, table: BaseModel, chosen: Sequence[str], included: bool = True
) -> list[str]:
    """Formulas of the chosen keys of an element, or of the others."""
    formulas: list[str] = []
    for field in keyed_fields(cls):
        formula = field.holds in (Quantity, Quantities, ForceLaw, Coefficients)
        if formula and (field.name in chosen) is included:
            entries = _as_list(getattr(table, field.name))
            formulas += [entry for entry in entries if isinstance(entry, str)]
    return formulas


def _as_list(entry: object) -> list:
    """A list; a single entry becomes a list of one."""
    return entry if isinstance(entry, list) else [entry]
