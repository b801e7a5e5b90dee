"""Model files: what Python users write and what files hold are the same."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from flexible_bodies import write_beam

import dalembert as da
from dalembert import planar
from dalembert.elements.registry import (
    CONTACT_LAWS,
    CURVES,
    FRICTIONS,
    LAWS,
    PLANAR,
    SHAPES,
)
from dalembert.io import load, load_model_file
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.designs import make_design
from dalembert.io.decisions.responses import make_responses
from dalembert.io.decisions.tasks import make_gradient
from dalembert.io.strategies import ANALYSES, RESPONSES, STRATEGIES

EXAMPLES = sorted((Path(__file__).parents[1] / "examples").glob("*.toml"))

HEAD = """\
format = 1
[parameters]
k = 2.0
[ground.points]
G = [0.0, 0.0]
[bodies.a]
mass = 1.0
inertia = 0.1
position = [1.0, 0.0]
points = { P = [0.1, 0.0] }
[bodies.b]
mass = 1.0
inertia = 0.1
position = [2.0, 0.0]
[joints.J]
type = "Revolute"
connect = ["ground.G", "a"]
"""

TWO_POINTS, TWO_BODIES = 'connect = ["a.P", "b"]\n', 'connect = ["a", "b"]\n'
# every registered element: what a file gives besides its type
ELEMENTS = {
    "bodies": {
        "Body": "",
        "Bar": 'length = "k/2"\nmass = 1',
        "Particle": "mass = 1",
        "FlexibleBody": 'structure = "beam.toml"\ninterface = { P = "n0", Q = ["n1"] }\n'
        'reference = "P"\ndamping_ratio = "k/100"\nparameters = { E = "1e9*k" }',
        "Node": "position = ['k', 0]\nangle = 0.1\nmass = 1\ninertia = 0.1",
        "PointNode": "position = ['k', 0]",
    },
    "beams": {
        "Beam": "length = 'k'\naxial_rigidity = 9\nshear_rigidity = 5\nbending_rigidity = 'k'\n"
        "mass_per_length = 1\nframe_i = 'a.P'",
    },
    "joints": {
        "Revolute": TWO_POINTS,
        "Prismatic": TWO_POINTS + 'axis = ["k", 1]\nangle = 0.1',
        "PinInSlot": TWO_POINTS,
        "Weld": TWO_POINTS,
        "RigidLink": TWO_POINTS + "length = 1.0",
        "PointOnCurve": 'connect = ["a", "b"]\nradius = 0.1\n'
        'curve = { type = "SplineCurve", points = [[0.1, 0], [0, 0.1], [-0.1, 0], [0, -0.1]] }',
        "GearPair": TWO_POINTS + 'radius_i = 0.1\nradius_j = "k"\ninternal = true',
        "RackAndPinion": TWO_POINTS + "radius = 0.1\nside = -1",
        "RollingDisc": TWO_POINTS + "radius = 0.1",
        "Coupling": TWO_BODIES + 'ratio = -2\ncarrier = "ground"',
        "UserConstraint": 'formula = "a.angle - k*b.angle"\nunit = "rad"',
    },
    "drivers": {
        "RotationalDriver": TWO_BODIES + 'law = "k*t"',
        "TranslationalDriver": TWO_POINTS + "axis = [1, 0]\nlaw = 0.1",
        "DistanceDriver": TWO_POINTS + 'law = "1 + 0.1*sin(t)"',
        "CoordinateDriver": 'connect = ["b"]\ndirection = [0, 1]\nlaw = 0',
    },
    "forces": {
        "Force": 'connect = ["a.P"]\nvector = ["k*sin(t)", "-b.vx"]\nfollowing = true',
        "Torque": 'connect = ["a"]\nvalue = "-0.1*a.angular_velocity"\nreaction_on = "b"',
        "Spring": TWO_POINTS
        + 'stiffness = "k"\nfree_length = 0.5\nlaw = "k*extension**3 + 0*rate"',
        "TorsionSpring": TWO_BODIES + "stiffness = 1\ndamping = 0.1",
        "Actuator": TWO_POINTS + 'force = "t"',
        "Bushing": TWO_POINTS + "stiffness = [1, 2]\nrotational_stiffness = 3",
        "JointFriction": 'joint = "J"\ncoulomb = "0.1*J.force_norm"\nviscous = 0.1',
        "JointActuator": 'joint = "J"\nvalue = "3*cos(t)"',
        "BristleFriction": 'joint = "J"\ncoulomb = "k/10"\nstatic = 0.3',
        "DCMotor": 'joint = "J"\nvoltage = "3*cos(t) - new.current"\nconstant = "k/10"',
        "HydraulicCylinder": TWO_POINTS + 'opening = "0.1*sin(t) - new.pressure_a/1e8"',
        "Stop": 'coordinate = "a.x"\nupper = 3\nstiffness = 100',
        "ClearanceRevolute": TWO_POINTS + "radius = 0.1\nclearance = 0.01\n"
        'law = { type = "KelvinVoigt", stiffness = "k" }',
        "Cable": 'points = ["a.P", { body = "ground", at = [0, "k"] }, "b"]\n'
        "length = 1\nstiffness = 100",
        "Contact": 'shape_j = "b"\nshape_i = { type = "Circle", point = "a", radius = "k/10" }\n'
        'law = { type = "Hertz", stiffness = "k" }\nfriction = { type = "Coulomb", dynamic = 0.3 }',
        "UnilateralConstraint": 'distance = "a.y + k"\nslip = "a.vx"\nrestitution = 0.5',
        "Collisions": 'shapes = [{ type = "Circle", point = "a", radius = "k/9" }]\nfriction = 0.1',
    },
}
REGISTRIES = PLANAR.sections
LAW_TABLES = {
    "Formula": 'formula = "k*t"',
    "Polynomial": 'velocity = "k"',
    "Harmonic": "amplitude = 1, frequency = 2",
    "HarmonicRise": "height = 1, duration = 2",
    "CycloidalRise": "height = 1, duration = 2, fall = 1",
    "Polynomial345Rise": "height = 1, duration = 2, fall = 1, period = 4",
    "Polynomial4567Rise": "height = 1, duration = 2",
    "Table": 'times = [0, "k/2", 2], values = [0, "k/2", 0], periodic = true',
    "Sum": 'laws = [{ type = "Harmonic", amplitude = 1, frequency = 2 }, "k*t", 0.5]',
    "Product": 'laws = ["k", { type = "Polynomial", velocity = 1 }]',
}
CURVE_TABLES = {
    "SplineCurve": 'points = [["k/10", 0], [0, 0.1], [-0.1, 0]], closed = true',
    "FormulaCurve": 'x = "k*cos(u)", y = "sin(u)", upper = "2*pi"',
}


def written(tmp_path, text: str, name: str = "model.toml") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


CASES = [(s, name) for s, registry in REGISTRIES.items() for name in registry]


@pytest.mark.parametrize(("section", "name"), CASES, ids=[n for _, n in CASES])
def test_every_element_can_be_written(section, name, tmp_path, schema):
    write_beam(tmp_path, 2)
    text = f'{HEAD}[{section}.new]\ntype = "{name}"\n{ELEMENTS[section][name]}\n'
    system = load(written(tmp_path, text))
    assert type(system.elements["new"]) is REGISTRIES[section][name]
    schema.validate(tomllib.loads(text))


@pytest.mark.parametrize("name", LAWS)
def test_every_law_can_be_written(name, tmp_path, schema):
    law = f'law = {{ type = "{name}", {LAW_TABLES[name]} }}'
    text = f'{HEAD}[drivers.new]\ntype = "RotationalDriver"\nconnect = ["ground", "a"]\n{law}\n'
    model = load(written(tmp_path, text)).build()
    assert type(model.parts.elements["new"].law) is LAWS[name]
    schema.validate(tomllib.loads(text))


@pytest.mark.parametrize("name", CURVES)
def test_every_curve_can_be_written(name, tmp_path, schema):
    curve = f'curve = {{ type = "{name}", {CURVE_TABLES[name]} }}'
    text = f'{HEAD}[joints.new]\ntype = "PointOnCurve"\nconnect = ["a", "b"]\n{curve}\n'
    assert type(load(written(tmp_path, text)).elements["new"].curve) is CURVES[name]
    schema.validate(tomllib.loads(text))


SHAPE_TABLES = {
    "Vertex": 'point = "a.P"',
    "Circle": 'point = "a", radius = "k/10"',
    "Bore": 'point = { body = "a", at = [0, "k"] }, radius = 9',
    "HalfPlane": 'point = "a.P", normal = ["k", 2]',
    "Polygon": 'body = "a", vertices = [["k", 0], [0, 1], [-1, 0]]',
    "Rectangle": 'point = "a", size = [1, "k"]',
    "Outline": 'body = "a", vertices = [["k", 0], [0, 1], [-1, 0], [0, 0.1]]',
    "Capsule": 'point_i = "a", point_j = "a.P", radius = "k"',
    "Sprocket": 'point = "a", teeth = 9, pitch = 0.1, roller = "0.06*k/k"',
    "Profile": f'body = "a", curve = {{ type = "FormulaCurve", {CURVE_TABLES["FormulaCurve"]} }}',
    "BeamLine": 'beam = "strip", radius = "k/100", stations = 2',
    "BeamSurface": 'beam = "strip", radius = "k/100"',
}
CONTACT_TABLES = {
    "Hertz": 'stiffness = "k"',
    "HuntCrossley": 'stiffness = "k", damping = 0.3, exponent = 1',
    "LankaraniNikravesh": 'stiffness = "k", restitution = 0.9, impact_speed = 1',
    "Flores": 'stiffness = "k", restitution = 0.9, impact_speed = 1',
    "KelvinVoigt": 'stiffness = "k", damping = 1',
    "Restitution": "e = 0.5",
}
FRICTION_TABLES = {
    "Coulomb": 'dynamic = 0.2, static = 0.3, slip_speed = "k"',
    "Stribeck": "dynamic = 0.2, stribeck_speed = 1, viscous = 0.1",
    "LuGre": 'dynamic = 0.2, stiffness = "1e5*k", damping = 0.1',
}


def test_every_part_of_a_contact_is_known_here():
    assert list(SHAPE_TABLES) == list(SHAPES[2])
    assert list(CONTACT_TABLES) == list(CONTACT_LAWS) and list(FRICTION_TABLES) == list(FRICTIONS)


@pytest.mark.parametrize(
    ("shape", "law", "friction"),
    [
        *((shape, "Hertz", "Coulomb") for shape in SHAPE_TABLES),
        *(("Circle", law, "Coulomb") for law in CONTACT_TABLES),
        *(("Circle", "Hertz", friction) for friction in FRICTION_TABLES),
    ],
)
def test_every_contact_can_be_written(shape, law, friction, tmp_path, schema):
    other = "Circle" if shape != "Circle" else "HalfPlane"
    touching = SHAPE_TABLES[other].replace('"a"', '"b"').replace('"a.P"', '"b"')
    parts = {
        "shape_i": (shape, SHAPE_TABLES[shape]),
        "shape_j": (other, touching),
        "law": (law, CONTACT_TABLES[law]),
        "friction": (friction, FRICTION_TABLES[friction]),
    }
    lines = (f'{key} = {{ type = "{kind}", {text} }}' for key, (kind, text) in parts.items())
    beam = f"[beams.strip]\n{ELEMENTS['beams']['Beam']}\n"
    text = f'{HEAD}{beam}[forces.new]\ntype = "Contact"\n' + "\n".join(lines)
    element = load(written(tmp_path, text)).elements["new"]
    kinds = [type(getattr(element, key)).__name__ for key in parts]
    assert kinds == [shape, other, law, friction]
    schema.validate(tomllib.loads(text))


NAMED = [(key, name) for key, registry in STRATEGIES.items() for name in registry]


@pytest.mark.product
@pytest.mark.parametrize(("key", "name"), NAMED)
@pytest.mark.parametrize("form", ["{!r}", "{{ type = {!r} }}"])
def test_every_strategy_can_be_named(key, name, form, tmp_path, schema):
    text = f'{HEAD}[analysis]\ntype = "Dynamics"\nduration = 1\n{key} = {form.format(name)}\n'
    if name == "DAE":  # refused with the default, which is explicit
        text += 'integrator = "Radau"\n'
    file = load_model_file(written(tmp_path, text))
    analysis = make_analysis(file, file.model())
    assert type(getattr(analysis, key)).__name__ == name
    schema.validate(tomllib.loads(text))


TOUCHING = """
[forces.hits]
type = "Collisions"
shapes = [
    { type = "Circle", point = "b", radius = 0.1 },
    { type = "HalfPlane", point = "ground", normal = [1, 0] },
]
"""


@pytest.mark.parametrize("name", ANALYSES)
def test_every_analysis_can_be_asked_for(name, tmp_path, schema):
    text = f'{HEAD}[analysis]\ntype = "{name}"\n'
    if "duration" in ANALYSES[name].__dataclass_fields__:
        text += "duration = 1.0\noutputs = [0.0, 0.5]\n"
    if name == "Nonsmooth":  # refused where nothing may touch
        text += TOUCHING
    file = load_model_file(written(tmp_path, text))
    assert type(make_analysis(file, file.model())) is ANALYSES[name]
    schema.validate(tomllib.loads(text))


@pytest.mark.parametrize("name", RESPONSES)
def test_every_response_can_be_asked_for(name, tmp_path, schema):
    text = f'{HEAD}[responses.r]\ntype = "{name}"\nmeasure = "a.angle + k"\n'
    if name == "At":
        text += "time = 0.5\n"
    if name == "AtEvent":
        text += 'event = "passes"\noccurrence = 2\n'
        text += '[analysis]\ntype = "Dynamics"\nduration = 1\nevents = { passes = "a.x" }\n'
    file = load_model_file(written(tmp_path, text))
    responses, parameters = make_gradient(file, file.model())
    assert type(responses["r"]) is RESPONSES[name]
    assert responses["r"].label == "r"
    assert parameters == ["k"]
    schema.validate(tomllib.loads(text))


# the file says what Python says ------------------------------------------------------
def four_bar_in_python() -> da.System:
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3)
    l2 = system.parameter("l2", 1.0)
    l3 = system.parameter("l3", 0.6)
    rho = system.parameter("rho", 5.0)
    crank = system.add(
        planar.Bar("crank", length=l1, mass=rho * l1, angle=np.pi / 2, angular_velocity=1.0)
    )
    coupler = system.add(planar.Bar("coupler", length=l2, mass=rho * l2, angle=0.2))
    rocker = system.add(planar.Bar("rocker", length=l3, mass=rho * l3, angle=1.2))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system


def test_four_bar_moves_as_written_in_python():
    path = next(p for p in EXAMPLES if p.stem == "four_bar")
    motions = [
        da.solve_dynamics(system.build(), 1.0, step=0.01)
        for system in (load(path), four_bar_in_python())
    ]
    for measure in ("crank.angle", "A.force_norm", "rocker.end.y"):
        np.testing.assert_allclose(
            motions[0].values(measure), motions[1].values(measure), rtol=1e-9
        )


@pytest.mark.parametrize("path", EXAMPLES, ids=[p.stem for p in EXAMPLES])
def test_examples_are_valid(path, schema):
    schema.validate(tomllib.loads(path.read_text(encoding="utf-8")))
    file = load_model_file(path)
    model = file.model()
    if file.document.analysis is not None:
        make_analysis(file, model)
    if file.document.optimize is not None:
        make_design(file, model)


@pytest.mark.parametrize("path", EXAMPLES, ids=[p.stem for p in EXAMPLES])
def test_json_is_the_same_file(path, tmp_path):
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    twin = written(tmp_path, json.dumps(data), f"{path.stem}.json")
    first, second = load_model_file(path).document, load_model_file(twin).document
    assert first == second
    again = written(
        tmp_path, json.dumps(first.model_dump(exclude_unset=True, by_alias=True)), "again.json"
    )
    assert load_model_file(again).document == first


# details ---------------------------------------------------------------------------------
def test_derived_in_any_order(tmp_path):
    text = HEAD + '[derived]\nc = "a1 + b1"\nb1 = { formula = "2*a1", unit = "m" }\na1 = "k"\n'
    system = load(written(tmp_path, text))
    assert list(system.derived_parameters) == ["a1", "b1", "c"]
    assert system.derived_parameters["b1"].unit == "m"


def test_a_thousand_derived(tmp_path):
    lines = [f'd{k} = "d{k + 1} + 1"' for k in range(1000)] + ['d1000 = "k"']
    system = load(written(tmp_path, HEAD + "[derived]\n" + "\n".join(lines)))
    assert len(system.derived_parameters) == 1001


def test_forces_may_name_later_ones(tmp_path):
    text = HEAD + (
        '[forces.first]\ntype = "Torque"\nconnect = ["a"]\nvalue = "0.1*Spring.force"\n'
        '[forces.Spring]\ntype = "Spring"\n' + TWO_POINTS + "stiffness = 1\n"
    )
    assert set(load(written(tmp_path, text)).elements) >= {"first", "Spring"}


def test_the_centre_of_a_body_has_a_name(tmp_path):
    """``"b.center"`` is the point that ``"b"`` is."""
    text = '[joints.new]\ntype = "Revolute"\nconnect = ["ground.center", "b.center"]\n'
    joint = load(written(tmp_path, HEAD + text)).elements["new"]
    assert [p.body.name for p in (joint.point_i, joint.point_j)] == ["ground", "b"]
    assert [float(x) for p in (joint.point_i, joint.point_j) for x in p.local] == [0.0] * 4
    with pytest.raises(da.ModelError, match=r"unknown point 'b.centre' \(did you mean 'b.center'"):
        load(written(tmp_path, HEAD + text.replace("b.center", "b.centre")))


def test_inline_points(tmp_path):
    text = HEAD + (
        '[joints.new]\ntype = "Revolute"\n'
        'connect = [{ body = "ground", at = ["k", 0] }, { body = "b", at = [0, 0.1] }]\n'
    )
    joint = load(written(tmp_path, text)).elements["new"]
    assert joint.point_i.body.name == "ground"
    assert float(joint.point_j.local[1]) == 0.1


def test_rows_from_a_file_beside_the_model(tmp_path):
    (tmp_path / "law.csv").write_text("time, angle\n# note\n0, 0\n1, 1\n\n2, 0\n", encoding="utf-8")
    text = HEAD + (
        '[drivers.new]\ntype = "RotationalDriver"\nconnect = ["ground", "a"]\n'
        'law = { type = "Table", file = "law.csv", periodic = true }\n'
        '[joints.cam]\ntype = "PointOnCurve"\nconnect = ["a", "b"]\n'
        'curve = { type = "SplineCurve", file = "law.csv", closed = false }\n'
    )
    system = load(written(tmp_path, text))
    assert system.elements["new"].law.spline.knots == [0, 1, 2]
    assert len(system.elements["cam"].curve.points) == 3


def test_rows_of_a_file_in_the_units_of_its_heading(tmp_path):
    rows = "time [ms], angle [deg]\n0, 0\n1000, 180\n2000, 0\n"
    (tmp_path / "law.csv").write_text(rows, encoding="utf-8")
    text = HEAD + (
        '[drivers.new]\ntype = "RotationalDriver"\nconnect = ["ground", "a"]\n'
        'law = { type = "Table", file = "law.csv" }\n'
    )
    spline = load(written(tmp_path, text)).elements["new"].law.spline
    assert spline.knots == pytest.approx([0, 1, 2])
    assert spline.values == pytest.approx([0, math.pi, 0])


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,0\n1;1\n", "line 2"),
        ("", "no rows"),
        ("0,0,0\n0,0,0\n", "has 3 columns; expected 2"),
        ("time [mm], angle [rad]\n0, 0\n1, 1\n2, 0\n", "'time' is in 'mm'; expected a unit of s"),
        ("a, a\n0, 0\n1, 1\n2, 0\n", "two columns are named 'a'"),
        ("0,0\n2,1\n1,0\n", "increase"),
    ],
)
def test_wrong_rows(rows, words, tmp_path):
    (tmp_path / "law.csv").write_text(rows, encoding="utf-8")
    text = HEAD + (
        '[drivers.new]\ntype = "RotationalDriver"\nconnect = ["ground", "a"]\n'
        'law = { type = "Table", file = "law.csv" }\n'
    )
    with pytest.raises(da.DalembertError, match=words) as message:
        load(written(tmp_path, text))
    assert "model.toml: drivers.new.law" in str(message.value)


def test_initial_is_held_exactly(tmp_path):
    text = HEAD + '[initial]\n"a.angle" = "k/4"\n"a.angular_velocity" = 3\n'
    model = load(written(tmp_path, text)).build()
    motion = da.solve_dynamics(model, 0.01, step=0.01)
    assert motion.values("a.angle")[0] == pytest.approx(0.5)
    assert motion.values("a.angular_velocity")[0] == pytest.approx(3)


def test_events_and_tables(tmp_path):
    text = HEAD + (
        '[analysis]\ntype = "Dynamics"\nt_span = [0, "pi"]\n'
        'integrator = { type = "DormandPrince", rtol = 1e-6 }\n'
        "stabilization = { type = 'Projection', every = 2 }\n"
        "[analysis.events]\nplain = 'a.angle - 1'\n"
        "flat = { measure = 'a.angle', terminal = true, direction = -1 }\n"
    )
    file = load_model_file(written(tmp_path, text))
    analysis = make_analysis(file, file.model())
    assert analysis.t_span == (0.0, np.pi)
    assert analysis.integrator.rtol == 1e-6
    assert analysis.stabilization.every == 2
    assert analysis.events["flat"].terminal
    assert analysis.events["flat"].direction == -1
    assert not analysis.events["plain"].terminal


def test_a_response_at_an_unknown_event_is_refused(tmp_path):
    text = HEAD + (
        '[analysis]\ntype = "Dynamics"\nduration = 1\nevents = { passes = "a.x" }\n'
        '[responses.r]\ntype = "AtEvent"\nmeasure = "time"\nevent = "pases"\n'
    )
    file = load_model_file(written(tmp_path, text))
    with pytest.raises(da.ModelError, match=r"responses\.r\.event.*'pases'.*did you mean 'passes'"):
        make_responses(file, file.model())
    text = text.replace("pases", "passes").replace("passes = ", "reached = ", 1)
    file = load_model_file(written(tmp_path, text))
    with pytest.raises(da.ModelError, match=r"known in the events of its analysis: reached"):
        make_responses(file, file.model())


def test_limits(tmp_path):
    text = HEAD.replace("k = 2.0", "k = { value = 2.0, bounds = [1, 3] }") + (
        '[responses.r]\ntype = "Final"\nmeasure = "a.angle"\n'
        '[optimize]\nmaximize = "r"\nsubject_to = [{ response = "r", lower = 0.1 }]\n'
    )
    file = load_model_file(written(tmp_path, text))
    design = make_design(file, file.model())
    assert design["vary"] == ["k"]
    assert design["subject_to"][0].lower == 0.1
    assert design["maximize"] is design["subject_to"][0].response


# schema -----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "change",
    [
        {"format": 2},
        {"jionts": {}},
        {"bodies": {"a": {"mas": 1}}},
        {"bodies": {"a": {"mass": True}}},
        {"joints": {"A": {"type": "Revolute", "connect": ["a"]}}},
        {"joints": {"A": {"type": "Revolut", "connect": ["a", "b"]}}},
        {"gravity": [0, 0, 0, 0]},
    ],
)
def test_schema_refuses(change, schema):
    assert not schema.is_valid({"format": 1, **change})


def test_definitions_have_names_of_their_own(schema):
    """An element is called by its space; what a file of another space says in full, by both."""
    names = schema.schema["$defs"]
    assert not [name for name in names if "__" in name]
    types = {name: names[name]["properties"]["type"] for name in names if name.endswith("Revolute")}
    assert types["PlanarRevolute"]["enum"] == ["Revolute", "planar.Revolute"]
    assert types["SpatialRevolute"]["enum"] == ["Revolute", "spatial.Revolute"]
    assert names["PlanarRevoluteInSpatialDocument"]["properties"]["type"]["const"] == (
        "planar.Revolute"
    )


def test_schema_tells_units(schema):
    bar = schema.schema["$defs"]["PlanarBar"]["properties"]
    assert "[m]" in bar["length"]["description"]
    assert "[kg m^2]" in bar["inertia"]["description"]


def test_checking_makes_no_step():
    """What cannot work is told by the strategies; steps are made by the run."""
    file = load_model_file(next(p for p in EXAMPLES if p.name == "four_bar.toml"))
    model = file.model()
    analysis = make_analysis(file, model)
    variants = analysis.kernel(model).variants
    assert variants and not any({"step", "attempt"} & set(vars(v)) for v in variants)


@pytest.mark.parametrize(
    ("name", "law", "by_ends"),
    [
        ("RotationalDriver", '"k*t"', 'connect = ["ground", "a"]'),
        ("TranslationalDriver", '"0.1*t"', 'connect = ["a.P", "b"]\naxis = [1, 2]'),
    ],
)
def test_a_driver_names_its_joint_or_its_ends(name, law, by_ends, tmp_path):
    """Both forms state the same equation; a driver with neither is refused."""
    slot = '[joints.S]\ntype = "PinInSlot"\nconnect = ["a.P", "b"]\naxis = [1, 2]\n'
    joint = "J" if name == "RotationalDriver" else "S"
    equations = []
    for k, ends in enumerate((f'joint = "{joint}"', by_ends)):
        text = f'{HEAD}{slot}[drivers.D]\ntype = "{name}"\n{ends}\nlaw = {law}\n'
        model = load(written(tmp_path, text, f"{k}.toml")).build()
        equations.append(str(model.constraints[-1].equations))
    assert equations[0] == equations[1]
    text = f'{HEAD}[drivers.D]\ntype = "{name}"\nlaw = {law}\n'
    with pytest.raises(da.ModelError, match=r"drivers.D: .*give a joint that leaves a .* free, or"):
        load(written(tmp_path, text))
