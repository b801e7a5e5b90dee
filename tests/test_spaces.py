"""Elements of one name in the plane and in space, told apart by their file."""

from __future__ import annotations

import json
import re
import tomllib

import casadi as ca
import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import ModelError
from dalembert.io import load


@pytest.fixture
def read(tmp_path, schema):
    def read(text: str, allowed: bool = True):
        """Elements by name, of a file that the schema allows or not."""
        data = {"format": 1, **tomllib.loads(text)}
        assert schema.is_valid(data) == allowed
        path = tmp_path / "model.json"
        path.write_text(json.dumps(data), encoding="utf-8")
        return load(path).elements

    return read


SPATIAL = """
[ground.frames]
base = { at = [0, 0, 1], axis = [0, 1, 0] }
[bodies.a]
mass = 1
inertia = [1, 2, 2]
rotation = { type = "axis_angle", axis = [0, 0, 1], angle = 0.3 }
points = { P = [1, 2, 3] }
frames = { hinge = { at = [1, 2, 3], axis = [0, 1, 0], x = [0, 0, 1] } }
[bodies.b]
type = "spatial.Body"
[joints.J]
type = "Revolute"
connect = ["a.hinge", { body = "b", at = [1, 2, 3], axis = [1, 0, 0] }]
[joints.L]
type = "Spherical"
connect = ["a.P", "ground.base"]
[bodies.flat]
type = "planar.Body"
points = { Q = [1, 2] }
[joints.K]
type = "planar.Revolute"
connect = ["ground", { body = "flat", at = [1, 2] }]
"""
PLANAR = """
[bodies.flat]
points = { Q = [1, 2] }
[joints.K]
type = "Revolute"
connect = ["ground", "flat.Q"]
[bodies.a]
type = "spatial.Body"
points = { P = [1, 2, 3] }
"""


@pytest.mark.parametrize("sign", ["dimension = 3", "gravity = [0, 0, -9.81]"])
def test_a_file_of_space_may_hold_elements_of_the_plane(read, sign):
    elements = read(sign + SPATIAL)
    kinds = {name: type(element) for name, element in elements.items()}
    assert kinds["a"] is kinds["b"] is spatial.Body and kinds["J"] is spatial.Revolute
    assert kinds["flat"] is planar.Body and kinds["K"] is planar.Revolute
    joint = elements["J"]
    assert joint.frame_i is elements["a"].frames["hinge"] and joint.frame_j.body is elements["b"]
    hinge = ca.DM(joint.frame_i.local_axes).full()
    np.testing.assert_array_equal(hinge[:, [0, 2]].T, [[0, 0, 1], [0, 1, 0]])
    np.testing.assert_array_equal(ca.DM(joint.frame_j.local_axes).full()[:, 2], [1, 0, 0])
    assert (
        elements["L"].point_i is elements["a"].points["P"]
        and elements["L"].point_j.name == "ground.base"
    )


@pytest.mark.parametrize("sign", ["", "dimension = 2", "gravity = [0, -9.81]"])
def test_a_file_of_the_plane_may_hold_elements_of_space(read, sign):
    kinds = {name: type(element) for name, element in read(sign + PLANAR).items()}
    assert kinds == {"flat": planar.Body, "K": planar.Revolute, "a": spatial.Body}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("dimension = 4", "dimension: unknown dimension 4; known: 2, 3"),
        ("dimension = true", "dimension: unknown dimension true; known: 2, 3"),
        ("dimension = []", "dimension: unknown dimension []; known: 2, 3"),
        ("dimension = 3\ngravity = [0, 1]", "gravity: expected 3 entries"),
        ("dimension = 2\ngravity = [0, 1, 2]", "gravity: expected 2 entries"),
        (PLANAR.replace("Q = [1, 2]", "Q = [1, 2, 3]"), "expected 2 entries"),
        ("dimension = 3" + SPATIAL.replace("P = [1, 2, 3]", "P = [1, 2]"), "expected 3 entries"),
        ("dimension = 3" + SPATIAL.replace("[1, 2, 2]", "[1, 2]"), "expected 3 or 6 entries"),
        (PLANAR.replace("spatial.Body", "spatial.Rod"), "unknown type 'spatial.Rod'"),
        ("[bodies.a]\ntype = 'Body'\nframes = {}", "bodies.a.frames: unknown key"),
    ],
)
def test_elements_of_the_other_space_are_refused(read, text, message):
    with pytest.raises(ModelError, match=re.escape(message)):
        read(text, allowed=False)


def test_unknown_places_are_told_by_what_they_are(read):
    with pytest.raises(ModelError, match=r"unknown point 'flat\.R'"):
        read(PLANAR.replace('"flat.Q"', '"flat.R"'))
    with pytest.raises(ModelError, match=r"unknown frame 'flat\.Q'.*frames of flat: none"):
        read("dimension = 3" + SPATIAL.replace('"a.hinge"', '"flat.Q"'))


