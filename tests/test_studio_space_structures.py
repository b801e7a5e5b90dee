"""Spatial structures in the studio: a frame that is drawn by its scripts, against closed forms."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from studio_scripts import drawn_by

import dalembert as da
from dalembert.io import load_model_file
from dalembert.studio.drawing_edits import apply
from dalembert.studio.new_models import UNTITLED_SPATIAL, UNTITLED_SPATIAL_STRUCTURE


def test_a_cardan_shaft(tmp_path: Path) -> None:
    """The cross of a drawn universal joint is perpendicular to both shafts.

    At an angle β between them the ratio of their speeds is cos β/(1 − sin² β sin² φ), where φ is
    the angle of the first shaft from the position in which its axis of the cross is normal to both.
    """
    text = UNTITLED_SPATIAL
    for operations in drawn_by("studio_shaft.mjs", tmp_path):
        text = apply(text, operations)
    text += '[drivers]\nmotor = { type = "RotationalDriver", joint = "B", law = "t" }\n'
    path = tmp_path / "shaft.toml"
    path.write_text(text, encoding="utf-8")
    model = load_model_file(path).model()
    motion = da.solve_kinematics(model, np.pi, outputs=13)
    shaft = np.array([3.0, 2.0, 0.0]) / np.sqrt(13.0)
    speed = motion["bar2.angular_velocity"].values @ shaft
    cosine, angle = shaft[0], motion.time
    expected = cosine / (1 - (1 - cosine**2) * np.sin(angle) ** 2)
    assert speed == pytest.approx(expected, abs=1e-8)


def test_a_bent_cantilever(tmp_path: Path) -> None:
    """A column of height h with an arm of length a, and a force P across both at its end.

    Both bend, and the column twists: u = P a³/(3 E I) + P h³/(3 E I') + P a² h/(G J).
    """
    drawn = drawn_by("studio_space_structure.mjs", tmp_path)
    assert drawn["refused"] == []
    text = UNTITLED_SPATIAL_STRUCTURE
    for operations in drawn["changes"]:
        text = apply(text, operations)
    data = tomllib.loads(text)
    assert data["nodes"] == {"n1": [0, 0, 0], "n2": [0, 0, 2], "n3": [1, 0, 2]}
    assert data["supports"] == [{"nodes": "n1"}]
    assert data["loads"] == [{"nodes": "n3", "fy": 1000}, {"nodes": "n2", "mz": -2000}]
    assert data["line_loads"] == [{"elements": "beam2", "qz": -3000}]
    assert data["temperatures"] == [{"elements": "beam1", "temperature": -30}]
    assert drawn["handles"] == 6  # arrows and planes; a node does not rotate
    moved = tomllib.loads(apply(text, drawn["moved"]["operations"]))
    assert moved["nodes"]["n3"] == [1.5, 0, 2]
    path = tmp_path / "drawn.toml"
    path.write_text(text, encoding="utf-8")
    result = da.solve_statics(load_model_file(path).model())
    beam = data["elements"]["beam1"]
    stiff = {key: beam["modulus"] * beam[f"second_moment_{key}"] for key in "yz"}
    twist = beam["shear_modulus"] * beam["torsion_constant"]
    force, arm, height, moment = 1e3, 1.0, 2.0, -2e3
    # The force is along the own z axis of the arm, and along the own y axis of the column.
    about = {"arm": stiff["y"], "column": stiff["z"]}
    wanted = force * (arm**3 / (3 * about["arm"]) + height**3 / (3 * about["column"]))
    wanted += (force * arm + moment) * height * arm / twist
    assert float(result["n3.uy"]) == pytest.approx(wanted, rel=1e-4)
    weight = 3e3 * arm
    shrinks = beam["expansion"] * 30 * height
    down = weight * height / (beam["modulus"] * beam["area"]) + shrinks
    assert float(result["n2.uz"]) == pytest.approx(-down, rel=1e-6)


def test_typed_places_join_what_is_there(tmp_path: Path) -> None:
    """A spring from the ground to the centre of a sphere, both typed."""
    drawn = drawn_by("studio_typed_places.mjs", tmp_path)
    ground, centre, point = drawn["places"]
    assert (ground["body"], ground["names"], centre["body"]) == (None, [], "bob")
    assert (point["body"], point["names"], point["joint"]) == ("plate", ["plate.top"], "pin")
    (on_ground, on_bob), length = drawn["spring"]["connect"], drawn["spring"]["free_length"]
    assert "bob" in str(on_bob) and "bob" not in str(on_ground)
    assert length == pytest.approx(np.hypot(0.3, 0.1), rel=1e-11)
