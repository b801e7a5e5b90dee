"""Commands on files of structures."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from structure_file import EXAMPLES, HEAD, MESH, written

import dalembert as da
from dalembert.cli import main
from dalembert.io import load_model_file
from dalembert.results.files.store import report_of


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["truss", "plate"])
def test_commands(name: str, tmp_path: Path, capsys) -> None:
    path, folder = EXAMPLES / f"{name}.toml", ["--output", str(tmp_path)]
    assert main(["check", str(path), "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["nodes"] > 6
    assert main(["run", str(path), *folder, "--csv", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["ok"]
    assert [Path(f).name for f in document["files"]] == [
        f"{name}.nc",
        f"{name}.csv",
        f"{name}.report.html",
    ]
    model = load_model_file(path).model()
    for row in document["states"]:
        case = row["load case"] if len(document["states"]) > 1 else ""
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


@pytest.mark.thorough
def test_settings_reach_the_structure(tmp_path: Path, capsys) -> None:
    path = written(tmp_path, MESH)
    results = []
    for setting in ([], ["--set", "thickness=0.02"]):
        assert main(["run", str(path), "--output", str(tmp_path), "--json", *setting]) == 0
        states = json.loads(capsys.readouterr().out)["states"]
        results.append(states[0]["largest displacement"]["value"])
    assert results[1] == pytest.approx(results[0] / 2)
    assert main(["run", str(path), "--set", "thickness=-1"]) == 2
    assert "parameters.thickness: value -1.0 lies outside its bounds" in capsys.readouterr().err


def test_a_mechanism_fails_with_its_nodes(tmp_path: Path, capsys) -> None:
    path = written(tmp_path, HEAD.replace('nodes = ["a", "c"]', 'nodes = ["a"]\nux = 0'))
    assert main(["run", str(path), "--output", str(tmp_path)]) == 1
    assert "is a mechanism" in capsys.readouterr().err


def test_a_path_that_is_lost_is_a_failure(tmp_path: Path, capsys) -> None:
    text = HEAD + '[[loads]]\nnodes = "b"\nfx = 1e8\n'
    text += '[analysis]\ntype = "Equilibrium"\nmax_iterations = 1\n'
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


@pytest.mark.thorough
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


MODES = """format = 1
kind = "structure"
[nodes]
root = [0, 0]
tip = [1, 0]
[elements.beam]
type = "Frame"
connect = ["root", "tip"]
area = 1e-3
second_moment = 1e-7
modulus = 2e11
density = 7850
[[supports]]
nodes = "root"
[analysis]
type = "Modal"
count = 3
"""


@pytest.mark.parametrize("width", [None, 40, 60, 80, 100])
def test_tables_of_modes_are_complete_at_any_width(width, tmp_path, capsys, monkeypatch) -> None:
    """Narrow terminals get further columns below, with the names of the modes."""
    if width is None:
        monkeypatch.delenv("COLUMNS", raising=False)
    else:
        monkeypatch.setenv("COLUMNS", str(width))
    path = written(tmp_path, MODES)
    assert main(["run", str(path), "--output", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("mode  "))
    last = next(k for k, line in enumerate(lines) if line.startswith("  written"))
    table = lines[first:last]
    assert not any("…" in line for line in table)
    for heading in ("frequency", "angular frequency", "eigenvalue"):
        assert sum(f"  {heading}" in line for line in table) >= 1
    assert max(map(len, table)) <= (width or 1000)
    blocks = sum(line.startswith("mode  ") for line in table)
    assert len([line for line in table if line.startswith("mode 3: ")]) == blocks
    assert (blocks > 1) == (width == 40)
