"""Files appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from dalembert.errors import FileError


@contextmanager
def atomic_path(target: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary path beside ``target`` that becomes it on success and vanishes on failure.

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
        handle, name = tempfile.mkstemp(
            prefix=f".{target.stem}-", suffix=target.suffix, dir=target.parent
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


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
