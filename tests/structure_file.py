"""A small file of a structure, one with a mesh, and what tests do to them."""

from __future__ import annotations

import tomllib
from pathlib import Path

from dalembert.io import load_model_file

EXAMPLES = Path(__file__).parents[1] / "examples"


HEAD = """\
format = 1
kind = "structure"
[parameters]
k = 2.0
area = { value = 1e-4, bounds = [1e-5, 1e-3], unit = "m^2" }
[nodes]
a = [0, 0]
b = [1, "k/2"]
c = [2, 0]
[elements.left]
type = "Frame"
connect = ["a", "b"]
area = "area"
second_moment = 1e-8
modulus = 210e9
density = 7850
[elements.right]
type = "Frame"
connect = ["b", "c"]
area = "2*area"
second_moment = 1e-8
modulus = 210e9
density = 7850
[[supports]]
nodes = ["a", "c"]
[[loads]]
nodes = "b"
fy = -10
[responses]
sag = { measure = "-b.uy" }
"""


MESH = """\
format = 1
kind = "structure"
[parameters]
thickness = { value = 0.01, bounds = [1e-3, 0.1] }
[meshes.plate]
type = "Quadrilateral"
rectangle = { size = [2, 1], counts = [4, 2] }
thickness = "thickness"
modulus = 70e9
[[supports]]
nodes = "plate"
where = { x = 0 }
[[loads]]
case = "corner"
nodes = "plate"
nearest = [2, 1]
fy = -1e3
[[loads]]
case = "edge"
nodes = "plate"
where = { x = 2 }
fx = 100
[responses]
peak = { measure = "plate.von_mises.max" }
"""


def written(folder: Path, text: str, name: str = "model.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def loaded(folder: Path, text: str, schema=None):
    if schema is not None:
        schema.validate(tomllib.loads(text))
    file = load_model_file(written(folder, text))
    return file, file.model()
