"""Photos of the studio on disk: stored by model, whatever the address; copied with the model."""

from __future__ import annotations

import asyncio
import json
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest
from studio_scripts import drawn_by

import dalembert as da
from dalembert.studio.application import make_application
from dalembert.studio.photos import MAX_PHOTO, Photos
from dalembert.studio.session import Session

PLACE = {"x": 0.1, "y": 0.2, "scale": 1e-3, "opacity": 0.5}
IMAGE = b"\x89PNG\r\n\x1a\n{not json}\n\n"


def test_a_photo_belongs_to_its_model(tmp_path: Path) -> None:
    photos = Photos(tmp_path / "state")
    assert photos.read("a.toml") is None
    photos.write("a.toml", json.dumps(PLACE | {"more": 1}), IMAGE)
    photo = Photos(tmp_path / "state").read("a.toml")
    assert photo is not None
    assert (photo.place, photo.image) == (PLACE, IMAGE)
    photos.copy("a.toml", "b.toml")
    photos.copy("none.toml", "c.toml")
    photos.remove("a.toml")
    assert [photos.read(f"{n}.toml") is None for n in "abc"] == [True, False, True]
    photos.file("b.toml").write_bytes(b"damaged")
    assert photos.read("b.toml") is None


@pytest.mark.parametrize(
    "place",
    [
        *("", "[]", "{}", '{"x": NaN}', json.dumps({"x": 1}), "[" * 20_000),
        *(json.dumps(PLACE | change) for change in ({"scale": 0}, {"x": 10**400}, {"y": True})),
    ],
)
def test_a_wrong_place_is_refused(tmp_path: Path, place: str) -> None:
    with pytest.raises(da.FileError, match="the place of the photo is invalid"):
        Photos(tmp_path).write("a.toml", place, IMAGE)
    with pytest.raises(da.FileError, match="choose a smaller one"):
        Photos(tmp_path).write("a.toml", json.dumps(PLACE), b"0" * (MAX_PHOTO + 1))


def request(
    application: Any, method: str, path: str, name: str, headers: dict[str, str], body: bytes = b""
) -> tuple[int, dict[str, str], bytes]:
    """Status, headers and body of the answer to a request, without a server."""
    answer: list[Any] = []
    scope = {
        "type": "http",
        "method": method,
        "path": path,
        "raw_path": path.encode(),
        "query_string": urlencode({"name": name}).encode(),
        "headers": [(k.lower().encode(), v.encode()) for k, v in headers.items()],
    }

    async def receive() -> dict[str, Any]:
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message: dict[str, Any]) -> None:
        answer.append(message)

    asyncio.run(application(scope, receive, send))
    shown = {k.decode().lower(): v.decode() for k, v in answer[0]["headers"]}
    return answer[0]["status"], shown, b"".join(part.get("body", b"") for part in answer[1:])


@pytest.mark.thorough
def test_a_photo_survives_another_address(tmp_path: Path) -> None:
    """Two sessions, as of two programs on different ports, with the same drafts."""
    sessions = [Session(None, tmp_path) for _ in range(2)]
    first, second = (
        make_application(session, f"t{port}", port, lambda: None)
        for port, session in enumerate(sessions)
    )
    name = sessions[0].photo_name
    own = {"host": "127.0.0.1:0", "origin": "http://127.0.0.1:0"}
    other = {"host": "127.0.0.1:1"}
    placed = own | {"X-Photo-Place": json.dumps(PLACE)}
    assert request(first, "PUT", "/t0/photo", name, placed, IMAGE)[0] == 204
    status, headers, body = request(second, "GET", "/t1/photo", name, other)
    assert (status, body, json.loads(headers["x-photo-place"])) == (200, IMAGE, PLACE)
    assert headers["content-type"] == "application/octet-stream"
    assert request(second, "GET", "/t1/photo", "b", other)[0] == 409
    foreign = placed | {"origin": "http://example.com"}
    assert request(first, "DELETE", "/t0/photo", name, foreign)[0] == 403
    status, _, body = request(first, "PUT", "/t0/photo", name, own, IMAGE)
    assert (status, b"invalid" in body) == (400, True)
    assert request(first, "PUT", "/t0/photo", name, placed, b"0" * (MAX_PHOTO + 1))[0] == 413
    assert request(first, "DELETE", "/t0/photo", name, own)[0] == 204
    assert request(second, "GET", "/t1/photo", name, other)[0] == 204
    for session in sessions:
        session.journal.close()


def test_the_distance_is_requested_when_the_second_click_is_released(tmp_path: Path) -> None:
    """While the button is pressed, the browser moves the focus to the picture."""
    scaled = drawn_by("studio_photo_scale.mjs", tmp_path)
    assert scaled == {"requested": ["pointerup 3,4"], "marks": [[0, 0], [3, 4]]}


@pytest.mark.thorough
def test_the_photo_of_a_new_model_moves_to_its_file(tmp_path: Path) -> None:
    session = Session(None, tmp_path / "state")
    new = session.photo_name
    session.photos.write(new, json.dumps(PLACE), IMAGE)
    session.save(tmp_path / "traced.toml", False)
    assert session.photos.read(new) is None
    assert session.photos.read(session.photo_name) is not None
