"""Attacks on the studio: floods, hostile names, replaced files, full disks, and sudden ends."""

from __future__ import annotations

import asyncio
import errno
import json
import os
import socket as sockets
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from processor_times import descendants
from studio_runs import Studio, running_studio
from test_studio_server import FOUR_BAR, get, page, receive, send

from dalembert.errors import FileError
from dalembert.studio.draft import Draft, Missing
from dalembert.studio.journal import Journal
from dalembert.studio.session import Session


@pytest.fixture(scope="module")
def studio(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Studio]:
    folder = tmp_path_factory.mktemp("attacked")
    (folder / "model.toml").write_text(FOUR_BAR)
    with running_studio(folder, "model.toml") as server:
        yield server


@pytest.mark.thorough
def test_a_flood_of_one_page_leaves_others_served(studio: Studio) -> None:
    with page(studio) as one, page(studio) as two:
        state = receive(one, "text")
        receive(two, "text")
        for k in range(300):
            text = FOUR_BAR + f"# {k}\n"
            send(one, kind="text", text=text, revision=state["revision"] + k)
        begin = time.monotonic()
        assert get(studio, f"/{studio.token}/")[0] == 200
        assert time.monotonic() - begin < 3
        while receive(two, "text")["text"] != text:
            pass
        send(two, kind="reload")
        assert receive(two, "text", changed=False)["text"] == FOUR_BAR


@pytest.mark.thorough
def test_connections_that_say_nothing_do_no_harm(studio: Studio) -> None:
    host, port = studio.host.split(":")
    idle = [sockets.create_connection((host, int(port))) for _ in range(60)]
    for k, connection in enumerate(idle):
        connection.sendall(b"GET /" + b"x" * k)
    begin = time.monotonic()
    assert get(studio, f"/{studio.token}/")[0] == 200
    assert time.monotonic() - begin < 2
    for connection in idle:
        connection.close()


@pytest.mark.thorough
def test_a_page_that_reads_nothing_does_not_stop_others(studio: Studio) -> None:
    address = studio.address.replace("http:", "ws:") + "socket"
    from websockets.sync.client import connect

    origin: Any = f"http://{studio.host}"
    with connect(address, origin=origin, max_queue=1, close_timeout=1), page(studio) as two:
        state = receive(two, "text")
        for k in range(40):
            text = FOUR_BAR + "#" * 50_000 + f"{k}\n"
            send(two, kind="text", text=text, revision=state["revision"] + k)
            receive(two, "text", revision=state["revision"] + k + 1)
        send(two, kind="reload")
        assert receive(two, "text", changed=False)["text"] == FOUR_BAR


@pytest.mark.thorough
def test_deep_and_odd_texts_are_problems_not_ends(studio: Studio) -> None:
    texts = ["a = " + "[" * 20_000, "[" + "a." * 20_000 + "b]", "a = 1979-05-27\n", "x" * 100_000]
    texts += ["a = nan", '"' * 50_000, "\x00", "[[a]]\n" * 5_000, "a.b = 1\n" * 3]
    with page(studio) as one:
        state = receive(one, "text")
        for k, text in enumerate(texts):
            send(one, kind="text", text=text, revision=state["revision"] + k)
            assert receive(one, "text", revision=state["revision"] + k + 1)["document"] is None or k
        problems = receive(one, "picture", live=False, revision=state["revision"] + len(texts))
        assert problems["problems"][0]["level"] == "error"
        send(one, kind="reload")
        assert receive(one, "text", changed=False)["text"] == FOUR_BAR


