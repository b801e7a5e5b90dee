"""Nothing is lost: reopened files, equal process numbers, clocks, long histories, odd requests."""

from __future__ import annotations

import asyncio
import json
import os
import socket as sockets
import time
import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from studio_runs import Studio, running_studio
from test_studio_files import BAR, LONG
from test_studio_server import FOUR_BAR, page, receive, send

from dalembert.studio import journal as journals
from dalembert.studio.building import BuildingProcess, Request
from dalembert.studio.draft import Draft
from dalembert.studio.journal import KEPT, Journal
from dalembert.studio.pictures import Picture
from dalembert.studio.session import Session


def session(path: Path | None, folder: Path) -> Session:
    """A session without pages."""
    own = Session(path, folder / "journals")
    own.broadcast = lambda message, but=None: None  # type: ignore[method-assign]
    return own


def test_a_reopened_file_has_its_unsaved_changes(tmp_path: Path) -> None:
    for name in "ab":
        (tmp_path / f"{name}.toml").write_text(f"{name} = 0\n")
    edited = session(tmp_path / "a.toml", tmp_path)
    edited.draft.replace("a = 1\n", "type")
    asyncio.run(edited.changed())
    edited.open(tmp_path / "a.toml")
    assert edited.draft.text == "a = 1\n"
    edited.open(tmp_path / "b.toml")
    edited.open(tmp_path / "a.toml")
    assert edited.draft.text == "a = 1\n"
    edited.draft.undo()
    assert edited.draft.text == "a = 0\n"
    edited.close()


def test_a_draft_of_a_process_of_the_same_number_is_recovered(tmp_path: Path) -> None:
    """As after a new start of a container, whose processes have the same numbers."""
    path = tmp_path / "a.toml"
    path.write_text("a = 0\n")
    ended = Journal(path, tmp_path / "journals")
    ended.write("a = 1\n")
    assert ended._lock is not None
    ended._lock.close()  # as the end of its process does
    again = session(path, tmp_path)
    assert again._recover() is not None and again.draft.text == "a = 1\n"
    again.close()


