"""Studies from the command line, in processes and on a cluster of this machine."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import dalembert as da
from dalembert.cli import main

pytest.importorskip("pyarrow")
FILE = """
format = 1
gravity = [0, -9.81]
[parameters]
length = { value = 1.0, bounds = [0.5, 2.0] }
mass = 2.0
[bodies.bar]
type = "Bar"
length = "length"
mass = "mass"
angle = -0.3
[joints.O]
type = "Revolute"
connect = ["ground", "bar.start"]
[analysis]
type = "Dynamics"
duration = 0.2
step = 0.02
backend = "vm"
[responses]
angle = { type = "Final", measure = "bar.angle" }
[sweep]
type = "Grid"
vary = { length = [0.6, 0.8, -1.0, 1.0, 1.5], mass = [1, 2] }
"""


@pytest.fixture
def model(tmp_path) -> Path:
    path = tmp_path / "bar.toml"
    path.write_text(FILE, encoding="utf-8")
    return path


def json_output(capsys) -> dict:
    return json.loads(capsys.readouterr().out)


def test_sweep(model, capsys):
    assert main(["sweep", str(model), "--workers", "1", "--json"]) == 0
    first = json_output(capsys)
    assert first["designs"] == 10 and sorted(first["failed"]) == ["4", "5"]
    assert "length" in first["failed"]["4"]
    assert main(["sweep", str(model), "--workers", "2", "--json"]) == 0
    again = json_output(capsys)
    assert again["reused_count"] == 10 and again["responses"] == first["responses"]
    assert main(["sweep", str(model), "--workers", "1"]) == 0
    assert "8 of 10 designs" in capsys.readouterr().out
    assert main(["sweep", str(model), "--set", "mass=3", "--json"]) == 2
    assert "another study" in json_output(capsys)["error"]["message"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('type = "Grid"', 'type = "Gird"', "Grid"),
        ("mass = [1, 2] }", "mess = [1, 2] }", "mass"),
        ('type = "Grid"', 'type = "Sobol"', "(lower, upper)"),
        ("[sweep]", '[sweep]\nresponses = ["angel"]', "angle"),
        (FILE[FILE.index("[sweep]") :], "", "[sweep]"),
    ],
)
def test_wrong_tables(model, old, new, words, capsys):
    model.write_text(FILE.replace(old, new), encoding="utf-8")
    assert main(["sweep", str(model), "--json"]) == 2
    assert words in json_output(capsys)["error"]["message"]


@pytest.mark.parametrize(("option", "number"), [("--workers", "-3"), ("--chunk", "-5")])
def test_numbers_that_count_nothing(model, option, number, capsys):
    """Nothing is run, and no folder begun."""
    assert main(["sweep", str(model), option, number]) == 2
    assert f"at least 1, got {number}" in capsys.readouterr().err
    assert not model.with_name(f"{model.stem}.study").exists()


def test_structures(tmp_path, capsys):
    """A study of a truss knows its loads."""
    text = (Path(__file__).parents[1] / "examples" / "truss.toml").read_text(encoding="utf-8")
    path = tmp_path / "truss.toml"
    path.write_text(text + "\n[sweep]\nsamples = 4\n", encoding="utf-8")
    sweep = ["sweep", str(path), "--workers", "1", "--json"]
    assert main(sweep) == 0 and json_output(capsys)["designs"] == 4
    changed = path.read_text(encoding="utf-8").replace("-30e3", "-31e3")
    path.write_text(changed, encoding="utf-8")
    assert main(sweep) == 2 and "another study" in json_output(capsys)["error"]["message"]


def start(*arguments: str) -> subprocess.Popen:
    where = os.pathsep.join([str(Path(da.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    return subprocess.Popen(
        [sys.executable, "-m", "dask", *arguments],
        env={**os.environ, "PYTHONPATH": where},
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
    )


@pytest.fixture
def cluster():
    """Address of a scheduler with two workers, and the processes of the workers."""
    pytest.importorskip("distributed")
    quiet = ("--no-dashboard",)
    scheduler = start("scheduler", "--host", "127.0.0.1", "--port", "0", *quiet)
    started = [scheduler]
    try:
        address = ""
        while not address:
            line = scheduler.stderr.readline()
            assert line, "the scheduler ended"
            match = re.search(r"Scheduler at:\s*(tcp://\S+)", line)
            address = match[1] if match else ""
        for _ in range(2):
            options = ("--nthreads", "1", "--no-nanny", "--host", "127.0.0.1", *quiet)
            started.append(start("worker", address, *options))
        yield address, started[1:]
    finally:
        for process in started:
            process.kill()
            process.wait()
            process.stderr.close()


@pytest.mark.thorough
def test_cluster(model, tmp_path, cluster, capsys):
    """The same table as here, although a worker is killed on the way."""
    import pyarrow.parquet as parquet

    address, workers = cluster
    there, here = tmp_path / "there", tmp_path / "here"
    model.write_text(FILE.replace("[1, 2] }", "[1, 2, 3, 4] }"), encoding="utf-8")
    sweep = ["sweep", str(model), "--json"]
    with ThreadPoolExecutor(1) as aside:
        running = aside.submit(
            main, [*sweep, "--scheduler", address, "--chunk", "1", "--output", str(there)]
        )
        deadline = time.monotonic() + 60
        while not list(there.glob("parts/part-*")) and time.monotonic() < deadline:
            time.sleep(0.01)
        workers[0].send_signal(signal.SIGKILL)
        assert running.result(timeout=60) == 0
    assert json_output(capsys)["designs"] == 20
    assert main(["sweep", str(model), "--workers", "1", "--output", str(here), "--json"]) == 0
    one, two = (parquet.read_table(folder / "table.parquet") for folder in (there, here))
    assert one.equals(two)


@pytest.mark.thorough
def test_no_scheduler(model, capsys, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("dalembert.design.studies.workers.WAIT", 0.5)
    address = "tcp://127.0.0.1:9"
    assert main(["sweep", str(model), "--scheduler", address, "--json"]) == 1
    assert "dask scheduler" in json_output(capsys)["error"]["message"]
