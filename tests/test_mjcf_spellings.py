"""Two spellings of an MJCF file are the same model, as MuJoCo reads them."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from robots import imported

import dalembert as da

HINGE = '<joint name="h" axis="0 1 0.2"/>'


def file(body: str, head: str = "", tail: str = "") -> str:
    """A file with one hinged body."""
    return (
        f'<mujoco model="m">{head}<worldbody><body name="a" pos="0 0 1">{HINGE}{body}</body>'
        f"</worldbody>{tail}</mujoco>"
    )


def default(text: str) -> str:
    return f"<default>{text}</default>"


def actuator(text: str) -> str:
    return f"<actuator>{text}</actuator>"


BOX = '<geom type="box" size=".1 .2 .3" pos="1 2 3" {}/>'
BALL = '<geom size=".1" pos=".5 0 0"/>'
INERTIAL = 'mass="2" diaginertia="1 1.5 2"'
TURNED = "0 0 0.7071067811865476 0.7071067811865476"
PAIRS = {
    "own orientation in another notation": (
        file(BOX.format('euler="10 20 30"'), default('<geom quat="1 2 3 4"/>')),
        file(BOX.format('euler="10 20 30"')),
    ),
    "own quaternion": (
        file(BOX.format('quat="1 2 3 4"'), default('<geom euler="10 20 30"/>')),
        file(BOX.format('quat="1 2 3 4"')),
    ),
    "size in part": (
        file(
            '<geom class="c" size=".2" pos="1 0 0"/>',
            default(
                '<geom size=".1 .2 .3" type="box"/>'
                '<default class="c"><geom size=".4 .6"/></default>'
            ),
        ),
        file('<geom type="box" size=".2 .6 .3" pos="1 0 0"/>'),
    ),
    "inertia in a frame": (
        file(f'<frame pos="1 2 3" euler="0 0 90"><inertial pos="1 0 0" {INERTIAL}/></frame>'),
        file(f'<inertial pos="1 3 3" euler="0 0 90" {INERTIAL}/>'),
    ),
    "copies are displaced along turned axes": (
        file('<replicate count="3" offset="1 0 0" euler="0 0 90"><geom size=".1"/></replicate>'),
        file('<geom size=".1"/><geom size=".1" pos="1 0 0"/><geom size=".1" pos="1 1 0"/>'),
    ),
    "copies are turned by multiples of the angles": (
        file('<replicate count="3" euler="90 90 0"><geom size=".1" pos="1 2 3"/></replicate>'),
        file(
            '<geom size=".1" pos="1 2 3"/><geom size=".1" pos="3 1 2"/>'
            '<geom size=".1" pos="-1 -2 3"/>'
        ),
    ),
    "mesh turned, then scaled": (
        file(
            '<geom type="mesh" mesh="m"/>',
            '<asset><mesh name="m" scale="1 2 3" refpos="1 0 0" refquat="1 0 0 1" '
            'vertex="1 0 0 1 1 0 0 0 0 1 0 1"/></asset>',
        ),
        file(
            '<geom type="mesh" mesh="m"/>',
            '<asset><mesh name="m" vertex="0 0 0 1 0 0 0 2 0 0 0 3"/></asset>',
        ),
    ),
    "kinds of actuators do not inherit from each other": (
        file(
            BALL,
            default('<velocity kv="5"/><position kp="3"/>'),
            actuator('<velocity name="v" joint="h"/>'),
        ),
        file(BALL, "", actuator('<velocity name="v" joint="h" kv="1"/>')),
    ),
    "general inherits from other kinds": (
        file(BALL, default('<position kp="3" kv="2"/>'), actuator('<general name="v" joint="h"/>')),
        file(BALL, "", actuator('<position name="v" joint="h" kp="3" kv="2"/>')),
    ),
    "other kinds inherit from general": (
        file(
            BALL,
            default('<general gainprm="7" biasprm="4 5 -6" gear="2"/>'),
            actuator('<position name="v" joint="h"/>'),
        ),
        file(BALL, "", actuator('<position name="v" joint="h" kp="7" kv="6" gear="2"/>')),
    ),
    "coefficients in part": (
        file(
            BALL,
            default('<general gainprm="1 2 3" gaintype="affine"/>'),
            actuator('<general name="v" joint="h" gainprm="7"/>'),
        ),
        file(BALL, "", actuator('<general name="v" joint="h" gainprm="7 2 3" gaintype="affine"/>')),
    ),
}


@pytest.mark.parametrize("name", PAIRS)
def test_both_spellings_are_one_model(tmp_path, name):
    first, second = (imported(tmp_path, text, "xml") for text in PAIRS[name])
    bodies = [robot.document["bodies"]["a"] for robot in (first, second)]
    for key in ("mass", "center_of_mass", "inertia"):
        values = [_padded(body.get(key, 0.0)) for body in bodies]
        np.testing.assert_allclose(*values, atol=1e-13 * np.abs(values[1]).max(initial=1.0))
    assert first.document.get("forces") == second.document.get("forces")


def _padded(value) -> np.ndarray:
    """Moments with products that are written only if they differ from zero."""
    array = np.atleast_1d(np.asarray(value, dtype=float))
    return np.pad(array, (0, 6 - len(array)))


WELD = """<mujoco><worldbody>
  <body name="a" pos="0 0 1"><joint name="h" axis="0 1 0"/><geom size=".1" pos="1 0 0"/></body>
  <body name="b" pos="3 0 0"><freejoint/><geom size=".1"/></body></worldbody><equality>
  <weld name="w" body1="a" body2="b" relpose="1 2 3 {turn}" anchor="4 5 6"/></equality></mujoco>"""


def test_relative_pose_of_a_weld_places_its_anchor(tmp_path):
    """``x₁ + A₁ r = x₂ + A₂ s`` with the relative position r and the anchor s."""
    document = imported(tmp_path, WELD.format(turn="1 0 0 0"), "xml").document
    assert document["bodies"]["a"]["frames"]["w"]["at"] == [1.0, 2.0, 3.0]
    assert document["bodies"]["b"]["frames"]["w"]["at"] == [4.0, 5.0, 6.0]
    turned = imported(tmp_path, WELD.format(turn="1 0 0 1"), "xml").document
    assert turned["bodies"]["a"]["frames"]["w"]["at"] == [1.0, 2.0, 3.0]
    np.testing.assert_allclose(turned["bodies"]["a"]["frames"]["w"]["x"], [0, 1, 0], atol=1e-15)


CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
MESH = '<asset><mesh name="m" {}/></asset>'


def binary_mesh(faces=FACES, normals: int = 4) -> bytes:
    """A tetrahedron in the binary format of MuJoCo."""
    data = struct.pack("<4i", 4, normals, 0, len(faces))
    data += struct.pack("<12f", *np.ravel(CORNERS)) + bytes(12 * normals)
    return data + np.array(faces, dtype="<i4").tobytes()


def test_binary_meshes(tmp_path):
    (tmp_path / "m.msh").write_bytes(binary_mesh())
    vertex, face = (" ".join(map(str, np.ravel(rows))) for rows in (CORNERS, FACES))
    geom = '<geom type="mesh" mesh="m"/>'
    texts = (
        file(geom, MESH.format('file="m.msh"')),
        file(geom, MESH.format(f'vertex="{vertex}" face="{face}"')),
    )
    first, second = (imported(tmp_path, text, "xml").document["bodies"]["a"] for text in texts)
    assert first["mass"] == pytest.approx(1000 / 6) and first["inertia"] == second["inertia"]
    for broken in (binary_mesh()[:-4], binary_mesh()[:8], binary_mesh([(0, 1, 4)])):
        (tmp_path / "m.msh").write_bytes(broken)
        with pytest.raises(da.ModelError, match=r"m\.msh.*export the mesh again"):
            imported(tmp_path, texts[0], "xml")