ARM = """
dimension = 3
gravity = [0, 0, -9.81]
[parameters]
l = 0.4
[ground.frames]
base = { at = [0, 0, 1] }
[bodies.a]
mass = 1
inertia = [0.1, 0.1, 0.05]
position = [0, 0, 1]
rotation = { type = "bryant", x = 0, y = 0, z = 0.3 }
angular_velocity = [0, 0, 2]
frames = { elbow = { at = ["l", 0, 0], axis = [0, 1, 0], x = [1, 0, 0] } }
[bodies.b]
mass = 1
inertia = [0.1, 0.1, 0.05, 0.01, 0, 0]
frames.elbow = { at = ["-l", 0, 0], axis = [0, 1, 0], x = [1, 0, 0] }
frames.slide = { at = ["l", 0, 0], axis = [1, 0, 0], x = [0, 1, 0] }
[bodies.c]
mass = 1
inertia = [0.1, 0.1, 0.05]
[bodies.d]
type = "Particle"
mass = 0.2
[joints.A]
type = "Revolute"
connect = ["ground.base", "a"]
[joints.B]
type = "Revolute"
connect = ["a.elbow", "b.elbow"]
[joints.C]
type = "Prismatic"
connect = ["b.slide", { body = "c", axis = [1, 0, 0], x = [0, 1, 0] }]
[joints.D]
type = "Spherical"
connect = [{ body = "c", at = [0.1, 0, 0] }, "d"]
"""


def test_a_file_describes_what_python_does(tmp_path):
    """An arm with a slider and a load: the same motion from a file and from the classes."""
    path = tmp_path / "arm.json"
    path.write_text(json.dumps({"format": 1, **tomllib.loads(ARM)}), encoding="utf-8")
    system = da.System("arm", gravity=(0, 0, -9.81))
    l = system.parameter("l", 0.4)
    moments = {"mass": 1, "inertia": (0.1, 0.1, 0.05)}
    a = system.add(
        spatial.Body(
            "a",
            **moments,
            position=(0, 0, 1),
            rotation=da.rotation.axis_angle((0, 0, 1), 0.3),
            angular_velocity=(0, 0, 2),
        )
    )
    b = system.add(spatial.Body("b", mass=1, inertia=(0.1, 0.1, 0.05, 0.01, 0, 0)))
    c, d = system.add(spatial.Body("c", **moments)), system.add(spatial.Particle("d", mass=0.2))
    y = {"axis": (0, 1, 0), "x": (1, 0, 0)}
    x = {"axis": (1, 0, 0), "x": (0, 1, 0)}
    system.add(spatial.Revolute("A", system.ground.frame((0, 0, 1)), a))
    system.add(spatial.Revolute("B", a.frame((l, 0, 0), **y), b.frame((-l, 0, 0), **y)))
    system.add(spatial.Prismatic("C", b.frame((l, 0, 0), **x), c.frame(**x)))
    system.add(spatial.Spherical("D", c.point(0.1, 0, 0), d))
    from_file, from_python = (
        da.solve_dynamics(s.build(), 0.2, step=0.01) for s in (load(path), system)
    )
    assert from_file.status.success and from_python.status.success
    np.testing.assert_allclose(from_file.data.coordinates, from_python.data.coordinates, atol=1e-12)
    assert abs(float(from_file["C.displacement"][-1])) > 1e-3


REFUSED = {
    "Revolute": lambda ground, body: planar.Revolute("A", ground.point(0, 0, 0), body.center),
    "RotationalDriver": lambda ground, body: planar.RotationalDriver("A", ground, body, 1.0),
    "CoordinateDriver": lambda ground, body: planar.CoordinateDriver("A", body.center, 1.0),
    "Force": lambda ground, body: planar.Force("A", body.center, (1.0, 0.0)),
    "Torque": lambda ground, body: planar.Torque("A", body, 1.0),
    "TorsionSpring": lambda ground, body: planar.TorsionSpring("A", ground, body),
    "Bushing": lambda ground, body: planar.Bushing(
        "A", ground.point(0, 0, 0), body.center, stiffness=(1.0, 1.0)
    ),
    "PointOnCurve": lambda ground, body: planar.PointOnCurve("A", ground, body.center),
}


@pytest.mark.parametrize("name", REFUSED)
def test_elements_of_the_plane_refuse_what_is_in_space(name):
    from dalembert import System, spatial

    system = System("s")
    body = system.add(spatial.Body("b", mass=1, inertia=(1, 1, 1)))
    with pytest.raises(ModelError, match=rf"A: .* is in space, and {name} is a planar element"):
        REFUSED[name](system.ground, body)


def test_the_ground_stands_for_its_origin_in_either_space():
    from dalembert import System, spatial

    system = System("s")
    body = system.add(spatial.Body("b", mass=1, inertia=(1, 1, 1)))
    joint = spatial.Spherical("O", system.ground, body.point(0, 0, 1))
    assert joint.point_i.dimension == 3
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    assert planar.Revolute("P", system.ground, bar.start).point_i.dimension == 2
