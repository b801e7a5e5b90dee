"""Nodes, finite elements, meshes, supports and loads of a model file as Python code."""

from __future__ import annotations

from typing import Any

from dalembert.elements.fem.registry import ELEMENTS, cell_of
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
from dalembert.io.fields import Quantities, Quantity, connected_fields, keyed_fields
from dalembert.io.finite_element_tables import (
    DISPLACEMENTS,
    FORCES,
    LINE_FORCES,
    TEMPERATURES,
    TRACTIONS,
    VELOCITIES,
    NodeChoice,
)
from dalembert.io.schema import ModelDocument


class StructureCode:
    """Writer of finite elements and of the conditions on them.

    Parameters
    ----------
    document : of the file
    formulas : writer of formulas
    """

    def __init__(self, document: ModelDocument, formulas: FormulaCode):
        self.document: Any = document
        self.formulas = formulas
        self.system, self.variables = formulas.system, formulas.variables

    def parts(self) -> Statements:
        """Nodes, elements and meshes."""
        write = self.formulas.write
        for name, coordinates in self.document.nodes.items():
            code = call("system.node", quoted(name), *(write(x, text=False) for x in coordinates))
            yield self.variables.assign("part", name, "node"), code
        for name, entry in self.document.elements.items():
            cls = ELEMENTS[entry.type]
            nodes = [self.part(end) for end in entry.connect]
            ties = [vector(nodes)] if len(connected_fields(cls)) < len(nodes) else nodes
            element = call(
                f"structures.{cls.__name__}", quoted(name), *ties, **self.fields(cls, entry)
            )
            code = call("system.add", element)
            yield self.variables.assign("part", name, "element"), code
        for name, entry in self.document.meshes.items():
            cls = ELEMENTS[entry.type]
            shape = cell_of(cls)
            arguments = (self.mesh(entry, shape), table({shape: f"structures.{cls.__name__}"}))
            fields = self.fields(cls, entry)
            code = call("system.add_mesh", quoted(name), *arguments, **fields)
            yield self.variables.assign("part", name, "mesh"), code

    def fields(self, cls: type, entry: Any) -> dict[str, Any]:
        """Quantities and options of elements."""
        keywords = {}
        for field in keyed_fields(cls):
            if field.name in entry.model_fields_set:
                value = getattr(entry, field.name)
                formula = field.holds in (Quantity, Quantities)
                keywords[field.name] = self.quantity(field, value) if formula else literal(value)
        return keywords

    def quantity(self, field: Any, entry: Any) -> Any:
        """A number for all elements, one for each or one for each group."""
        write = self.formulas.write
        if isinstance(entry, dict):
            return table({group: write(value, text=False) for group, value in entry.items()})
        if not isinstance(entry, list):
            return write(entry)
        values = Code("[", [write(value, text=False) for value in entry], "]")
        return values if field.holds is Quantities else call("np.array", values)

    def mesh(self, entry: Any, shape: str) -> Any:
        """Path of a mesh file, or points and cells."""
        if entry.file is not None:
            return f"HERE / {quoted(entry.file)}"
        if entry.points is not None:
            rows = [vector(self.formulas.write(x, text=False) for x in p) for p in entry.points]
            points = call("np.array", Code("[", rows, "]"))
            cells = call("np.array", literal([list(cell) for cell in entry.cells]))
            return vector([points, table({shape: cells})])
        for key in ("rectangle", "box"):
            source = getattr(entry, key)
            if source is not None:
                sizes = literal(tuple(source.size)), literal(tuple(source.counts))
                return call(f"structures.{key}_mesh", *sizes, quoted(shape))
        if entry.polygon is not None:
            return self.polygon(entry.polygon, shape)
        line = entry.line
        ends = literal(tuple(line.start)), literal(tuple(line.end))
        return call("structures.line_mesh", *ends, literal(line.count))

    def polygon(self, region: Any, shape: str) -> Any:
        """Triangles of a region with a polygonal outline and holes."""

        def places(rows: Any) -> Any:
            written = [vector(self.formulas.write(x, text=False) for x in row) for row in rows]
            return Code("[", written, "]")

        def hole(entry: Any) -> Any:
            if isinstance(entry, list):
                return places(entry)
            center = vector(self.formulas.write(x, text=False) for x in entry.center)
            return vector([center, self.formulas.write(entry.radius, text=False)])

        arguments: list[Any] = [places(region.vertices), literal(region.size)]
        keywords: dict[str, Any] = {"kind": quoted(shape), "parameters": "system.parameters"}
        if region.holes:
            keywords = {"holes": Code("[", [hole(h) for h in region.holes], "]")} | keywords
        return call("structures.polygon_mesh", *arguments, **keywords)

    # conditions ------------------------------------------------------------------------------
    def conditions(self, gravity_is_written: bool) -> Statements:
        """Supports, loads and initial motions of nodes."""
        yield from self.on_nodes("supports", "support", DISPLACEMENTS)
        yield from self.on_nodes("loads", "load", FORCES, "case", "fixed_axes")
        if not gravity_is_written:
            yield from self.gravity()
        for section, method, directions in (
            ("line_loads", "line_load", LINE_FORCES),
            ("temperatures", "heat", TEMPERATURES),
        ):
            for entry in getattr(self.document, section):
                parts = Code("[", [self.part(name) for name in entry.elements], "]")
                keywords = self.directed(entry, directions) | self.plain(entry, "case")
                yield "", call(f"system.{method}", parts, **keywords)
        for entry in self.document.tractions:
            for name in entry.nodes:
                keywords = self.directed(entry, TRACTIONS) | self.plain(entry, "case")
                arguments = (self.part(entry.elements), self.nodes(name, entry))
                yield "", call("system.traction", *arguments, **keywords)
        if isinstance(self.document.initial, list):
            yield from self.on_nodes("initial", "initial", DISPLACEMENTS | VELOCITIES)

    def on_nodes(
        self, section: str, method: str, directions: dict[str, str], *plain: str
    ) -> Statements:
        """A call for the nodes of each table of a section."""
        for entry in getattr(self.document, section):
            keywords = self.directed(entry, directions) | self.plain(entry, *plain)
            for name in entry.nodes:
                yield "", call(f"system.{method}", self.nodes(name, entry), **keywords)

    def gravity(self) -> Statements:
        """Fields of gravity that the constructor does not take."""
        fields = self.document.gravity or []
        if fields and not hasattr(fields[0], "acceleration"):
            yield "", call("system.gravity", *map(self.formulas.write, fields))
            return
        for entry in fields:
            values = map(self.formulas.write, entry.acceleration)
            yield "", call("system.gravity", *values, **self.plain(entry, "case"))

    def initial(self) -> Statements:
        """Values of measures at the start, or motions of nodes by name."""
        if isinstance(self.document.initial, list):
            return
        for measure, value in self.document.initial.items():
            owner, _, direction = measure.rpartition(".")
            if owner in self.document.nodes and direction in DISPLACEMENTS | VELOCITIES:
                keywords = {direction: self.formulas.write(value)}
                yield "", call("system.initial", self.part(owner), **keywords)
            else:
                code = self.formulas.write(measure, text=False)
                yield "", call("system.initial", code, self.formulas.write(value))

    def directed(self, entry: Any, directions: dict[str, str]) -> dict[str, Any]:
        """Values by direction."""
        return {
            key: self.formulas.write(getattr(entry, key))
            for key in directions
            if key in entry.model_fields_set
        }

    @staticmethod
    def plain(entry: Any, *keys: str) -> dict[str, Any]:
        """Options that a table states."""
        return {key: literal(getattr(entry, key)) for key in keys if getattr(entry, key)}

    # names -----------------------------------------------------------------------------------
    def part(self, name: str) -> str:
        """Variable of a node, an element or a mesh."""
        return self.variables.read("part", name)

    def nodes(self, name: str, entry: NodeChoice) -> str:
        """Nodes of a table of supports or loads."""
        owner, _, group = name.partition(".")
        if owner in self.document.meshes:
            code = f"{self.part(owner)}.nodes({quoted(group) if group else ''})"
        else:
            code = self.part(name)
        if entry.where is not None:
            places = (f"{axis}={literal(value)}" for axis, value in entry.where.items())
            code += f".where({', '.join(places)})"
        if entry.nearest is not None:
            code += f".nearest({', '.join(literal(x) for x in entry.nearest)})"
        return code
