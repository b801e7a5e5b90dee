"""From a checked document to a system, in the order in which things need one another."""

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
from dalembert.io.decisions.histories import declare_history
from dalembert.io.fields import (
    FileField,
    Places,
    Points,
    Quantities,
    Quantity,
    connected,
    given_fields,
    written,
)
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.messages import explain
from dalembert.io.order import dependency_order
from dalembert.io.orientations import read_frame, read_orientation
from dalembert.io.parameters import declare_parameters, declare_tables
from dalembert.io.reading import read_document
from dalembert.io.references import References
from dalembert.io.schema import DerivedTable, Document
from dalembert.io.shapes import Shapes, made_of
from dalembert.io.structures.builder import StructureBuilder
from dalembert.io.structures.finite_elements import FiniteElements
from dalembert.io.structures.mesh_reader import MeshReader
from dalembert.io.structures.schema import StructureDocument
from dalembert.model.system import System
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import visible

NAME = 25
"""Rounds of work for each name that a file declares, as the budget counts them."""


class Builder:
    """Makes the system that a document describes.

    Parameters
    ----------
    document : Document
    source : path of the file, for messages and for the files it names
    """

    def __init__(self, document: Document, source: Path):
        self.document, self.source = document, source
        self.located = Located(source, document)
        name = document.name or visible(source.stem)
        self.system = System(name, description=document.description)
        self.formulas = Formulas(self.system)
        self.references = References(document, self.system, self.formulas)
        self.structures: dict[Path, StructuralModel] = {}
        self.shapes = Shapes(self.located, self.formulas)

    def build(self) -> System:
        """The system.

        Raises
        ------
        ModelError
            With file, place, value and cure.
        """
        self._afford()
        declare_parameters(self.system, self.document, self.located)
        declare_tables(self.system, self.document, self.located, self.formulas)
        self.derived()
        self.histories()
        if self.document.gravity is not None:
            with self.located("gravity"):
                given = [self.formulas.read(g) for g in self.document.gravity]
                self.system.gravity = as_expression(given, "", "m/s^2", len(given))
        for name, at in self.document.ground.points.items():
            with self.located("ground", "points", name):
                self.system.ground.add_point(name, self.vector(at, Scope.PARAMETERS))
        for name, frame in self.document.ground.frames.items():
            with self.located("ground", "frames", name):
                self.system.ground.add_frame(name, **read_frame(frame, self.formulas))
        for name in self.document.bodies:
            self.add("bodies", name)
        for name in self.document.beams:
            self.add("beams", name)
        elastic = FiniteElements(
            self.document, MeshReader(self.source, self.located, self.formulas), self.system
        )
        elastic.add()
        for name in self.document.joints:
            self.add("joints", name)
        for name in self.document.drivers:
            self.add("drivers", name)
        self.forces()
        elastic.hold()
        for measure, value in self.document.initial.items():
            with self.located("initial", measure):
                known = self.formulas.read(measure, Scope.MOTION)
                self.system.initial(as_expression(known, ""), self.formulas.read(value))
        return self.system

    def _afford(self) -> None:
        """Refuse more names than can be read in a reasonable time."""
        d = self.document
        places = [d.ground, *d.bodies.values()]
        tables = [place if isinstance(place, dict) else vars(place) for place in places]
        points = (table.get(key) for table in tables for key in ("points", "frames"))
        counts = {
            "parameters": len(d.parameters),
            "derived parameters": len(d.derived),
            "bodies": len(d.bodies),
            "points and frames": sum(len(named or ()) for named in points),
            "joints": len(d.joints),
            "forces": len(d.forces),
        }
        for what, count in counts.items():
            check_budget(f"{self.source}: {count} {what}", rounds=NAME * count, cure="give fewer")

    # numbers -------------------------------------------------------------------
    def derived(self) -> None:
        entries: dict[str, Any] = self.document.derived
        tables = {
            name: given if isinstance(given, DerivedTable) else DerivedTable(formula=given)
            for name, given in entries.items()
        }
        with self.located():
            order = dependency_order("derived", {n: [str(d.formula)] for n, d in tables.items()})
        for name in order:
            table = tables[name]
            with self.located("derived", name):
                formula = self.formulas.read(table.formula)
                self.system.derived(name, formula, table.unit, table.description)

    def histories(self) -> None:
        """Unknown functions of time, for forces and drivers."""
        tables: dict[str, Any] = self.document.histories
        for name, table in tables.items():
            with self.located("histories", name):
                found = declare_history(self.system, name, table)
            self.formulas.histories[name] = found.value
            self.shapes.histories[name] = found.law

    def vector(self, entries: list, scope: Scope) -> list:
        return [self.formulas.read(entry, scope) for entry in entries]

    # elements ------------------------------------------------------------------
    def forces(self) -> None:
        """Forces may be formulas of other forces, in any order."""
        given: dict[str, Any] = self.document.forces
        with self.located():
            known = elements_of(self.document.space, "forces")
            texts = {name: _formula_texts(known[f.type], f) for name, f in given.items()}
            order = dependency_order("forces", texts)
        for name in order:
            self.add("forces", name)

    def add(self, section: str, name: str) -> None:
        table = getattr(self.document, section)[name]
        cls, where = elements_of(self.document.space, section)[table.type], (section, name)
        moving = issubclass(cls, (ForceElement, UserConstraint)) and section != "beams"
        scope = Scope.MOTION if moving else Scope.PARAMETERS
        with self.located(*where):
            ties = []
            given = getattr(table, "connect", ())
            for k, (field, end) in enumerate(zip(connected(cls), given, strict=True)):
                with self.located(*where, "connect", k):
                    ties.append(self.references.end(field.holds, end))
            keys = given_fields(
                cls,
                table,
                self.located,
                where,
                lambda field, value, here: self.value(field, value, scope, here),
            )
            self.system.add(made_of(cls, name, *ties, **keys))

    def value(self, field: FileField, given: Any, scope: Scope, where: tuple[str, ...]) -> Any:
        readers: dict[Any, Callable[[], Any]] = {
            Quantity: lambda: self.formulas.read(given, scope),
            Quantities: lambda: self.vector(_listed(given), scope),
            Points: lambda: {n: self.vector(at, Scope.PARAMETERS) for n, at in given.items()},
            Frames: lambda: {n: read_frame(at, self.formulas) for n, at in given.items()},
            Orientation: lambda: read_orientation(given, self.formulas),
            Places: lambda: [self.references.end(Point, end) for end in given],
            Law: lambda: self.shapes.law(given, where),
            Curve: lambda: self.shapes.curve(given, where),
            ForceLaw: lambda: self.force_law(given, scope),
            Constraint: lambda: self.references.joint(given),
            Shape: lambda: self.shape(given, where),
            NormalLaw: lambda: self.ingredient(CONTACT_LAWS, given, where),
            Friction: lambda: self.ingredient(FRICTIONS, given, where),
            Rows: lambda: [self.vector(row, Scope.PARAMETERS) for row in given],
            Path: lambda: self.source.parent / given,
            Numbers: lambda: {n: self.formulas.read(v, Scope.PARAMETERS) for n, v in given.items()},
            FlexibleStructure: lambda: self.structure(self.source.parent / given),
            **dict.fromkeys(
                (BodyElement, Point, Frame), lambda: self.references.end(field.holds, given)
            ),
        }
        return readers[field.holds]() if field.holds in readers else given

    def shape(self, given: Any, where: tuple[str, ...]) -> Any:
        """A shape, or the point or body that touches in its place."""
        if isinstance(given, str):
            return self.references.end(Point, given)
        return self.ingredient(SHAPES[self.document.space.dimension], given, where)

    def ingredient(self, registry: dict[str, type], table: Any, where: tuple[str, ...]) -> Any:
        """What an element is made of beside numbers."""
        cls = registry[table.type]
        keys = given_fields(
            cls,
            table,
            self.located,
            where,
            lambda field, value, here: self.value(field, value, Scope.PARAMETERS, here),
        )
        return made_of(cls, **keys)

    def structure(self, path: Path) -> StructuralModel:
        """The structure in another file, which is read once."""
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
            self.structures[path] = StructureBuilder(document, path).build().build()
        return self.structures[path]

    def force_law(self, text: float | str, scope: Scope) -> Callable:
        """The function (extension, rate) → force that a formula describes."""

        def law(extension: Expression, rate: Expression) -> float | Expression:
            return self.formulas.read(text, scope, {"extension": extension, "rate": rate})

        law(Expression(0.0), Expression(0.0))  # a slip is told here, not when the model is built
        return law


def _formula_texts(cls: type, table: BaseModel) -> list[str]:
    """The formulas of an element, where it may name others."""
    found: list[str] = []
    for field in written(cls):
        if field.holds in (Quantity, Quantities, ForceLaw):
            given = getattr(table, field.name)
            found += [entry for entry in _listed(given) if isinstance(entry, str)]
    return found


def _listed(given: Any) -> list:
    """Where a single entry is enough, it may stand alone."""
    return given if isinstance(given, list) else [given]
