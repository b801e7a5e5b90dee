"""Reading of regular files of reasonable size."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from dalembert.budget import check_budget
from dalembert.errors import FileError

WEIGHT = 200
"""Memory per byte of a model, a table or a deck [bytes]."""
KINDS = {
    stat.S_IFDIR: "a folder; give the name of a file in it",
    stat.S_IFIFO: "a named pipe and no regular file; copy what it holds into one",
    stat.S_IFSOCK: "a socket and no regular file",
    stat.S_IFCHR: "a device and no regular file",
    stat.S_IFBLK: "a device and no regular file",
}


def readable(path: str | Path, weight: float) -> int:
    """Size of a regular file [bytes]; zero for virtual files, as in ``/proc``.

    Parameters
    ----------
    path : of the file
    weight : memory per byte of the file [bytes]

    Raises
    ------
    FileError
        Missing, or of another kind.
    BudgetError
        Too large.
    """
    try:
        status = os.stat(path)
    except FileNotFoundError:
        raise FileError(f"{path}: no such file; check the name and the folder") from None
    except (OSError, ValueError) as error:  # circular links, invalid name
        reason = getattr(error, "strerror", None) or error
        raise FileError(f"{str(path)[:200]!r}: cannot be read ({reason})") from None
    if not stat.S_ISREG(status.st_mode):
        kind = KINDS.get(stat.S_IFMT(status.st_mode), "no regular file")
        raise FileError(f"{path}: is {kind}")
    reading = f"{path}: to read its {status.st_size} bytes"
    check_budget(reading, memory=weight * status.st_size, cure="check that it is the file you mean")
    return status.st_size


def read_text(path: str | Path) -> str:
    """The text of a file of reasonable size.

    Raises
    ------
    FileError
        Missing, of another kind, unreadable or not UTF-8.
    BudgetError
        Too large.
    """
    size = readable(path, WEIGHT)
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(size)  # ignores what is appended meanwhile
        return data.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        raise FileError(
            f"{path}: byte {error.start} is not UTF-8 text; save the file as UTF-8"
        ) from None
    except OSError as error:
        raise FileError(f"{path}: cannot be read ({error.strerror or error})") from None
