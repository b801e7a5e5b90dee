"""Elements of one name in the plane and in space, told apart by their file."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import dataclass

import pytest

from dalembert import planar
from dalembert.elements.base import Element, Vector, option, quantity
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.elements.registry import SPACES, Space, named
from dalembert.errors import ModelError
from dalembert.io import json_schema, load
from dalembert.io.schema import MECHANISMS, document_of


class Place(Frame):
    def __init__(self, body, local, axis=None):
        self.body, self.local, self.direction = body, local, axis


@dataclass(eq=False)
class Body(planar.Body):
    """Stands for a body in space."""

    size: Vector = quantity("m", "size", default=(1, 1, 1), size=3)

    def add_point(self, name, local):
        self.points[name] = Place(self, local)
        self.frames = {**self.frames, name: self.points[name]}

    def point(self, x, y, z):
        return Place(self, (x, y, z))

    def frame(self, at, axis=(0, 0, 1)):
        return Place(self, at, axis)


@dataclass(eq=False)
class Revolute(Element):
    """Stands for a joint in space."""

    frame_i: Frame
    point_j: Point
    plane: Frame = option("a frame of its own", default=None)


@pytest.fixture(autouse=True)
def two_spaces(monkeypatch):
    space = Space(
        "spatial",
        3,
        {"bodies": named(Body), "joints": named(Revolute), "drivers": {}, "forces": {}},
    )
    monkeypatch.setitem(SPACES, 3, space)
    for known in (SPACES[2], space):
        monkeypatch.setitem(MECHANISMS, known.dimension, document_of(known))


@pytest.fixture
def read(tmp_path):
    jsonschema = pytest.importorskip("jsonschema")
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    checked = jsonschema.Draft202012Validator(schema)

    def read(text: str, allowed: bool = True):
        """Elements by name, of a file that the schema allows or not."""
        data = {"format": 1, **tomllib.loads(text)}
        assert checked.is_valid(data) == allowed
        path = tmp_path / "model.json"
        path.write_text(json.dumps(data), encoding="utf-8")
        return load(path).elements

    return read


SPATIAL = """
[bodies.a]
mass = 1
inertia = 1
size = [1, 2, 3]
points = { P = [1, 2, 3] }
[bodies.b]
type = "spatial.Body"
[joints.J]
type = "Revolute"
connect = ["a.P", { body = "b", at = [1, 2, 3] }]
plane = { body = "b", at = [0, 0, 1], axis = [1, 0, 0] }
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
    made = read(sign + SPATIAL)
    kinds = {name: type(element) for name, element in made.items()}
    assert kinds["a"] is kinds["b"] is Body and kinds["J"] is Revolute
    assert kinds["flat"] is planar.Body and kinds["K"] is planar.Revolute
    joint = made["J"]
    assert joint.frame_i is made["a"].frames["P"] and joint.point_j.local == (1, 2, 3)
    assert joint.plane.body is made["b"] and joint.plane.direction == [1, 0, 0]


@pytest.mark.parametrize("sign", ["", "dimension = 2", "gravity = [0, -9.81]"])
def test_a_file_of_the_plane_may_hold_elements_of_space(read, sign):
    kinds = {name: type(element) for name, element in read(sign + PLANAR).items()}
    assert kinds == {"flat": planar.Body, "K": planar.Revolute, "a": Body}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("dimension = 4", "dimension: unknown dimension 4; known: 2, 3"),
        ("dimension = true", "dimension: unknown dimension true; known: 2, 3"),
        ("dimension = 3\ngravity = [0, 1]", "gravity: expected 3 entries"),
        ("dimension = 2\ngravity = [0, 1, 2]", "gravity: expected 2 entries"),
        (PLANAR.replace("Q = [1, 2]", "Q = [1, 2, 3]"), "expected 2 entries"),
        ("dimension = 3" + SPATIAL.replace("P = [1, 2, 3]", "P = [1, 2]"), "expected 3 entries"),
        (PLANAR.replace("spatial.Body", "spatial.Bar"), "unknown type 'spatial.Bar'"),
        ("[bodies.a]\ntype = 'Body'\nsize = [1, 2, 3]", "bodies.a.size: unknown key"),
    ],
)
def test_what_a_space_does_not_have_is_refused(read, text, told):
    with pytest.raises(ModelError, match=re.escape(told)):
        read(text, allowed=False)


def test_unknown_places_are_told_by_what_they_are(read):
    with pytest.raises(ModelError, match=r"unknown point 'flat\.R'"):
        read(PLANAR.replace('"flat.Q"', '"flat.R"'))
    with pytest.raises(ModelError, match=r"unknown frame 'flat\.Q'.*frames of flat: none"):
        read("dimension = 3" + SPATIAL.replace('"a.P"', '"flat.Q"'))
