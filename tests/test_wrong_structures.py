"""Wrong files of structures are one clear message; any damage is refused by one error."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from structure_file import HEAD, MESH, loaded, written

import dalembert as da
from dalembert.cli import main
from dalembert.io import load_model_file
from dalembert.io.decisions.tasks import check_tasks

WRONG = [
    ('kind = "structure"', 'kind = "strukture"', "kind: unknown kind 'strukture' (did you mean 's"),
    ('kind = "structure"\n', "", 'nodes and elements make a structure; add kind = "structure"'),
    ('connect = ["a", "b"]', 'connect = ["a", "d"]', "elements.left.connect[1]: unknown node 'd'"),
    ('connect = ["a", "b"]', 'connect = ["a"]', "elements.left.connect: expected 2 entries"),
    ('connect = ["a", "b"]', 'connect = ["a", "a"]', "elements.left: ties a to itself"),
    (
        'type = "Frame"',
        'type = "Frames"',
        "elements.left: unknown type 'Frames' (did you mean 'Fra",
    ),
    (
        'area = "area"',
        'area = "aera"',
        "elements.left.area: in formula 'aera': unknown name 'aera' (",
    ),
    ('area = "area"', "aera = 1", "elements.left.aera: unknown key (did you mean 'area'?)"),
    ('area = "area"', "area = -1", "elements.left.area: is -1 m^2, but it must be above 0"),
    ('area = "area"', "", "elements.left.area: is missing"),
    ("a = [0, 0]", "a = [0, 0, 0]", "nodes.b: has 2 coordinates, a has 3"),
    ("a = [0, 0]", "a = [0, 0, 0, 0]", "nodes.a: expected 1 to 3 coordinates, got 4"),
    ("a = [0, 0]", "a = [0, true]", "nodes.a: expected a number or a formula, got true"),
    ("c = [2, 0]", "c = [2, 0]\nd = [3, 3]", "nodes.d: is not connected to any element"),
    ("c = [2, 0]", "c = [2, 0]\nleft = [3, 3]", "elements.left: the name is already used by"),
    ('nodes = ["a", "c"]', 'nodes = ["a", "x"]', "supports[0].nodes: unknown node 'x'"),
    ('nodes = ["a", "c"]', 'nodes = "a"\nuz = 0', "unknown direction 'uz'; known: ux, uy, rz"),
    ('nodes = ["a", "c"]', 'nodes = "a"\nwhere = { x = 0 }', "supports[0]: a is one node; where"),
    ('nodes = ["a", "c"]', "nodes = []", "supports[0].nodes: expected the name of nodes"),
    ('nodes = "b"\nfy', 'nodes = "a"\nfy', "load a: fy: uy is prescribed, so the force there is "),
    ("fy = -10", "f = -10", "loads[0].f: unknown key (did you mean 'fz'?)"),
    ("fy = -10", 'fy = "b.uy"', "loads[0].fy: in formula 'b.uy': unknown name 'b.uy'"),
    (
        'measure = "-b.uy"',
        'measure = "b.uz"',
        "responses.sag.measure: no measure 'b.uz'; nearest: b.",
    ),
    (
        'measure = "-b.uy"',
        'measure = "-q.uy"',
        "responses.sag.measure: in formula '-q.uy': unknown",
    ),
    (
        "[responses]",
        '[analysis]\ntype = "Kinematics"\n[responses]',
        "analysis: type Kinematics is for mechanisms; known here: Statics",
    ),
    (
        "[responses]",
        '[analysis]\ntype = "Modal"\ncount = 0\n[responses]',
        "analysis: Modal: count is 0; it must be positive",
    ),
    (
        "[responses]",
        '[analysis]\ntype = "Dynamics"\nduration = 1\nintegrator = "RK4"\n[responses]',
        "analysis.integrator: integrator is RK4",
    ),
    ("[responses]", "[bodies.x]\nmass = 1\n[responses]", "bodies: is for mechanisms"),
    (
        "[responses]",
        '[optimize]\nminimize = "sug"\n[responses]',
        "optimize.minimize: unknown respon",
    ),
    ("k = 2.0", "k = [2.0]", "parameters.k: expected a number, got [2.0]"),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG, ids=[w[2][:40] for w in WRONG])
def test_one_message(old: str, new: str, words: str, tmp_path: Path, capsys) -> None:
    assert old in HEAD
    path = written(tmp_path, HEAD.replace(old, new, 1))
    assert main(["check", str(path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"Error: {path}: ")
    assert words in message
    assert "Traceback" not in message


MESH_WRONG = [
    (
        "rectangle = { size = [2, 1], counts = [4, 2] }",
        "",
        "meshes.plate: give one of file, points",
    ),
    ("counts = [4, 2]", "counts = [4, 0]", "meshes.plate.rectangle: a mesh needs 2 positive whole"),
    ("counts = [4, 2]", "counts = [4]", "meshes.plate.rectangle.counts: expected 2 entries"),
    (
        "rectangle = { size = [2, 1], counts = [4, 2] }",
        'file = "none.msh"',
        "none.msh: no such file",
    ),
    (
        "rectangle = { size = [2, 1], counts = [4, 2] }",
        "points = [[0, 0], [1]]\ncells = [[0, 1, 2, 3]]",
        "meshes.plate.points: rows have different lengths",
    ),
    ("modulus = 70e9", "modulus = [1, 2]", "plate.modulus"),
    ("modulus = 70e9", "modulus = { soft = 1 }", "modulus: no group of elements 'soft'"),
    ("where = { x = 0 }", "where = { x = 7 }", "supports[0]: no node fulfils x = 7"),
    ("where = { x = 0 }", "where = { w = 0 }", "supports[0]: has no coordinate 'w'"),
    ('nodes = "plate"\nwhere', 'nodes = "plate.top"\nwhere', "has no group 'top'"),
    (
        'nodes = "plate"\nwhere',
        'nodes = "plat"\nwhere',
        "unknown node 'plat' (did you mean 'plate'?)",
    ),
    (
        "plate.von_mises.max",
        "plate.von_mises",
        "'plate.von_mises' has several measures; name one",
    ),
]


@pytest.mark.parametrize(("old", "new", "words"), MESH_WRONG, ids=[w[2][:40] for w in MESH_WRONG])
def test_one_message_of_meshes(old: str, new: str, words: str, tmp_path: Path, capsys) -> None:
    assert old in MESH
    path = written(tmp_path, MESH.replace(old, new, 1))
    assert main(["check", str(path)]) == 2
    message = capsys.readouterr().err
    assert message.startswith(f"Error: {path}: ")
    assert words in message


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            '[[tractions]]\nelements = "plat"\nnodes = "plate"',
            "tractions[0].elements: unknown elem",
        ),
        ('[[tractions]]\nelements = "plate"\nnodes = "n"\ntx = 1', "tractions[0]: n is one node"),
        ('[[line_loads]]\nelements = "plate"\nqy = 1', "carries no line load"),
        ('[[temperatures]]\nelements = "plate"\ntemperature_gradient = 1', "feels no temperature"),
        ("[[gravity]]\nacceleration = [1]", "gravity[0]"),
    ],
)
def test_wrong_loads_on_elements(table: str, words: str, tmp_path: Path, capsys) -> None:
    text = MESH.replace("[[supports]]", "[nodes]\nn = [5, 5]\n[[supports]]", 1)
    path = written(tmp_path, text.replace("[[loads]]", f"{table}\n[[loads]]", 1))
    assert main(["check", str(path)]) == 2
    assert words in capsys.readouterr().err


@pytest.mark.parametrize("change", [("type", 7), ("connect", ["a"]), ("area", True), ("what", 1)])
def test_schema_refuses(change, schema) -> None:
    data = tomllib.loads(HEAD)
    assert schema.is_valid(data)
    data["elements"]["left"] |= dict([change])
    assert not schema.is_valid(data)


def test_tasks_are_checked(tmp_path: Path) -> None:
    file, model = loaded(tmp_path, HEAD + '[sensitivity]\nwrt = ["what"]\n')
    with pytest.raises(da.ModelError, match="unknown parameter 'what'"):
        check_tasks(file, model)


def places(data: object, at: tuple = ()) -> list[tuple]:
    """The keys on the way to everything in a document."""
    keys = data if isinstance(data, dict) else range(len(data)) if isinstance(data, list) else ()
    return [p for key in keys for p in [(*at, key), *places(data[key], (*at, key))]]


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_any_damage_is_a_dalembert_error(tmp_path: Path, data) -> None:
    document = tomllib.loads(data.draw(st.sampled_from([HEAD, MESH])))
    wrong = [None, True, -1, 0, 1e300, "", "x", "k", "a", [], [1], [[1]], {}, {"x": 1}, "plate"]
    for _ in range(data.draw(st.integers(1, 3))):
        *way, last = data.draw(st.sampled_from(places(document)))
        table = document
        for key in way:
            table = table[key]
        if data.draw(st.booleans()):
            table[last] = json.loads(json.dumps(data.draw(st.sampled_from(wrong))))
        else:
            del table[last]
    path = written(tmp_path, json.dumps(document), "damaged.json")
    try:
        file = load_model_file(path)
        check_tasks(file, file.model())
    except da.DalembertError as error:
        message = str(error)
    else:
        return
    assert str(path) in message
