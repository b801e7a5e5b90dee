"""The text of a model file while it is edited: undo, redo, saving without losing other changes."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path

from dalembert.errors import FileError
from dalembert.files import atomic_path, readable
from dalembert.studio.common_ends import common_ends

PAUSE = 1.0
"""Typed changes within this time of each other are undone together [s]."""
WEIGHT = 50
"""Memory per byte of a file [bytes]."""
BOM = b"\xef\xbb\xbf"


@dataclass(frozen=True)
class Change:
    """Replacement in a text that returns the text before a change, or after one.

    Attributes
    ----------
    start : of the replaced characters
    length : their number
    text : in their place
    label : description of the change, such as ``add bar``
    typed : whether it was typed into the text
    """

    start: int
    length: int
    text: str
    label: str
    typed: bool = False

    @classmethod
    def between(cls, now: str, other: str, label: str, typed: bool = False) -> Change:
        """Change that turns the present text into another one."""
        start, tail = common_ends(now, other)
        return cls(start, len(now) - tail - start, other[start : len(other) - tail], label, typed)

    def apply(self, text: str) -> str:
        """The other text."""
        return text[: self.start] + self.text + text[self.start + self.length :]


def digest(text: str) -> str:
    """Short hash of a text, by which pages compare it with others."""
    return blake2b(text.encode(), digest_size=8).hexdigest()


class Draft:
    """A text with its history, and the file that it is saved to.

    Parameters
    ----------
    path : of the file; None for a draft without one
    text : of a draft without a file
    clock : seconds, for the grouping of typed changes

    Raises
    ------
    FileError, BudgetError
        The file cannot be read.

    Attributes
    ----------
    revision : number of the text; every change increases it
    """

    def __init__(
        self, path: Path | None, text: str = "", clock: Callable[[], float] = time.monotonic
    ):
        self.path = path.resolve() if path is not None else None
        self.revision = 0
        self._clock = clock
        self._undo: list[Change] = []
        self._redo: list[Change] = []
        self._typed_at = -PAUSE
        self._disk = b"" if self.path is None else _read(self.path)
        self._identity = _identity(self.path)
        self._newline = "\r\n" if b"\r\n" in self._disk else "\n"
        self._loaded = (self._disk, text if self.path is None else _decode(self._disk, self.path))
        self.text = self.saved_text = self._loaded[1]

    @property
    def name(self) -> str:
        """Name of the file."""
        return self.path.name if self.path is not None else "untitled.toml"

    @property
    def digest(self) -> str:
        """The same for equal texts, whatever their revision."""
        return digest(self.text)

    @property
    def is_changed(self) -> bool:
        """Whether the text differs from the saved one."""
        return self.text != self.saved_text

    @property
    def undo_label(self) -> str:
        """Description of the change that ``undo`` reverts; empty if there is none."""
        return self._undo[-1].label if self._undo else ""

    @property
    def redo_label(self) -> str:
        """Description of the change that ``redo`` repeats; empty if there is none."""
        return self._redo[-1].label if self._redo else ""

    def replace(self, text: str, label: str, typed: bool = False) -> bool:
        """Change the text; returns whether it differs."""
        if text == self.text:
            return False
        now = self._clock()
        joins = typed and self._undo and self._undo[-1].typed and now - self._typed_at < PAUSE
        before = self._undo.pop().apply(self.text) if joins else self.text
        self._undo.append(Change.between(text, before, label, typed))
        self._typed_at = now if typed else -PAUSE
        self._redo.clear()
        self._set(text)
        return True

    def undo(self) -> bool:
        """Revert the last change; returns whether there was one."""
        return self._move(self._undo, self._redo)

    def redo(self) -> bool:
        """Repeat the last change that was reverted; returns whether there was one."""
        return self._move(self._redo, self._undo)

    def _move(self, source: list[Change], target: list[Change]) -> bool:
        if not source:
            return False
        change = source.pop()
        text = change.apply(self.text)
        target.append(Change.between(text, self.text, change.label))
        self._typed_at = -PAUSE
        self._set(text)
        return True

    def _set(self, text: str) -> None:
        self.text = text
        self.revision += 1

    @property
    def is_replaced(self) -> bool:
        """Whether another program has changed or deleted the file since it was read or saved."""
        if self.path is None:
            return False
        try:
            return _read(self.path) != self._disk
        except FileError:
            return True

    def save(self, path: Path | None = None, replace: bool = False) -> Path:
        """Write the text to its file, or to another one, which becomes its file.

        Parameters
        ----------
        path : of another file; its own by default
        replace : overwrite a file that has changed or is write-protected, or another one that
            exists

        Raises
        ------
        Unconfirmed
            The file has been changed, renamed or deleted by another program, is write-protected or
            exists already.
        FileError
            It cannot be written.
        """
        target = self.path if path is None else path.resolve()
        if target is None:
            raise FileError("the model has no file yet; save it under a name")
        if target.suffix.lower() != ".toml":
            raise FileError(f"{target.name}: end the name with .toml")
        if not replace:
            if target != self.path and target.exists():
                raise Unconfirmed(f"{target}: exists already")
            if path is None and not target.exists():
                raise Missing(f"{target}: {self._renamed(target)}")
            if target == self.path and target.exists() and self.is_replaced:
                raise Unconfirmed(f"{target}: has been changed by another program")
            if target.exists() and not target.stat().st_mode & 0o222:
                raise Unconfirmed(f"{target}: is write-protected")
        data = self.encoded()
        with atomic_path(target) as temporary:
            temporary.write_bytes(data)
        self.path, self._disk, self.saved_text = target, data, self.text
        self._identity = _identity(target)
        return target

    def _renamed(self, missing: Path) -> str:
        """What has become of the file that is no longer there."""
        with suppress(OSError):
            for other in missing.parent.iterdir():
                if self._identity is not None and _identity(other) == self._identity:
                    return f"has been renamed to {other.name} by another program"
        return "has been moved, renamed or deleted by another program"

    def reload(self) -> bool:
        """Read the file again; the former text can be restored by ``undo``.

        Raises
        ------
        FileError
            It cannot be read.
        """
        if self.path is None:
            return False
        data = _read(self.path)
        text = _decode(data, self.path)
        self._disk, self._loaded, self.saved_text = data, (data, text), text
        return self.replace(text, "reload the file")

    def encoded(self) -> bytes:
        """Contents of the file: with the line ends of the file that was read."""
        data, text = self._loaded
        if self.text == text:
            return data if data or not text else text.encode()
        mark = BOM if data.startswith(BOM) else b""
        return mark + self.text.replace("\n", self._newline).encode()


class Unconfirmed(FileError):
    """A file that is not replaced without confirmation."""


class Missing(Unconfirmed):
    """The file of the model is no longer there, and is not written again without confirmation."""


def _identity(path: Path | None) -> tuple[int, int] | None:
    """Device and number of a file, which stay when it is renamed."""
    try:
        status = path.stat() if path is not None else None
    except OSError:
        return None
    return (status.st_dev, status.st_ino) if status is not None else None


def _read(path: Path) -> bytes:
    readable(path, WEIGHT)
    try:
        return path.read_bytes()
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror or error})") from None


def _decode(data: bytes, path: Path) -> str:
    try:
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise FileError(
            f"{path}: byte {error.start} is not UTF-8 text; save the file as UTF-8"
        ) from None
