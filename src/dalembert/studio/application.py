"""Web application of the studio: its page, the pictures and the WebSocket.

All addresses begin with a random token. Requests of other sites are refused by the headers ``Host``
and ``Origin``; the pages load nothing from elsewhere.
"""

from __future__ import annotations

import hmac
import json
import re
from collections.abc import Awaitable, Callable, MutableMapping
from dataclasses import asdict
from importlib import resources
from typing import Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import FileResponse, HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket

from dalembert.errors import DalembertError, FileError
from dalembert.studio.connection import Connection
from dalembert.studio.event_loop import in_thread
from dalembert.studio.exporting import CHOICES
from dalembert.studio.measurements import MAX_DATA, columns_of, store_measurements
from dalembert.studio.photos import MAX_PHOTO, Photo, Photos
from dalembert.studio.picture_frames import frame_page
from dalembert.studio.schema_process import schema_text
from dalembert.studio.session import Session

MEDIA = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
PLACE_HEADER = "X-Photo-Place"
"""Header with the place of a photo."""
DOWNLOAD = "application/octet-stream"
"""Media type of files that are stored, not shown."""
POLICY = "; ".join(
    [
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",
        "img-src 'self' data: blob:",
        "connect-src 'self'",
        "frame-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    ]
)
"""Content security policy of the studio; pictures have their own."""
HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
}
Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


def make_application(session: Session, token: str, port: int, stop: Callable[[], None]) -> Guard:
    """The application for one session.

    Parameters
    ----------
    token : first part of the path of all addresses
    port : on which it is served
    stop : ends the server
    """

    async def index(request: Request) -> Response:
        return _asset("studio.html", {"Content-Security-Policy": POLICY})

    async def asset(request: Request) -> Response:
        return _asset(request.path_params["name"])

    async def schema(request: Request) -> Response:
        return Response(await in_thread(schema_text), 200, HEADERS, "application/json")

    async def exports(request: Request) -> Response:
        choices = [{"to": to} | asdict(choice) for to, choice in CHOICES.items()]
        return Response(json.dumps(choices), 200, HEADERS, "application/json")

    async def picture(request: Request) -> Response:
        number = _number(request)
        page = session.pictures.pages.get(number)
        if page is None and session.pictures.is_outdated(number):  # no error of a slow page
            return Response(status_code=204, headers=HEADERS)
        if page is None:
            return PlainTextResponse("no such picture", 404, HEADERS)
        return Response(page, 200, HEADERS, "application/json")

    async def frame(request: Request) -> Response:
        page = frame_page(request.path_params["name"])
        if not page:
            return PlainTextResponse("no such frame", 404, HEADERS)
        return HTMLResponse(page, headers=HEADERS | {"X-Frame-Options": "SAMEORIGIN"})

    async def export(request: Request) -> Response:
        path = session.exports.files.get(_number(request))
        if path is None or not path.is_file():
            return PlainTextResponse("this file has been deleted; export it again", 404, HEADERS)
        return FileResponse(path, headers=HEADERS, filename=path.name, media_type=DOWNLOAD)

    async def example(request: Request) -> Response:
        name = request.path_params["name"]
        file = resources.files(__package__) / "assets" / "examples" / f"{name}.png"
        if not re.fullmatch(r"\w+", name) or not file.is_file():
            return PlainTextResponse("no such picture", 404, HEADERS)
        return Response(file.read_bytes(), 200, HEADERS, "image/png")

    async def task(request: Request) -> Response:
        state = session.tasks.state(_number(request))
        if state is None or not state.outcome.page:
            return PlainTextResponse("this result is outdated", 404, HEADERS)
        return HTMLResponse(state.outcome.page, headers=HEADERS | {"X-Frame-Options": "SAMEORIGIN"})

    async def photo(request: Request) -> Response:
        name = session.photo_name
        if request.query_params.get("name") != name:
            return PlainTextResponse("another model is shown", 409, HEADERS)
        if request.method == "GET":
            return _photo(session.photos.read(name))
        return await _store_photo(session.photos, name, request)

    async def measurements(request: Request) -> Response:
        name, path = request.query_params.get("name", ""), session.draft.path
        try:
            if request.method == "PUT":
                if path is None:
                    raise FileError("save the model first; measurements are stored beside its file")
                contents = await _body(request, MAX_DATA)
                name = await in_thread(lambda: store_measurements(path.parent, name, contents))
            file = session.place.parent / name
            answer = {"name": name, "columns": await in_thread(lambda: columns_of(file))}
        except DalembertError as error:
            return PlainTextResponse(str(error), 400, HEADERS)
        return Response(json.dumps(answer), 200, HEADERS, "application/json")

    async def socket(websocket: WebSocket) -> None:
        await Connection(session, websocket, stop).run()

    routes = [
        Route("/", index),
        Route("/picture/{number}", picture),
        Route("/frame/{name}", frame),
        Route("/export/{number}", export),
        Route("/examples/{name}", example),
        Route("/task/{number}", task),
        Route("/photo", photo, methods=["GET", "PUT", "DELETE"]),
        Route("/measurements", measurements, methods=["GET", "PUT"]),
        Route("/assets/schema.json", schema),
        Route("/assets/exports.json", exports),
        Route("/assets/{name}", asset),
        WebSocketRoute("/socket", socket),
    ]
    return Guard(Starlette(routes=routes), token, port)


