"""Reading of regular files and atomic writing of files."""

from __future__ import annotations

import functools
import os
import platform
import re
import stat
import tempfile
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from dalembert.budget import check_budget
from dalembert.errors import FileError

WEIGHT = 200
"""Memory per byte of a model, a table or a deck [bytes]."""
KINDS = {
    stat.S_IFDIR: "a folder; give the name of a file in it",
    stat.S_IFIFO: "a named pipe, not a regular file; copy its content to a file",
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


LONGEST_STEM = 100
"""Upper limit of the part of a name in its temporary name [bytes]; systems allow 255 in all."""
ABANDONED = 24 * 3600.0
"""Age at which a temporary file of another machine counts as abandoned [s]."""
TEMPORARY = re.compile(r"\..*-dalembert-([0-9a-f]{8})-([0-9]+)-\w+(\..*)?", re.DOTALL)


@contextmanager
def atomic_path(target: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``target``, renamed to it on success and deleted on failure.

    Temporary files of processes that were killed are deleted when a process first writes to a
    folder.

    Raises
    ------
    FileError
        The folder is missing or cannot be written, or the target is no regular file.
    """
    target = Path(target)
    try:
        if target.is_dir():
            raise FileError(f"{target}: is a folder; give a file name")
        if target.exists() and not target.is_file():
            raise FileError(f"{target}: is no regular file, and would be replaced; give another")
        clear_left_over(target.parent.resolve())
        handle, name = tempfile.mkstemp(
            prefix=f".{_stem(target)}-dalembert-{_machine()}-{os.getpid()}-",
            suffix=target.suffix,
            dir=target.parent,
        )
    except (OSError, ValueError) as error:  # ValueError: a name with a null character
        reason = getattr(error, "strerror", None) or error
        raise FileError(f"{target}: cannot be written ({reason}); choose another folder") from None
    os.close(handle)
    temporary = Path(name)
    try:
        yield temporary
        os.chmod(temporary, _mode(target))
        os.replace(temporary, target)
    except OSError as error:
        raise FileError(f"{target}: cannot be written ({error.strerror or error})") from None
    finally:
        temporary.unlink(missing_ok=True)


@functools.lru_cache(1024)
def clear_left_over(folder: Path) -> None:
    """Delete temporary files whose processes have ended, once per process and folder."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            match = TEMPORARY.fullmatch(entry.name)
            if match is None:
                continue
            with suppress(OSError):  # another process may have deleted it
                if not entry.is_file(follow_symlinks=False):
                    continue
                if match[1] == _machine() and os.name == "posix":
                    abandoned = not _is_running(int(match[2]))
                else:
                    abandoned = time.time() - entry.stat().st_mtime > ABANDONED
                if abandoned:
                    os.unlink(entry.path)


def locked_file(path: Path) -> IO[str] | None:
    """A file opened and locked by this process, until it is closed or the process ends.

    Returns
    -------
    None if another process has locked it; systems without locks always open it
    """
    file = path.open("w")
    try:
        if os.name == "nt":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
        else:
            import fcntl

            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except ImportError:
        pass
    except OSError:
        file.close()
        return None
    return file


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # a process of another user
        return True
    return True


def _stem(target: Path) -> str:
    """The stem of the name, shortened to the limit."""
    stem = target.stem
    while len(os.fsencode(stem)) > LONGEST_STEM:
        stem = stem[:-1]
    return stem


@functools.cache
def _machine() -> str:
    """Eight characters that identify this machine among those that share a folder."""
    return f"{zlib.crc32(platform.node().encode('utf-8', 'replace')):08x}"


def _mode(target: Path) -> int:
    """Permissions of a file: those that it has, or the usual ones of a new file."""
    try:
        return stat.S_IMODE(target.stat().st_mode)
    except OSError:
        return 0o666 & ~_umask()


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
