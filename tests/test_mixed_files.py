"""Model files with nodes, finite elements, supports and loads beside bodies and joints."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from structure_file import HEAD, loaded

import dalembert as da
from dalembert import planar, structures
from dalembert.cli import main
from dalembert.io import load

MODEL = """\
format = 1
gravity = [0, -9.81]
[parameters]
E = { value = 2e7, bounds = [1e6, 1e8] }
[derived]
pull = "E * 1e-7"
[nodes]
a = [0, 0]
b = [0.5, "0.1"]
c = [1, 0]
[elements.left]
type = "Frame"
connect = ["a", "b"]
area = 1e-3
second_moment = 1e-6
modulus = "E"
density = 7800
[elements.right]
type = "Frame"
connect = ["b", "c"]
area = 1e-3
second_moment = 1e-6
modulus = "E"
density = 7800
[meshes.skin]
type = "Quadrilateral"
rectangle = { size = [0.5, 0.1], counts = [2, 1] }
thickness = 0.01
modulus = "E"
density = 1000
expansion = 1e-5
[bodies.block]
mass = 2
inertia = 0.1
position = [1, 0]
angle = 0
[joints.hold]
type = "Weld"
connect = ["c", "block"]
[joints.tip]
type = "Revolute"
connect = ["skin_nodes[5]", "b"]
[forces.push]
type = "Force"
connect = ["b"]
vector = ["-10*b.ux", "pull"]
[[supports]]
nodes = "a"
[[supports]]
nodes = "skin"
where = { x = 0 }
[[loads]]
nodes = ["b", "skin"]
fy = "-0.1*t"
[[tractions]]
elements = "skin"
nodes = "skin"
where = { y = 0 }
pressure = 50
[[temperatures]]
elements = "skin"
temperature = 5
[initial]
"b.vx" = 0.01
[analysis]
type = "Dynamics"
duration = 2e-3
step = 1e-4
integrator = "HHT"
[responses]
sag = { type = "Final", measure = "skin_nodes[5].uy" }
[sensitivity]
wrt = ["E"]
"""


def written(folder: Path, text: str = MODEL) -> Path:
    path = folder / "model.toml"
    path.write_text(text, encoding="utf-8")
    return path


def in_python() -> da.System:
    system = da.System("model", gravity=(0, -9.81))
    modulus = system.parameter("E", 2e7, bounds=(1e6, 1e8))
    pull = system.derived("pull", modulus * 1e-7)
    a, b, c = (
        system.node(n, *at) for n, at in zip("abc", [(0, 0), (0.5, 0.1), (1, 0)], strict=True)
    )
    numbers = {"area": 1e-3, "second_moment": 1e-6, "modulus": modulus, "density": 7800}
    system.add(structures.Frame("left", a, b, **numbers))
    system.add(structures.Frame("right", b, c, **numbers))
    mesh = structures.rectangle_mesh((0.5, 0.1), (2, 1))
    numbers = {"thickness": 0.01, "modulus": modulus, "density": 1000, "expansion": 1e-5}
    skin = system.add_mesh("skin", mesh, **numbers)
    block = system.add(planar.Body("block", mass=2, inertia=0.1, position=(1, 0), angle=0))
    system.add(planar.Weld("hold", c, block.center))
    system.add(planar.Revolute("tip", skin.nodes()[5], b))
    system.add(planar.Force("push", b, (-10 * system.formula("b.ux"), pull)))
    system.support([a, skin.nodes().where(x=0)])
    system.load([b, skin.nodes()], fy=-0.1 * da.t)
    system.traction(skin.elements["skin"], skin.nodes().where(y=0), pressure=50)
    system.heat(skin.elements["skin"], temperature=5)
    system.initial(b, vx=0.01)
    return system


def test_files_mirror_python(tmp_path, schema):
    schema.validate(tomllib.loads(MODEL))
    models = load(written(tmp_path)).build(), in_python().build()
    runs = [da.solve_dynamics(m, 2e-3, step=1e-4, integrator=da.HHT()) for m in models]
    for name in ("block.y", "b.rz", "skin_nodes[5].uy", "left.force", "skin[1].sxx", "tip.force"):
        np.testing.assert_allclose(runs[0][name], runs[1][name], rtol=1e-9, atol=1e-12)
    assert runs[0]["b.vx"].values[0] == pytest.approx(0.01)


@pytest.mark.thorough
def test_commands_run_it(tmp_path, capsys):
    path = written(tmp_path)
    for command in (["check"], ["run", "--output", str(tmp_path)], ["sensitivity"]):
        assert main([command[0], str(path), *command[1:]]) == 0, capsys.readouterr().err
    assert da.load_results(tmp_path / "model.nc").attrs["model"] == "model"


def test_older_names_of_nodes_of_meshes(tmp_path):
    """``skin.mesh_nodes5`` of files written before meshes were the same everywhere."""
    older = MODEL.replace("skin_nodes[5]", "skin.mesh_nodes5")
    assert older != MODEL
    models = load(written(tmp_path, older)).build(), load(written(tmp_path)).build()
    rows = [m.diagnosis.degrees_of_freedom for m in models]
    assert rows[0] == rows[1]


WRONG = {
    (
        'connect = ["c", "block"]',
        'connect = ["d", "block"]',
    ): "joints.hold.connect[0]: unknown body",
    ("skin_nodes[5]", "skin_nodes[9]"): "joints.tip.connect[0]: unknown node 'skin_nodes[9]'",
    ('nodes = "a"\n', 'nodes = "block"\n'): "supports[0].nodes: 'block' is no node",
    ('nodes = ["b", "skin"]\n', 'nodes = "b"\ncase = "wind"\n'): "load case 'wind': a mechanism",
    ('elements = "skin"\nn', 'elements = "skim"\nn'): "tractions[0].elements: unknown element 'sk",
    ('"b.vx" = 0.01', '"b.vz" = 0.01'): 'initial."b.vz": ',
    ("[nodes]\n", "[nodes]\nblock = [3, 3]\n"): "bodies.block: the name is already used by nodes",
    ("[nodes]\n", "[nodes]\nd = [3, 3, 3]\n"): "nodes.a: has 2 coordinates, d has 3",
}


@pytest.mark.parametrize(("old", "new"), WRONG, ids=WRONG.values())
def test_wrong_files_are_told_in_one_message(old, new, tmp_path, capsys):
    assert old in MODEL
    path = written(tmp_path, MODEL.replace(old, new, 1))
    assert main(["check", str(path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"Error: {path}: ") and WRONG[old, new] in message
    assert message.count("Error") == 1


def test_a_structure_is_written_alike(tmp_path, schema):
    """Gravity as a vector, derived parameters and initial motions, as in a mechanism."""
    text = HEAD.replace("[nodes]", '[derived]\nheight = "k/2"\n[nodes]').replace(
        '"k/2"]', '"height"]'
    )
    text = text.replace('kind = "structure"', 'kind = "structure"\ngravity = [0, -9.81]')
    text += '[initial]\n"b.vx" = 0.2\n[analysis]\ntype = "Dynamics"\nduration = 0.01\nstep = 1e-3\n'
    _, model = loaded(tmp_path, text, schema)
    motion = da.solve_dynamics(model, 0.01, step=1e-3)
    assert motion["b.vx"].values[0] == pytest.approx(0.2)
    twin = text.replace("gravity = [0, -9.81]\n", "").replace('[initial]\n"b.vx" = 0.2\n', "")
    twin += "[[gravity]]\nacceleration = [0, -9.81]\n[[initial]]\nnodes = 'b'\nvx = 0.2\n"
    _, other = loaded(tmp_path, twin, schema)
    result = da.solve_dynamics(other, 0.01, step=1e-3)
    np.testing.assert_array_equal(motion["b.uy"].values, result["b.uy"].values)
