"""The server of the studio: its messages, and requests of others."""

from __future__ import annotations

import http.client
import json
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from studio_runs import Studio, running_studio
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from dalembert.cli.app import main
from dalembert.studio.picture_feed import PictureFeed
from dalembert.studio.pictures import Picture

FOUR_BAR = (Path(__file__).parents[1] / "examples" / "four_bar.toml").read_text("utf-8")


QUIET = [
    "Ctrl-C stops it\n" + end for end in ("", "Error: interrupted\n\n", "Error: interrupted\n")
]
"""What the program says when Ctrl-C ends it."""


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("studio")
    (folder / "model.toml").write_text(FOUR_BAR)
    with running_studio(folder, "model.toml") as server:
        yield server


@contextmanager
def page(studio: Studio, **options: Any) -> Iterator[ClientConnection]:
    """A page without a browser."""
    address = studio.address.replace("http:", "ws:") + "socket"
    options = {"origin": f"http://{studio.host}", "max_size": None, "close_timeout": 1} | options
    with connect(address, **options) as socket:
        yield socket


def receive(socket: ClientConnection, kind: str, **wanted: Any) -> dict[str, Any]:
    """The next message of a kind."""
    end = time.monotonic() + 20
    while time.monotonic() < end:
        message = json.loads(socket.recv(timeout=20))
        if message["kind"] == kind and all(message[k] == v for k, v in wanted.items()):
            return message
    raise AssertionError(f"no {kind} {wanted}")


def send(socket: ClientConnection, **request: Any) -> None:
    socket.send(json.dumps(request))


def send_and_wait(socket: ClientConnection, data: str) -> None:
    socket.send(data)
    receive(socket, "failure")


def get(studio: Studio, path: str, **headers: str) -> tuple[int, bytes, dict[str, str]]:
    connection = http.client.HTTPConnection(studio.host, timeout=20)
    connection.putrequest("GET", path, skip_host=True)
    for name, value in ({"Host": studio.host} | headers).items():
        connection.putheader(name, value)
    connection.endheaders()
    response = connection.getresponse()
    body = response.read()
    connection.close()
    return response.status, body, {k.lower(): v for k, v in response.getheaders()}


def test_text_picture_edit_and_undo(studio: Studio) -> None:
    with page(studio) as socket:
        state = receive(socket, "text")
        assert state["text"] == FOUR_BAR and state["name"] == "model.toml"
        still = receive(socket, "picture", live=False)
        assert still["summary"] == "1 degree of freedom" and still["page"]
        status, body, headers = get(studio, f"/{studio.token}/{still['page']}")
        assert status == 200 and b"crank" in body and headers["content-type"] == "application/json"
        status, body, headers = get(studio, f"/{studio.token}/{still['frame']}")
        assert status == 200 and b"<canvas" in body and headers["x-frame-options"] == "SAMEORIGIN"
        live = receive(socket, "picture", live=True)
        assert live["number"] == still["number"] and live["page"] != still["page"]
        text = FOUR_BAR.replace("l1 = { value = 0.3,", "l1 = { value = -0.3,")
        send(socket, kind="text", text=text, revision=state["revision"])
        confirmed = receive(socket, "text")
        assert confirmed["text"] is None and confirmed["changed"]
        wrong = receive(socket, "picture", live=False, number=still["number"] + 1)
        (problem,) = wrong["problems"]
        assert (
            problem["level"] == "error"
            and problem["line"] == text[: problem["start"]].count("\n") + 1
        )
        assert wrong["page"] == ""
        send(socket, kind="undo")
        assert receive(socket, "text")["text"] == FOUR_BAR
        remove = {"op": "remove", "section": "bodies", "name": "coupler"}
        revision = confirmed["revision"] + 1
        send(socket, kind="edit", operations=[remove], label="delete", revision=revision)
        assert receive(socket, "text")["document"]["bodies"].keys() == {"crank", "rocker"}
        two = receive(socket, "picture", live=False, number=still["number"] + 3)
        assert two["facts"]["degrees_of_freedom"] == 2
        send(socket, kind="undo")
        assert receive(socket, "text")["changed"] is False


