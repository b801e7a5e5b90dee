"""MAT and Parquet files of results, read back by SciPy and Arrow."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as parquet
import pytest
from scipy.io import loadmat

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.errors import KeywordError
from dalembert.io.exports.registry import FORMATS

EXAMPLES = Path(__file__).parents[1] / "examples"


def pendulum() -> da.Model:
    system = da.System("pendulum", gravity=(0, -9.81))
    length = system.parameter("length", 0.5, "m")
    system.parameter("end", 1.0)  # a keyword of MATLAB
    bar = system.add(planar.Bar("bar", length=length, mass=2.0, angle=-1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    return system.build()


def results() -> dict:
    model = pendulum()
    plate = da.load_model(EXAMPLES / "plate.toml").build()
    lengths = {"length": [0.4, 0.5, 0.6]}
    return {
        "motion": da.solve_dynamics(model, 0.5, step=0.1),
        "batch": da.solve_dynamics(model, 0.5, step=0.1, parameters=lengths),
        "modes": da.linearize(model),
        "structure": da.solve_statics(plate),
    }


@pytest.fixture(scope="module")
def solved() -> dict:
    return results()


def test_motions_as_mat(solved, tmp_path):
    motion = solved["motion"]
    written = da.export(motion, tmp_path / "swing.mat")
    data = loadmat(written.files[0], simplify_cells=True)
    rows = {row[1]: row for row in data["variables"][1:]}
    frame = motion.to_dataframe()
    assert set(frame.columns) | {"time"} == set(rows)
    for name in frame.columns:
        short, _, unit = rows[name]
        np.testing.assert_array_equal(data[short], frame[name])
        assert unit == frame.attrs["units"][name]
    assert data["parameters"]["length"] == 0.5 and data["parameters"]["end_"] == 1.0
    np.testing.assert_array_equal(data["time"], motion.time)


def test_batches_as_mat(solved, tmp_path):
    batch = solved["batch"]
    data = loadmat(da.export(batch, tmp_path / "many.mat").files[0], simplify_cells=True)
    np.testing.assert_array_equal(data["designs"]["length"], [0.4, 0.5, 0.6])
    np.testing.assert_array_equal(data["bar_angle"], batch["bar.angle"].values)


@pytest.mark.parametrize("kind", ["motion", "modes", "structure", "batch"])
def test_parquet_has_the_numbers_of_mat(solved, kind, tmp_path):
    result = solved[kind]
    data = loadmat(da.export(result, tmp_path / "x.mat").files[0], simplify_cells=True)
    table = parquet.read_table(da.export(result, tmp_path / "x.parquet").files[0])
    assert table.schema.metadata[b"model"].decode() == result.model.name
    for short, name, unit in data["variables"][1:]:
        field = table.schema.field(name)
        assert field.metadata[b"unit"].decode() == (unit if len(unit) else "")
        if name != "time":
            np.testing.assert_array_equal(table[name].to_numpy(), np.ravel(data[short]))


@pytest.mark.parametrize("name", ["design", "case"])
def test_a_parameter_named_like_an_index_leaves_the_table_readable(name, tmp_path):
    """Columns of a table have different names: other readers refuse files where two are alike."""
    pandas = pytest.importorskip("pandas")
    system = da.System("pendulum", gravity=(0, -9.81))
    length = system.parameter(name, 0.5, "m")
    bar = system.add(planar.Bar("bar", length=length, mass=2.0, angle=-1.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    model, values = system.build(), [0.4, 0.5]
    batch = da.solve_dynamics(model, 0.2, step=0.1, parameters={name: values})
    table = pandas.read_parquet(da.export(batch, tmp_path / "x.parquet").files[0])
    assert list(dict.fromkeys(table[name])) == values
    index = "design_index" if name == "design" else "design"
    assert table[index].to_list() == [0, 0, 0, 1, 1, 1]


def test_variable_names_are_valid_and_different(tmp_path):
    system = da.System("names")
    for name in ("a" * 70, "a" * 70 + "b"):
        system.add(planar.Particle(name, mass=1.0))
    motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    data = loadmat(da.export(motion, tmp_path / "n.mat").files[0], simplify_cells=True)
    shorts = [row[0] for row in data["variables"][1:]]
    assert len(set(shorts)) == len(shorts) and max(map(len, shorts)) <= 63


def test_wrong_input_is_one_message_and_leaves_no_file(solved, tmp_path):
    with pytest.raises(da.FileError, match=r"unknown suffix '.tiff'.*\.mat \(mat\)"):
        da.export(solved["motion"], tmp_path / "x.tiff")
    with pytest.raises(da.UnsupportedError, match=r"unknown format .mta. .*mat"):
        da.export(solved["motion"], tmp_path / "x", "mta")
    with pytest.raises(da.UnsupportedError, match="not a mechanism; analyse it first"):
        da.export(pendulum(), tmp_path / "x.mat")
    with pytest.raises(da.UnsupportedError, match="got int 3"):
        da.export(3, tmp_path / "x.mat")
    with pytest.raises(KeywordError, match="unknown keyword 'unit'"):
        da.export(solved["motion"], tmp_path / "x.mat", unit="mm")
    with pytest.raises(da.FileError, match=r"missing.*cannot be written"):
        da.export(solved["motion"], tmp_path / "missing" / "x.mat")
    assert not list(tmp_path.iterdir())


def test_a_missing_package_is_named_with_its_installation(solved, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(da.UnsupportedError, match=r"pip install 'dalembert\[study\]'"):
        da.export(solved["motion"], tmp_path / "x.parquet")
    assert not list(tmp_path.iterdir())


def test_the_command_writes_results(tmp_path, capsys):
    source = str(EXAMPLES / "four_bar.toml")
    assert main(["export", source, "--to", "mat", "-o", str(tmp_path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["files"] == [str(tmp_path / "four_bar.mat")] and answer["omissions"] == []
    assert main(["export", source, "--to", "matt", "-o", str(tmp_path)]) == 2
    assert "unknown format 'matt' (did you mean 'mat'?)" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["four_bar.mat"]


def test_the_command_takes_options_of_a_format(tmp_path, capsys):
    source = str(EXAMPLES / "sliding_pendulum.toml")
    command = ["export", source, "-o", str(tmp_path), "--json", "--to"]
    assert main([*command, "vtk", "--option", "frames=3"]) == 0
    grids = [name for name in json.loads(capsys.readouterr().out)["files"] if "bodies" in name]
    assert len(grids) == 3
    timed = ["--option", "time=0.1", "--option", "unit=m"]
    assert main([*command, "dxf", *timed]) == 0
    capsys.readouterr()
    for option, text in {
        "frames=abc": "frames is 'abc'; give a whole number, at least 2",
        "frames=0": "frames is 0; give a whole number, at least 2",
        "frame=3": "did you mean 'frames'?",
        "frames": "write NAME=VALUE",
    }.items():
        assert main([*command, "vtk", "--option", option]) == 2
        assert text in capsys.readouterr().out
    assert main([*command, "js", "--option", "frames=3"]) == 2
    assert "has no --option frames" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("suffix", "options"),
    [
        ("pvd", {"frames": 2.5}),
        ("glb", {"frames": -1}),
        ("glb", {"scale": np.nan}),
        ("dxf", {"time": "soon"}),
        ("dxf", {"trace": "bar.end"}),
    ],
)
def test_wrong_values_of_options_are_named(solved, tmp_path, suffix, options):
    with pytest.raises(da.UnsupportedError, match=f"{next(iter(options))} is .*; give a"):
        da.export(solved["motion"], tmp_path / f"x.{suffix}", **options)
    assert not list(tmp_path.iterdir())


def test_every_format_names_its_writer_and_sources():
    for name, file_format in FORMATS.items():
        assert callable(file_format._writer()), name
