"""Unsaved changes of drafts on disk, so that they survive the end of the program.

Every draft that is edited has a file of its own with a random name, and locks another one, in
``$XDG_STATE_HOME/dalembert/studio``, else ``~/.local/state/dalembert/studio``. A draft whose
process has ended, or edits another file, is offered when its file is opened again.
"""

from __future__ import annotations

import hashlib
import json
import os
import secrets
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dalembert.errors import FileError
from dalembert.files import atomic_path, locked_file

KEPT = 30 * 24 * 3600.0
"""Age at which a draft is deleted when another file is opened [s]."""

PATIENCE = 2.0
"""Time to wait for another program that saves the same file [s]."""

LOCK = ".lock"
"""Suffix of the file that a process locks while it edits."""


def journal_folder() -> Path:
    """Folder of the drafts of this user."""
    base = os.environ.get("XDG_STATE_HOME")
    return (Path(base) if base else Path.home() / ".local" / "state") / "dalembert" / "studio"


@dataclass(frozen=True)
class Recovered:
    """An unsaved text of a process that has ended.

    Attributes
    ----------
    text : of the draft
    time : of its last change, seconds since 1970
    file : of the journal
    """

    text: str
    time: float
    file: Path


class Journal:
    """Unsaved text of one draft.

    Parameters
    ----------
    path : of the model file; None for a draft without one
    folder : of the drafts; that of the user by default
    """

    def __init__(self, path: Path | None, folder: Path | None = None):
        self.path = path
        self.folder = journal_folder() if folder is None else folder
        self.file = self.folder / f"{_key(path)}-{secrets.token_hex(8)}.json"
        self._lock = None
        with suppress(OSError):  # ``write`` reports a folder that cannot be written
            self.folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            self._lock = locked_file(self.file.with_suffix(LOCK))

    def write(self, text: str) -> None:
        """Store the text.

        Raises
        ------
        FileError
            The folder cannot be written.
        """
        data = {"path": str(self.path or ""), "text": text}
        with atomic_path(self.file) as temporary:
            temporary.write_text(json.dumps(data | {"time": time.time()}), encoding="utf-8")

    def clear(self) -> None:
        """Delete the text, which is saved."""
        with suppress(OSError):
            self.file.unlink(missing_ok=True)

    def close(self) -> None:
        """Release the draft; a text that is not saved remains for the next process."""
        if self._lock is not None:
            self._lock.close()
            self.file.with_suffix(LOCK).unlink(missing_ok=True)

    def left_over(self) -> list[Recovered]:
        """Texts of this draft by processes that have ended, the newest last."""
        return sorted(self._left_over(), key=lambda draft: draft.time)

    def _left_over(self) -> Iterator[Recovered]:
        for file in self.folder.glob("*.json"):
            data = _load(file)
            if data is None or file == self.file or not _is_free(file.with_suffix(LOCK)):
                continue
            if file.name.startswith(f"{_key(self.path)}-"):
                yield Recovered(data["text"], data["time"], file)
            elif time.time() - data["time"] > KEPT:
                file.unlink(missing_ok=True)


@contextmanager
def saving(path: Path, folder: Path | None = None) -> Iterator[None]:
    """Exclude other programs from saving a file meanwhile.

    Parameters
    ----------
    path : of the file
    folder : of the drafts; that of the user by default

    Raises
    ------
    FileError
        Another one is saving it.
    """
    lock = None
    file = (journal_folder() if folder is None else folder) / f"{_key(path)}.saving"
    with suppress(OSError):  # without such a folder, nothing is excluded
        end = time.monotonic() + PATIENCE
        while (lock := locked_file(file)) is None:
            if time.monotonic() > end:
                raise FileError(f"{path}: another program is saving it; save once more")
            time.sleep(0.02)
    try:
        yield
    finally:
        if lock is not None:
            lock.close()


def _load(file: Path) -> dict[str, Any] | None:
    """Contents of a journal; None for a damaged one."""
    kinds = {"path": str, "text": str, "time": float}
    with suppress(OSError, ValueError):
        data = json.loads(file.read_text(encoding="utf-8"))
        if isinstance(data, dict) and all(isinstance(data.get(k), t) for k, t in kinds.items()):
            return data
    return None


def _is_free(path: Path) -> bool:
    """Whether no process has locked a file; it is deleted then."""
    lock = locked_file(path)
    if lock is None:
        return False
    lock.close()
    path.unlink(missing_ok=True)
    return True


def _key(path: Path | None) -> str:
    return hashlib.sha256(str(path or "").encode("utf-8", "surrogatepass")).hexdigest()[:16]