def test_two_pages_do_not_overwrite_each_other(studio: Studio) -> None:
    with page(studio) as one, page(studio) as two:
        revision = receive(one, "text")["revision"]
        receive(two, "text")
        send(one, kind="text", text=FOUR_BAR + "# one\n", revision=revision)
        assert receive(two, "text")["text"] == FOUR_BAR + "# one\n"
        send(two, kind="text", text=FOUR_BAR + "# two\n", revision=revision)
        assert "another page" in receive(two, "failure")["text"]
        send(one, kind="undo")
        assert receive(two, "text", changed=False)["text"] == FOUR_BAR


@pytest.mark.parametrize(
    "data",
    [
        "",
        "{",
        "[]",
        "null",
        '{"kind": "eval"}',
        '{"kind": ["text"]}',
        '{"kind": "text"}',
        '{"kind": "text", "text": 3, "revision": 0}',
        '{"kind": "edit", "revision": -1}',
        "[" * 100_000,
        '{"kind": "text", "revision": 0, "text": "' + "x" * 3_000_000 + '"}',
    ],
    ids=range(11),
)
def test_malformed_requests_are_answered(studio: Studio, data: str) -> None:
    with page(studio) as socket:
        text = receive(socket, "text")["text"]
        socket.send(data)
        assert receive(socket, "failure")["text"]
    with page(studio) as socket:
        assert receive(socket, "text")["text"] == text


@pytest.mark.thorough
def test_a_huge_message_closes_only_its_page(studio: Studio) -> None:
    with page(studio) as socket:
        receive(socket, "text")
        with pytest.raises(ConnectionClosed):
            send_and_wait(socket, "x" * 100_000_000)
    with page(studio) as socket:
        assert receive(socket, "text")["text"] == FOUR_BAR


def test_other_sites_are_refused(studio: Studio) -> None:
    good = f"/{studio.token}/"
    assert get(studio, good)[0] == 200
    for path, headers in (
        ("/", {}),
        ("/studio/", {}),
        (f"/{studio.token[:-1]}/", {}),
        (f"/{studio.token}x/assets/studio.js", {}),
        (good, {"Host": "example.org"}),
        (good, {"Host": "attacker.localhost:80"}),
        (good, {"Origin": "http://example.org"}),
        (good, {"Origin": "null"}),
        (f"{good}../../etc/passwd", {"Host": "x"}),
    ):
        status, body, _ = get(studio, path, **headers)
        assert status == 403 and b"<" not in body, path
    for path in (
        "assets/..%2fserver.py",
        "assets/../session.py",
        "assets/vendor",
        "picture/999",
        "frame/x",
    ):
        assert get(studio, good + path)[0] == 404, path
    for options in ({"origin": "http://example.org"}, {"origin": None}):
        with pytest.raises(InvalidStatus), page(studio, **options):
            pass


def test_the_page_loads_nothing_from_elsewhere(studio: Studio) -> None:
    _, body, headers = get(studio, f"/{studio.token}/")
    assert "default-src 'none'" in headers["content-security-policy"]
    assert headers["referrer-policy"] == "no-referrer"
    assert b"http:" not in body and b"https:" not in body


