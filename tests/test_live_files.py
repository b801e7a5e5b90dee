"""Live pages from model files and from the command line."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from dalembert.cli import main
from dalembert.io import load_model_file
from dalembert.symbolic.native import code_cache, webassembly

EXAMPLE = Path(__file__).parents[1] / "examples" / "four_bar.toml"


@pytest.fixture
def model(tmp_path):
    text = EXAMPLE.read_text(encoding="utf-8")
    path = tmp_path / "four_bar.toml"
    path.write_text(text.replace("duration = 8.0", "duration = 0.25"), encoding="utf-8")
    return path


def with_live(model: Path, value: str) -> Path:
    text = model.read_text(encoding="utf-8")
    model.write_text(text.replace("[report]", f"[report]\nlive = {value}"), encoding="utf-8")
    return model


def run(model: Path, *options: str) -> str:
    assert main(["run", str(model), "--output", str(model.parent), "--quiet", *options]) == 0
    return model.with_suffix(".report.html").read_text(encoding="utf-8")


def is_live(page: str) -> bool:
    return '"live":{' in page and '"code":"' in page and 'id="worker"' in page


@pytest.mark.few(2)
@pytest.mark.parametrize(
    ("value", "options", "live"),
    [
        ("", [], True),
        ("false", [], False),
        ("false", ["--live"], True),
        ("true", [], True),
        ("true", ["--no-live"], False),
        ("", ["--no-live"], False),
    ],
)
def test_the_file_states_whether_a_page_is_live_and_the_command_line_decides(
    value, options, live, model
):
    page = run(with_live(model, value) if value else model, *options)
    assert is_live(page) == live
    assert live or '"reason":' not in page


@pytest.mark.thorough
def test_without_bounds_a_page_is_live_if_requested(model):
    text = model.read_text(encoding="utf-8")
    for bounds in ("[0.2, 0.4]", "[0.8, 1.2]", "[0.5, 0.8]"):
        text = text.replace(f", bounds = {bounds}", "")
    model.write_text(text.partition("[optimize]")[0], encoding="utf-8")
    assert not is_live(run(model))
    assert is_live(run(model, "--live"))


def test_a_page_that_cannot_be_live_states_the_reason_unless_declined(model):
    text = model.read_text(encoding="utf-8").replace("step = 0.005\n", "")
    model.write_text(text.replace('integrator = "RK4"', 'integrator = "Radau"'), encoding="utf-8")
    page = run(model, "--live")
    assert not is_live(page) and '"reason":"the run takes implicit steps' in page
    assert '"reason":' not in run(model, "--no-live")


@pytest.mark.thorough
def test_stored_pages_are_not_live(model):
    run(model)
    assert main(["report", str(model.with_suffix(".nc"))]) == 0
    page = model.with_suffix(".report.html").read_text(encoding="utf-8")
    assert not is_live(page) and '"reason":' not in page


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "path", sorted(EXAMPLE.parent.glob("teaching/*.toml")), ids=lambda path: path.stem
)
def test_teaching_models_are_live_and_ask_something(path, tmp_path):
    page = run(Path(shutil.copy(path, tmp_path)))
    assert is_live(page)
    assert '"kind":"notes"' in page and "?" in page.partition('"texts":')[2].partition("]")[0]
    names = load_model_file(path).document.responses
    assert all(f'"label": "{name}"' in page.replace("\\", "") for name in names) and names


def test_structures_are_live_with_the_responses_of_their_file(tmp_path):
    model = Path(shutil.copy(EXAMPLE.with_name("truss.toml"), tmp_path))
    page = run(model)
    assert is_live(page)
    names = load_model_file(model).document.responses
    assert all(f'"label": "{name}"' in page.replace("\\", "") for name in names) and names
    assert not is_live(run(model, "--no-live"))


@pytest.mark.thorough
def test_modes_of_a_file_are_live_with_its_responses_or_their_frequencies(tmp_path):
    model = Path(shutil.copy(EXAMPLE.parent / "teaching" / "ride.toml", tmp_path))
    page = run(model).replace("\\", "")
    assert is_live(page) and '"label": "damping of bounce"' in page
    assert not is_live(run(model, "--no-live"))
    assert main(["report", str(model.with_suffix(".nc"))]) == 0
    stored = model.with_suffix(".report.html").read_text(encoding="utf-8")
    assert not is_live(stored) and '"states":{"kind":"mode"' in stored
    text = model.read_text(encoding="utf-8")
    before, _, after = text.partition("[responses]")
    model.write_text(before + "[report]" + after.partition("[report]")[2], encoding="utf-8")
    page = run(model).replace("\\", "")
    assert all(f'"label": "frequency of mode {k}"' in page for k in (1, 2, 3, 4))


def test_responses_of_motions_are_left_out_of_pages_of_modes(model):
    text = model.read_text(encoding="utf-8")
    model.write_text(text.replace('angle = "pi/2"', 'angle = "-pi/2"'), encoding="utf-8")
    page = run(model, "--analysis", "Modal").replace("\\", "")
    assert is_live(page) and '"label": "frequency of mode 1"' in page
    assert '"reason":' not in page


def test_wrong_values_are_refused_with_their_place(model, capsys):
    assert main(["run", str(with_live(model, '"yes"'))]) == 2
    error = capsys.readouterr().err
    assert "report.live" in error and "true or false" in error


def test_modules_are_compiled_once(model, tmp_path, monkeypatch):
    monkeypatch.setenv("DALEMBERT_CACHE", str(tmp_path / "cache"))
    assert is_live(run(model))
    (file,) = code_cache.cache_folder().glob("*.wasm")
    assert file.read_bytes().startswith(b"\0asm")
    monkeypatch.setattr(webassembly, "emit_object", None)
    assert is_live(run(model))


@pytest.mark.thorough
def test_without_a_cache_pages_are_live(model, tmp_path, monkeypatch):
    folder = tmp_path / "cache"
    folder.mkdir(mode=0o700)
    folder.chmod(0o777)  # others may write: nothing is read from it or stored in it
    monkeypatch.setenv("DALEMBERT_CACHE", str(folder))
    assert is_live(run(model))
    assert not list(folder.glob("*.wasm"))