class Guard:
    """Refuses requests without the token, from other sites or under other names of this machine.

    Parameters
    ----------
    application : that answers the others
    token : first part of the path
    port : of the server
    """

    def __init__(self, application: Starlette, token: str, port: int):
        self.application = application
        self.token = token
        self.hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] in ("http", "websocket"):
            reason = self._refusal(scope)
            if reason:
                await _refuse(scope, receive, send, reason)
                return
            scope = dict(scope)
            rest = scope["path"][len(self.token) + 1 :]
            scope |= {"path": rest or "/", "raw_path": (rest or "/").encode()}
        await self.application(scope, receive, send)

    def _refusal(self, scope: Scope) -> str:
        """Reason to refuse a request; empty if there is none."""
        headers = [(name.lower(), value.decode("latin-1")) for name, value in scope["headers"]]
        hosts = [value for name, value in headers if name == b"host"]
        origins = [value for name, value in headers if name == b"origin"]
        if len(hosts) != 1 or hosts[0].lower() not in self.hosts:
            return "unknown host"
        if len(origins) > 1 or (origins and origins[0] != f"http://{hosts[0]}"):
            return "foreign origin"
        if scope["type"] == "websocket" and not origins:
            return "no origin"
        token, slash, _ = scope["path"][1:].partition("/")
        if not slash or not hmac.compare_digest(token.encode(), self.token.encode()):
            return "wrong or missing token; use the address that 'dalembert studio' printed"
        return ""


def _number(request: Request) -> int:
    """Number of the address; negative where it is none."""
    text = request.path_params["number"]
    return int(text) if re.fullmatch(r"[0-9]{1,9}", text) else -1


def _photo(photo: Photo | None) -> Response:
    """An image with its place; empty if there is none."""
    if photo is None:
        return Response(status_code=204, headers=HEADERS)
    headers = HEADERS | {PLACE_HEADER: json.dumps(photo.place)}
    return Response(photo.image, 200, headers, DOWNLOAD)


async def _store_photo(photos: Photos, name: str, request: Request) -> Response:
    """Store or delete the photo of a model."""
    if request.method == "DELETE":
        photos.remove(name)
        return Response(status_code=204, headers=HEADERS)
    try:
        image = await _body(request, MAX_PHOTO)
    except FileError:
        return PlainTextResponse("the photo is too large", 413, HEADERS)
    try:
        photos.write(name, request.headers.get(PLACE_HEADER, ""), image)
    except DalembertError as error:
        return PlainTextResponse(str(error), 400, HEADERS)
    return Response(status_code=204, headers=HEADERS)


async def _body(request: Request, limit: int) -> bytes:
    """Contents of a file that a page sends.

    Raises
    ------
    FileError
        It has more bytes than the limit.
    """
    parts, size = [], 0
    async for part in request.stream():
        size += len(part)
        if size > limit:
            raise FileError(f"the file has more than {limit / 1e6:.0f} MB; choose a smaller one")
        parts.append(part)
    return b"".join(parts)


async def _refuse(scope: Scope, receive: Receive, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": ""})
        return
    await PlainTextResponse(reason, 403, HEADERS)(scope, receive, send)


def _asset(name: str, headers: dict[str, str] | None = None) -> Response:
    """A file of the studio's page."""
    suffix = f".{name.rpartition('.')[2]}"
    folder = resources.files(__package__) / "assets"
    report = resources.files("dalembert.report") / "assets"
    if name == "page.css":
        return Response((report / name).read_bytes(), 200, HEADERS, "text/css; charset=utf-8")
    for place in (folder, folder / "vendor"):
        for file in place.iterdir():
            if file.name == name and suffix in MEDIA:
                media = f"{MEDIA[suffix]}; charset=utf-8"
                return Response(file.read_bytes(), 200, HEADERS | (headers or {}), media)
    return PlainTextResponse("no such file", 404, HEADERS)
