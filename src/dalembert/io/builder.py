"""From a checked document to a system, in the order in which things need one another."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from dalembert.elements.curves import u
from dalembert.elements.planar.body import Body, Point
from dalembert.elements.registry import BODIES, CURVES, DRIVERS, FORCES, JOINTS, LAWS
from dalembert.errors import ModelError
from dalembert.io.fields import FROM_FILE, connected, kind_of, written
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.messages import nearest
from dalembert.io.order import dependency_order
from dalembert.io.pairs import read_pairs
from dalembert.io.schema import DerivedTable, Document, ParameterTable
from dalembert.io.tables import InlinePoint
from dalembert.model.system import System
from dalembert.symbolic.expression import Expression, as_expression

Place = tuple[str | int, ...]


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
        self.system = System(document.name or source.stem, description=document.description)
        self.formulas = Formulas(self.system)

    def build(self) -> System:
        """The system.

        Raises
        ------
        ModelError
            With file, place, value and cure.
        """
        self.parameters()
        self.derived()
        if self.document.gravity is not None:
            with self.located("gravity"):
                given = [self.formulas.read(g) for g in self.document.gravity]
                self.system.gravity = as_expression(given, "", "m/s^2", 2)
        for name, at in self.document.ground.points.items():
            with self.located("ground", "points", name):
                self.system.ground.add_point(name, self.vector(at, Scope.PARAMETERS))
        for name in self.document.bodies:
            self.add("bodies", BODIES, name)
        for name in self.document.joints:
            self.add("joints", JOINTS, name)
        for name in self.document.drivers:
            self.add("drivers", DRIVERS, name)
        with self.located():
            texts = {n: list(_formula_texts(FORCES[f.type], f)) for n, f in self.document.forces.items()}
            order = dependency_order("forces", texts)
        for name in order:
            self.add("forces", FORCES, name)
        for measure, value in self.document.initial.items():
            with self.located("initial", measure):
                known = self.formulas.read(measure, Scope.MOTION)
                self.system.initial(known, self.formulas.read(value))
        return self.system

    # numbers -------------------------------------------------------------------
    def parameters(self) -> None:
        for name, given in self.document.parameters.items():
            table = given if isinstance(given, ParameterTable) else ParameterTable(value=given)
            with self.located("parameters", name):
                self.system.parameter(name, table.value, table.unit, table.bounds, table.description)

    def derived(self) -> None:
        tables = {
            name: given if isinstance(given, DerivedTable) else DerivedTable(formula=given)
            for name, given in self.document.derived.items()
        }
        with self.located():
            order = dependency_order("derived", {n: [str(d.formula)] for n, d in tables.items()})
        for name in order:
            table = tables[name]
            with self.located("derived", name):
                formula = self.formulas.read(table.formula)
                self.system.derived(name, formula, table.unit, table.description)

    def vector(self, entries: list, scope: Scope, local: dict | None = None) -> list:
        return [self.formulas.read(entry, scope, local) for entry in entries]

    # elements ------------------------------------------------------------------
    def add(self, section: str, registry: dict[str, type], name: str) -> None:
        table = getattr(self.document, section)[name]
        cls, where = registry[table.type], (section, name)
        scope = Scope.MOTION if section == "forces" else Scope.PARAMETERS
        with self.located(*where):
            ties = [
                self.reference(kind_of(field), given, (*where, "connect", k))
                for k, (field, given) in enumerate(zip(connected(cls), getattr(table, "connect", ()), strict=True))
            ]
            keys = self.keywords(cls, table, scope, where)
            self.system.add(_made(cls, name, *ties, **keys))

    def keywords(self, cls: type, table: BaseModel, scope: Scope, where: Place) -> dict[str, Any]:
        """The fields that a table gives, as the class takes them."""
        made = {}
        for field in written(cls):
            if field.name not in table.model_fields_set:
                continue
            with self.located(*where, field.name):
                given = getattr(table, field.name)
                own = Scope.MOTION if field.name == "formula" and scope is Scope.PARAMETERS else scope
                made[field.name] = self.value(field, given, own, (*where, field.name))
        return made

    def value(self, field: dataclasses.Field, given: Any, scope: Scope, where: Place) -> Any:
        kind = kind_of(field)
        readers: dict[str, Callable[[], Any]] = {
            "quantity": lambda: self.formulas.read(given, scope),
            "vector": lambda: self.vector(given, scope),
            "points": lambda: {n: self.vector(at, Scope.PARAMETERS) for n, at in given.items()},
            "law": lambda: self.law(given, where),
            "curve": lambda: self.shape(CURVES, given, Scope.PARAMETERS, where, {"u": u}),
            "spring-law": lambda: self.spring_law(given, scope),
            "body": lambda: self.reference("body", given, where),
            "joint": lambda: self.joint(given),
        }
        return readers[kind]() if kind in readers else given

    def law(self, given: Any, where: Place) -> Any:
        if isinstance(given, BaseModel):
            return self.shape(LAWS, given, Scope.TIME, where)
        return self.formulas.read(given, Scope.TIME)

    def spring_law(self, text: float | str, scope: Scope) -> Callable:
        """The function (extension, rate) → force that a formula describes."""

        def law(extension: Expression, rate: Expression) -> float | Expression:
            return self.formulas.read(text, scope, {"extension": extension, "rate": rate})

        law(Expression(0.0), Expression(0.0))  # a slip is told here, not when the model is built
        return law

    def shape(
        self, registry: dict[str, type], table: Any, scope: Scope, where: Place, local: dict | None = None
    ) -> Any:
        """A law or a curve, whose rows may lie in a file beside the model."""
        cls, made = registry[table.type], {}
        rows = FROM_FILE.get(table.type, ())
        if rows:
            made |= self.rows(table, rows, where)
        for field in written(cls, frozenset()):
            if field.name in table.model_fields_set and field.name not in rows:
                given = getattr(table, field.name)
                with self.located(*where, field.name):
                    numeric = kind_of(field) == "quantity"
                    made[field.name] = self.formulas.read(given, scope, local) if numeric else given
        with self.located(*where):
            return _made(cls, **made)

    def rows(self, table: Any, fields: tuple[str, ...], where: Place) -> dict[str, Any]:
        given = [name for name in fields if getattr(table, name) is not None]
        names = " and ".join(fields)
        if (table.file is None) == (not given) or (given and len(given) < len(fields)):
            raise self.located.error(f"give either {names}, or file", *where)
        if table.file is None:
            with self.located(*where):
                return {name: [self._row(item) for item in getattr(table, name)] for name in fields}
        with self.located(*where, "file"):
            pairs = read_pairs(self.source.parent / table.file)
        columns = list(zip(*pairs, strict=True))
        return dict(zip(fields, columns, strict=True)) if len(fields) == 2 else {fields[0]: pairs}

    def _row(self, item: Any) -> Any:
        return [self._row(x) for x in item] if isinstance(item, list) else self.formulas.read(item)

    # references ------------------------------------------------------------------
    def body(self, name: str) -> Body:
        if name == "ground" or name in self.document.bodies:
            return self.system.body(name)
        known = ["ground", *self.document.bodies]
        raise ModelError(f"unknown body {name!r}{nearest(name, known)}; known: {_listed(known)}")

    def joint(self, name: str) -> Any:
        known = list(self.document.joints)
        if name not in known:
            raise ModelError(f"unknown joint {name!r}{nearest(name, known)}; known: {_listed(known)}")
        return self.system.elements[name]

    def reference(self, kind: str, given: Any, where: Place) -> Body | Point:
        """The body or point behind ``"crank"``, ``"crank.end"`` or a table with ``body`` and ``at``."""
        with self.located(*where):
            if isinstance(given, InlinePoint):
                if kind == "body":
                    raise ModelError(f"expected the name of a body, e.g. {given.body!r}; got a point")
                return Point(self.body(given.body), self.vector(given.at, Scope.PARAMETERS))
            owner, _, point = given.partition(".")
            body = self.body(owner)
            if not point:
                return body
            if kind == "body":
                raise ModelError(f"expected a body, got the point {given!r}; write {owner!r}")
            if point not in body.points:
                known = [f"{owner}.{p}" for p in body.points]
                raise ModelError(
                    f"unknown point {given!r}{nearest(given, known)}; points of {owner}: "
                    f"{_listed(known) or 'none, name one in its points'}"
                )
            return body.points[point]


def _made(cls: type, *arguments: Any, **keys: Any) -> Any:
    try:
        return cls(*arguments, **keys)
    except (TypeError, ValueError, ArithmeticError) as error:
        raise ModelError(f"cannot be made: {error}") from None


def _listed(names: list[str]) -> str:
    return ", ".join(names[:12]) + (", …" if len(names) > 12 else "")


def _formula_texts(cls: type, table: BaseModel) -> list[str]:
    """The formulas of an element, where it may name others."""
    found: list[str] = []
    for field in written(cls):
        if kind_of(field) in ("quantity", "vector", "spring-law"):
            given = getattr(table, field.name)
            found += [x for x in (given if isinstance(given, list) else [given]) if isinstance(x, str)]
    return found
