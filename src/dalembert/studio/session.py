"""One model file that is edited: its draft, its pictures and the pages that show it."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError, FileError
from dalembert.studio.assembly_feed import AssemblyFeed
from dalembert.studio.companions import Companions, copy_companions
from dalembert.studio.draft import Draft
from dalembert.studio.drawn_document import DrawnDocument
from dalembert.studio.event_loop import in_loop
from dalembert.studio.export_process import Exports
from dalembert.studio.journal import Journal, Recovered, saving
from dalembert.studio.listed_files import listed_files
from dalembert.studio.new_models import UNTITLED
from dalembert.studio.photos import Photos
from dalembert.studio.picture_feed import PictureFeed
from dalembert.studio.preview import Preview
from dalembert.studio.recent_files import remember
from dalembert.studio.tasks import Tasks

Send = Callable[[dict[str, Any]], Awaitable[None]]

RESTORED = "unsaved changes were restored; undo returns to the file"
MAX_TEXT = 2_000_000
"""Upper limit of the length of a text [characters]."""


class Session:
    """A draft, shown by any number of pages.

    Parameters
    ----------
    path : of the model file; None for a new model
    journals : folder of the unsaved drafts; that of the user by default

    Raises
    ------
    FileError
        The file cannot be read.
    """

    def __init__(self, path: Path | None, journals: Path | None = None):
        self.draft = Draft(path, UNTITLED)
        self.journal = Journal(self.draft.path, journals)
        self._journals = journals
        self.photos = Photos(journals)
        self.exports = Exports()
        self._is_stored = True
        self._folder: Path | None = None
        self.opened = 0  # files after the first one
        self._document = DrawnDocument()
        self._clients: list[Send] = []
        self._tasks: set[asyncio.Task[None]] = set()
        self.tasks = Tasks()
        self.preview = Preview()
        self.assemblies = AssemblyFeed(self.broadcast)
        self.pictures = PictureFeed(
            self.broadcast, lambda problems: self.preview.in_text(problems, self.draft.text)
        )

    def start(self) -> None:
        """Start the building processes; call inside the event loop."""
        self.tasks.report = in_loop(self._show_task)
        self.pictures.start()
        self.recovered = self._recover()
        if self.draft.path is not None:
            remember(self.draft.path, self._journals)
        self.build()

    def open(self, path: Path | None, text: str = UNTITLED, folder: Path | None = None) -> None:
        """Edit another model; unsaved changes of the former one remain in the journal.

        Parameters
        ----------
        path : of the model file; None for a new model
        text : of the new model
        folder : of the files that the new model reads; the present one by default

        Raises
        ------
        FileError, BudgetError
            The file cannot be read; the former model stays.
        """
        draft = Draft(path, text)
        revision = self.draft.revision + 1
        self._folder = folder
        self.opened += 1
        self.journal.close()
        self.draft, self.journal = draft, Journal(draft.path, self._journals)
        draft.revision = revision  # pages compare revisions
        if path is not None and draft.path is not None:
            remember(draft.path, self._journals)
        self.recovered = self._recover() if path is not None else None
        self.preview.set(None)
        for message in (self.state(), self.preview.message()):
            self.broadcast(message)
        if self.recovered is not None:
            self.broadcast({"kind": "notice", "text": RESTORED})
        self.build()

    def files(self) -> dict[str, Any]:
        """Model files that can be opened, as a message."""
        folder = self.draft.path.parent if self.draft.path is not None else Path.cwd()
        return {"kind": "files"} | listed_files(folder, self._journals)

    def export(self, to: str, share: float, send: Send) -> None:
        """Write the text as a file of another kind, in a process of its own.

        Raises
        ------
        FileError
            Unknown kind, or another export runs.
        """
        report = in_loop(partial(self.reply, send))
        number = self.exports.start(to, self.draft.text, self.place, share, report)
        self.reply(send, {"kind": "export", "number": number, "state": "progress", "share": 0.0})

    def close(self) -> None:
        """End the processes; a draft with unsaved changes remains in the journal."""
        self.pictures.close()
        self.assemblies.close()
        self.exports.close()
        self.tasks.close()
        self.journal.close()

    def _recover(self) -> Recovered | None:
        """Continue with the unsaved texts of processes that have ended."""
        left = self.journal.left_over()
        changes = [self.draft.replace(each.text, "recover unsaved changes") for each in left]
        self._store()
        if self._is_stored:  # older texts can be reached by undo
            for each in left:
                each.file.unlink(missing_ok=True)
        return left[-1] if any(changes) and self.draft.is_changed else None

    @property
    def place(self) -> Path:
        """Path of the file, or that of a new model beside the files that it reads."""
        return self.draft.path or (self._folder or Path.cwd()) / self.draft.name

    def build(self) -> None:
        """Make pictures of the present text, with the analysis of the preview."""
        text = self.preview.apply(self.draft.text)
        self.pictures.build(text, self.place, self.draft.revision)
        self.assemblies.build(self.draft.text, self.place, self.draft.revision)

    def show_assemblies(self, shown: bool) -> None:
        """Search the other configurations after every change, or no longer."""
        self.assemblies.shown = shown
        self.assemblies.build(self.draft.text, self.place, self.draft.revision)

    def show_analysis(self, fields: dict[str, Any] | None) -> None:
        """Show another analysis than that of the text; None shows that of the text."""
        if self.preview.set(fields):
            self.broadcast(self.preview.message())
            self.build()

    def start_task(self, section: Any) -> None:
        """Run a design task of the present text in a process of its own.

        Raises
        ------
        ModelError
            Unknown section, or another task runs.
        """
        draft = self.draft
        state = self.tasks.start(section, draft.text, self.place)
        self.broadcast(state.message())

    def _show_task(self, number: int) -> None:
        state = self.tasks.state(number)
        if state is not None:
            self.broadcast(state.message())

    def state(self) -> dict[str, Any]:
        """The text and the state of its file, as a message."""
        draft = self.draft
        return {
            "kind": "text",
            "revision": draft.revision,
            "opened": self.opened,
            "text": draft.text,
            "digest": draft.digest,
            "name": draft.name,
            "path": str(draft.path or ""),
            "changed": draft.is_changed,
            "undo": draft.undo_label,
            "redo": draft.redo_label,
            "document": self._document.of(draft),
        }

    @property
    def photo_name(self) -> str:
        """Name under which the photo of the draft is stored."""
        return str(self.draft.path or self.draft.name)

    async def attach(self, send: Send) -> None:
        """Show the draft on a page."""
        self._clients.append(send)
        await send(self.state())
        if self.recovered is not None:
            await send({"kind": "notice", "text": RESTORED})
        shown = (*self.pictures.present(), *self.assemblies.present(), *self.tasks.messages())
        for message in (*shown, self.preview.message()):
            await send(message)

    def detach(self, send: Send) -> None:
        """Stop showing the draft on a page."""
        self._clients.remove(send)

    def broadcast(self, message: dict[str, Any], but: Send | None = None) -> None:
        """Send a message to all pages."""
        for send in self._clients:
            if send != but:  # bound methods are equal, not identical
                self.reply(send, message)

    def reply(self, send: Send, message: dict[str, Any]) -> None:
        """Send a message to one page."""
        task = asyncio.ensure_future(_delivery(send, message))
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def changed(self, origin: Send | None = None) -> None:
        """Store and show the text after a change.

        Parameters
        ----------
        origin : page that has the new text already
        """
        self._store()
        await self._document.read(self.draft)
        self.broadcast(self.state(), origin)
        if origin is not None:
            self.confirm(origin)
        self.build()

    def _store(self) -> None:
        """Store unsaved changes; pages are warned once if they cannot be stored."""
        try:
            if self.draft.is_changed:
                self.journal.write(self.draft.text)
            else:
                self.journal.clear()
            self._is_stored = True
        except FileError as error:
            if self._is_stored:
                text = f"unsaved changes would be lost with the program: {error}"
                self.broadcast({"kind": "failure", "text": text})
            self._is_stored = False

    def confirm(self, origin: Send) -> None:
        """Send a page the state of the file, without the text that it has."""
        self.reply(origin, self.state() | {"text": None})

    def save(self, path: Path | None, replace: bool) -> tuple[Path, Companions]:
        """Write the draft to its file, or to another one; files that it names go with it.

        Returns
        -------
        tuple of Path and Companions
            File, and the files that it names.

        Raises
        ------
        FileError
            As ``Draft.save``.
        """
        former, name, source = self.journal, self.photo_name, self.place.parent
        target = self.draft.path if path is None else path.resolve()
        with saving(target or Path.cwd(), self._journals):
            saved = self.draft.save(path, replace)
        if saved != former.path:
            self.journal = Journal(saved, self._journals)
            former.clear()
            former.close()
            self.photos.copy(name, self.photo_name)
            if former.path is None:  # the next new model begins without it
                self.photos.remove(name)
        else:
            former.clear()
        remember(saved, self._journals)
        companions = copy_companions(self._document.of(self.draft), source, saved.parent)
        self.broadcast(self.state())
        return saved, companions


async def _delivery(send: Send, message: dict[str, Any]) -> None:
    with suppress(Exception):  # the page has been closed
        await send(message)


def failure(error: DalembertError) -> dict[str, Any]:
    """Message about a request that could not be carried out."""
    return {"kind": "failure", "text": str(error)}
