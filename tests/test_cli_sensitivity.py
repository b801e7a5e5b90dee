"""``dalembert sensitivity``: tables, notes, certificates, charts, decks, wrong names."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.cli import main
from dalembert.results.pictures.influence import by_influence, relative_influence

EXAMPLES = Path(__file__).parents[1] / "examples"
NUMBERS = ("derivative", "relative", "parameter_value", "response_value")


@pytest.fixture
def model(tmp_path) -> Path:
    """A driven slider-crank, shortened."""
    path = tmp_path / "slider_crank.toml"
    path.write_text((EXAMPLES / "slider_crank.toml").read_text(encoding="utf-8"), encoding="utf-8")
    return path


@pytest.fixture
def bridge() -> Path:
    """The deck of example 8.13."""
    return EXAMPLES / "bridge.dat"


def json_output(capsys) -> dict:
    return json.loads(capsys.readouterr().out)


def rows(text: str, name: str) -> list[list[str]]:
    """Cells of the lines that begin with a name."""
    computed = (line.split() for line in text.splitlines())
    return [cells for cells in computed if cells[:1] == [name]]


def test_tables_are_sorted_by_influence(model, capsys):
    assert main(["sensitivity", str(model)]) == 0
    text = capsys.readouterr().out
    assert "derivatives by Adjoint" in text
    assert "percent of the response per percent of the parameter" in text
    assert "note: m_rod, m_piston, gas: no influence on piston_speed (exactly zero)" in text
    assert main(["sensitivity", str(model), "--json"]) == 0
    output = json_output(capsys)
    order = [text.index(f"\n{name} ") for name in output["by_influence"]]
    assert order == sorted(order)
    speed = output["responses"]["piston_speed"]
    derivative, value = speed["gradient"]["r"], output["parameters"]["r"]["value"]
    assert speed["relative"]["r"] == pytest.approx(derivative * value / speed["value"], rel=1e-12)
    assert rows(text, "r")[1][-1] == f"{speed['relative']['r']:+.4g}"
    assert output["notes"]
    assert output["parameters"]["r"]["unit"] == "m"


def test_few_parameters_are_columns(model, capsys):
    assert main(["sensitivity", str(model), "--wrt", "r", "--wrt", "l"]) == 0
    text = capsys.readouterr().out
    assert len(rows(text, "torque_rms")) == 2  # one line in each table
    assert rows(text, "r") == [["r", "l"], ["r", "l"]]


def test_chosen_responses_and_parameters(model, capsys):
    command = ["sensitivity", str(model), "--response", "bearing", "--wrt", "m_rod", "--json"]
    assert main(command) == 0
    output = json_output(capsys)
    assert list(output["responses"]) == ["bearing"]
    assert list(output["responses"]["bearing"]["gradient"]) == ["m_rod"]


@pytest.mark.thorough
def test_certificate(model, capsys):
    command = ["sensitivity", str(model), "--certificate", "--response", "bearing"]
    assert main(command) == 0
    text = capsys.readouterr().out
    assert re.search(r"Taylor test of bearing: slope 2\.\d\d, confirmed", text)
    assert "d bearing / d m_rod" in text
    assert main([*command, "--json"]) == 0
    certificate = json_output(capsys)["certificate"]
    assert certificate["passed"]
    assert {entry["verdict"] for entry in certificate["entries"]} <= {"confirmed", "no influence"}
    assert certificate["taylor"][0]["taylor_slope"] == pytest.approx(2.0, abs=0.1)


def test_a_certificate_that_fails_is_a_failure(model, capsys, monkeypatch):
    from dalembert.sensitivity.pointwise import PointwiseEngine

    true = PointwiseEngine.adjoint
    monkeypatch.setattr(PointwiseEngine, "adjoint", lambda self: 1.001 * true(self))
    assert main(["sensitivity", str(model), "--certificate", "--json"]) == 1
    output = json_output(capsys)
    assert not output["ok"]
    assert not output["certificate"]["passed"]


def test_files(model, tmp_path, capsys):
    out = tmp_path / "o"
    assert main(["sensitivity", str(model), "--output", str(out)]) == 0
    text = capsys.readouterr().out
    table, chart = out / "slider_crank.sensitivity.csv", out / "slider_crank.sensitivity.png"
    assert str(table) in text
    assert str(chart) in text
    with table.open(encoding="utf-8", newline="") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == 3 * 6
    results = {(x["response"], x["parameter"]): x for x in lines}
    entry = {name: float(results["bearing", "r"][name]) for name in NUMBERS}
    change = entry["derivative"] * entry["parameter_value"] / entry["response_value"]
    assert entry["relative"] == pytest.approx(change, rel=1e-12)
    assert chart.read_bytes()[:4] == b"\x89PNG"


@pytest.mark.thorough
def test_chart_alone(model, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["sensitivity", str(model), "--plot", "--svg", "--json"]) == 0
    assert json_output(capsys)["files"] == ["slider_crank.sensitivity.svg"]
    picture = (tmp_path / "slider_crank.sensitivity.svg").read_text(encoding="utf-8")
    assert "<svg" in picture
    assert sorted(p.suffix for p in tmp_path.iterdir()) == [".svg", ".toml"]


def test_deck_with_parameters(bridge, capsys):
    """Example 8.13: ∇Θ = (−9, −1), and ∂U1/∂k1 = −3 where U1 = 3/k1."""
    assert main(["sensitivity", str(bridge), "--json"]) == 0
    output = json_output(capsys)
    assert output["responses"]["compliance"]["gradient"] == {
        "d1": pytest.approx(-9.0, abs=1e-12),
        "d2": pytest.approx(-1.0, abs=1e-12),
    }
    command = ["sensitivity", str(bridge), "--response", "n1.ux", "--response", "n3.fx"]
    assert main([*command, "--certificate"]) == 0
    text = capsys.readouterr().out
    assert rows(text, "d1")[0][-2:] == ["-3", "0"]
    assert "d1, d2: no influence on n3.fx (exactly zero)" in text
    assert main(["sensitivity", str(bridge), "--set", "d1=2", "--json"]) == 0
    assert json_output(capsys)["responses"]["compliance"]["gradient"]["d1"] == pytest.approx(-9 / 4)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("slider_crank.toml", ["--method", "adjont"], "unknown --method 'adjont' (did you mean"),
        ("slider_crank.toml", ["--response", "bering"], "'bering' (did you mean 'bear"),
        ("slider_crank.toml", ["--wrt", "m_rode"], "unknown --wrt 'm_rode' (did you mean"),
        ("slider_crank.toml", ["--set", "nothing=1"], "nothing: unknown parameter"),
        ("bridge.dat", ["--method", "simplex"], "unknown --method 'simplex'"),
        ("bridge.dat", ["--response", "n9.ux"], "no measure 'n9.ux'"),
        ("bridge.dat", ["--wrt", "d3"], "unknown --wrt 'd3' (did you mean 'd2'?); known: d1"),
        ("bridge.dat", ["--set", "d1=x"], "--set d1: 'x' is not a number"),
        ("springs.dat", [], "has no sensitivity parameters; add their count"),
    ],
)
def test_wrong_names_are_wrong_input(name, options, message, tmp_path, capsys):
    out = tmp_path / "new"
    assert main(["sensitivity", str(EXAMPLES / name), "--output", str(out), *options]) == 2
    assert message in capsys.readouterr().err
    assert not out.exists()


# charts ------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def gradient():
    """Three responses of a thrown mass: one negative, one zero."""
    system = da.System("thrown", gravity=(0.0, -10.0))
    system.parameter("idle", 3.0)
    speed = system.parameter("speed", 2.0, "m/s", bounds=(1.0, 4.0))
    side = system.parameter("side", 0.0, "m/s", bounds=(-1.0, 1.0))
    start = system.parameter("start", -30.0, "m")
    ball = planar.Particle("ball", mass=1.0, position=(0.0, start), velocity=(side, speed))
    system.add(ball)
    motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    return da.sensitivity(motion, [da.final(f"ball.{x}", name=x) for x in ("y", "x", "vy")])


def test_relative_influence_has_the_sign_of_the_derivative(gradient):
    """y = start + speed t − g t²/2 = −33, with a negative parameter and a negative value."""
    shares = relative_influence(gradient)
    assert shares.sel(response="y", parameter="speed").item() == pytest.approx(2 / 33)
    assert shares.sel(response="y", parameter="start").item() == pytest.approx(30 / 33)
    assert np.isnan(shares.sel(response="x").values).all()
    assert by_influence(gradient)[:2] == ["speed", "start"]


def test_bars_are_sorted_and_told(gradient):
    axes = da.tornado(gradient)
    first = axes[0]
    assert first.get_title("left") == "y = −33 m"
    assert [t.get_text() for t in first.get_yticklabels()] == ["start = −30 m", "speed = 2 m/s"]
    widths = [bar.get_width() for bar in first.patches]
    assert widths == pytest.approx([100 * 0.3 / 33, 100 * 0.02 / 33])
    assert "[%] for 1 % more" in first.get_xlabel()
    texts = " ".join(t.get_text() for ax in axes for t in ax.texts)
    assert "no influence: idle" in texts
    assert "zero, without relative change: side" in texts  # x moves with side alone
    colours = {tuple(bar.get_facecolor()) for ax in axes for bar in ax.patches}
    assert len(colours) == 1  # everything rises


def test_bars_over_bounds(gradient):
    axes = da.tornado(gradient.sel(response=["y"]), kind="range")
    assert [bar.get_width() for bar in axes.patches] == pytest.approx([1.5])  # half of 1 … 4
    assert axes.texts[-1].get_text() == "no influence: idle, side\nwithout bounds: start"
    with pytest.raises(da.AnalysisError, match="no parameter has bounds on both sides"):
        da.tornado(gradient.sel(parameter=["start"]), kind="range")
    with pytest.raises(da.AnalysisError, match="known: relative, range"):
        da.tornado(gradient, kind="cake")
    with pytest.raises(da.AnalysisError, match="3 responses need as many axes"):
        da.tornado(gradient, axes=axes)
    with pytest.raises(da.AnalysisError, match="give the gradient as sensitivity returns it"):
        da.tornado(gradient.drop_vars("parameter_value"))


def test_many_bars_are_cut(gradient):
    axes = da.tornado(gradient, most=1)
    assert len(axes[0].patches) == 1
    assert "1 more, each at most" in axes[0].texts[-1].get_text()