@pytest.mark.thorough
def test_changes_survive_the_end_of_the_server(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    with running_studio(tmp_path, path) as studio, page(studio) as socket:
        state = receive(socket, "text")
        send(socket, kind="text", text=FOUR_BAR + "# kept\n", revision=state["revision"])
        receive(socket, "text")
        studio.process.kill()
        studio.process.wait()
    assert path.read_text() == FOUR_BAR
    with running_studio(tmp_path, path) as studio, page(studio) as socket:
        assert receive(socket, "text")["text"] == FOUR_BAR + "# kept\n"
        assert "restored" in receive(socket, "notice")["text"]
        send(socket, kind="save")
        assert "saved" in receive(socket, "notice")["text"]
        assert path.read_text() == FOUR_BAR + "# kept\n"
        path.write_text("# other\n")
        send(socket, kind="save")
        assert "another program" in receive(socket, "conflict")["text"]
        send(socket, kind="save", path=str(tmp_path / "new" / "x.toml"))
        assert "cannot be written" in receive(socket, "failure")["text"]
        send(socket, kind="save", path=str(tmp_path / "copy.toml"))
        assert receive(socket, "text", name="copy.toml")["changed"] is False
        send(socket, kind="stop")
        assert studio.process.wait(20) == 0
    assert path.read_text() == "# other\n"
    assert not list((tmp_path / "state").rglob("*.json"))


def test_ctrl_c_stops_it(tmp_path: Path) -> None:
    with running_studio(tmp_path) as studio, page(studio) as socket:
        assert receive(socket, "text")["name"] == "untitled.toml"
        studio.process.send_signal(signal.SIGINT)
        assert studio.process.wait(20) in (0, 130)
        assert studio.process.stdout is not None
        assert studio.process.stdout.read() in QUIET


@pytest.mark.thorough
def test_ctrl_c_ends_an_upload_quietly(tmp_path: Path) -> None:
    with running_studio(tmp_path) as studio:
        upload = http.client.HTTPConnection(studio.host, timeout=20)
        upload.putrequest("PUT", f"/{studio.token}/photo?name=untitled.toml", skip_host=True)
        upload.putheader("Host", studio.host)
        upload.putheader("Content-Length", "1000000")
        upload.endheaders()
        upload.send(b"x" * 1000)
        time.sleep(0.5)
        studio.process.send_signal(signal.SIGINT)
        assert studio.process.wait(20) in (0, 130)
        assert studio.process.stdout is not None
        assert studio.process.stdout.read() in QUIET
        upload.close()


def test_wrong_files_and_ports_are_refused(tmp_path: Path, capsys: Any, studio: Studio) -> None:
    port = studio.host.split(":")[1]
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    for arguments, text in (
        ([str(tmp_path / "none.toml")], "no such file"),
        ([str(tmp_path)], "a folder"),
        ([str(tmp_path / "binary.toml")], "is not UTF-8"),
        (["--port", port], "choose another with --port"),
        (["--port", "70000"], "choose another with --port"),
    ):
        assert main(["studio", *arguments, "--no-open"]) == 2
        assert text in capsys.readouterr().err


def test_a_live_picture_follows_the_still_one() -> None:
    sent: list[tuple[bool, str]] = []
    feed = PictureFeed(lambda message: sent.append((message["live"], message["page"])), list)
    feed.number = 2
    feed.show("live", 1, Picture(page="outdated"))
    feed.show("live", 2, Picture(page="moving"))
    assert sent == []
    feed.show("still", 2, Picture(page="at rest"))
    assert sent == [(False, "picture/4"), (True, "picture/5")]


@pytest.mark.thorough
def test_another_page_is_served_while_a_long_text_changes(
    studio: Studio, monkeypatch: pytest.MonkeyPatch
) -> None:
    rows = [f'b{k} = {{ type = "Particle", mass = 1, position = [{k}, 0] }}' for k in range(9000)]
    long = "\n".join(["format = 1", "[bodies]", *rows, ""])
    particle = {"type": "Particle", "mass": 1, "position": [0, 1]}
    add = {"op": "add", "section": "bodies", "base": "p", "fields": particle}
    with page(studio) as socket:
        state = receive(socket, "text")
        send(socket, kind="text", text=long, revision=state["revision"])
        revision = receive(socket, "text")["revision"]
        send(socket, kind="edit", label="add", operations=[add], revision=revision)
        answered = 0
        while True:  # meanwhile other requests are answered
            status, _, _ = get(studio, f"/{studio.token}/assets/dom.js")
            assert status == 200
            try:
                message = json.loads(socket.recv(timeout=0))
            except TimeoutError:
                answered += 1
                continue
            if message["kind"] == "text":
                break
        assert "p1 = " in message["text"] and answered > 5
        send(socket, kind="cancel")
        send(socket, kind="text", text=FOUR_BAR, revision=message["revision"])
        assert receive(socket, "text")["revision"] > message["revision"]
