"""The command line as people and programs use it."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

from dalembert.cli import main
from dalembert.cli.app import COMMANDS
from dalembert.design.optimize.problem import DesignProblem
from dalembert.integrators.marching.march import FixedMarch
from dalembert.sensitivity.methods import Adjoint

FOUR_BAR = Path(__file__).parents[1] / "examples" / "four_bar.toml"


@pytest.fixture
def model(tmp_path) -> Path:
    """The example, shortened."""
    path = tmp_path / "four_bar.toml"
    text = FOUR_BAR.read_text(encoding="utf-8")
    text = re.sub(r"(?m)^duration = .*$", "duration = 0.5", text)
    path.write_text(re.sub(r"(?m)^outputs = .*$", "outputs = 26", text), encoding="utf-8")
    return path


def json_output(capsys) -> dict:
    return json.loads(capsys.readouterr().out)


def test_help(capsys):
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for name in COMMANDS:
        assert name in text
        assert main([name, "--help"]) == 0
        page = capsys.readouterr().out
        assert "--json" in page
        assert COMMANDS[name].split()[0] in page


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.strip()[0].isdigit()


def test_check_explains(model, capsys):
    assert main(["check", str(model)]) == 0
    text = capsys.readouterr().out
    for word in ("1 degree of freedom", "crank", "O1 → A → B → O2", "l1 = 0.3 m", "links = 1.9 m"):
        assert word in text


def test_check_as_json(model, capsys):
    assert main(["check", str(model), "--json", "--set", "l1=0.25"]) == 0
    output = json_output(capsys)
    assert output["diagnosis"]["degrees_of_freedom"] == 1
    assert output["diagnosis"]["joints"] == ["O1", "A", "B", "O2"]
    assert output["parameters"]["l1"]["value"] == 0.25
    assert output["derived"]["links"]["value"] == pytest.approx(1.85)


def test_check_names_redundant_joints(tmp_path, capsys):
    path = tmp_path / "double.toml"
    path.write_text(
        'format = 1\n[bodies.a]\nmass = 1\ninertia = 1\n[joints.A]\ntype = "Revolute"\n'
        'connect = ["ground", "a"]\n[joints.B]\ntype = "Revolute"\nconnect = ["ground", "a"]\n',
        encoding="utf-8",
    )
    assert main(["check", str(path)]) == 0
    text = capsys.readouterr().out
    assert "redundant" in text
    assert "of B follows from A" in text


def test_run_writes_results_and_report(model, tmp_path, capsys):
    out = tmp_path / "new" / "results"
    assert main(["run", str(model), "--output", str(out), "--csv"]) == 0
    text = capsys.readouterr().out
    assert "completed" in text
    names = ["four_bar.csv", "four_bar.nc", "four_bar.report.html"]
    assert sorted(p.name for p in out.iterdir()) == names
    for name in names:
        assert str(out / name) in text
    with xr.open_dataset(out / "four_bar.nc") as data:
        assert data.sizes["time"] == 26
    assert "coupler.P" in (out / "four_bar.report.html").read_text(encoding="utf-8")


@pytest.mark.thorough
def test_profile_lists_the_durations(model, tmp_path, capsys):
    """Parts add up to the whole, and what is inside of them is no more than they are."""
    run = ["run", str(model), "--output", str(tmp_path / "out"), "--profile"]
    assert main([*run, "--json"]) == 0
    output = json_output(capsys)["profile"]
    parts = output["parts"]
    assert list(parts) == ["model", "analysis", "results", "report"]
    assert sum(part["seconds"] for part in parts.values()) == pytest.approx(output["seconds"])
    assert "build" in parts["model"]["inside"]
    inside = parts["analysis"]["inside"]
    assert {"assembly", "compile", "integration", "outputs", "checks"} <= set(inside)
    assert inside["projection, of the integration"] > 0
    for part in parts.values():
        shares = [v for name, v in part["inside"].items() if not name.startswith("projection")]
        assert sum(shares) <= part["seconds"] + 1e-5
    counts = output["counts"]
    assert counts["evaluations of accelerations"] == 4 * counts["steps"] > 0
    assert counts["projections"] == counts["steps"]
    assert main(run) == 0
    assert "projection, of the integration" in capsys.readouterr().out


def test_run_here_by_default(model, tmp_path, monkeypatch, capsys):
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    assert main(["run", str(model), "--no-report", "--quiet"]) == 0
    assert [p.name for p in here.iterdir()] == ["four_bar.nc"]
    captured = capsys.readouterr()
    assert not captured.out + captured.err


def test_run_as_json(model, tmp_path, capsys):
    assert (
        main(["run", str(model), "--output", str(tmp_path / "o"), "--json", "--set", "l1=0.25"])
        == 0
    )
    output = json_output(capsys)
    assert output["ok"]
    assert output["time"] == pytest.approx(0.5)
    assert output["maxima"]["position_violation"] < 1e-10
    assert all(Path(f).exists() for f in output["files"])


@pytest.mark.few(1)
@pytest.mark.parametrize("kind", ["Equilibrium", "Modal"])
def test_another_analysis(kind, model, tmp_path, capsys):
    text = model.read_text(encoding="utf-8").replace('angle = "pi/2"', 'angle = "-pi/2"')
    model.write_text(text, encoding="utf-8")
    out = tmp_path / "o"
    assert main(["run", str(model), "--analysis", kind, "--output", str(out), "--csv"]) == 0
    assert (out / "four_bar.nc").exists()
    assert "stable" in capsys.readouterr().out


def test_failed_run_keeps_what_it_had(tmp_path, capsys):
    path = tmp_path / "locked.toml"
    text = FOUR_BAR.read_text(encoding="utf-8").replace('type = "Dynamics"', 'type = "Kinematics"')
    for line in ("formulation", "stabilization", "integrator"):
        text = "\n".join(row for row in text.splitlines() if not row.startswith(line))
    text = text.replace("value = 0.3", "value = 0.7").replace("bounds = [0.2, 0.4], ", "")
    text += '\n[drivers.motor]\ntype = "RotationalDriver"\nconnect = ["ground", "crank"]\n'
    path.write_text(text + 'law = "pi/2 + t"\n', encoding="utf-8")
    out = tmp_path / "o"
    assert main(["run", str(path), "--output", str(out)]) == 1
    assert "locked" in capsys.readouterr().out
    assert (out / "locked.nc").exists()


def test_report_again(model, tmp_path, capsys):
    out = tmp_path / "o"
    assert main(["run", str(model), "--output", str(out), "--no-report", "--quiet"]) == 0
    assert main(["report", str(out / "four_bar.nc")]) == 0
    assert "four-bar" in (out / "four_bar.report.html").read_text(encoding="utf-8")
    capsys.readouterr()
    assert main(["report", str(model)]) == 2
    assert str(model) in capsys.readouterr().err


@pytest.mark.thorough
def test_methods_of_sensitivity_agree(model, tmp_path, capsys):
    gradients = {}
    for method in ("adjoint", "direct", "finite-difference"):
        assert main(["sensitivity", str(model), "--method", method, "--json"]) == 0
        gradients[method] = json_output(capsys)["responses"]["angle"]["gradient"]
    for name in ("l1", "l2", "l3"):
        exact = gradients["adjoint"][name]
        assert gradients["direct"][name] == pytest.approx(exact, rel=1e-9)
        assert gradients["finite-difference"][name] == pytest.approx(exact, rel=1e-5)
    assert main(["sensitivity", str(model), "--output", str(tmp_path / "o")]) == 0
    assert (tmp_path / "o" / "four_bar.sensitivity.csv").exists()
    assert main(["sensitivity", str(model), "--method", "adjont"]) == 2
    assert "did you mean 'adjoint'" in capsys.readouterr().err


def test_optimize(model, tmp_path, capsys):
    out = tmp_path / "o"
    assert main(["optimize", str(model), "--json", "--output", str(out)]) == 0
    output = json_output(capsys)
    assert output["fun"] < output["start_fun"]
    assert set(output["x"]) == {"l2", "l3"}
    page = (out / "four_bar.optimum.report.html").read_text(encoding="utf-8")
    assert '"optimum":{"label":"peak","unit":"N"' in page and '"ghosts":[{' in page
    assert output["objective"] == "peak" and output["stationarity"] < 1e-3
    assert main(["optimize", str(model), "--quiet"]) == 0
    assert "objective" in capsys.readouterr().out


def test_cache(tmp_path, monkeypatch, capsys):
    folder = tmp_path / "machine code"
    monkeypatch.setenv("DALEMBERT_CACHE", str(folder))
    assert main(["cache"]) == 0
    assert "0 compiled functions, 0.0 MB, in" in capsys.readouterr().out
    folder.mkdir()
    (folder / "one.o").write_bytes(bytes(2_000_000))
    (folder / "one.sha256").write_text("…")
    assert main(["cache", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert (
        document["functions"] == 1
        and document["bytes"] == 2_000_000
        and document["folder"] == str(folder)
    )
    assert main(["cache", "--clear"]) == 0
    assert "1 compiled functions, 2.0 MB, deleted from" in capsys.readouterr().out
    assert not list(folder.iterdir())


def test_schema(tmp_path, capsys):
    assert main(["schema"]) == 0
    output = json_output(capsys)
    assert "joints" in output["$defs"]["PlanarDocument"]["properties"]
    assert "supports" in output["$defs"]["StructureDocument"]["properties"]
    assert main(["schema", "--output", str(tmp_path / "s.json")]) == 0
    assert json.loads((tmp_path / "s.json").read_text(encoding="utf-8")) == output


def test_schema_is_itself_valid(schema):
    schema.check_schema(schema.schema)


def test_examples(tmp_path, capsys):
    assert main(["examples", "--json"]) == 0
    assert "four_bar" in json_output(capsys)["examples"]
    assert main(["examples", "four_bar", "--output", str(tmp_path)]) == 0
    assert (tmp_path / "four_bar.toml").read_text(encoding="utf-8") == FOUR_BAR.read_text(
        encoding="utf-8"
    )
    capsys.readouterr()
    assert main(["examples", "four_bar", "--output", str(tmp_path)]) == 2
    assert "--force" in capsys.readouterr().err
    assert main(["examples", "fourbar"]) == 2
    assert "did you mean 'four_bar'" in capsys.readouterr().err


# as a process ------------------------------------------------------------------------
def started(*arguments: str, **options) -> subprocess.Popen:
    if os.name != "nt":  # a run in the background of a shell is started deaf to interrupts
        options["preexec_fn"] = lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True} | options
    return subprocess.Popen([sys.executable, "-m", "dalembert", *arguments], **options)


def test_exit_code_of_the_process(tmp_path):
    process = started("check", str(tmp_path / "none.toml"))
    _, errors = process.communicate()
    assert process.returncode == 2
    assert errors.count("\n") == 1


@pytest.mark.skipif(os.name == "nt", reason="needs a terminal and an interrupt signal")
def test_interrupt_keeps_the_results(model, tmp_path):
    """The signal comes when the terminal shows a part of the steps."""
    text = model.read_text(encoding="utf-8").replace("duration = 0.5", "duration = 20000")
    model.write_text(text, encoding="utf-8")
    shown, terminal = os.openpty()
    arguments = ("run", str(model), "--output", str(tmp_path / "o"), "--no-report")
    process = started(*arguments, stderr=terminal)
    os.close(terminal)
    screen = b""
    while not re.search(rb"integrating four-bar[^%]* [1-9]\d?%", screen):
        screen += os.read(shown, 4096)
    process.send_signal(signal.SIGINT)
    out, _ = process.communicate()
    assert process.returncode == 130, out
    assert "interrupted" in out
    assert b"Traceback" not in screen
    assert (tmp_path / "o" / "four_bar.nc").exists()


def interrupts(monkeypatch, owner, name: str, call: int) -> None:
    """Ctrl-C in the call of this number."""
    honest, calls = getattr(owner, name), [0]

    def stopped(*arguments, **named):
        calls[0] += 1
        if calls[0] == call:
            raise KeyboardInterrupt
        return honest(*arguments, **named)

    monkeypatch.setattr(owner, name, stopped)


@pytest.mark.parametrize(("owner", "name"), [(FixedMarch, "advance"), (Adjoint, "gradient")])
def test_interrupted_gradients(model, tmp_path, capsys, monkeypatch, owner, name):
    """In the run and in the sweep back: nothing is written, and no traceback."""
    interrupts(monkeypatch, owner, name, 1)
    arguments = ["sensitivity", str(model), "--method", "adjoint", "--output", str(tmp_path / "o")]
    assert main(arguments) == 130
    assert capsys.readouterr().err == "Error: interrupted\n"
    assert not list((tmp_path / "o").glob("*"))


@pytest.mark.few(1)
@pytest.mark.parametrize(("call", "saved"), [(1, False), (2, True)])
def test_interrupted_optimisations(model, tmp_path, capsys, monkeypatch, call, saved):
    """The design reached is told and written, where there is one."""
    interrupts(monkeypatch, DesignProblem, "_run", call)
    assert main(["optimize", str(model), "--output", str(tmp_path / "o")]) == 130
    output = capsys.readouterr()
    assert "interrupted" in (output.out if saved else output.err) and "Traceback" not in output.err
    assert (tmp_path / "o" / "four_bar.optimum.nc").exists() == saved


def test_all_examples_are_listed_and_bring_what_they_need(tmp_path, capsys):
    assert main(["examples", "--json"]) == 0
    listed = json_output(capsys)["examples"]
    folder = FOUR_BAR.parent
    wanted = {p.stem for p in folder.glob("*.toml")} | {p.name for p in folder.glob("*.ipynb")}
    wanted |= {p.name for p in folder.glob("*.py")} - {"style.py"}
    wanted |= {p.stem for p in folder.glob("teaching/*.toml")}
    assert wanted | {"start.ipynb"} <= listed.keys() and all(listed.values())
    for name in ("robot_arm", "carts.py", "start.ipynb", "grashof"):
        assert main(["examples", name, "--output", str(tmp_path)]) == 0
    assert {p.name for p in tmp_path.iterdir()} >= {"robot_arm.py", "style.py", "start.ipynb"}


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_can_complete(shell, capsys):
    assert main(["completion", shell]) == 0
    script = capsys.readouterr().out
    assert all(command in script for command in COMMANDS)


@pytest.mark.thorough
def test_two_runs_are_reported_together_and_filmed(model, tmp_path, capsys, monkeypatch):
    seen: list[str] = []
    monkeypatch.setattr("webbrowser.open", seen.append)
    for name, setting in (("a", "l1=0.3"), ("b", "l1=0.28")):
        options = ["--output", str(tmp_path / name), "--set", setting, "--no-report", "--quiet"]
        assert main(["run", str(model), *options]) == 0
    one, other = (tmp_path / name / "four_bar.nc" for name in "ab")
    assert main(["report", str(one), str(other), "--open"]) == 0
    page = one.with_suffix(".report.html")
    assert 'b/four_bar.nc"' in page.read_text(encoding="utf-8")
    assert seen == [page.resolve().as_uri()]
    assert main(["film", str(one), "--seconds", "0.3", "--fps", "10", "--width", "200"]) == 0
    assert one.with_suffix(".gif").read_bytes()[:4] == b"GIF8"
    capsys.readouterr()
    assert main(["film", str(one), "--output", str(tmp_path / "x.avi")]) == 2
    assert ".gif or .mp4" in capsys.readouterr().err


def test_a_report_drawn_again_is_the_one_that_was_written(model, tmp_path):
    assert main(["run", str(model), "--output", str(tmp_path), "--no-live", "--quiet"]) == 0
    page = tmp_path / "four_bar.report.html"
    first = page.read_text(encoding="utf-8")
    assert main(["report", str(tmp_path / "four_bar.nc")]) == 0
    assert page.read_text(encoding="utf-8") == first
