"""Messages between a page of the studio and its session."""

from __future__ import annotations

import asyncio
import json
import re
import traceback
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

from starlette.websockets import WebSocket, WebSocketDisconnect

from dalembert.errors import DalembertError, FileError
from dalembert.files import read_text
from dalembert.io.example_files import example_folder
from dalembert.studio.draft import Missing, Unconfirmed
from dalembert.studio.drawing_edits import apply
from dalembert.studio.drawn_document import LONG
from dalembert.studio.event_loop import in_thread
from dalembert.studio.new_models import NEW
from dalembert.studio.preview import analysis_fields, section_operation
from dalembert.studio.session import (
    MAX_TEXT,
    Session,
    failure,
)
from dalembert.studio.text_edits import TextEdits

MEANWHILE = "the model has changed meanwhile; draw it once more"
OUTDATED = "another page has changed the model; its text is shown now"


class Connection:
    """One page: carries out its requests and sends what changes.

    Requests are JSON objects with a ``kind``; unknown or malformed ones are answered by a failure.

    Parameters
    ----------
    session : of the model file
    websocket : of the page
    stop : ends the server
    """

    def __init__(self, session: Session, websocket: WebSocket, stop: Callable[[], None]):
        self.session = session
        self.websocket = websocket
        self.stop = stop
        self.requests: dict[str, Callable[[dict[str, Any]], Awaitable[None] | None]] = {
            "text": self.text,
            "edit": self.edit,
            "undo": self.undo,
            "redo": self.redo,
            "save": self.save,
            "reload": self.reload,
            "open": self.open,
            "preview": self.preview,
            "write_preview": self.write_preview,
            "start": lambda request: session.start_task(request.get("section")),
            "stop task": lambda _: session.tasks.stop(),
            "assemblies": lambda request: session.show_assemblies(request.get("shown") is True),
            "files": lambda _: session.reply(self.send, session.files()),
            "export": self.export,
            "stop export": lambda _: session.exports.stop(),
            "cancel": lambda _: session.pictures.cancel(),
            "stop": lambda _: stop(),
        }

    async def send(self, message: dict[str, Any]) -> None:
        """Send a message to the page."""
        await self.websocket.send_text(json.dumps(message))

    async def run(self) -> None:
        """Serve the page until it is closed."""
        await self.websocket.accept()
        try:
            await self.session.attach(self.send)
            while True:
                await self.answer(await self.websocket.receive_text())
                await asyncio.sleep(0)  # other pages are served between many messages of this one
        except (WebSocketDisconnect, RuntimeError, KeyError):  # KeyError: not a text
            pass
        finally:
            self.session.detach(self.send)

    async def answer(self, data: str) -> None:
        """Carry out one request."""
        kind = None
        try:
            request = json.loads(data)
            kind = request.get("kind") if isinstance(request, dict) else None
            if not isinstance(kind, str) or kind not in self.requests:
                raise FileError("unknown request; reload the page")
            work = self.requests[kind](request)
            if work is not None:
                await work
        except Unconfirmed as conflict:
            path = str(_path(request) or "")
            missing = isinstance(conflict, Missing)
            message = {"kind": "conflict", "text": str(conflict), "path": path, "missing": missing}
            await self.send(message)
        except DalembertError as error:
            await self.send(failure(error) | {"request": kind})
        except (ValueError, RecursionError):
            await self.send({"kind": "failure", "text": "unreadable request; reload the page"})
        except Exception:  # the page stays connected, and the text as it is
            text = f"internal error; please report it:\n{traceback.format_exc(limit=-3)}"
            await self.send({"kind": "failure", "text": text, "request": kind})

    async def text(self, request: dict[str, Any]) -> None:
        """Replace the text by one that was typed on the base of the present revision."""
        text, revision = request.get("text"), request.get("revision")
        if not isinstance(text, str) or len(text) > MAX_TEXT:
            raise FileError(f"the text has more than {MAX_TEXT} characters; it was not stored")
        _check_characters(text)
        if revision != self.session.draft.revision:
            self.session.broadcast(self.session.state())
            message = {"kind": "failure", "text": OUTDATED}
            self.session.reply(self.send, message)
            return
        if self.session.draft.replace(text, "edit text", typed=True):
            await self.session.changed(self.send)
        else:
            self.session.confirm(self.send)

    async def edit(self, request: dict[str, Any]) -> None:
        """Change the text as the drawing requests."""
        before, revision = self.session.draft.text, request.get("revision")
        if revision != self.session.draft.revision:
            raise FileError(MEANWHILE)
        text = await _applied(before, request.get("operations"))
        if revision != self.session.draft.revision:
            raise FileError(MEANWHILE)
        if len(text) > MAX_TEXT:
            raise FileError(f"the text would have more than {MAX_TEXT} characters")
        _check_characters(text)
        label = request.get("label")
        if self.session.draft.replace(text, str(label)[:60] if label else "draw"):
            await self.session.changed()
        else:
            self.session.reply(self.send, self.session.state())

    def preview(self, request: dict[str, Any]) -> None:
        """Show an analysis without writing it; that of the text without a type."""
        kind, fields = request.get("type"), request.get("fields") or {}
        if kind is None:
            self.session.show_analysis(None)
            return
        if not isinstance(kind, str) or not isinstance(fields, dict):
            raise FileError("an analysis has a type and a table of fields")
        text = self.session.draft.text
        shown = analysis_fields(TextEdits(text).data, kind, fields)
        apply(text, [section_operation("analysis", shown)])
        self.session.show_analysis(shown)

    async def write_preview(self, request: dict[str, Any]) -> None:
        """Write the analysis that is shown into the text."""
        preview = self.session.preview
        if preview.fields is None:
            raise FileError("the analysis of the text is shown; there is nothing to write")
        text = preview.apply(self.session.draft.text)
        preview.set(None)
        self.session.broadcast(preview.message())
        if self.session.draft.replace(text, "set analysis"):
            await self.session.changed()

    async def undo(self, request: dict[str, Any]) -> None:
        """Revert the last change."""
        if self.session.draft.undo():
            await self.session.changed()
        else:
            self.session.reply(self.send, self.session.state())

    async def redo(self, request: dict[str, Any]) -> None:
        """Repeat the change that was reverted."""
        if self.session.draft.redo():
            await self.session.changed()
        else:
            self.session.reply(self.send, self.session.state())

    def save(self, request: dict[str, Any]) -> None:
        """Write the file."""
        target = _path(request)
        if target is not None and not str(target).isprintable():
            raise FileError(f"{str(target)!r}: contains hidden characters; use another name")
        saved, companions = self.session.save(target, request.get("replace") is True)
        also = f", with {', '.join(companions.copied)}" if companions.copied else ""
        self.session.broadcast({"kind": "notice", "text": f"saved {saved}{also}"})
        if companions.refused:
            self.session.broadcast({"kind": "failure", "text": "; ".join(companions.refused)})

    def export(self, request: dict[str, Any]) -> None:
        """Write a file of another kind for download."""
        to, share = request.get("to"), request.get("share")
        usable = isinstance(share, (int, float)) and 0 <= share <= 1
        self.session.export(str(to), float(share) if usable else 0.0, self.send)  # type: ignore[arg-type]

    async def reload(self, request: dict[str, Any]) -> None:
        """Read the file again."""
        if self.session.draft.reload():
            await self.session.changed()

    def open(self, request: dict[str, Any]) -> None:
        """Edit another file, an example, or a new model."""
        example = request.get("example")
        if isinstance(example, str) and re.fullmatch(r"\w+", example):
            text = read_text(example_folder() / f"{example}.toml")
            self.session.open(None, text, example_folder())
        elif request.get("structure") is True or request.get("dimension") == 3:
            key = request.get("structure") is True, request.get("dimension") == 3
            self.session.open(None, NEW[key])
        else:
            self.session.open(_path(request))


async def _applied(text: str, operations: Any) -> str:
    """The text after the operations of a change; that of a long one is computed in a thread."""
    if len(text) > LONG:
        return await in_thread(lambda: apply(text, operations))
    return apply(text, operations)


def _path(request: dict[str, Any]) -> Path | None:
    """Path that a request names; None if it names none."""
    path = request.get("path")
    if not isinstance(path, str) or not path:
        return None
    try:
        target = Path(path).expanduser()
        target.resolve().exists()
    except (OSError, RuntimeError, ValueError) as error:  # an unknown user, a too long name
        reason = getattr(error, "strerror", None) or error
        raise FileError(f"{path[:80]!r}: is no path ({reason})") from None
    return target


def _check_characters(text: str) -> None:
    """Refuse halves of pairs of UTF-16, which no file can contain."""
    try:
        text.encode()
    except UnicodeEncodeError as error:
        raise FileError(f"character {error.start} of the text is no character; remove it") from None
