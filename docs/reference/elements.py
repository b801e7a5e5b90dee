"""Keys of the classes of a registry, from their fields and docstrings."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

from dalembert.analysis.events import Event, Events
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.design.reliability.distribution import Distribution
from dalembert.elements.base import Constraint, Rows
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.flexible.beam import Beam
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
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.io import fields
from dalembert.io.fields import FROM_FILE, connected_fields, keyed_fields
from dalembert.model.graph.coordinates import Coordinates
from dalembert.results.structural.result import StructuralResult
from reference.markdown import field_texts, summary, table

HOLDS: dict[object, str] = {
    Sequence[float]: "list of numbers",
    dict[str, object]: "table of numbers and formulas",
    dict[str, complex]: "table of numbers, or pairs of real and imaginary part",
    fields.Geometries: "list of [geometries](#geometry)",
    fields.Coefficients: "list of formulas",
    fields.Quantity: "formula",
    ForceLaw: "formula",
    fields.Measured: "measure",
    Event: "name of an event",
    float: "number",
    int: "integer",
    bool: "true or false",
    str: "text",
    Path: "path relative to the model file",
    BodyElement: "name of a body",
    Beam: "name of a beam",
    Point: "point",
    Frame: "frame",
    Constraint: "name of a joint",
    FlexibleStructure: "file of a structure",
    StructuralResult: "table of an analysis",
    Interfaces: "name of a section: nodes; or list of nodes",
    Numbers: "table of formulas",
    Rows: "list",
    fields.Laws: "list of laws, numbers or formulas",
    fields.CountOrTimes: "count or list of times",
    fields.Interval: "two numbers",
    fields.Points: "table",
    Frames: "table",
    Orientation: "orientation",
    Law: "law",
    Shape: "shape, or name of a point",
    fields.Shapes: "list of shapes, or table of lists by groups",
    fields.Pairs: "list of pairs",
    NormalLaw: "contact law",
    Friction: "friction",
    fields.Places: "list of points",
    Curve: "curve",
    fields.Names: "list of names",
    Coordinates: "coordinates",
    Formulation: "formulation",
    Stabilization: "stabilisation",
    Integrator: "integrator",
    ContactScheme: "contact scheme",
    ContactSolver: "contact solver",
    Events: "table of events",
    Distribution: "distribution",
    Rayleigh: "table with `mass` and `stiffness`",
}
NEEDED = {
    "Bar.length",
    "RigidLink.length",
    "GearPair.radius_i",
    "GearPair.radius_j",
    "RackAndPinion.radius",
    "Screw.pitch",
    "RevoluteSphericalLink.length",
    "RevoluteRevoluteLink.length",
    "RollingDisc.radius",
    "Stop.stiffness",
    "Hertz.stiffness",
    "HuntCrossley.stiffness",
    "LankaraniNikravesh.stiffness",
    "LankaraniNikravesh.restitution",
    "LankaraniNikravesh.impact_speed",
    "Flores.stiffness",
    "Flores.restitution",
    "Flores.impact_speed",
    "KelvinVoigt.stiffness",
    "ClearanceRevolute.radius",
    "ClearanceRevolute.clearance",
    "ClearanceSpherical.radius",
    "ClearanceSpherical.clearance",
    "Cable.length",
    "Cable.stiffness",
}
"""Required keys whose field has a default."""
REFUSED = {
    "Particle": {"inertia", "angle", "angular_velocity", "rotation", "center_of_mass"},
}
"""Inherited keys that a class does not accept."""
COUNTS = {1: "one", 2: "two", 3: "three", 6: "six"}


def shown_default(field: dataclasses.Field, needed: bool) -> str:
    if needed:
        return "required"
    default = field.default
    if default is dataclasses.MISSING and field.default_factory is not dataclasses.MISSING:
        default = field.default_factory()
    if default is None or default is dataclasses.MISSING:
        return "none"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    if isinstance(default, (int, float)):
        return f"`{default:.6g}`"
    if isinstance(default, tuple):
        texts = (f'"{x}"' if isinstance(x, str) else f"{x:g}" for x in default)
        return f"`[{', '.join(texts)}]`"
    if isinstance(default, str):
        return f'`"{default}"`'
    return f'`"{type(default).__name__}"`'


def record(name: str, cls: type, heading: str = "###") -> str:
    """Heading, text and keys of one class of the registry."""
    parts = [f"{heading} {name}", summary(cls)]
    ties = connected_fields(cls)
    if ties:
        listed = ", ".join(f.name for f in ties)
        optional = not any(f.is_needed for f in ties)
        parts.append(f"`connect = [{listed}]`{', or `joint`' if optional else ''}")
    texts, from_file, rows = field_texts(cls), FROM_FILE.get(name, ()), []
    for field in keyed_fields(cls):
        if field.name in REFUSED.get(name, ()):
            continue
        meta = field.field.metadata
        text = meta.get("description") or texts.get(field.name, "")
        named = field.holds is fields.Points
        if named:
            text = "named points: coordinates in the body frame"
        if field.holds is Frames:
            text = "named frames, tables as below without `body`"
        unit = meta.get("unit") or ("m" if named else "")
        needed = field.is_needed and field.name not in from_file
        needed = needed or f"{name}.{field.name}" in NEEDED
        rows.append(
            (
                f"`{field.name}`",
                held(field),
                unit.replace(" | ", " or "),
                shown_default(field.field, needed),
                text,
            )
        )
    if from_file:
        names = " and ".join(from_file)
        text = f"CSV file with two columns, instead of {names}"
        rows.append(("`file`", "text", "", "none", text))
    if rows:
        parts.append(table(("key", "value", "unit", "default", "meaning"), rows))
    else:
        parts.append("No keys of its own.")
    return "\n\n".join(parts)


def held(field: fields.FileField) -> str:
    """Description of the value of a key."""
    if field.holds is not fields.Quantities:
        return HOLDS[field.holds]
    fewer = f"{COUNTS[field.minimum_size]} or " if field.minimum_size else ""
    return f"{fewer}{COUNTS[field.size]} formulas"


def records(registry: dict[str, type], heading: str = "###") -> str:
    return "\n\n".join(record(name, cls, heading) for name, cls in registry.items())
