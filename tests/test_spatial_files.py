"""Every element in space can be written in a model file."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest
from flexible_bodies import write_beam

from dalembert.elements.base import Element
from dalembert.elements.registry import SPATIAL
from dalembert.io import json_schema, load

HEAD = """\
format = 1
dimension = 3
[parameters]
k = 2.0
[ground.frames]
G = { axis = [0, 0, 1] }
[bodies.a]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
position = [1, 0, 0]
points = { P = [0.1, 0, 0] }
frames = { F = { at = [-1, 0, 0], axis = [0, 0, 1] } }
[bodies.b]
mass = 1.0
inertia = [0.1, 0.1, 0.1]
position = [2, 0, 0]
frames = { F = { axis = [0, 0, 1], x = [1, 0, 0] } }
[joints.J]
type = "Revolute"
connect = ["ground.G", "a.F"]
[joints.S]
type = "Cylindrical"
connect = ["a.F", "b.F"]
"""
POINTS, FRAMES = 'connect = ["a.P", "b"]\n', 'connect = ["a.F", "b.F"]\n'
SPOT = 'connect = ["b.F", "a.P"]\n'
OBJ = """\
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
ELEMENTS = {
    "bodies": {
        "Body": "mass = 1\ninertia = [1, 1, 1]\nrotation = { type = 'bryant', x=0, y='k', z=0 }",
        "Particle": "mass = 1\nvelocity = [1, 'k', 0]",
        "Bar": "length = 'k'\nmass = 1\nradius = 0.1",
        "Box": "size = ['k', 1, 2]\ndensity = 'k'",
        "Cylinder": "radius = 'k'\nlength = 1\ninner_radius = 0.1\ndensity = 1",
        "Sphere": "radius = 'k'\nmass = 1",
        "Capsule": "radius = 'k'\nlength = 1\ndensity = 1",
        "Mesh": "file = 'wedge.obj'\nscale = 'k'\ndensity = 1",
        "FlexibleBody": "structure = 'beam.toml'\ninterface = ['n0', 'n1']\nmodes = 1\n"
        "rayleigh = ['k', 0]",
    },
    "joints": {
        "Spherical": POINTS,
        "PointOnLine": SPOT,
        "PointOnPlane": SPOT,
        "RigidLink": POINTS + "length = 'k'",
        "RevoluteSphericalLink": SPOT + "length = 'k'",
        "RevoluteRevoluteLink": FRAMES + "length = 'k'\ntwist = 0.1",
        "ConstantVelocity": FRAMES,
        "Revolute": FRAMES,
        "Cylindrical": FRAMES,
        "Prismatic": FRAMES,
        "Universal": FRAMES,
        "Screw": FRAMES + "pitch = 'k'",
        "Planar": FRAMES,
        "Weld": FRAMES,
        "PointOnCurve": "connect = ['a', 'b']\n"
        "curve = { type = 'FormulaCurve', x = 'cos(u)', y = 'sin(u)', z = 'k*u' }",
        "GearPair": "joint_i = 'J'\njoint_j = 'S'\nradius_i = 'k'\nradius_j = 1",
        "RackAndPinion": "joint_i = 'J'\njoint_j = 'S'\nradius = 'k'\nside = -1",
        "Coupling": "joint_i = 'J'\njoint_j = 'S'\nratio = 'k'\nmotion_j = 'angle'",
        "RollingDisc": "connect = ['a', 'ground.G']\nradius = 'k'",
        "UserConstraint": "formula = 'a.x - k*b.y'",
        "KnifeEdge": "connect = ['a.F', 'ground.G']",
    },
    "drivers": {
        "RotationalDriver": "joint = 'J'\nlaw = 'k*t'",
        "TranslationalDriver": "joint = 'S'\nlaw = 'k*t'\nmotion = 'displacement'",
        "DistanceDriver": POINTS + "law = '1 + 0.1*sin(t)'",
        "CoordinateDriver": "connect = ['b']\ndirection = [0, 1, 0]\nlaw = 0",
    },
    "forces": {
        "Force": "connect = ['a.P']\nvector = ['k*sin(t)', '-b.vx', 0]\nfollows = 'b'",
        "Torque": "connect = ['a']\nvector = ['k', 0, 't']\nreaction_on = 'b'\nfollows = 'a'",
        "Spring": POINTS + "stiffness = 'k'\nfree_length = 0.5",
        "TorsionSpring": FRAMES + "stiffness = 'k'\nfree_angle = 0.1\nlaw = 'k*extension**3'",
        "Bushing": FRAMES + "stiffness = [1, 2, 'k']\nrotational_stiffness = [1, 1, 'k']",
        "Actuator": POINTS + "force = 't'",
        "JointFriction": "joint = 'J'\ncoulomb = '0.1*J.force_norm'\nviscous = 0.1",
        "JointActuator": "joint = 'J'\nvalue = '3*cos(t)'\nmotion = 'angle'",
        "Stop": "coordinate = 'a.x'\nupper = 3\nstiffness = 100",
    },
}
CASES = [(section, name) for section, table in SPATIAL.sections.items() for name in table]


@pytest.fixture(scope="module")
def schema():
    jsonschema = pytest.importorskip("jsonschema")
    return jsonschema.Draft202012Validator(json_schema())


def written(section: str, name: str, folder: Path) -> Element:
    """An element read from a file in the folder, beside some bodies and joints."""
    (folder / "wedge.obj").write_text(OBJ)
    write_beam(folder, 3)
    text = f'{HEAD}[{section}.new]\ntype = "{name}"\n{ELEMENTS[section][name]}\n'
    (folder / "model.toml").write_text(text, encoding="utf-8")
    return load(folder / "model.toml").elements["new"]


@pytest.mark.parametrize(("section", "name"), CASES, ids=[n for _, n in CASES])
def test_every_element_can_be_written(section, name, tmp_path, schema):
    if name == "Mesh":
        pytest.importorskip("trimesh")
    assert type(written(section, name, tmp_path)) is SPATIAL.sections[section][name]
    schema.validate(tomllib.loads((tmp_path / "model.toml").read_text(encoding="utf-8")))
