"""Writes the parts of the documentation that repeat what the code says.

    python docs/generate_reference.py            rewrites them
    python docs/generate_reference.py --check    tells whether they are up to date

A generated part stands between ``<!-- generated: NAME -->`` and ``<!-- end: NAME -->``; the text
around it is written by hand. Element tables come from the registry of elements, other tables from
the classes and the schema of model files, names from ``dalembert.__all__``.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

import dalembert
from dalembert.analysis.events import Event, Events
from dalembert.design.reliability.distribution import Distribution
from dalembert.elements.base import Constraint, Rows
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.curves import Curve
from dalembert.elements.flexible.body import Interfaces, Numbers
from dalembert.elements.flexible.shapes import FlexibleStructure
from dalembert.elements.frame import Frame, Frames
from dalembert.elements.laws.base import Law
from dalembert.elements.point import Point
from dalembert.elements.registry import (
    CONTACT_LAWS,
    CURVES,
    FRICTIONS,
    LAWS,
    PLANAR,
    SHAPES,
    SPATIAL,
)
from dalembert.elements.rotation import Orientation
from dalembert.elements.springs import ForceLaw
from dalembert.formulations.base import Formulation
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Integrator
from dalembert.io import decision_tables, fields, orientations, schema, tables, task_tables
from dalembert.io.fields import FROM_FILE, connected, written
from dalembert.io.strategies import (
    ANALYSES,
    COORDINATES,
    FORMULATIONS,
    INTEGRATORS,
    RESPONSES,
    STABILIZATIONS,
)
from dalembert.model.coordinates import Coordinates
from dalembert.symbolic.parser import FUNCTIONS

DOCS = Path(__file__).parent
ROOT = DOCS.parent

HOLDS: dict[object, str] = {
    fields.Quantity: "formula",
    ForceLaw: "formula",
    fields.Measured: "measure",
    Event: "name of an event",
    float: "number",
    int: "whole number",
    bool: "true or false",
    str: "text",
    Path: "path beside the model file",
    BodyElement: "name of a body",
    Point: "point",
    Frame: "frame",
    Constraint: "name of a joint",
    FlexibleStructure: "file of a structure",
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
    NormalLaw: "contact law",
    Friction: "friction",
    fields.Places: "list of points",
    Curve: "curve",
    fields.Names: "list of names",
    Coordinates: "coordinates",
    Formulation: "formulation",
    Stabilization: "stabilisation",
    Integrator: "integrator",
    Events: "table of events",
    Distribution: "distribution",
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
"""Keys that their class refuses to miss, although the field has a default."""
REFUSED = {
    "Particle": {"inertia", "angle", "angular_velocity", "rotation", "center_of_mass"},
}
"""Keys that a class inherits and refuses."""
COUNTS = {1: "one", 2: "two", 3: "three", 6: "six"}
FIELD = re.compile(r"^(\w+(?:, \w+)*) : (.*)$")


# texts of classes ------------------------------------------------------------------------
def summary(cls: type) -> str:
    """Everything a docstring says before its sections, as Markdown."""
    text = inspect.getdoc(cls) or ""
    return markdown(re.split(r"\n\n\w+\n-+\n", text)[0])


def field_texts(cls: type) -> dict[str, str]:
    """Parameter → description, from the docstrings of a class and its bases."""
    found: dict[str, str] = {}
    for base in reversed(cls.__mro__):
        names: list[str] = []
        for line in inspect.cleandoc(vars(base).get("__doc__") or "").splitlines():
            match = FIELD.match(line)
            if match:
                names = match[1].split(", ")
                found |= dict.fromkeys(names, match[2])
            elif line.startswith("    ") and names:
                found |= {n: f"{found[n]} {line.strip()}" for n in names}
            else:
                names = []
    return found


def markdown(text: str) -> str:
    return re.sub(r"``([^`]+)``", r"`\1`", text).strip()


def cell(text: object) -> str:
    return " ".join(markdown(str(text)).replace("|", "\\|").split()) or " "


def table(headings: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    lines = ["| " + " | ".join(headings) + " |", "|" + "---|" * len(list(headings))]
    return "\n".join([*lines, *("| " + " | ".join(map(cell, row)) + " |" for row in rows)])


def shown_default(field: dataclasses.Field, needed: bool) -> str:
    if needed:
        return "needed"
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


# tables ----------------------------------------------------------------------------------
def record(name: str, cls: type, heading: str = "###") -> str:
    """Heading, text and keys of one class of the registry."""
    parts = [f"{heading} {name}", summary(cls)]
    ties = connected(cls)
    if ties:
        listed = ", ".join(f.name for f in ties)
        parts.append(f"`connect = [{listed}]`")
    texts, from_file, rows = field_texts(cls), FROM_FILE.get(name, ()), []
    for field in written(cls):
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
        parts.append(table(("key", "holds", "unit", "default", "meaning"), rows))
    else:
        parts.append("No keys of its own.")
    return "\n\n".join(parts)


def held(field: fields.FileField) -> str:
    """What a key holds, in words."""
    if field.holds is not fields.Quantities:
        return HOLDS[field.holds]
    fewer = f"{COUNTS[field.least]} or " if field.least else ""
    return f"{fewer}{COUNTS[field.size]} formulas"


def records(registry: dict[str, type], heading: str = "###") -> str:
    return "\n\n".join(record(name, cls, heading) for name, cls in registry.items())


def section(model: type, texts: dict[str, str]) -> str:
    """Keys of a fixed table of the schema; every key needs a text here or in the schema."""
    rows = []
    for name, field in model.model_fields.items():
        default = "needed" if field.is_required() else _plain_default(field)
        text = texts.get(name) or field.description or ""
        rows.append((f"`{field.alias or name}`", default, text))
    missing = [key for key, _, text in rows if not text]
    if missing:
        raise SystemExit(f"{model.__name__}: describe {', '.join(missing)}")
    return table(("key", "default", "meaning"), rows)


def _plain_default(field) -> str:
    default = field.get_default(call_default_factory=True)
    if default is None or default == "" or default == {} or default == []:
        return "none"
    if isinstance(default, bool):
        return f"`{str(default).lower()}`"
    if isinstance(default, (int, float)):
        return f"`{default:g}`"
    return f'`"{default}"`' if isinstance(default, str) else "none"


ABOUT = "text for people"
UNIT = "coherent unit of the formula, such as `m^3/s`"
FIXED = {
    "document": (
        schema.Document,
        {
            "schema_location": "address of a schema, for editors",
            "format": "version of the format: `1`",
            "description": ABOUT,
            "parameters": "name → number, or a table as below",
            "derived": "name → formula of parameters, or a table as below",
            "ground": "named points and frames, in `[ground.points]` and `[ground.frames]`",
            "bodies": "name → body; the type `Body` may be left out",
            "beams": "name → beam; the type `Beam` may be left out",
            "joints": "name → joint",
            "drivers": "name → driver",
            "forces": "name → force",
            "initial": "measure → number or formula that it has at the start, exactly",
            "analysis": "what `dalembert run` computes",
            "compare": "what `dalembert compare` combines",
            "responses": "name → response",
            "cases": "name → another run that a design is judged by",
            "combined": "name → formula of responses",
            "pareto": "between which aims `dalembert pareto` lets choose",
            "random": "list of random parameters",
            "reliability": "which limits `dalembert reliability` looks at",
            "tolerance": "which tolerances `dalembert tolerance` follows",
            "invert": "from what `dalembert invert` finds the histories",
            "synthesis": "what linkages `dalembert synthesize` finds",
            "sensitivity": "what `dalembert sensitivity` computes",
            "optimize": "what `dalembert optimize` computes",
            "identify": "what `dalembert identify` finds",
            "sweep": "which designs `dalembert sweep` runs",
            "report": "what the report shows first",
        },
    ),
    "parameter": (
        schema.ParameterTable,
        {
            "value": 'nominal value in `unit`, or a text with its unit: `"45 mm"`',
            "unit": 'what value and bounds are given in: `"mm"`, `"deg"`; SI units if left out',
            "bounds": "`[lower, upper]` for designs, in `unit`; `inf` leaves a side open",
            "description": ABOUT,
        },
    ),
    "derived": (
        schema.DerivedTable,
        {
            "formula": "formula of parameters and other derived ones",
            "unit": UNIT,
            "description": ABOUT,
        },
    ),
    "inline": (tables.InlinePoint, {"body": "name of a body", "at": "its coordinates there [m]"}),
    "frame": (orientations.InlineFrame, {}),
    "event": (
        tables.EventTable,
        {
            "measure": "measure or formula that crosses zero",
            "terminal": "the run ends there",
            "direction": "`1` rising, `-1` falling, `0` both",
        },
    ),
    "compare": (
        task_tables.CompareTable,
        {
            "formulations": "names, or tables with `type` and keys; by default "
            "[a few](formulations.md#see-it-on-your-mechanism)",
            "integrators": "the same",
            "stabilizations": "the same; `Projection` by default",
            "coordinates": "the same; `AbsoluteCoordinates` where formulations are named",
        },
    ),
    "sensitivity": (
        task_tables.SensitivityTable,
        {
            "method": '`"auto"`, `"adjoint"`, `"direct"` or `"finite-difference"`',
        },
    ),
    "sweep": (
        task_tables.SweepTable,
        {"type": '`"Grid"`, `"LatinHypercube"`, `"MonteCarlo"`, `"Sobol"` or `"Table"`'},
    ),
    "optimize": (
        decision_tables.OptimizeTable,
        {
            "minimize": "name of the response to make small; this or `maximize`",
            "maximize": "name of the response to make large",
            "method": "how it is searched for, see [methods](optimization.md#methods)",
            "gradient": "method of the gradients",
            "max_iterations": "of the optimiser",
            "tolerance": "on the relative change of the objective",
        },
    ),
    "limit": (
        decision_tables.LimitTable,
        {
            "response": "name of a response",
            "lower": "it must not be below",
            "upper": "it must not be above",
        },
    ),
    "identify": (
        task_tables.IdentifyTable,
        {
            "data": "file of measurements beside this one, .csv or .parquet",
            "time": "column of the times; `time` or `t` by default",
            "loss": '`"linear"`, or against outliers `"soft_l1"`, `"huber"`, `"cauchy"`, '
            '`"arctan"`',
            "max_iterations": "of least squares",
        },
    ),
    "experiment": (
        task_tables.ExperimentTable,
        {
            "data": "file of measurements",
            "name": "in results; its number by default",
        },
    ),
    "case": (schema.CaseTable, {}),
    "combined": (decision_tables.CombinedTable, {}),
    "pareto": (
        decision_tables.ParetoTable,
        {
            "method": "how it is searched for, see [several aims](optimization.md#several-aims)",
            "gradient": "method of the gradients",
            "max_iterations": "of each point",
            "tolerance": "on the relative change of the objective",
        },
    ),
    "reliability": (
        decision_tables.ReliabilityTable,
        {
            "method": '`"improved-hlrf"` or `"hlrf"`',
            "tolerance": "on residual and distance of the design point",
            "max_iterations": "of each search",
        },
    ),
    "tolerance": (decision_tables.ToleranceTable, {}),
    "allot": (
        decision_tables.AllotTable,
        {
            "exponent": "of the tolerance in its cost",
            "worst_case": "all tolerances used up at once; statistical by default",
        },
    ),
    "synthesis": (decision_tables.SynthesisTable, {}),
    "history": (task_tables.HistoryTable, {}),
    "invert": (task_tables.InvertTable, {"max_iterations": "of least squares"}),
    "report": (task_tables.ReportTable, {}),
}


def functions() -> str:
    names = (f"`{n}({', '.join('abc'[:k])})`" for n, (_, k) in FUNCTIONS.items())
    return ", ".join(names)


# names and examples -------------------------------------------------------------------------
def api() -> str:
    """Every public name with its signature and first sentence."""
    rows = []
    for name in sorted(dalembert.__all__, key=lambda n: (n[0].islower(), n.lower())):
        rows.append((f"`{name}`", _kind(getattr(dalembert, name)), _first(name)))
    return table(("name", "is", "what it is for"), rows)


NAMED = {
    "t": "time, in laws, forces and user constraints",
    "u": "parameter of a curve that is written as formulas",
    "laws": "motion laws for drivers",
    "planar": "planar bodies, joints, drivers and forces",
    "spatial": "bodies, joints, drivers and forces in space",
    "rotation": "orientations: `axis_angle`, `euler`, `bryant`, `from_matrix`",
    "absolute": "absolute value",
    "where": "`where(condition, a, b)`: a where the condition holds, else b",
    "sign": "−1, 0 or 1",
}


def _kind(value: object) -> str:
    if inspect.isclass(value):
        return "error" if issubclass(value, Exception) else "class"
    if inspect.ismodule(value):
        return "module"
    return "function" if callable(value) else "expression"


def _first(name: str) -> str:
    value = getattr(dalembert, name)
    if name in NAMED:
        return NAMED[name]
    if inspect.isfunction(value) and value.__name__ == "lifted":
        return f"{name} of numbers and formulas"
    return (inspect.getdoc(value) or "").partition("\n")[0]


CATEGORIES: dict[str, tuple[str, set[str]]] = {
    "Linkages, cams and gears": (
        "quick_return_shaper",
        set(
            "four_bar slider_crank quick_return_shaper sewing_machine cam_follower geneva_wheel "
            "double_parallelogram flat_four_bars n_four_bar massless_coupler rolling_disc carts "
            "cart_a cart_b cart_c "
            "gait_torques smooth_torque chain_drive excavator four_bar_balancing".split()
        ),
    ),
    "Mechanisms in space": (
        "rssr_four_bar",
        set(
            "bicycle bricard bump_steer double_wishbone governor gyroscope heavy_top robot_arm rssr_four_bar "
            "spatial_slider_crank stewart_platform universal_driveline".split()
        ),
    ),
    "Flexible mechanisms": (
        "",
        set(
            "compliant_gripper elastic_slider_crank flexible_robot_arm leaf_spring "
            "tapered_arm".split()
        ),
    ),
    "Contact and impacts": (
        "",
        set("cam_lift_off catenary_cable discs_in_a_box slider_crank_with_play woodpecker".split()),
    ),
    "Structures": ("", set("plate truss ten_bar_truss marimba_bar mbb_beam tuned_mass".split())),
    "Design": (
        "path_optimization",
        set(
            "catapult four_bar_map four_bar_study identified_arm path_optimization pump_front "
            "gripper reliable_truss shaper_tolerances smallest_cam straight_line_synthesis "
            "swing_up".split()
        ),
    ),
    "Cases of the book, methods side by side": (
        "spring_pendulum",
        set(
            "bar_slider_mass body_about_a_point compare_four_bar finite_difference_steps "
            "four_bar_violation oscillator_energy partition_conditioning pendulum_multipliers "
            "slider_and_link slider_link_crank sliding_pendulum spherical_particle "
            "spring_pendulum three_body_system".split()
        ),
    ),
}
"""Of the gallery: title → a moving picture, and its examples."""


def gallery() -> str:
    folder = ROOT / "examples"
    stems = sorted(
        {p.stem for p in folder.glob("*.toml")}
        | {p.stem for p in folder.glob("*.py") if "def main(" in p.read_text(encoding="utf-8")}
    )
    parts = []
    for title, (moving, members) in CATEGORIES.items():
        parts.append(f"## {title}")
        if moving:
            parts.append(f"![{moving.replace('_', ' ')}, moving](gallery/{moving}.gif)")
        parts += [_example(folder, stem) for stem in stems if stem in members]
    known = {stem for _, members in CATEGORIES.values() for stem in members}
    if missing := [stem for stem in stems if stem not in known]:
        raise ValueError(f"the gallery has no category for {', '.join(missing)}")
    return "\n\n".join(parts)


def _example(folder: Path, stem: str) -> str:
    script, model = folder / f"{stem}.py", folder / f"{stem}.toml"
    if script.exists():
        text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    else:
        lines = model.read_text(encoding="utf-8").splitlines()
        comments = lines[: next(k for k, line in enumerate(lines) if not line.startswith("#"))]
        text = "\n".join(line.lstrip("# ") for line in comments)
    links = [f"[{p.name}](../examples/{p.name})" for p in (model, script) if p.exists()]
    parts = [f"### {stem.replace('_', ' ')}", markdown(text), ", ".join(links)]
    if (DOCS / "gallery" / f"{stem}.png").exists():
        parts.append(f"![{stem.replace('_', ' ')}](gallery/{stem}.png)")
    return "\n\n".join(parts)


# putting in ---------------------------------------------------------------------------------
PARTS: dict[str, Callable[[], str]] = {
    **{name: (lambda pair=pair: section(*pair)) for name, pair in FIXED.items()},
    "bodies": lambda: records(PLANAR.sections["bodies"]),
    "beams": lambda: records(PLANAR.sections["beams"]),
    "joints": lambda: records(PLANAR.sections["joints"]),
    "drivers": lambda: records(PLANAR.sections["drivers"]),
    "forces": lambda: records(PLANAR.sections["forces"]),
    **{
        f"spatial_{name}": (lambda name=name: records(SPATIAL.sections[name], "####"))
        for name in SPATIAL.sections
    },
    "laws": lambda: records(LAWS),
    "curves": lambda: records(CURVES),
    "shapes": lambda: records(SHAPES[2], "####"),
    "spatial_shapes": lambda: records(SHAPES[3], "####"),
    "contact_laws": lambda: records(CONTACT_LAWS, "####"),
    "frictions": lambda: records(FRICTIONS, "####"),
    "analyses": lambda: records(ANALYSES),
    "coordinates": lambda: records(COORDINATES),
    "formulations": lambda: records(FORMULATIONS),
    "stabilizations": lambda: records(STABILIZATIONS),
    "integrators": lambda: records(INTEGRATORS),
    "responses": lambda: records(RESPONSES),
    "distributions": lambda: records(
        {n: decision_tables.distribution(n) for n in decision_tables.DISTRIBUTIONS}, "####"
    ),
    "functions": functions,
    "api": api,
    "gallery": gallery,
}
BLOCK = re.compile(r"<!-- generated: (\w+) -->\n.*?<!-- end: \1 -->", re.DOTALL)


def renewed(text: str) -> str:
    """A page with its generated parts made again."""
    return BLOCK.sub(
        lambda m: f"<!-- generated: {m[1]} -->\n\n{PARTS[m[1]]()}\n\n<!-- end: {m[1]} -->", text
    )


def stale(write: bool = False) -> list[Path]:
    """Pages whose generated parts differ from the code."""
    found = []
    for page in sorted(DOCS.glob("*.md")):
        old = page.read_text(encoding="utf-8")
        new = renewed(old)
        if new != old:
            found.append(page)
            if write:
                page.write_text(new, encoding="utf-8")
    return found


def main(arguments: list[str]) -> int:
    check = "--check" in arguments
    pages = stale(write=not check)
    for page in pages:
        print(f"{'out of date' if check else 'renewed'}: {page.relative_to(ROOT)}")
    return int(check and bool(pages))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
