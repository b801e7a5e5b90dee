"""Finite elements, meshes, supports and loads in files of mechanisms."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, structures
from dalembert.cli import main
from dalembert.io import load

MODEL = """\
format = 1
gravity = [0, -9.81]
[parameters]
E = { value = 2e7, bounds = [1e6, 1e8] }
[bodies.car]
mass = 5
inertia = 1
position = [0, 0]
angle = 0
[bodies.a]
type = "PointNode"
position = [0, 0]
[bodies.b]
type = "Node"
position = [0, 1]
[bodies.c]
type = "Node"
position = [0.5, 1]
[elements.bar]
type = "Truss"
connect = ["a", "b"]
area = 1e-4
modulus = "E"
density = 7800
[elements.beam]
type = "Frame"
connect = ["b", "c"]
area = 1e-4
second_moment = 1e-8
modulus = "E"
density = 7800
[meshes.flag]
type = "Quadrilateral"
rectangle = { size = [0.5, 0.1], counts = [2, 1] }
thickness = 0.01
modulus = "E"
density = 1000
[[supports]]
nodes = "flag"
where = { x = 0 }
[[supports]]
nodes = "c"
uy = "-0.01*t"
ux = 0
[[loads]]
nodes = "flag"
nearest = [0.5, 0.1]
fy = "-0.1*t"
[joints.foot]
type = "Revolute"
connect = ["car", "a"]
[joints.rails]
type = "Prismatic"
connect = [{ body = "ground", at = [0, 0] }, "car"]
[joints.tip]
type = "Revolute"
connect = [{ body = "ground", at = [0.25, 0] }, "flag.mesh_nodes1"]
"""


def written(folder: Path, old: str = "", new: str = "") -> Path:
    assert old in MODEL
    path = folder / "model.toml"
    path.write_text(MODEL.replace(old, new, 1), encoding="utf-8")
    return path


def in_python() -> da.System:
    system = da.System("model", gravity=(0, -9.81))
    modulus = system.parameter("E", 2e7, bounds=(1e6, 1e8))
    car = system.add(planar.Body("car", mass=5.0, inertia=1.0, position=(0, 0), angle=0.0))
    a = system.add(planar.PointNode("a", position=(0, 0)))
    b = system.add(planar.Node("b", position=(0, 1)))
    c = system.add(planar.Node("c", position=(0.5, 1)))
    numbers = {"area": 1e-4, "modulus": modulus, "density": 7800}
    system.add(structures.Truss("bar", a, b, **numbers))
    system.add(structures.Frame("beam", b, c, second_moment=1e-8, **numbers))
    mesh = structures.rectangle_mesh((0.5, 0.1), (2, 1))
    flag = system.add_mesh("flag", mesh, thickness=0.01, modulus=modulus, density=1000)
    system.support(flag.nodes().where(x=0))
    system.support(c, uy=-0.01 * da.t, ux=0)
    system.load(flag.nodes().nearest(0.5, 0.1), fy=-0.1 * da.t)
    system.add(planar.Revolute("foot", car.center, a))
    system.add(planar.Prismatic("rails", system.ground.center, car.center))
    middle = flag.nodes()[1]
    system.add(planar.Revolute("tip", system.ground.point(0.25, 0.0), middle))
    return system


def test_files_mirror_python(tmp_path):
    models = load(written(tmp_path)).build(), in_python().build()
    runs = [da.solve_dynamics(m, 0.05, step=1e-3, integrator=da.HHT()) for m in models]
    for name in ("c.y", "b.angle", "flag_nodes[5].y", "bar.force", "tip.force"):
        np.testing.assert_allclose(runs[0][name], runs[1][name], rtol=1e-9, atol=1e-12)


WRONG = {
    ('["a", "b"]', '["a", "d"]'): "elements.bar.connect[1]: unknown node 'd'; known: a, b, c",
    ('["a", "b"]', '["a", "car"]'): "elements.bar.connect[1]: 'car' is no node; give it type",
    ('["b", "c"]', '["a", "c"]'): "elements.beam: rotates its node a, a point; use planar.Node",
    ('nodes = "c"', 'nodes = "car"'): "supports[1].nodes: 'car' is no node",
    ('nodes = "flag"', 'nodes = "flga"'): "supports[0].nodes: unknown node 'flga' (did you mean",
    ('nodes = "flag"', 'nodes = "flag.top"'): "supports[0].nodes: has no group 'top'",
    ("where = { x = 0 }", "where = { x = 9 }"): "supports[0]: no node fulfils x = 9",
    ("ux = 0", "uz = 0"): "supports[1]: c: unknown direction 'uz'; known: ux, uy, rz",
    ('fy = "-0.1*t"', 'mz = "t"'): "load flag_nodes[5]: mz: no element turns this node",
    ('fy = "-0.1*t"', 'fy = "c.y"'): "loads[0].fy: in formula 'c.y'",
    ("mesh_nodes1", "nodes1"): "joints.tip.connect[1]: unknown node 'flag.nodes1' (did you mean",
    ("[meshes.flag]", "[meshes.car]"): "meshes.car: the name is already used by bodies.car",
    ("area = 1e-4", "area = -1"): "elements.bar.area: is -1 m^2, but it must be above 0",
    ("position = [0, 1]", "position = [0.5, 1]"): "elements.beam: has no length",
    ("position = [0, 0]\n[bodies.b]", "[bodies.b]"): "bodies.a: needs a position, where its",
}


@pytest.mark.parametrize(("old", "new"), WRONG, ids=WRONG.values())
def test_wrong_files_are_told_in_one_message(old, new, tmp_path, capsys):
    path = written(tmp_path, old, new)
    assert main(["check", str(path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"Error: {path}: {WRONG[old, new]}")
    assert message.count("Error") == 1
