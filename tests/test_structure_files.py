"""Model files of structures: what Python users write and what files hold are the same."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

import dalembert as da
from dalembert import structures
from dalembert.cli import main
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.io import load_model_file
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.tasks import check_tasks, make_responses
from dalembert.io.strategies import RESPONSES, STRUCTURAL_ANALYSES
from dalembert.results.files.store import report_of

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


def written(folder: Path, text: str, name: str = "model.toml") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def loaded(folder: Path, text: str, schema=None):
    if schema is not None:
        schema.validate(tomllib.loads(text))
    file = load_model_file(written(folder, text))
    return file, file.model()


# what files say -----------------------------------------------------------------------------
def test_the_same_as_in_python(tmp_path: Path, schema) -> None:
    file, model = loaded(tmp_path, HEAD, schema)
    twin = da.Structure("twin")
    k, area = twin.parameter("k", 2.0), twin.parameter("area", 1e-4)
    a, b, c = twin.node("a", 0, 0), twin.node("b", 1, k / 2), twin.node("c", 2, 0)
    steel = {"second_moment": 1e-8, "modulus": 210e9, "density": 7850}
    twin.add(structures.Frame("left", a, b, area=area, **steel))
    twin.add(structures.Frame("right", b, c, area=2 * area, **steel))
    twin.support(a)
    twin.support(c)
    twin.load(b, fy=-10)
    expected = da.solve_statics(twin.build())
    found = make_analysis(file, model).run(model)
    np.testing.assert_allclose(found.displacements, expected.displacements, rtol=1e-12)
    by_file = da.sensitivity(found, list(make_responses(file, model).values()))
    np.testing.assert_allclose(by_file, -da.sensitivity(expected, da.final("b.uy")), rtol=1e-9)


def test_load_model_gives_a_structure(tmp_path: Path) -> None:
    made = da.load_model(written(tmp_path, HEAD))
    assert isinstance(made, da.Structure)
    made.load(made.nodes["b"], fx=3)
    assert da.solve_statics(made.build())["b.fx"] == 3


def test_json_is_the_same_file(tmp_path: Path) -> None:
    twin = written(tmp_path, json.dumps(tomllib.loads(HEAD)), "model.json")
    one, two = (da.solve_statics(da.load_model(p).build()) for p in (written(tmp_path, HEAD), twin))
    np.testing.assert_array_equal(one.displacements, two.displacements)


@pytest.mark.parametrize("name", list(ELEMENTS))
def test_every_element_can_be_written(name: str, tmp_path: Path, schema) -> None:
    cls = ELEMENTS[name]
    cell = getattr(cls, "cell", None)
    dimension = max(cls.dimensions)
    rng = np.random.default_rng(3)
    places = np.array(cell.nodes) if cell else rng.random((cls.node_count, dimension))
    nodes = "".join(f"n{k} = {list(map(float, p))}\n" for k, p in enumerate(places))
    numbers = "".join(
        f'{f.name} = "k/10"\n' for f in cls.quantity_fields() if f.metadata["size"] == 1
    )
    text = (
        f'format = 1\nkind = "structure"\n[parameters]\nk = 2.0\n[nodes]\n{nodes}'
        f'[elements.part]\ntype = "{name}"\n'
        f"connect = {json.dumps([f'n{k}' for k in range(len(places))])}\n{numbers}"
    )
    _, model = loaded(tmp_path, text, schema)
    assert [type_.kind.cls for type_ in model.blocks] == [cls]
    mesh = (
        f'format = 1\nkind = "structure"\n[parameters]\nk = 2.0\n[meshes.part]\ntype = "{name}"\n'
        f"points = {places.tolist()}\ncells = [{list(range(len(places)))}]\n{numbers}"
    )
    _, meshed = loaded(tmp_path, mesh, schema)
    data = [m.blocks[0].data(m.nominal) for m in (model, meshed)]
    np.testing.assert_allclose(*data, rtol=1e-12)


OPTIONS = {
    "Statics": "",
    "NonlinearStatics": "steps = 2",
    "ArcLength": "first = 0.2\nmax_points = 5",
    "Modal": "count = 2",
    "Buckling": "count = 1",
    "Transient": 'duration = 0.01\nstep = 1e-3\ndamping = { stiffness = "k*1e-4" }\n'
    'integrator = "HHT"',
}


@pytest.mark.parametrize("name", list(STRUCTURAL_ANALYSES))
def test_every_analysis_can_be_asked_for(name: str, tmp_path: Path, schema, capsys) -> None:
    text = f'{HEAD}[analysis]\ntype = "{name}"\n{OPTIONS[name]}\n'
    file, model = loaded(tmp_path, text, schema)
    analysis = make_analysis(file, model)
    assert type(analysis) is STRUCTURAL_ANALYSES[name]
    if name in ("Modal", "Buckling"):
        text = text.replace("-b.uy", "frequency" if name == "Modal" else "load_factor")
    path = written(tmp_path, text)
    assert main(["check", str(path)]) == 0
    assert main(["run", str(path), "--output", str(tmp_path), "--json"]) == 0
    capsys.readouterr()
    assert (tmp_path / "model.report.html").stat().st_size > 50_000
    assert da.load_results(tmp_path / "model.nc").attrs["model"] == "model"


def test_modes_about_a_loaded_state(tmp_path: Path, schema) -> None:
    text = HEAD + '[analysis]\ntype = "Modal"\ncount = 1\n'
    file, model = loaded(tmp_path, text, schema)
    plain = make_analysis(file, model).run(model)
    file, model = loaded(tmp_path, text + 'about = ""\n', schema)
    loaded_ = make_analysis(file, model).run(model)
    assert loaded_.frequencies[0] < plain.frequencies[0]  # it presses the arch


@pytest.mark.parametrize("name", list(RESPONSES))
def test_every_response_can_be_asked_for(name: str, tmp_path: Path, schema) -> None:
    more = {"At": ", time = 0.005", "AtEvent": ', event = "e"'}.get(name, "")
    table = '[analysis]\ntype = "Transient"\nduration = 0.01\nstep = 1e-3\n'
    text = HEAD.replace(
        "sag = {", f'other = {{ type = "{name}", measure = "b.vy"{more} }}\nsag = {{'
    )
    if name == "AtEvent":  # structures have no events
        file, model = loaded(tmp_path, text + table)
        with pytest.raises(da.ModelError, match="unknown event"):
            make_responses(file, model)
        return
    file, model = loaded(tmp_path, text + table, schema)
    made = make_responses(file, model)["other"]
    assert type(made) is RESPONSES[name]


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


def test_meshes_and_where(tmp_path: Path, schema) -> None:
    _, model = loaded(tmp_path, MESH, schema)
    result = da.solve_statics(model)
    nodes = model.structure.nodes["plate_nodes"]
    corner, edge = nodes.nearest(2, 1), nodes.where(x=2)
    assert result[f"{corner.names[0]}.fy"][result.case("corner")] == -1e3
    assert [result[f"{n}.fx"][result.case("edge")] for n in edge.names] == [100.0] * 3
    assert not result.displacement_of(nodes.where(x=0)).any()


def test_mesh_files_with_groups(tmp_path: Path, schema) -> None:
    meshio = pytest.importorskip("meshio")
    points, cells = structures.rectangle_mesh((2, 1), (4, 2))
    left = np.flatnonzero(points[:, 0] == 0)
    soft = points[cells].mean(axis=1)[:, 0] < 1
    groups = {"soft": [np.flatnonzero(soft)], "hard": [np.flatnonzero(~soft)]}
    flat = np.column_stack([points, np.zeros(len(points))])
    made = meshio.Mesh(flat, [("quad", cells)], point_sets={"left": left}, cell_sets=groups)
    meshio.write(tmp_path / "plate.xdmf", made)
    meshio.abaqus.write(tmp_path / "plate.inp", made)
    text = MESH.replace("rectangle = { size = [2, 1], counts = [4, 2] }", 'file = "plate.inp"')
    text = text.replace("modulus = 70e9", 'modulus = { soft = 1e9, hard = "thickness*7e12" }')
    text = text.replace('nodes = "plate"\nwhere = { x = 0 }', 'nodes = "plate.left"')
    _, model = loaded(tmp_path, text, schema)
    block = model.blocks[0]
    moduli = block.data(model.nominal)[block.kind.row("modulus")]
    assert {1e9, 7e10} <= set(moduli.ravel())
    assert len(model.supports) == 6


@pytest.mark.parametrize(
    ("source", "count"),
    [
        ("line = { start = [0, 0], end = [3, 4], count = 5 }", 6),
        ('points = [[0, 0], [3, "4*k"]]\ncells = [[0, 1]]', 2),
    ],
)
def test_lines(source: str, count: int, tmp_path: Path, schema) -> None:
    text = (
        'format = 1\nkind = "structure"\n[parameters]\nk = 1.0\n[meshes.bar]\ntype = "Truss"\n'
        f"{source}\narea = 1e-4\nmodulus = [{', '.join(['1e9'] * (count - 1))}]\ndensity = 10.0\n"
        '[[supports]]\nnodes = "bar"\n'
    )
    _, model = loaded(tmp_path, text, schema)
    assert da.solve_statics(model)["mass"] == pytest.approx(10.0 * 1e-4 * 5)
    assert len(model.degrees.nodes) == count


def test_loads_on_elements(tmp_path: Path, schema) -> None:
    text = HEAD + (
        '[[gravity]]\nacceleration = [0, "-5*k"]\ncase = "weight"\n'
        '[[line_loads]]\nelements = ["left"]\nqy = -3\ncase = "snow"\n'
        '[[temperatures]]\nelements = ["left"]\ntemperature = "20*k"\ncase = "summer"\n'
    )
    _, model = loaded(tmp_path, text, schema)
    result = da.solve_statics(model)
    lift = result["a.fy"] + result["c.fy"]
    assert lift[result.case("weight")] == pytest.approx(10 * result["mass"][0])
    assert lift[result.case("snow")] == pytest.approx(3 * np.sqrt(2))
    assert "summer" in result.cases


def test_tractions(tmp_path: Path, schema) -> None:
    text = MESH + (
        '[[tractions]]\nelements = "plate"\nnodes = "plate"\nwhere = { x = 2 }\n'
        'tx = 1e6\ncase = "pull"\n'
    )
    _, model = loaded(tmp_path, text, schema)
    result = da.solve_statics(model)
    assert result.applied(result.case("pull")).sum() == pytest.approx(1e6 * 0.01 * 1.0)


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


def test_smooth_maximum_is_a_measure(tmp_path: Path) -> None:
    file, model = loaded(tmp_path, MESH.replace(".max", ".max(1e-4)"))
    (response,) = make_responses(file, model).values()
    result = da.solve_statics(model)
    assert da.evaluate(result, response) > result["plate.von_mises.max"][1]


def test_initial_motion(tmp_path: Path, schema) -> None:
    text = HEAD + (
        '[[initial]]\nnodes = "b"\nvy = 2\nuy = 1e-3\nvrz = 0.5\n'
        '[analysis]\ntype = "Transient"\nduration = 1e-3\nstep = 1e-4\n'
    )
    file, model = loaded(tmp_path, text, schema)
    motion = make_analysis(file, model).run(model)
    assert [float(motion[name][0]) for name in ("b.vy", "b.uy", "b.vrz")] == [2.0, 1e-3, 0.5]


def test_loads_that_change_with_time(tmp_path: Path, schema) -> None:
    text = HEAD.replace("fy = -10", 'fy = "-10*sin(k*t)"') + (
        '[analysis]\ntype = "Transient"\nduration = 1.0\nstep = 0.1\n'
    )
    file, model = loaded(tmp_path, text, schema)
    motion = make_analysis(file, model).run(model)
    np.testing.assert_allclose(motion["b.fy"], -10 * np.sin(2 * motion.time), atol=1e-12)


# what goes wrong ---------------------------------------------------------------------------------
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
    ('area = "area"', "area = -1", "elements.left.area: is -1 m^2; it must be above 0"),
    ('area = "area"', "", "elements.left.area: is missing"),
    ("a = [0, 0]", "a = [0, 0, 0]", "nodes.b: has 2 coordinates, a has 3"),
    ("a = [0, 0]", "a = [0, 0, 0, 0]", "nodes.a: expected 1 to 3 coordinates, got 4"),
    ("a = [0, 0]", "a = [0, true]", "nodes.a: expected a number or a formula, got true"),
    ("c = [2, 0]", "c = [2, 0]\nd = [3, 3]", "nodes.d: is not connected to any element"),
    ("c = [2, 0]", "c = [2, 0]\narea = [3, 3]", "nodes.area: the name is already used by param"),
    ('nodes = ["a", "c"]', 'nodes = ["a", "x"]', "supports[0].nodes: unknown nodes 'x'"),
    ('nodes = ["a", "c"]', 'nodes = "a"\nuz = 0', "unknown direction 'uz'; known: ux, uy, rz"),
    ('nodes = ["a", "c"]', 'nodes = "a"\nwhere = { x = 0 }', "supports[0]: a is one node; where"),
    ('nodes = ["a", "c"]', "nodes = []", "supports[0].nodes: expected the name of nodes"),
    ('nodes = "b"\nfy', 'nodes = "a"\nfy', "load a: uy is prescribed, so the force there is a rea"),
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
        '[analysis]\ntype = "Dynamics"\n[responses]',
        "analysis: unknown type 'Dynamics'",
    ),
    (
        "[responses]",
        '[analysis]\ntype = "Modal"\ncount = 0\n[responses]',
        "analysis: Modal: count is 0; it must be positive",
    ),
    (
        "[responses]",
        '[analysis]\ntype = "Transient"\nduration = 1\nintegrator = "RK4"\n[responses]',
        "analysis: integrator is RK4",
    ),
    ("[responses]", "[bodies.x]\nmass = 1\n[responses]", "bodies: unknown key"),
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
    told = capsys.readouterr().err
    assert told.startswith(f"Error: {path}: ")
    assert words in told
    assert "Traceback" not in told


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
        "unknown nodes 'plat' (did you mean 'plate'?)",
    ),
    (
        "plate.von_mises.max",
        "plate.von_mises",
        "no measure 'plate.von_mises'; nearest: plate.von_mi",
    ),
]


@pytest.mark.parametrize(("old", "new", "words"), MESH_WRONG, ids=[w[2][:40] for w in MESH_WRONG])
def test_one_message_of_meshes(old: str, new: str, words: str, tmp_path: Path, capsys) -> None:
    assert old in MESH
    path = written(tmp_path, MESH.replace(old, new, 1))
    assert main(["check", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"Error: {path}: ")
    assert words in told


@pytest.mark.parametrize("change", [("type", 7), ("connect", ["a"]), ("area", True), ("what", 1)])
def test_schema_refuses(change, schema) -> None:
    data = tomllib.loads(HEAD)
    assert schema.is_valid(data)
    data["elements"]["left"] |= dict([change])
    assert not schema.is_valid(data)


# commands --------------------------------------------------------------------------------------
@pytest.mark.parametrize("name", ["truss", "plate"])
def test_commands(name: str, tmp_path: Path, capsys) -> None:
    path, folder = EXAMPLES / f"{name}.toml", ["--output", str(tmp_path)]
    assert main(["check", str(path), "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["nodes"] > 6
    assert main(["run", str(path), *folder, "--csv", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["ok"]
    assert [Path(f).name for f in made["files"]] == [
        f"{name}.nc",
        f"{name}.csv",
        f"{name}.report.html",
    ]
    model = load_model_file(path).model()
    for row in made["states"]:
        case = row["load case"] if len(made["states"]) > 1 else ""
        applied = model.loads[case].values(model.nominal)
        sums = [applied[model.degrees.table[:, axis]].sum() for axis in range(2)]
        reactions = [row["sum of reactions"][f] for f in ("fx", "fy")]
        assert reactions == pytest.approx([-s for s in sums], abs=1e-6)
        assert row["largest displacement"]["value"] > 0
    assert main(["run", str(path), *folder]) == 0
    assert "largest displacement" in capsys.readouterr().out
    assert main(["report", str(tmp_path / f"{name}.nc")]) == 0
    assert main(["sensitivity", str(path), "--json"]) == 0
    capsys.readouterr()


def test_settings_reach_the_structure(tmp_path: Path, capsys) -> None:
    path = written(tmp_path, MESH)
    found = []
    for setting in ([], ["--set", "thickness=0.02"]):
        assert main(["run", str(path), "--output", str(tmp_path), "--json", *setting]) == 0
        states = json.loads(capsys.readouterr().out)["states"]
        found.append(states[0]["largest displacement"]["value"])
    assert found[1] == pytest.approx(found[0] / 2)
    assert main(["run", str(path), "--set", "thickness=-1"]) == 2
    assert "parameters.thickness: value -1.0 lies outside its bounds" in capsys.readouterr().err


def test_a_mechanism_fails_with_its_nodes(tmp_path: Path, capsys) -> None:
    path = written(tmp_path, HEAD.replace('nodes = ["a", "c"]', 'nodes = ["a"]\nux = 0'))
    assert main(["run", str(path), "--output", str(tmp_path)]) == 1
    assert "is a mechanism" in capsys.readouterr().err


def test_a_path_that_is_lost_is_a_failure(tmp_path: Path, capsys) -> None:
    text = HEAD + '[[loads]]\nnodes = "b"\nfx = 1e8\n'
    text += '[analysis]\ntype = "NonlinearStatics"\nmax_iterations = 1\n'
    assert main(["run", str(written(tmp_path, text)), "--output", str(tmp_path), "-q"]) == 1
    assert "no equilibrium beyond" in capsys.readouterr().err


def test_comparing_formulations_is_for_mechanisms(tmp_path: Path, capsys) -> None:
    assert main(["compare", str(written(tmp_path, HEAD))]) == 2
    assert "is for mechanisms" in capsys.readouterr().err


def test_deck_has_a_report_too(tmp_path: Path, capsys) -> None:
    deck = EXAMPLES / "springs.dat"
    assert main(["run", str(deck), "--output", str(tmp_path), "--json"]) == 0
    files = [Path(f).suffix for f in json.loads(capsys.readouterr().out)["files"]]
    assert files == [".nc", ".html"]


def test_units_of_the_page_are_chosen(tmp_path: Path, capsys) -> None:
    path = written(tmp_path, HEAD + '[report]\nunits = ["cm", "kN"]\n')
    assert main(["run", str(path), "--output", str(tmp_path), "--csv", "--json"]) == 0
    page = report_of(da.load_results(tmp_path / "model.nc"))
    assert page["units"] == {"N": [1000.0, "kN"], "m": [0.01, "cm"]}
    assert "cm" in (tmp_path / "model.csv").read_text("utf-8")
    capsys.readouterr()
    wrong = written(tmp_path, HEAD + '[report]\nunits = ["cmm"]\n', "wrong.toml")
    assert main(["check", str(wrong)]) == 2
    assert "report.units: units: unknown unit 'cmm'" in capsys.readouterr().err


def test_reserved_names_are_those_of_formulas(tmp_path: Path) -> None:
    """A node may be called e, whose measures are e.ux; a parameter may not."""
    for declare in (lambda s: s.parameter("t", 1.0), lambda s: s.table("pi", [0, 1], [0, 1])):
        with pytest.raises(da.ModelError, match="reserved"):
            declare(da.Structure("bar"))
    file, model = loaded(
        tmp_path, HEAD.replace("b = [1", "e = [1").replace('"b"', '"e"').replace("b.uy", "e.uy")
    )
    result = make_analysis(file, model).run(model)
    assert result.values("e.uy")[0] < 0
    with pytest.raises(da.ModelError, match="reserved"):
        loaded(tmp_path, HEAD.replace("k = 2.0", "k = 2.0\ne = 1.0"))


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
        told = str(error)
    else:
        return
    assert str(path) in told
