"""Hostile texts, addresses, names and ends: each has one clear message."""

from __future__ import annotations

from pathlib import Path
from queue import Queue
from types import SimpleNamespace
from typing import Any

import pytest
from test_studio_photos import request

from dalembert.errors import FileError
from dalembert.studio.application import make_application
from dalembert.studio.building import BuildingProcess, Request
from dalembert.studio.child import child_context
from dalembert.studio.connection import Connection
from dalembert.studio.draft import Draft, Unconfirmed
from dalembert.studio.picture_feed import PictureFeed
from dalembert.studio.pictures import Picture, picture_of


@pytest.mark.parametrize(
    "text", ["x = " + "[" * 5000 + "]" * 5000, "x = " + "{a=" * 3000 + "1" + "}" * 3000]
)
def test_a_text_that_is_nested_deep_is_one_problem(text: str) -> None:
    (problem,) = picture_of(text, Path("model.toml"), live=False).problems
    assert problem.message == "cannot be read as TOML: nested too deep"


@pytest.mark.parametrize("kind", ["picture", "export", "task"])
@pytest.mark.parametrize("number", ["9" * 5000, "-1", "0x1", "٣"])
def test_an_address_with_any_number_is_outdated(kind: str, number: str) -> None:
    nothing = SimpleNamespace(files={}, state=lambda number: None)
    pictures = PictureFeed(lambda message: None, lambda problems: problems)
    session: Any = SimpleNamespace(pictures=pictures, exports=nothing, tasks=nothing)
    application = make_application(session, "token", 80, lambda: None)
    headers = {"Host": "127.0.0.1:80"}
    status, _, body = request(application, "GET", f"/token/{kind}/{number}", "", headers)
    assert status == 404, body


@pytest.mark.parametrize("failures", [1, 99])
def test_processes_that_cannot_be_started_are_reported(
    failures: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The parent of children ends between two requests, or no memory is left for another one."""
    left = failures

    class Context:
        def Pipe(self) -> Any:
            nonlocal left
            left -= 1
            if left >= 0:
                raise ConnectionResetError("the parent of children has ended")
            return child_context().Pipe()

        Process = staticmethod(child_context().Process)

    monkeypatch.setattr("dalembert.studio.building.child_context", Context)
    pictures: Queue[Picture] = Queue()
    builder = BuildingProcess("still", lambda number, picture: pictures.put(picture))
    for number in (1, 2):
        builder.request(Request(number, "format = 1\n", tmp_path / "model.toml"))
        picture = pictures.get(timeout=60)
        if failures == 1:
            assert picture.page
        else:
            (problem,) = picture.problems
            assert "no building process can be started" in problem.message
    builder.close()


def test_a_write_protected_file_is_replaced_after_confirmation(tmp_path: Path) -> None:
    path = tmp_path / "model.toml"
    path.write_text("format = 1\n")
    path.chmod(0o444)
    draft = Draft(path)
    draft.replace("format = 1\n# changed\n", "type")
    with pytest.raises(Unconfirmed, match="is write-protected"):
        draft.save()
    assert path.read_text() == "format = 1\n"
    draft.save(replace=True)
    assert path.read_text() == draft.text


@pytest.mark.parametrize("name", ["a\nb.toml", "a\u202elmot.toml", "\x1b[2J.toml"])
def test_no_file_is_saved_under_a_hidden_name(name: str, tmp_path: Path) -> None:
    session: Any = SimpleNamespace(save=lambda path, replace: pytest.fail(f"saved {path}"))
    connection = Connection(session, None, lambda: None)  # type: ignore[arg-type]
    with pytest.raises(FileError, match="hidden characters"):
        connection.save({"path": str(tmp_path / name), "replace": True})
