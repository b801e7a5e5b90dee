"""Files of the studio: recent ones, examples, exports and their processes."""

from __future__ import annotations

import json
import threading
import time
import zipfile
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest
from studio_runs import Studio, running_studio
from test_studio_server import get, page, receive, send

from dalembert.errors import FileError, UnsupportedError
from dalembert.io.example_files import example_folder
from dalembert.io.exports.registry import FORMATS
from dalembert.report.exports import FORMATS as MODULES
from dalembert.studio import listed_files
from dalembert.studio.building import BuildingProcess, Request
from dalembert.studio.export_process import KEPT, Exports
from dalembert.studio.exporting import CHOICES, ExportRequest, write_export
from dalembert.studio.pictures import Picture
from dalembert.studio.recent_files import LIMIT, recent_files, remember
from dalembert.studio.server import start_processes
from dalembert.studio.session import Session

BAR = """\
format = 1
name = "pendulum"
gravity = [0.0, -9.81]
[parameters]
l = { value = 0.5, bounds = [0.3, 0.8] }
[bodies.bar]
type = "Bar"
length = "l"
mass = 1
[joints.O]
type = "Revolute"
connect = ["ground", "bar.start"]
[analysis]
type = "Dynamics"
duration = 0.4
step = 0.02
"""
BEGINS = {
    "toml": BAR.encode(),
    "page": b"<!doctype html>",
    "svg": b"<?xml",
    "gif": b"GIF8",
    "csv": b"time",
    "python": b'"""',
    "dxf": b"0",
    "urdf": b"PK",
    "js": b"PK",
}
"""First bytes of the files."""


def test_every_format_of_the_library_is_offered() -> None:
    assert {*FORMATS, *MODULES, *BEGINS} <= set(CHOICES)


@pytest.mark.thorough
def test_exports_of_a_text(tmp_path: Path) -> None:
    shares: list[float] = []
    for to, begin in BEGINS.items():
        request = ExportRequest(to, BAR, tmp_path / "my model.toml", 0.5, tmp_path)
        path, _ = write_export(request, shares.append)
        data = path.read_bytes()
        assert path.stem == "my_model"
        assert data.lower().lstrip().startswith(begin.lower().lstrip()), (to, data[:20])
        if path.suffix == ".zip":
            assert zipfile.ZipFile(BytesIO(data)).testzip() is None
    assert max(shares) == 1.0


def test_an_export_reports_its_end_or_its_error(tmp_path: Path) -> None:
    exports, messages, changed = Exports(), [], threading.Event()

    def report(message: dict[str, Any]) -> None:
        messages.append(message)
        if message["state"] != "progress":
            changed.set()

    for to, text, state in (("python", BAR, "done"), ("svg", "format = 1\n", "failed")):
        changed.clear()
        number = exports.start(to, text, tmp_path / "bar.toml", 0.0, report)
        assert changed.wait(30) and messages[-1]["state"] == state
        assert messages[-1]["number"] == number
    assert str(tmp_path) not in messages[-1]["text"] and "has no bodies" in messages[-1]["text"]
    (path,) = exports.files.values()
    assert path.read_text().startswith('"""pendulum"""')
    changed.clear()
    exports.start("gif", BAR, tmp_path / "bar.toml", 0.0, report)
    exports.stop()
    assert changed.wait(10) and messages[-1]["state"] == "stopped"
    folder = path.parents[1]
    assert [entry.name for entry in folder.iterdir()] == ["1"]
    exports.close()
    assert not folder.exists() and KEPT > 1


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("files")
    (folder / "model.toml").write_text(BAR)
    (folder / "other.toml").write_text(BAR.replace("pendulum", "other"))
    with running_studio(folder, "model.toml") as server:
        yield server