def test_a_wrong_clock_deletes_no_draft(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.toml"
    path.write_text("a = 0\n")
    Journal(path, tmp_path / "journals").write("a = 1\n")
    for file in (tmp_path / "journals").glob("*.lock"):
        file.unlink()
    now = time.time()
    for shift in (100 * KEPT, -now + 1):
        monkeypatch.setattr(journals.time, "time", lambda shift=shift: now + shift)
        again = session(path, tmp_path)
        assert again._recover() is not None and again.draft.text == "a = 1\n"
        again.close()


@pytest.mark.thorough
def test_ten_thousand_changes_are_undone(tmp_path: Path) -> None:
    """The history keeps what changed, not the whole texts, which would be 1 GB."""
    path = tmp_path / "long.toml"
    lines = [f"a{k} = {k}\n" for k in range(8_000)]
    path.write_text("".join(lines))
    draft = Draft(path)
    original = draft.text
    assert len(original) > 100_000
    tracemalloc.start()
    for k in range(10_000):
        at = len(original) * (k % 97) // 97
        draft.replace(draft.text[:at] + f"# {k}\n" + draft.text[at:], f"add {k % 10}", k % 3 == 0)
    used = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert used < 2e7
    last = draft.text
    steps = 0
    while draft.undo():
        steps += 1
    assert draft.text == original and 6_000 < steps <= 10_000
    while draft.redo():
        steps -= 1
    assert draft.text == last and steps == 0


def running(process: int) -> bool:
    """Whether a process exists and has not ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.thorough
def test_no_process_outlives_a_killed_server(tmp_path: Path) -> None:
    if not Path("/proc").exists():
        pytest.skip("no list of processes")
    path = tmp_path / "model.toml"
    path.write_text(LONG)
    with running_studio(tmp_path, path) as server, page(server) as socket:
        receive(socket, "text")
        time.sleep(2.0)  # the model is being built, which takes minutes
        threads = Path(f"/proc/{server.process.pid}/task").glob("*/children")
        children = [int(child) for listed in threads for child in listed.read_text().split()]
        assert children  # on Linux the process that starts the others, and theirs end with it
        server.process.kill()
        server.process.wait()
        end = time.monotonic() + 120  # on a busy machine they may only be starting
        while any(map(running, children)) and time.monotonic() < end:
            time.sleep(0.1)
        assert not any(map(running, children))


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("losses")
    (folder / "model.toml").write_text(FOUR_BAR)
    with running_studio(folder, "model.toml") as server:
        yield server


REQUESTS: list[dict[str, Any]] = [
    {"kind": kind, "path": path}
    for kind in ("save", "open")
    for path in (
        "~no_such_user/x.toml",
        "a" * 5000 + ".toml",
        "/" + "b/" * 3000 + "x.toml",
        "\0.toml",
    )
]
REQUESTS += [
    {"kind": "edit", "operations": [{"op": "set", "keys": keys, "value": value}]}
    for keys, value in (
        (["bodies"], 1),
        (["bodies", 0], 1),
        ([True], {}),
        (["bodies", "crank", "mass"], {"a": [{}]}),
        (["name"], "\ud800"),
        (["__proto__"], {"polluted": 1}),
    )
]
REQUESTS += [
    {"kind": "edit", "operations": [operation]}
    for operation in (
        {"op": "add", "section": [], "fields": {}},
        {"op": "add", "section": "bodies", "name": {"a": 1}, "fields": {}},
        {"op": "add", "section": "bodies", "base": 3, "fields": {}},
        {"op": "add", "section": "bodies", "base": "x" * 5000, "fields": {}},
        {"op": "parameter", "name": None, "value": None},
        {"op": "parameter", "name": [], "value": 1},
        {"op": "remove", "section": "format", "name": "x"},
        {"op": "remove", "section": "name", "name": "four"},
        {"op": "remove group", "name": "x", "group": "y"},
        {"op": "rename", "section": "format", "name": "1", "to": "x"},
        {"op": "rename", "section": "name", "name": "four", "to": "x"},
        {"op": "section", "section": "name", "fields": {"a": 1}},
        {"op": "section", "section": "bodies", "fields": {"a": 1}},
        {"op": "append", "section": "bodies", "fields": {}},
        {"op": "append", "section": "name", "fields": {}},
        {"op": "remove_entry", "section": "name", "index": 0},
        {"op": "extract", "keys": [["a"]]},
        {"op": "extract", "at": -5},
        {"op": "extract", "at": 10**30},
        {"op": []},
    )
]
REQUESTS += [
    {"kind": "preview", "type": "Dynamics", "fields": {"duration": {"a": 1}}},
    {"kind": "preview", "type": "Dynamics", "fields": {"step": [1, [2]]}},
    {"kind": "start", "section": []},
    {"kind": "start", "section": "optimize"},
    {"kind": "open", "example": "none"},
    {"kind": "text", "text": "a = '\ud800'"},
]


@pytest.mark.thorough
def test_every_odd_request_is_answered_on_the_same_connection(studio: Studio) -> None:
    with page(studio) as socket:
        state = receive(socket, "text")
        revision, text = state["revision"], state["text"]
        for request in REQUESTS:
            send(socket, **({"revision": revision} | request))
            send(socket, kind="barrier")
            while True:
                message = json.loads(socket.recv(timeout=20))
                if message["kind"] == "text":
                    revision = message["revision"]
                if message.get("text", "").startswith("unknown request"):
                    break
                assert "internal error" not in str(message.get("text")), (request, message)
        send(socket, kind="open", path=str(studio.folder / "model.toml"))
        receive(socket, "text", name="model.toml")
        send(socket, kind="reload")
        assert receive(socket, "text", changed=False)["text"] == text


@pytest.mark.thorough
def test_a_refused_text_is_followed_by_a_shorter_one(studio: Studio) -> None:
    """A page counts the texts that it has sent; a refused one is reported with its kind."""
    with page(studio) as socket:
        state = receive(socket, "text")
        send(socket, kind="text", text="#" * 2_500_000, revision=state["revision"])
        assert receive(socket, "failure")["request"] == "text"
        send(socket, kind="text", text=state["text"] + "# shorter\n", revision=state["revision"])
        assert receive(socket, "text")["text"] is None
        send(socket, kind="undo")
        assert receive(socket, "text")["text"] == state["text"]


def open_files(process: int) -> int:
    return len(os.listdir(f"/proc/{process}/fd"))


def resources(process: int) -> tuple[int, int]:
    """Open files and threads, when connections that were closed have ended."""
    before, now = (0, 0), (open_files(process), threads(process))
    while now != before:
        time.sleep(0.3)
        before, now = now, (open_files(process), threads(process))
    return now


@pytest.mark.thorough
def test_pages_that_come_and_go_leave_nothing(studio: Studio) -> None:
    if not Path("/proc").exists():
        pytest.skip("no list of files")
    counts = []
    for _ in range(2):
        for _ in range(30):
            with page(studio) as socket:
                receive(socket, "text")
        counts.append(resources(studio.process.pid))
    assert counts[0] == counts[1]


def threads(process: int) -> int:
    return len(os.listdir(f"/proc/{process}/task"))


def upgraded(studio: Studio) -> sockets.socket:
    """A raw connection after the handshake."""
    host, port = studio.host.split(":")
    raw = sockets.create_connection((host, int(port)), timeout=20)
    raw.sendall(
        f"GET /{studio.token}/socket HTTP/1.1\r\nHost: {studio.host}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nOrigin: http://{studio.host}\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode()
    )
    assert b" 101 " in raw.recv(200)
    return raw


FRAMES = {
    "without a mask": b"\x81\x02{}",
    "unknown kind": b"\x83\x80\x00\x00\x00\x00",
    "reserved bits": b"\xf1\x80\x00\x00\x00\x00",
    "huge": b"\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\x00\x00\x00\x00",
    "continuation of nothing": b"\x80\x80\x00\x00\x00\x00",
    "long ping": b"\x89\xfe\x01\x00\x00\x00\x00\x00" + b"x" * 256,
    "no UTF-8": b"\x81\x82\x00\x00\x00\x00\xff\xfe",
    "binary": b"\x82\x82\x00\x00\x00\x00{}",
    "half": b"\x81\xfe\x10\x00\x00\x00",
    "none": b"\x00" * 40,
    "no frame": b"GET / HTTP/1.1\r\n\r\n",
}
"""Frames that RFC 6455 forbids, or that carry no text."""


def test_malformed_frames_end_only_their_connection(studio: Studio) -> None:
    with page(studio) as other:
        receive(other, "text")
        for name, frame in FRAMES.items():
            with upgraded(studio) as raw:
                raw.sendall(frame)
                raw.shutdown(sockets.SHUT_WR)
                while raw.recv(65_536):  # until the server closes it
                    pass
            send(other, kind="barrier")
            assert receive(other, "failure")["text"].startswith("unknown request"), name


def test_a_process_that_was_killed_while_idle_is_replaced(tmp_path: Path) -> None:
    pictures: list[Picture] = []
    builder = BuildingProcess("still", lambda number, picture: pictures.append(picture))
    for number in (1, 2):
        builder.request(Request(number, BAR, tmp_path / "bar.toml"))
        end = time.monotonic() + 120
        while len(pictures) < number and time.monotonic() < end:
            time.sleep(0.02)
        builder._process.kill()
        builder._process.join()
    builder.close()
    assert [bool(picture.page) for picture in pictures] == [True, True]
