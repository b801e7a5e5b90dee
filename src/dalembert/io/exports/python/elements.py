"""Ground, bodies, joints, drivers, forces and blocks of a model file as Python code."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import BaseModel

from dalembert.elements import blocks, curves, laws, planar, spatial
from dalembert.elements.base import Constraint, Rows
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
    CONTACT_LAWS,
    CONTACT_PAIRS,
    CURVES,
    FRICTIONS,
    LAWS,
    SHAPES,
)
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.io.exports.python.code import (
    Code,
    Statements,
    call,
    literal,
    quoted,
    table,
    vector,
)
from dalembert.io.exports.python.formulas import FormulaCode
from dalembert.io.exports.python.orientations import frame_keywords, geometry_code, orientation_code
from dalembert.io.fields import (
    FROM_FILE,
    FileField,
    Geometries,
    Laws,
    Pairs,
    Places,
    Points,
    Quantities,
    Quantity,
    Shapes,
    connected_fields,
    keyed_fields,
)
from dalembert.io.laws_and_curves import LawReader
from dalembert.io.mechanism_elements import INPUTS, MechanismElements
from dalembert.io.orientations import FrameTable

MODULES: dict[str, ModuleType] = {
    "planar": planar,
    "spatial": spatial,
    "planar.contact": planar.contact,
    "spatial.contact": spatial.contact,
    "laws": laws,
    "curves": curves,
    "blocks": blocks,
}


class ElementCode:
    """Writer of the elements of a mechanism.

    Parameters
    ----------
    reader : of the same file, on its complete system
    formulas : writer of formulas
    """

    def __init__(self, reader: MechanismElements, formulas: FormulaCode):
        self.reader, self.document, self.system = reader, reader.document, reader.system
        self.formulas, self.variables = formulas, formulas.variables
        self.space = self.document.space.name

    # sections --------------------------------------------------------------------------------
    def ground(self) -> Statements:
        """Points and frames of the ground."""
        for name, at in self.document.ground.points.items():
            place = self.vector(at)
            variable = self.variables.assign("part", f"ground.{name}", "point")
            yield variable, call("system.ground.add_point", quoted(name), place)
        for name, frame in self.document.ground.frames.items():
            keywords = frame_keywords(frame, self.formulas.write)
            variable = self.variables.assign("part", f"ground.{name}", "frame")
            yield variable, call("system.ground.add_frame", quoted(name), **keywords)

    def section(self, section: str) -> Statements:
        """Elements of a section."""
        for name in getattr(self.document, section):
            yield self.element(section, name)

    def forces(self) -> Statements:
        """Forces, and inputs of blocks and forces, in order of dependence."""
        tables: dict[str, tuple[str, Any]] = {}
        for section in ("blocks", "forces"):
            tables |= {n: (section, t) for n, t in getattr(self.document, section).items()}
        for name, part in self.reader.order(tables):
            section, entry = tables[name]
            if part == INPUTS:
                for key, code in self.fields(self.reader.class_of(section, entry), entry, True):
                    yield "", f"{self.variables.read('part', name)}.{key} = {code}"
            elif section == "forces":
                yield self.element(section, name)

    def element(self, section: str, name: str) -> tuple[str, Code]:
        """Variable and construction of an element."""
        entry = getattr(self.document, section)[name]
        cls = self.reader.class_of(section, entry)
        ends = getattr(entry, "connect", None) or ()
        connections = connected_fields(cls) if ends else []
        ties = [self.end(f.holds, end) for f, end in zip(connections, ends, strict=True)]
        keys = dict(self.fields(cls, entry, False))
        module = "blocks" if section == "blocks" else self.space
        function = f"{module}.{entry.type}" if "." not in entry.type else entry.type
        added = call("system.add", call(function, quoted(name), *ties, **keys))
        return self.variables.assign("part", name, section.removesuffix("s")), added

    def fields(self, cls: type, entry: BaseModel, signals: bool) -> Iterator[tuple[str, Any]]:
        """Key and code of the fields of a table."""
        for field in keyed_fields(cls):
            if field.name in entry.model_fields_set and field.is_signal == signals:
                yield field.name, self.value(field, getattr(entry, field.name))

    # values ----------------------------------------------------------------------------------
    def vector(self, entries: list[Any]) -> Code:
        """Tuple of numbers and formulas."""
        return vector(self.formulas.write(entry) for entry in entries)

    def value(self, field: FileField, entry: Any) -> Any:
        """Code of the value of a field, as ``MechanismElements.value`` reads it."""
        write = self.formulas.write
        writers: dict[Any, Callable[[], Any]] = {
            Quantity: lambda: write(entry),
            Quantities: lambda: self.vector(entry if isinstance(entry, list) else [entry]),
            Points: lambda: table({n: self.vector(at) for n, at in entry.items()}),
            Frames: lambda: table(
                {n: call("dict", **frame_keywords(at, write)) for n, at in entry.items()}
            ),
            Orientation: lambda: orientation_code(entry, write),
            Places: lambda: Code("[", [self.end(Point, end) for end in entry], "]"),
            Law: lambda: self.law(entry),
            Curve: lambda: self.curve(entry),
            ForceLaw: lambda: self.force_law(entry),
            Constraint: lambda: self.variables.read("part", entry),
            Beam: lambda: self.variables.read("part", entry),
            Shape: lambda: self.shape(entry),
            Shapes: lambda: self.shapes(entry),
            Pairs: lambda: Code("[", [self.component(CONTACT_PAIRS, x) for x in entry], "]"),
            Geometries: lambda: Code("[", [geometry_code(x) for x in entry], "]"),
            NormalLaw: lambda: self.component(CONTACT_LAWS, entry),
            Friction: lambda: self.component(FRICTIONS, entry),
            Coefficients: lambda: self.vector(entry),
            Rows: lambda: Code("[", [self.vector(row) for row in entry], "]"),
            Path: lambda: f"HERE / {quoted(entry)}",
            Numbers: lambda: table({n: write(v) for n, v in entry.items()}),
            FlexibleStructure: lambda: f"da.load_model(HERE / {quoted(entry)}).build()",
            **dict.fromkeys((BodyElement, Point, Frame), lambda: self.end(field.holds, entry)),
        }
        return writers[field.holds]() if field.holds in writers else literal(entry)

    def law(self, entry: Any) -> Any:
        """A law, or the number or formula that replaces it."""
        if isinstance(entry, str) and entry in self.formulas.histories:
            return f"{self.variables.read('value', entry)}.law"
        if not isinstance(entry, BaseModel):
            return self.formulas.write(entry)
        return self._law_or_curve("laws", LAWS[entry.type], entry, {})  # type: ignore[attr-defined]

    def curve(self, entry: Any) -> Code:
        """A curve, whose formulas may use its parameter."""
        return self._law_or_curve("curves", CURVES[entry.type], entry, {"u": "curves.u"})

    def _law_or_curve(self, module: str, cls: type, entry: Any, local: dict[str, str]) -> Code:
        rows = FROM_FILE.get(entry.type, {})
        keywords: dict[str, Any] = {}
        if rows:
            values = LawReader(self.reader.located, self.reader.formulas)
            inline = entry.file is None
            columns = {} if inline else values.columns(entry, rows, ())
            for name in rows:
                keywords[name] = self._rows(getattr(entry, name) if inline else columns[name])
        for field in keyed_fields(cls, frozenset()):
            if field.name in entry.model_fields_set and field.name not in (*rows, "file"):
                value = getattr(entry, field.name)
                if field.holds is Quantity:
                    keywords[field.name] = self.formulas.write(value, local)
                elif field.holds is Laws:
                    keywords[field.name] = Code("[", [self.law(x) for x in value], "]")
                else:
                    keywords[field.name] = literal(value)
        return call(f"{module}.{cls.__name__}", **keywords)

    def _rows(self, rows: Any) -> Any:
        if isinstance(rows, (list, tuple)):
            return Code("[", [self._rows(row) for row in rows], "]")
        return self.formulas.write(rows, text=False)

    def force_law(self, text: float | str) -> str:
        """Function of extension and rate."""
        local = {"extension": "extension", "rate": "rate"}
        return f"lambda extension, rate: {self.formulas.write(text, local, text=False)}"

    def shape(self, entry: Any) -> Any:
        """A contact shape, or the point or body that replaces it."""
        if isinstance(entry, str):
            return self.end(Point, entry)
        return self.component(SHAPES[self.document.space.dimension], entry)

    def shapes(self, entry: Any) -> Code:
        """Contact shapes, or lists of these by the names of groups."""
        if isinstance(entry, dict):
            return table({group: self.shapes(listed) for group, listed in entry.items()})
        return Code("[", [self.shape(shape) for shape in entry], "]")

    def component(self, registry: dict[str, type], entry: Any) -> Code:
        """A part of an element, such as a contact law."""
        cls = registry[entry.type]
        keys = {
            field.name: self.value(field, getattr(entry, field.name))
            for field in keyed_fields(cls)
            if field.name in entry.model_fields_set
        }
        own = f"{self.space}.contact"
        module = own if hasattr(MODULES[own], cls.__name__) else "planar.contact"
        return call(f"{module}.{cls.__name__}", **keys)

    # references ------------------------------------------------------------------------------
    def end(self, kind: type, reference: Any) -> Any:
        """A body, point, frame or node, as ``References.end`` reads it."""
        if not isinstance(reference, str):
            named = self.part(reference.body)
            if kind is Frame and isinstance(reference, FrameTable):
                return call(f"{named}.frame", **frame_keywords(reference, self.formulas.write))
            return call(f"{named}.point", *map(self.formulas.write, reference.at))
        owner, _, name = reference.partition(".")
        target = self.reader.references.end(kind, reference)
        mesh = owner.partition("[")[0].removesuffix("_nodes")
        if mesh in self.document.meshes and owner not in self.document.beams:
            names = list(self.system.meshes[mesh].nodes().names)
            return f"{self.part(mesh)}.nodes()[{names.index(reference)}]"
        if not name:
            return self.part(owner)
        if ("part", reference) in self.variables.names:
            return self.variables.read("part", reference)
        is_ground = owner == "ground"
        body: Any = (
            self.system.ground if is_ground else self.reader.references.end(BodyElement, owner)
        )
        if target is body:
            return self.part(owner)
        return f"{self.part(owner)}{_access(body, name, target)}"

    def part(self, name: str) -> str:
        """Variable of an element, or the ground."""
        return "system.ground" if name == "ground" else self.variables.read("part", name)


def _access(owner: Any, name: str, target: Any) -> str:
    """Attribute or call by which an owner returns a named place."""
    static = inspect.getattr_static(owner, name, None)
    if name.isidentifier() and static is not None and getattr(owner, name) is target:
        return f".{name}"
    if name in getattr(owner, "points", {}):
        return f".point({quoted(name)})"
    if name in getattr(owner, "frames", {}):
        return f".frame({quoted(name)})"
    return f".named_nodes[{quoted(name)}]"
