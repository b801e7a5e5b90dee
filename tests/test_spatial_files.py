"""Every element in space can be written in a model file."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import pytest
from flexible_bodies import write_beam

import dalembert as da
from dalembert.elements.base import Element
from dalembert.elements.registry import SPATIAL
from dalembert.io import load
from dalembert.io.model_file import load_model_file

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
        "Node": "position = ['k', 0, 0]\nmass = 1\ninertia = [1, 1, 1]",
        "PointNode": "position = ['k', 0, 0]",
    },
    "beams": {
        "Beam": "frame_i = { body = 'ground' }\nlength = 'k'\naxial_rigidity = 9\n"
        "shear_rigidity = 5\ntorsional_rigidity = 1\nbending_rigidity_y = 1\n"
        "bending_rigidity_z = 'k'\nmass_per_length = 1",
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
        "BristleFriction": "joint = 'J'\ncoulomb = 'k/10'\nmotion = 'angle'",
        "DCMotor": "joint = 'J'\nvoltage = '3*cos(t) - new.current'\nmotion = 'angle'",
        "HydraulicCylinder": POINTS + "opening = '0.1*sin(t) - new.pressure_a/1e8'",
        "Stop": "coordinate = 'a.x'\nupper = 3\nstiffness = 100",
        "ClearanceSpherical": POINTS + "radius = 0.1\nclearance = 0.01\n"
        "law = { type = 'KelvinVoigt', stiffness = 'k' }",
        "Cable": "points = ['a.P', { body = 'ground', at = [0, 'k', 0] }, 'b']\n"
        "length = 1\nstiffness = 100",
        "Contact": "shape_j = 'b'\nshape_i = { type = 'HalfSpace', point = 'ground.G' }\n"
        "law = { type = 'Hertz', stiffness = 'k' }\nfriction = { type = 'Coulomb', dynamic = 0.3 }",
        "UnilateralConstraint": "distance = 'a.z + k'\nslip = 'a.vx'\nrestitution = 0.5",
        "Collisions": "shapes = [{ type = 'Sphere', point = 'a', radius = 'k' }, "
        "{ type = 'HalfSpace', point = 'ground.G' }]",
    },
}
CASES = [(section, name) for section, table in SPATIAL.sections.items() for name in table]


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


WRONG = {
    "no dimension": (
        "[joints.new]\ntype = 'Spherical'\n" + POINTS,
        "as dimension = 3 it is valid; write that if it is intended",
    ),
    "an element of the plane": (
        "[joints.new]\ntype = 'planar.Revolute'\nconnect = ['ground', { body = 'a', at = [0, 0] }]",
        "joints.new.connect[1]: a is a body in space, and elements of the plane tie bodies of",
    ),
    "a tube without a wall": (
        "[bodies.new]\ntype = 'Cylinder'\nradius = 1\ninner_radius = 'k'\nlength = 1\ndensity = 1",
        "bodies.new.radius − inner_radius: is -1 m, but it must not be negative",
    ),
    "a twist that no axes have": (
        "[joints.new]\ntype = 'RevoluteRevoluteLink'\n" + FRAMES + "length = 1\ntwist = 3.5",
        "joints.new: its twist is 3.5 rad, but it must be above 0 and below π; leave it out",
    ),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_errors_name_location_value_and_remedy(wrong, tmp_path):
    text, message = WRONG[wrong]
    head = HEAD.replace("dimension = 3\n", "") if wrong == "no dimension" else HEAD
    (tmp_path / "model.toml").write_text(f"{head}{text}\n", encoding="utf-8")
    with pytest.raises(da.ModelError, match=re.escape(message)):
        load_model_file(tmp_path / "model.toml").model()
