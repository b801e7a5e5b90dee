"""Files appear whole or not at all."""

from __future__ import annotations

import functools
import os
import platform
import re
import tempfile
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from dalembert.errors import FileError

LONGEST_STEM = 100
"""Characters of a name that its temporary file repeats; systems allow 255 bytes in all."""
ABANDONED = 24 * 3600.0
"""Seconds after which a temporary file of another machine is left over."""
TEMPORARY = re.compile(r"\..*-dalembert-([0-9a-f]{8})-([0-9]+)-\w+(\.\w+)?", re.DOTALL)


@contextmanager
def atomic_path(target: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``target`` that becomes it on success and vanishes on failure.

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
        os.chmod(temporary, 0o666 & ~_umask())
        os.replace(temporary, target)
    except OSError as error:
        raise FileError(f"{target}: cannot be written ({error.strerror or error})") from None
    finally:
        temporary.unlink(missing_ok=True)


@functools.lru_cache(1024)
def clear_left_over(folder: Path) -> None:
    """Delete temporary files in a folder whose processes have ended; once in a process."""
    with suppress(OSError), os.scandir(folder) as entries:
        for entry in entries:
            found = TEMPORARY.fullmatch(entry.name)
            if found is None:
                continue
            with suppress(OSError):  # another process may have deleted it
                if not entry.is_file(follow_symlinks=False):
                    continue
                if found[1] == _machine() and os.name == "posix":
                    left_over = not _is_running(int(found[2]))
                else:
                    left_over = time.time() - entry.stat().st_mtime > ABANDONED
                if left_over:
                    os.unlink(entry.path)


def _is_running(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # of another user
        return True
    return True


def _stem(target: Path) -> str:
    """The name in few bytes."""
    stem = target.stem
    while len(os.fsencode(stem)) > LONGEST_STEM:
        stem = stem[:-1]
    return stem


@functools.cache
def _machine() -> str:
    """Eight characters that tell machines apart, which may write to one folder."""
    return f"{zlib.crc32(platform.node().encode('utf-8', 'replace')):08x}"


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
