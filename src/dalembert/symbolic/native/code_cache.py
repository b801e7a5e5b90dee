"""Machine code kept on disk: made once, found again by its content, never loaded damaged.

A file is named by the hash of the C text it was made of and of all else that it depends on, so that
a file found is the right one and a changed model makes a new one. Values of parameters are
arguments of the function and no part of the text. The folder is ``$DALEMBERT_CACHE``, else
``$XDG_CACHE_HOME/dalembert``, else ``~/.cache/dalembert``, else, without a home folder, one of the
user among temporary files; ``clear_cache`` empties it. Machine code is loaded only from a folder in
which nobody else may write.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from dalembert.errors import FileError, UnsupportedError
from dalembert.files import atomic_path
from dalembert.symbolic.native.toolchain import Call, Toolchain

KEPT = 1 << 30
"""Bytes of files kept; those unused for longest go first."""
SUFFIXES = (".so", ".dll", ".dylib", ".o")
SEAL = ".sha256"
REMEDY = "set DALEMBERT_CACHE to a folder of your own, or use backend='vm'"


def cache_folder() -> Path:
    """Where compiled functions are kept."""
    if asked := os.environ.get("DALEMBERT_CACHE"):
        with suppress(RuntimeError):  # a home folder that is not known stays as written
            return Path(asked).expanduser()
        return Path(asked)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "dalembert"
    try:
        return Path.home() / ".cache" / "dalembert"
    except RuntimeError:  # there is none
        user = os.getuid() if hasattr(os, "getuid") else "user"
        return Path(tempfile.gettempdir()) / f"dalembert-{user}"


def check_folder(folder: Path) -> None:
    """Refuse a folder in which others may put machine code.

    Raises
    ------
    UnsupportedError
        It belongs to another user, or others may write in it.
    """
    if os.name != "posix":
        return
    try:
        about = folder.stat()
    except FileNotFoundError:
        return
    except OSError as error:
        reason = error.strerror or error
        raise UnsupportedError(f"the cache {folder} cannot be read ({reason}); {REMEDY}") from None
    mode = stat.S_IMODE(about.st_mode)
    if about.st_uid not in (os.geteuid(), 0):
        raise UnsupportedError(f"the cache {folder} belongs to another user; {REMEDY}")
    if mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise UnsupportedError(
            f"others may write in the cache {folder} (mode {mode:o}), whose machine code would be "
            f"run; use chmod 700, or {REMEDY}"
        )


def clear_cache() -> int:
    """Delete all compiled functions; they are made again when needed.

    Returns
    -------
    int
        How many were deleted.

    Examples
    --------
    >>> import os, tempfile
    >>> import dalembert as da
    >>> kept = os.environ.get("DALEMBERT_CACHE", "")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     os.environ["DALEMBERT_CACHE"] = folder  # instead of what all programs of the user share
    ...     deleted = da.clear_cache()
    >>> os.environ["DALEMBERT_CACHE"] = kept
    >>> deleted  # nothing had been compiled into it
    0
    """
    found = list(_kept(cache_folder()))
    for path in found:
        _delete(path)
    return len(found)


def cache_size() -> tuple[int, int]:
    """How many compiled functions are kept, and their bytes."""
    sizes = []
    for path in _kept(cache_folder()):
        with suppress(OSError):  # another process may have deleted it
            sizes.append(path.stat().st_size)
    return len(sizes), sum(sizes)


def kept_path(text: str, toolchain: Toolchain) -> Path:
    """Where the machine code of this text belongs."""
    import casadi as ca  # needed here only: who just builds does without

    about = (*toolchain.identity, ca.CasadiMeta.version(), sys.platform, platform.machine())
    key = "\n".join([*about, text])
    return cache_folder() / f"{hashlib.sha256(key.encode()).hexdigest()[:40]}{toolchain.suffix}"


def is_whole(path: Path) -> bool:
    """The file is there as it was written: loading a damaged one would end the process."""
    try:
        if not all(stat.S_ISREG(os.stat(file).st_mode) for file in (path, _seal(path))):
            return False  # reading a pipe would wait for who writes into it
        return _seal(path).read_text() == hashlib.sha256(path.read_bytes()).hexdigest()
    except (OSError, UnicodeDecodeError):
        return False


def kept(text: str, toolchain: Toolchain) -> Call | None:
    """The loop of this text if it is in the cache, and nobody else may write there."""
    path = kept_path(text, toolchain)
    try:
        check_folder(path.parent)
    except UnsupportedError:
        return None
    if is_whole(path):
        with suppress(OSError):
            os.utime(path)
            return toolchain.load(path)
    return None


def made(text: str, toolchain: Toolchain) -> Call:
    """The loop of this text, compiled now if it is not in the cache.

    Raises
    ------
    UnsupportedError
        It cannot be compiled, or the cache cannot be written.
    """
    found = kept(text, toolchain)
    if found is None:
        build(text, toolchain)
        found = toolchain.load(kept_path(text, toolchain))
    return found


def build(text: str, toolchain: Toolchain, path: Path | None = None) -> None:
    """Compile beside the target and move it there: two processes at once do no harm.

    Raises
    ------
    UnsupportedError
        It cannot be compiled, or the cache cannot be written.
    """
    path = path or kept_path(text, toolchain)
    check_folder(path.parent)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        _clear_place(path)
        with atomic_path(path) as temporary:
            toolchain.build(text, temporary)
            digest = hashlib.sha256(temporary.read_bytes()).hexdigest()
        with atomic_path(_seal(path)) as temporary:
            temporary.write_text(digest)
    except (FileError, OSError) as error:
        raise UnsupportedError(
            f"backend {toolchain.backend!r}: the cache {path.parent} cannot be written ({error}); "
            "set DALEMBERT_CACHE to another folder, or use backend='vm'"
        ) from None
    _forget_oldest(path.parent)


def _kept(folder: Path) -> Iterator[Path]:
    return (path for suffix in SUFFIXES for path in folder.glob(f"[!.]*{suffix}"))


def _seal(path: Path) -> Path:
    """File with the checksum of another."""
    return path.with_suffix(SEAL)


def _forget_oldest(folder: Path) -> None:
    total, aged = 0, []
    for path in _kept(folder):
        with suppress(OSError):  # another process may have deleted it
            aged.append((path.stat().st_mtime, path.stat().st_size, path))
    for _, size, path in sorted(aged, reverse=True):
        total += size
        if total > KEPT:
            _delete(path)


def _clear_place(path: Path) -> None:
    """Remove what is no regular file where machine code and its checksum belong."""
    for file in (path, _seal(path)):
        if file.is_dir() and not file.is_symlink():
            shutil.rmtree(file)
        elif file.is_symlink() or (file.exists() and not file.is_file()):
            file.unlink()


def _delete(path: Path) -> None:
    for file in (_seal(path), path):
        with suppress(OSError):
            file.unlink(missing_ok=True)