@pytest.mark.thorough
def test_files_are_listed_and_exports_downloaded(studio: Studio) -> None:
    with page(studio) as socket:
        receive(socket, "text")
        send(socket, kind="files")
        listed = receive(socket, "files")
        assert [Path(path).name for path in listed["files"]] == ["model.toml", "other.toml"]
        assert [Path(path).name for path in listed["recent"]] == ["model.toml"]
        assert len(listed["examples"]) == len(list(example_folder().glob("*.toml")))
        for entry in listed["examples"]:
            status, body, _ = get(studio, f"/{studio.token}/examples/{entry['example']}")
            assert status == 200 and body.startswith(b"\x89PNG") and entry["name"], entry
        assert get(studio, f"/{studio.token}/examples/..%2fstudio")[0] == 404
        send(socket, kind="export", to="csv", share=0)
        done = receive(socket, "export", state="done")
        status, body, headers = get(studio, f"/{studio.token}/{done['address']}")
        assert status == 200 and body.startswith(b"time")
        assert headers["content-disposition"] == 'attachment; filename="model.csv"'
        assert headers["content-type"] == "application/octet-stream"
        assert get(studio, f"/{studio.token}/export/999")[0] == 404
        for wrong in ({"to": "exe"}, {"to": ["csv"]}, {}):
            send(socket, kind="export", **wrong)
            assert "unknown kind" in receive(socket, "failure")["text"]
        send(socket, kind="export", to="gif", share=1e99)
        send(socket, kind="export", to="csv")
        assert "an export is running" in receive(socket, "failure")["text"]
        send(socket, kind="stop export")
        assert receive(socket, "export", state="stopped")
        beside = Path(listed["folder"])
        assert {p.name for p in beside.iterdir()} == {"model.toml", "other.toml", "state"}


def test_files_are_listed_without_installed_examples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing() -> Path:
        raise FileError("the example files are missing")

    (tmp_path / "own.toml").touch()
    monkeypatch.setattr(listed_files, "example_folder", missing)
    listed_files.example_texts.cache_clear()
    files = listed_files.listed_files(tmp_path, tmp_path)
    listed_files.example_texts.cache_clear()
    assert files["examples"] == [] and files["files"] == [str(tmp_path / "own.toml")]


def test_a_refused_thread_is_one_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused() -> None:
        raise RuntimeError("can't start new thread")

    session = Session(None, tmp_path)
    monkeypatch.setattr(session, "start", refused)
    with pytest.raises(UnsupportedError, match=r"can't start new thread.*ulimit -v"):
        start_processes(session)


def test_recent_files(tmp_path: Path) -> None:
    assert recent_files(tmp_path) == []
    paths = [tmp_path / f"{k}.toml" for k in range(LIMIT + 3)]
    for path in paths:
        path.touch()
        remember(path, tmp_path)
    remember(paths[5], tmp_path)
    assert recent_files(tmp_path)[:2] == [paths[5], paths[-1]]
    assert len(recent_files(tmp_path)) == LIMIT
    paths[5].unlink()
    assert recent_files(tmp_path)[0] == paths[-1]
    (tmp_path / "recent_files.txt").write_text("[3, {")
    assert recent_files(tmp_path) == []
    (tmp_path / "recent_files.txt").write_text(json.dumps([3, "\0", None]))
    assert recent_files(tmp_path) == []
    remember(paths[1], tmp_path / "none" / "deeper")
    assert recent_files(tmp_path / "none" / "deeper") == [paths[1]]


LONG = BAR.replace("duration = 0.4\nstep = 0.02", "duration = 2e4\nstep = 1e-3\noutputs = 9")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"time": 1.0}, "took more than 1 s"),
        ({"memory": 3e7}, "GB of memory"),
        pytest.param({}, "stopped", marks=pytest.mark.thorough),
    ],
    ids=["time", "memory", "cancelled"],
)
def test_endless_builds_are_stopped(options: dict, message: str, tmp_path: Path) -> None:
    pictures: list[Picture] = []
    builder = BuildingProcess("still", lambda number, picture: pictures.append(picture), **options)
    builder.request(Request(1, LONG, tmp_path / "long.toml"))
    end = time.monotonic() + 20
    while not pictures and time.monotonic() < end:
        time.sleep(0.05)
        if not options and time.monotonic() > end - 18:
            builder.cancel()
    assert message in pictures[0].problems[0].message
    builder.close()


def test_what_a_build_prints_is_not_shown(capfd: Any, tmp_path: Path) -> None:
    pictures: list[Picture] = []
    builder = BuildingProcess("still", lambda number, picture: pictures.append(picture))
    builder.request(Request(1, "x" * 5 + "[" * 100_000, tmp_path / "deep.toml"))
    end = time.monotonic() + 20
    while not pictures and time.monotonic() < end:
        time.sleep(0.05)
    builder.close()
    assert pictures[0].problems[0].level == "error"
    assert "internal error" not in pictures[0].problems[0].message
    assert capfd.readouterr().out == ""


def test_an_example_reads_the_files_beside_it(tmp_path: Path) -> None:
    session = Session(None, tmp_path)
    session.broadcast = lambda message, but=None: None  # type: ignore[method-assign]
    session.open(None, (example_folder() / "excavator.toml").read_text(), example_folder())
    assert (session.place.parent / "soil.csv").exists()
    session.open(None)
    assert session.place.parent == Path.cwd()
    session.close()
