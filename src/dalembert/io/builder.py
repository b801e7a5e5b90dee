"""Construction of a model from a validated document, in order of dependence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from dalembert.budget import check_budget
from dalembert.elements.base import Constraint, ForceElement, Rows
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.flexible.body import Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law
from dalembert.elements.point import Point
from dalembert.elements.registry import CONTACT_LAWS, FRICTIONS, SHAPES, elements_of
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.elements.user_constraint import UserConstraint
from dalembert.errors import ModelError
from dalembert.io.declarations import (
    declare_history,
    declare_parameters,
    declare_tables,
    dependency_order,
)
from dalembert.io.documents import Document, StructureDocument
from dalembert.io.fields import (
    FileField,
    Places,
    Points,
    Quantities,
    Quantity,
    Shapes,
    connected_fields,
    keyed_fields,
    read_fields,
)
from dalembert.io.finite_element_tables import DISPLACEMENTS, VELOCITIES
from dalembert.io.finite_elements import FiniteElements
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.laws_and_curves import LawReader, construct
from dalembert.io.location import Located
from dalembert.io.messages import explain
from dalembert.io.orientations import read_frame, read_orientation
from dalembert.io.reading import read_document
from dalembert.io.references import References
from dalembert.io.schema import DerivedTable, ModelDocument
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.system import System
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import visible

NAME = 25
"""Estimated cost per declared name, in the rounds of the budget."""


class Builder:
    """Builder of the system that a document describes.

    Parameters
    ----------
    document : ModelDocument
    source : path of the file, for messages and relative paths
    """

    def __init__(self, document: ModelDocument, source: Path):
        self.document, self.source = document, source
        self.located = Located(source, document)
        name = document.name or visible(source.stem)
        self.system: System = document.builder(name, description=document.description)
        self.formulas = Formulas(self.system)
        self.elastic = FiniteElements(document, self.system, self.located, self.formulas)
        self.structures: dict[Path, StructuralModel] = {}
        self.laws = LawReader(self.located, self.formulas)

    def build(self) -> System:
        """The system.

        Raises
        ------
        ModelError, FileError, UnsupportedError
            Names file, location, value and a fix.
        """
        declare_parameters(self.system, self.document, self.located)
        declare_tables(self.system, self.document, self.located, self.formulas)
        self.derived()
        if isinstance(self.document, Document):
            self.mechanism(self.document)
        else:
            self.elastic.add()
        self.elastic.add_conditions()
        self.initial()
        return self.system

    def mechanism(self, document: Document) -> None:
        """Add bodies, finite elements, joints, drivers and forces."""
        self._check_budget(document)
        self.references = References(document, self.system, self.formulas)
        self.histories(document)
        for name, at in document.ground.points.items():
            with self.located("ground", "points", name):
                self.system.ground.add_point(name, self.vector(at, Scope.PARAMETERS))
        for name, frame in document.ground.frames.items():
            with self.located("ground", "frames", name):
                self.system.ground.add_frame(name, **read_frame(frame, self.formulas))
        for section in ("bodies", "beams"):
            for name in getattr(document, section):
                self.add(document, section, name)
        self.elastic.add()
        for section in ("joints", "drivers"):
            for name in getattr(document, section):
                self.add(document, section, name)
        self.forces(document)

    def initial(self) -> None:
        """Prescribe measures, or motions of nodes, at the start."""
        if isinstance(self.document.initial, list):
            return
        for measure, value in self.document.initial.items():
            with self.located("initial", measure):
                number = self.formulas.read(value)
                owner, _, direction = measure.rpartition(".")
                if owner in self.document.nodes and direction in DISPLACEMENTS | VELOCITIES:
                    self.system.initial(self.system.nodes[owner], **{direction: number})
                else:
                    quantity = self.formulas.read(measure, Scope.MOTION)
                    self.system.initial(as_expression(quantity, ""), number)

    def _check_budget(self, document: Document) -> None:
        """Refuse more names than can be processed in reasonable time."""
        owners = [document.ground, *document.bodies.values()]
        tables = [owner if isinstance(owner, dict) else vars(owner) for owner in owners]
        points = (table.get(key) for table in tables for key in ("points", "frames"))
        counts = {
            "parameters": len(document.parameters),
            "derived parameters": len(document.derived),
            "bodies": len(document.bodies),
            "points and frames": sum(len(named or ()) for named in points),
            "joints": len(document.joints),
            "forces": len(document.forces),
        }
        for section, count in counts.items():
            check_budget(
                f"{self.source}: {count} {section}", rounds=NAME * count, cure="give fewer"
            )

    # numbers -------------------------------------------------------------------
    def derived(self) -> None:
        entries: dict[str, Any] = self.document.derived
        tables = {
            name: entry if isinstance(entry, DerivedTable) else DerivedTable(formula=entry)
            for name, entry in entries.items()
        }
        with self.located():
            order = dependency_order("derived", {n: [str(d.formula)] for n, d in tables.items()})
        for name in order:
            table = tables[name]
            with self.located("derived", name):
                formula = self.formulas.read(table.formula)
                self.system.derived(name, formula, table.unit, table.description)

    def histories(self, document: Document) -> None:
        """Declare unknown functions of time, for forces and drivers."""
        tables: dict[str, Any] = document.histories
        for name, table in tables.items():
            with self.located("histories", name):
                declared = declare_history(self.system, name, table)
            self.formulas.histories[name] = declared.value
            self.laws.histories[name] = declared.law

    def vector(self, entries: list, scope: Scope) -> list:
        return [self.formulas.read(entry, scope) for entry in entries]

    # elements ------------------------------------------------------------------
    def forces(self, document: Document) -> None:
        """Add forces, which may be formulas of other forces, in order of dependence."""
        entries: dict[str, Any] = document.forces
        with self.located():
            classes = elements_of(document.space, "forces")
            texts = {name: _formula_texts(classes[f.type], f) for name, f in entries.items()}
            order = dependency_order("forces", texts)
        for name in order:
            self.add(document, "forces", name)

    def add(self, document: Document, section: str, name: str) -> None:
        table = getattr(document, section)[name]
        cls, where = elements_of(document.space, section)[table.type], (section, name)
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
            Shape: lambda: self.shape(entry, where),
            Shapes: lambda: [self.shape(shape, (*where, str(k))) for k, shape in enumerate(entry)],
            NormalLaw: lambda: self.component(CONTACT_LAWS, entry, where),
            Friction: lambda: self.component(FRICTIONS, entry, where),
            Rows: lambda: [self.vector(row, Scope.PARAMETERS) for row in entry],
            Path: lambda: self.source.parent / entry,
            Numbers: lambda: {n: self.formulas.read(v, Scope.PARAMETERS) for n, v in entry.items()},
            FlexibleStructure: lambda: self.structure(self.source.parent / entry),
            **dict.fromkeys(
                (BodyElement, Point, Frame), lambda: self.references.end(field.holds, entry)
            ),
        }
        return readers[field.holds]() if field.holds in readers else entry

    def shape(self, entry: Any, where: tuple[str | int, ...]) -> Any:
        """A contact shape, or the point or body that replaces it."""
        if isinstance(entry, str):
            return self.references.end(Point, entry)
        return self.component(SHAPES[self.references.document.space.dimension], entry, where)

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

    def structure(self, path: Path) -> StructuralModel:
        """The structure in another file; each file is read once."""
        if path not in self.structures:
            data = read_document(path)
            if data.get("kind") != "structure":
                raise ModelError(
                    f'{path.name} is no structure; give a file with kind = "structure"'
                )
            try:
                document = StructureDocument.model_validate(data)
            except ValidationError as error:
                raise explain(error, data, path) from None
            model: Any = Builder(document, path).build().build()
            self.structures[path] = model
        return self.structures[path]

    def force_law(self, text: float | str, scope: Scope) -> Callable:
        """The function (extension, rate) → force that a formula describes."""

        def law(extension: Expression, rate: Expression) -> float | Expression:
            return self.formulas.read(text, scope, {"extension": extension, "rate": rate})

        law(Expression(0.0), Expression(0.0))  # raise errors now, not when the model is built
        return law


def _formula_texts(cls: type, table: BaseModel) -> list[str]:
    """Formulas of an element that may name other elements."""
    formulas: list[str] = []
    for field in keyed_fields(cls):
        if field.holds in (Quantity, Quantities, ForceLaw):
            entries = _as_list(getattr(table, field.name))
            formulas += [entry for entry in entries if isinstance(entry, str)]
    return formulas


def _as_list(entry: object) -> list:
    """A list; a single entry becomes a list of one."""
    return entry if isinstance(entry, list) else [entry]
