"""Measurements in the studio: chosen, matched with measures, and a stiffness identified."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from studio_desk import WAIT, Desk
from studio_runs import Studio
from test_studio_photos import request

import dalembert as da
from dalembert.studio.application import make_application
from dalembert.studio.companions import Companions
from dalembert.studio.measurements import columns_of, store_measurements
from dalembert.studio.session import Session

OSCILLATOR = """format = 1
name = "oscillator"
gravity = [0.0, 0.0]

[parameters]
k = { value = 80.0, unit = "N/m", bounds = [1, 1000] }

[bodies]
mass = { type = "Particle", mass = 2.0, position = [0.5, 0] }

[forces.spring]
type = "Spring"
connect = [{ body = "ground", at = [-1, 0] }, "mass"]
stiffness = "k"
free_length = 1.0

[analysis]
type = "Dynamics"
duration = 2.0
step = 0.02
"""
STIFFNESS = 100.0
TASK = "studio.insight.design.tasks.identify"


def table(heading: str) -> str:
    """Displacement x = 0.5 cos(√(k/m) t) in millimetres."""
    times = np.linspace(0, 2, 101)
    rows = [f"{t},{500 * np.cos(np.sqrt(STIFFNESS / 2) * t)},a" for t in times]
    return "\n".join([heading, *rows])


def test_a_table_never_replaces_another_one(tmp_path: Path) -> None:
    first, other = (table(f"{name},laser [mm],note").encode() for name in ("t", "zeit"))
    names = [store_measurements(tmp_path, "run 1.csv", each) for each in (first, other, other)]
    assert names == ["run 1.csv", "run 1_2.csv", "run 1_2.csv"]
    assert (tmp_path / "run 1.csv").read_bytes() == first
    columns = columns_of(tmp_path / "run 1.csv")
    assert [column["name"] for column in columns] == ["t", "laser"]  # text is no measurement
    assert columns[0] == {"name": "t", "samples": 101, "range": [0.0, 2.0]}
    assert columns[1]["range"][1] == 0.5  # metres
    for name in ("../run.csv", "run.toml", ".csv", "a\n.csv", "", "C:\\run.csv"):
        with pytest.raises(da.FileError, match="no name of a table"):
            store_measurements(tmp_path, name, first)


def test_headings_belong_to_their_columns(tmp_path: Path) -> None:
    """Rows longer than the heading shifted its names; text below a unit was an internal error."""
    path = tmp_path / "run.csv"
    path.write_text("t,x [mm]\n0,1000,\n1,2000,\n")  # rows end with a separator
    ranges = [(column["name"], column["range"]) for column in columns_of(path)]
    assert ranges == [("t", [0.0, 1.0]), ("x", [1.0, 2.0])]
    path.write_text("t,note [mm]\n0,a\n1,b\n")
    assert [column["name"] for column in columns_of(path)] == ["t"]
    with pytest.raises(da.AnalysisError, match="name all columns"):
        store_measurements(tmp_path, "short.csv", b"t,x\n0,1,2\n")
    assert not (tmp_path / "short.csv").exists()
    for row in ("0,1,2", "0,1,a", "0,1,2,3"):
        path.write_text(f"t,x [mm]\n{row}\n")
        with pytest.raises(da.AnalysisError, match="name all columns in the first line"):
            columns_of(path)


def test_measurements_need_a_saved_model(tmp_path: Path) -> None:
    session = Session(None, tmp_path)
    application = make_application(session, "t", 0, lambda: None)
    own = {"host": "127.0.0.1:0", "origin": "http://127.0.0.1:0"}
    status, _, body = request(application, "PUT", "/t/measurements", "run.csv", own, b"t,x\n0,1\n")
    assert (status, b"save the model first" in body) == (400, True)
    status, _, body = request(application, "GET", "/t/measurements", "none.csv", own)
    assert (status, b"no such file" in body) == (400, True)
    foreign = own | {"origin": "http://example.com"}
    assert request(application, "GET", "/t/measurements", "none.csv", foreign)[0] == 403
    session.journal.close()


def test_measurements_go_with_a_model_that_is_saved_elsewhere(tmp_path: Path) -> None:
    """Files that the text names are copied; those of the other folder are never replaced."""
    old, new = tmp_path / "old", tmp_path / "new"
    (old / "runs").mkdir(parents=True)
    new.mkdir()
    for name in ("run.csv", "runs/2.csv", "mine.csv", "other.csv"):
        (old / name).write_text(table("t,x"))
    (new / "mine.csv").write_text("t,x\n0,1\n")
    names = ["run.csv", "runs/2.csv", "mine.csv", "../old/other.csv", "none.csv"]
    rows = "".join(f'[[identify.experiments]]\ndata = "{name}"\n' for name in names)
    (old / "m.toml").write_text(OSCILLATOR + rows)
    session = Session(old / "m.toml", tmp_path / "state")
    saved, companions = session.save(new / "m.toml", False)
    assert saved == new / "m.toml"
    refused = [
        "mine.csv was not copied: another file has this name there, which the model reads now"
    ]
    assert companions == Companions(["run.csv", "runs/2.csv"], refused)
    assert (new / "runs/2.csv").read_text() == (old / "runs/2.csv").read_text()
    assert sorted(path.name for path in new.iterdir()) == ["m.toml", "mine.csv", "run.csv", "runs"]
    assert session.save(old / "m.toml", True)[1] == Companions([], refused)
    session.journal.close()


@pytest.mark.thorough
def test_a_stiffness_is_identified_by_clicks(desk: tuple[Desk, Studio], tmp_path: Path) -> None:
    visit, _ = desk
    page = visit.page
    data, model = tmp_path / "run.csv", tmp_path / "models" / "oscillator.toml"
    data.write_text(table("zeit,laser [mm],note"), encoding="utf-8")
    model.parent.mkdir()
    visit.show(OSCILLATOR)
    visit.page.evaluate("path => studio.request('save', { path })", str(model))
    visit.until("Boolean(studio.file.path)", 20)
    page.click("#tab-design")
    page.click(".pick:has-text('Identify')")
    page.set_input_files(".measurements input[type=file]", str(data))
    page.wait_for_selector("[name='column-laser']", timeout=1000 * WAIT)
    page.fill("[name='column-laser']", "mass.x")
    page.keyboard.press("Enter")
    visit.until("Boolean(studio.file.document.identify.measures)", 20)
    expected = {"data": "run.csv", "time": "zeit", "measures": {"laser": "mass.x"}}
    assert visit.document["identify"] == expected
    page.click("#start-task")
    visit.until(f"{TASK}?.status === 'done'", WAIT)
    page.click("text=Show the result")
    page.click("text=Write its parameters into the text")
    visit.until("studio.file.undo.startsWith('adopt')", 20)
    assert visit.document["parameters"]["k"]["value"] == pytest.approx(STIFFNESS, rel=1e-4)
    assert (model.parent / "run.csv").read_bytes() == data.read_bytes()
    expected = visit.document["identify"]
    (tmp_path / "letters.csv").write_text("a;b\nx;y\n")
    page.set_input_files(".measurements input[type=file]", str(tmp_path / "letters.csv"))
    page.wait_for_selector(".measurements .reason", timeout=1000 * WAIT)
    page.wait_for_selector("[name='column-laser']", timeout=1000 * WAIT)  # those of the former file
    assert "letters.csv" in page.inner_text(".measurements .reason")
    assert visit.document["identify"] == expected
    assert not (model.parent / "letters.csv").exists()
    assert all("400" in line for line in visit.console)  # Chromium notes the refusal
    visit.console.clear()
