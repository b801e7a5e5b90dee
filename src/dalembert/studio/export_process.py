"""Exports in a process of their own, whose files are downloaded once they are complete."""

from __future__ import annotations

import shutil
import tempfile
import threading
import traceback
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError, FileError
from dalembert.studio.child import begin_child, child_context
from dalembert.studio.exporting import CHOICES, ExportRequest, write_export

Report = Callable[[dict[str, Any]], None]
KEPT = 8
"""Number of files that can be downloaded."""


class Exports:
    """Exports of one session."""

    def __init__(self) -> None:
        self.files: dict[int, Path] = {}
        """Number of an export → its file."""
        self._folder: Path | None = None
        self._number = 0
        self._processes: dict[int, Any] = {}

    def start(self, to: str, text: str, path: Path, share: float, report: Report) -> int:
        """Begin an export; returns its number.

        Parameters
        ----------
        to : kind of file
        text, path : of the model file
        share : instant of a picture as a fraction of the motion
        report : called in a thread with messages for the page

        Raises
        ------
        FileError
            Unknown kind, or another export runs.
        """
        if to not in CHOICES:
            raise FileError("unknown kind of file; reload the page")
        if self._processes:
            raise FileError("an export is running; wait for it, or stop it")
        if self._folder is None:
            self._folder = Path(tempfile.mkdtemp(prefix="dalembert-studio-"))
        self._number += 1
        folder = self._folder / str(self._number)
        folder.mkdir()
        context = child_context()
        receiver, sender = context.Pipe(duplex=False)
        request = ExportRequest(to, text, path, share, folder)
        process = context.Process(target=work, args=(sender, request), daemon=True)
        process.start()
        sender.close()
        self._processes[self._number] = process
        arguments = (self._number, receiver, report)
        threading.Thread(target=self._follow, args=arguments, daemon=True).start()
        return self._number

    def stop(self) -> None:
        """End a running export; its files are deleted."""
        for process in list(self._processes.values()):
            process.kill()

    def close(self) -> None:
        """End a running export and delete all files."""
        self.stop()
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    def _follow(self, number: int, receiver: Connection, report: Report) -> None:
        """Send the messages of the process to the page."""
        last: dict[str, Any] = {"state": "stopped"}
        with suppress(EOFError, OSError):
            while True:
                last = receiver.recv()
                if last["state"] != "progress":
                    break
                report({"kind": "export", "number": number} | last)
        process = self._processes.pop(number)
        process.join(5.0)
        if last["state"] == "done":
            path = Path(last.pop("path"))
            self.files[number] = path
            for old in sorted(self.files)[:-KEPT]:
                shutil.rmtree(self.files.pop(old).parent, ignore_errors=True)
            last |= {"address": f"export/{number}", "name": path.name}
        elif last["state"] != "failed":
            last = {"state": "stopped"}
        if last["state"] != "done" and self._folder is not None:
            shutil.rmtree(self._folder / str(number), ignore_errors=True)
        report({"kind": "export", "number": number} | last)


def work(sender: Connection, request: ExportRequest) -> None:
    """Export in the process: messages of progress, then of the file or the error."""
    begin_child()

    def progress(share: float) -> None:
        sender.send({"state": "progress", "share": share})

    try:
        path, omissions = write_export(request, progress)
        sender.send({"state": "done", "path": str(path), "omissions": omissions})
    except DalembertError as error:
        text = str(error).replace(f"{request.path}: ", "").replace(f"{request.folder}/", "")
        sender.send({"state": "failed", "text": text})
    except Exception:
        text = f"internal error; please report it:\n{traceback.format_exc(limit=-3)}"
        sender.send({"state": "failed", "text": text})