@pytest.mark.thorough
def test_two_programs_on_one_file(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    with (
        running_studio(tmp_path, path) as first,
        running_studio(tmp_path, path) as second,
        page(first) as one,
        page(second) as two,
    ):
        for socket, mark in ((one, "# one\n"), (two, "# two\n")):
            revision = receive(socket, "text")["revision"]
            send(socket, kind="text", text=FOUR_BAR + mark, revision=revision)
            receive(socket, "text", changed=True)
        send(two, kind="save")
        assert "saved" in receive(two, "notice")["text"]
        send(one, kind="save")
        assert "another program" in receive(one, "conflict")["text"]
        assert path.read_text() == FOUR_BAR + "# two\n"
        send(one, kind="save", path=str(path))
        assert "another program" in receive(one, "conflict")["text"]
        send(one, kind="reload")
        assert receive(one, "text", changed=False)["text"] == FOUR_BAR + "# two\n"
        send(one, kind="undo")
        assert receive(one, "text")["text"] == FOUR_BAR + "# one\n"


@pytest.mark.thorough
def test_a_file_that_another_program_saves_is_waited_for(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text("a = 0\n")
    session = Session(path, tmp_path / "journals")
    session.broadcast = lambda message, but=None: None  # type: ignore[method-assign]
    code = (
        "import sys, time; from pathlib import Path; from dalembert.studio.journal import saving\n"
        "with saving(Path(sys.argv[1]), Path(sys.argv[2])):\n"
        "    print('locked', flush=True); sys.stdin.readline()"
    )
    command = [sys.executable, "-c", code, str(path), str(tmp_path / "journals")]
    other = subprocess.Popen(command, stdin=-1, stdout=-1, text=True)
    assert other.stdout is not None and other.stdin is not None
    assert other.stdout.readline() == "locked\n"
    session.draft.replace("a = 1\n", "type")
    with pytest.raises(FileError, match="another program is saving it"):
        session.save(None, False)
    assert path.read_text() == "a = 0\n"
    other.communicate("\n")
    session.save(None, False)
    assert path.read_text() == "a = 1\n"
    session.close()


def test_a_state_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "blocked").touch()
    session = Session(None, tmp_path / "blocked" / "journals")
    sent: list[dict[str, Any]] = []
    session.broadcast = lambda message, but=None: sent.append(message)  # type: ignore[method-assign]
    for text in ("a = 1\n", "a = 2\n"):
        session.draft.replace(text, "type")
        asyncio.run(session.changed())
    assert [m["kind"] for m in sent] == ["failure", "text", "text"]
    session.save(tmp_path / "saved.toml", False)
    assert (tmp_path / "saved.toml").read_text() == "a = 2\n"
    session.close()


def test_links_stay_links_and_files_keep_their_kind(tmp_path: Path) -> None:
    (tmp_path / "real.toml").write_text(FOUR_BAR)
    (tmp_path / "real.toml").chmod(0o640)
    link = tmp_path / "link.toml"
    link.symlink_to("real.toml")
    draft = Draft(link)
    draft.replace("a = 1\n", "type")
    draft.save()
    assert link.is_symlink() and (tmp_path / "real.toml").read_text() == "a = 1\n"
    assert (tmp_path / "real.toml").stat().st_mode & 0o777 == 0o640
    loop = tmp_path / "loop.toml"
    loop.symlink_to("loop.toml")
    with pytest.raises((FileError, OSError, RuntimeError)):
        Draft(loop)


def test_a_file_that_is_deleted_or_a_folder_while_open(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    draft = Draft(path)
    draft.replace("a = 1\n", "type")
    path.unlink()
    path.mkdir()
    with pytest.raises(FileError):
        draft.save()
    with pytest.raises(FileError):
        draft.reload()
    assert draft.text == "a = 1\n" and draft.is_changed
    path.rmdir()
    with pytest.raises(Missing, match="moved, renamed or deleted by another program"):
        draft.save()
    draft.save(replace=True)
    assert path.read_text() == "a = 1\n"


def test_a_full_disk_loses_neither_the_file_nor_the_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    session = Session(path, tmp_path / "journals")
    sent: list[dict[str, Any]] = []
    session.broadcast = lambda message, but=None: sent.append(message)  # type: ignore[method-assign]

    def full(*_: Any, **__: Any) -> int:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    monkeypatch.setattr(Path, "write_bytes", full)
    session.draft.replace("a = 1\n", "type")
    asyncio.run(session.changed())
    assert sent[-1]["text"] == "a = 1\n" or sent[-2]["text"] == "a = 1\n"
    assert any("No space left" in str(message.get("text")) for message in sent)
    with pytest.raises(FileError, match="No space left"):
        session.save(None, False)
    assert path.read_text() == FOUR_BAR and session.draft.text == "a = 1\n"
    monkeypatch.undo()
    session.save(None, False)
    assert path.read_text() == "a = 1\n"
    assert sorted(p.name for p in tmp_path.iterdir()) == ["journals", "model.toml"]
    session.close()


@pytest.mark.thorough
@pytest.mark.parametrize(
    "waits", [(0.01,), pytest.param((0.0, 0.005, 0.02, 0.05, 0.2), marks=pytest.mark.thorough)]
)
def test_kill_at_any_moment_leaves_a_whole_file_and_the_text(
    waits: tuple[float, ...], tmp_path: Path
) -> None:
    path = tmp_path / "model.toml"
    path.write_text(FOUR_BAR)
    for wait in waits:
        old = path.read_text()
        new = FOUR_BAR + f"# {wait}\n" + "# long\n" * 4_000
        with running_studio(tmp_path, path) as server, page(server) as socket:
            state = receive(socket, "text")
            assert state["text"] == old
            send(socket, kind="text", text=new, revision=state["revision"])
            receive(socket, "text")
            for _ in range(20):
                send(socket, kind="save", replace=True)
            time.sleep(wait)
            server.process.kill()
            server.process.wait()
        assert path.read_text() in (old, new)
        drafts = [json.loads(p.read_text())["text"] for p in tmp_path.rglob("state/**/*-*.json")]
        assert path.read_text() == new or new in drafts
        with running_studio(tmp_path, path) as server, page(server) as socket:
            assert receive(socket, "text")["text"] == new
            send(socket, kind="save", replace=True)
            receive(socket, "notice", text=f"saved {path}")
    assert not [p for p in tmp_path.iterdir() if p.name.startswith(".")]


@pytest.mark.thorough
def test_a_killed_building_process_is_started_again(studio: Studio) -> None:
    if not Path("/proc").exists():
        pytest.skip("no list of processes")
    with page(studio) as socket:
        state = receive(socket, "text")
        receive(socket, "picture", live=False)
        revision = state["revision"]
        for text, generations in (("# a\n", 1), ("# b\n", 2)):
            started = list(descendants(studio.process.pid))
            for child in started:
                if b"forkserver" not in Path(f"/proc/{child}/cmdline").read_bytes():
                    continue
                if generations == 2 or not set(descendants(child)):  # what starts them, too
                    os.kill(child, 9)
            for again in ("", "# again\n"):
                send(socket, kind="text", text=FOUR_BAR + text + again, revision=revision)
                revision += 1
                picture = receive(socket, "picture", live=False, revision=revision)
            assert picture["page"]
        send(socket, kind="reload")
        assert receive(socket, "text", changed=False)["text"] == FOUR_BAR


MARKUP = "<img src=x onerror=window.hacked=1>"


def test_names_are_shown_as_text(browser: Any, tmp_path: Path) -> None:
    path = tmp_path / f"{MARKUP}&lt;b&gt;.toml"
    path.write_text(
        f'format = 1\nname = "{MARKUP}"\ndescription = "{MARKUP}</script>"\n'
        f'[parameters]\nl = {{ value = 1, bounds = [0.5, 2], description = "{MARKUP}" }}\n'
        f'[bodies.a]\ntype = "Bar"\nlength = "l"\nmass = 1\n[bodies."{MARKUP}"]\nmass = 1\n'
    )
    with running_studio(tmp_path, path) as server:
        shown = browser.new_page()
        shown.goto(server.address)
        end = time.monotonic() + 30
        while not shown.evaluate("studio?.described") and time.monotonic() < end:
            time.sleep(0.05)
        shown.click("text=Open…")
        shown.wait_for_selector("#sheet .example")
        assert shown.locator('#sheet .row b:has-text("onerror")').count() >= 1
        assert "a name consists of letters" in shown.inner_text("#problems")
        assert shown.evaluate("window.hacked") is None
        assert shown.locator('img[src="x"]').count() == 0
        assert MARKUP in shown.title()
        shown.close()


def test_the_journal_is_that_of_its_own_file(tmp_path: Path) -> None:
    names = ["a.toml", "b\n.toml", "ü.toml", "\udcff.toml"]
    for name in names:
        journal = Journal(tmp_path / name, tmp_path / "state")
        journal.write(name.encode("utf-8", "replace").decode())
        journal._lock = None  # as after the end of its process
    for name in names:
        journal = Journal(tmp_path / name, tmp_path / "state")
        journal.file = tmp_path / "state" / "other.json"
        (left,) = journal.left_over()
        assert left.text == name.encode("utf-8", "replace").decode()


def test_older_drafts_are_reached_by_undo_and_come_once(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text("a = 0\n")
    for k, text in enumerate(("a = 2\n", "a = 1\n", "a = 0\n")):
        data = {"path": str(path), "text": text, "time": float(time.time() - k)}
        name = Journal(path, tmp_path / "state").file.name.split("-")[0]
        (tmp_path / "state" / f"{name}-{10**9 + k}.json").write_text(json.dumps(data))
    session = Session(path, tmp_path / "state")
    assert session._recover() is not None and session.draft.text == "a = 2\n"
    session.draft.undo()
    assert session.draft.text == "a = 1\n"
    session.save(None, False)
    session.close()
    again = Session(path, tmp_path / "state")
    assert again._recover() is None and again.draft.text == "a = 1\n"
    again.close()
