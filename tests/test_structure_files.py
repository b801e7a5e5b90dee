"""Model files of structures: what Python users write and what files hold are the same."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest
from structure_file import HEAD, MESH, loaded, written

import dalembert as da
from dalembert import structures
from dalembert.cli import main
from dalembert.elements.fem.registry import ELEMENTS
from dalembert.io.analyses import make_analysis
from dalembert.io.decisions.tasks import make_responses
from dalembert.io.strategies import RESPONSES, STRUCTURAL_ANALYSES


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
    done = make_analysis(file, model).run(model)
    np.testing.assert_allclose(done.displacements, expected.displacements, rtol=1e-12)
    by_file = da.sensitivity(done, list(make_responses(file, model).values()))
    np.testing.assert_allclose(by_file, -da.sensitivity(expected, da.final("b.uy")), rtol=1e-9)


def test_load_model_gives_a_structure(tmp_path: Path) -> None:
    model = da.load_model(written(tmp_path, HEAD))
    assert isinstance(model, da.Structure)
    model.load(model.nodes["b"], fx=3)
    assert da.solve_statics(model.build())["b.fx"] == 3


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
    "Equilibrium": "steps = 2",
    "ArcLength": "first = 0.2\nmax_points = 5",
    "Modal": "count = 2",
    "Buckling": "count = 1",
    "Dynamics": 'duration = 0.01\nstep = 1e-3\ndamping = { stiffness = "k*1e-4" }\n'
    'integrator = "HHT"',
    "FrequencyResponse": 'outputs = ["b.uy"]\nspan = [1, 50]\nloss_factor = 0.02',
    "RandomResponse": 'outputs = ["b.uy"]\nband = [1, 50]\nloss_factor = 0.02\npsd = { push = 2 }',
}
LAW = {
    "Modal": "frequency",
    "Buckling": "load_factor",
    "FrequencyResponse": "b.uy.amplitude",
    "RandomResponse": "b.uy.amplitude",
}
"""Measures of results that are no displacements."""


@pytest.mark.few(5)
@pytest.mark.parametrize("name", list(STRUCTURAL_ANALYSES))
def test_every_analysis_can_be_asked_for(name: str, tmp_path: Path, schema, capsys) -> None:
    head = HEAD.replace('nodes = "b"\nfy', 'case = "push"\nnodes = "b"\nfy')
    head = head if name == "RandomResponse" else HEAD
    text = f'{head}[analysis]\ntype = "{name}"\n{OPTIONS[name]}\n'
    file, model = loaded(tmp_path, text, schema)
    analysis = make_analysis(file, model)
    assert type(analysis) is STRUCTURAL_ANALYSES[name]
    text = text.replace("-b.uy", LAW.get(name, "-b.uy"))
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
    table = '[analysis]\ntype = "Dynamics"\nduration = 0.01\nstep = 1e-3\n'
    text = HEAD.replace(
        "sag = {", f'other = {{ type = "{name}", measure = "b.vy"{more} }}\nsag = {{'
    )
    if name == "AtEvent":  # structures have no events
        file, model = loaded(tmp_path, text + table)
        with pytest.raises(da.ModelError, match="unknown event"):
            make_responses(file, model)
        return
    file, model = loaded(tmp_path, text + table, schema)
    response = make_responses(file, model)["other"]
    assert type(response) is RESPONSES[name]


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
    mesh = meshio.Mesh(flat, [("quad", cells)], point_sets={"left": left}, cell_sets=groups)
    meshio.write(tmp_path / "plate.xdmf", mesh)
    meshio.abaqus.write(tmp_path / "plate.inp", mesh)
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
    text = HEAD.replace("density", "expansion = 1e-5\ndensity", 1) + (
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


def test_smooth_maximum_is_a_measure(tmp_path: Path) -> None:
    file, model = loaded(tmp_path, MESH.replace(".max", ".max(1e-4)"))
    (response,) = make_responses(file, model).values()
    result = da.solve_statics(model)
    assert da.evaluate(result.at(1), response) > result["plate.von_mises.max"][1]


def test_initial_motion(tmp_path: Path, schema) -> None:
    text = HEAD + (
        '[[initial]]\nnodes = "b"\nvy = 2\nuy = 1e-3\nvrz = 0.5\n'
        '[analysis]\ntype = "Dynamics"\nduration = 1e-3\nstep = 1e-4\n'
    )
    file, model = loaded(tmp_path, text, schema)
    motion = make_analysis(file, model).run(model)
    assert [float(motion[name][0]) for name in ("b.vy", "b.uy", "b.vrz")] == [2.0, 1e-3, 0.5]


def test_loads_that_change_with_time(tmp_path: Path, schema) -> None:
    text = HEAD.replace("fy = -10", 'fy = "-10*sin(k*t)"') + (
        '[analysis]\ntype = "Dynamics"\nduration = 1.0\nstep = 0.1\n'
    )
    file, model = loaded(tmp_path, text, schema)
    motion = make_analysis(file, model).run(model)
    np.testing.assert_allclose(motion["b.fy"], -10 * np.sin(2 * motion.time), atol=1e-12)


def test_reserved_names_are_those_of_formulas(tmp_path: Path) -> None:
    """Nodes, elements and parameters may be called e and t where time plays no part."""
    with pytest.raises(da.ModelError, match=r"'pi' is reserved.*the number π"):
        da.Structure("bar").table("pi", [0, 1], [0, 1])
    file, model = loaded(
        tmp_path, HEAD.replace("b = [1", "e = [1").replace('"b"', '"e"').replace("b.uy", "e.uy")
    )
    result = make_analysis(file, model).run(model)
    assert result.values("e.uy")[0] < 0
    file, model = loaded(tmp_path, HEAD.replace("k = 2.0", "k = 2.0\nt = 3.0\nb = 4.0"))
    result = make_analysis(file, model).run(model)
    assert list(result.values("t + b")) == [7.0] * len(result.cases)
    with pytest.raises(da.AnalysisError, match="'t' is a parameter, but the time"):
        da.solve_transient(model, 1.0, step=0.1)
    structure = file.build()
    structure.load(structure.nodes["b"], fx=da.t)
    with pytest.raises(da.ModelError, match="depends on time, but 't' is a parameter"):
        structure.build()
