"""Cache of machine code on disk, addressed by content and verified by a checksum.

The name of a file is the hash of its C text and of everything else it depends on. Values of
parameters are arguments of the function and not part of the text. The folder is
``$DALEMBERT_CACHE``, else ``$XDG_CACHE_HOME/dalembert``, else ``~/.cache/dalembert``, else, without
a home folder, a temporary folder of the user; ``clear_cache`` empties it. Machine code is loaded
only from a folder that other users cannot write to.
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
from dalembert.symbolic.native.toolchain import Call, Compiler, NotTranslated, Toolchain

MAX_SIZE = 1 << 30
"""Upper limit of the size of the cache [bytes]; the least recently used files are deleted."""
SUFFIXES = (".so", ".dll", ".dylib", ".o", ".wasm")
SEAL = ".sha256"
REMEDY = "set DALEMBERT_CACHE to a folder of your own, or use backend='vm'"


def cache_folder() -> Path:
    """Folder of compiled functions."""
    if configured := os.environ.get("DALEMBERT_CACHE"):
        with suppress(RuntimeError):  # an unknown home folder stays as written
            return Path(configured).expanduser()
        return Path(configured)
    if base := os.environ.get("XDG_CACHE_HOME"):
        return Path(base) / "dalembert"
    try:
        return Path.home() / ".cache" / "dalembert"
    except RuntimeError:  # no home folder
        user = os.getuid() if hasattr(os, "getuid") else "user"
        return Path(tempfile.gettempdir()) / f"dalembert-{user}"


def check_folder(folder: Path) -> None:
    """Check that other users cannot write to a folder of machine code.

    Raises
    ------
    UnsupportedError
        The folder belongs to another user, or others may write to it.
    """
    if os.name != "posix":
        return
    try:
        status = folder.stat()
    except FileNotFoundError:
        return
    except OSError as error:
        reason = error.strerror or error
        raise UnsupportedError(f"the cache {folder} cannot be read ({reason}); {REMEDY}") from None
    mode = stat.S_IMODE(status.st_mode)
    if status.st_uid not in (os.geteuid(), 0):
        raise UnsupportedError(f"the cache {folder} belongs to another user; {REMEDY}")
    if mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise UnsupportedError(
            f"others may write in the cache {folder} (mode {mode:o}), whose machine code would be "
            f"run; use chmod 700, or {REMEDY}"
        )


def clear_cache() -> int:
    """Delete all compiled functions; they are compiled again when needed.

    Returns
    -------
    int
        Number of deleted functions.

    Examples
    --------
    >>> import os, tempfile
    >>> import dalembert as da
    >>> previous = os.environ.get("DALEMBERT_CACHE", "")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     os.environ["DALEMBERT_CACHE"] = folder  # instead of the folder shared by all programs
    ...     deleted = da.clear_cache()
    >>> os.environ["DALEMBERT_CACHE"] = previous
    >>> deleted  # nothing had been compiled into it
    0
    """
    paths = list(_cached_files(cache_folder()))
    for path in paths:
        _delete(path)
    return len(paths)


def cache_size() -> tuple[int, int]:
    """Number of compiled functions in the cache, and their size [bytes]."""
    sizes = []
    for path in _cached_files(cache_folder()):
        with suppress(OSError):  # another process may have deleted it
            sizes.append(path.stat().st_size)
    return len(sizes), sum(sizes)


def cache_path(text: str, toolchain: Compiler) -> Path:
    """File of the compiled code of a text."""
    import casadi as ca  # only here: the compiling process does not need it

    identity = (*toolchain.identity, ca.CasadiMeta.version(), sys.platform, platform.machine())
    key = "\n".join([*identity, text])
    return cache_folder() / f"{hashlib.sha256(key.encode()).hexdigest()[:40]}{toolchain.suffix}"


def is_whole(path: Path) -> bool:
    """Whether the file is as it was written; loading a damaged one would kill the process."""
    try:
        if not all(stat.S_ISREG(os.stat(file).st_mode) for file in (path, _seal(path))):
            return False  # reading a pipe would block
        return _seal(path).read_text() == hashlib.sha256(path.read_bytes()).hexdigest()
    except (OSError, UnicodeDecodeError):
        return False


def cached_loop(text: str, toolchain: Toolchain) -> Call | None:
    """The loop of a text if it is cached in a folder that other users cannot write to."""
    path = cache_path(text, toolchain)
    try:
        check_folder(path.parent)
    except UnsupportedError:
        return None
    if is_whole(path):
        with suppress(OSError):
            os.utime(path)
            return toolchain.load(path)
    return None


def compiled_loop(text: str, toolchain: Toolchain) -> Call:
    """The loop of a text, compiled now if it is not cached.

    Raises
    ------
    UnsupportedError
        The text cannot be compiled, or the cache is not writable.
    """
    loop = cached_loop(text, toolchain)
    if loop is None:
        build(text, toolchain)
        loop = toolchain.load(cache_path(text, toolchain))
    return loop


def compiled_bytes(text: str, compiler: Compiler) -> bytes:
    """The compiled file of a text; without a cache that can be used it is not stored.

    Raises
    ------
    UnsupportedError
        The text cannot be compiled.
    """
    path = cache_path(text, compiler)
    try:
        check_folder(path.parent)
        if is_whole(path):
            os.utime(path)
        else:
            build(text, compiler)
        return path.read_bytes()
    except NotTranslated:
        raise
    except (UnsupportedError, OSError):  # of the cache
        with tempfile.TemporaryDirectory() as folder:
            compiler.build(text, file := Path(folder) / path.name)
            return file.read_bytes()


def build(text: str, toolchain: Compiler, path: Path | None = None) -> None:
    """Compile to a temporary file and move it to its target, safe for concurrent processes.

    Raises
    ------
    UnsupportedError
        The text cannot be compiled, or the cache is not writable.
    """
    path = path or cache_path(text, toolchain)
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
    _delete_oldest(path.parent)


def _cached_files(folder: Path) -> Iterator[Path]:
    return (path for suffix in SUFFIXES for path in folder.glob(f"[!.]*{suffix}"))


def _seal(path: Path) -> Path:
    """File of the checksum of a file."""
    return path.with_suffix(SEAL)


def _delete_oldest(folder: Path) -> None:
    total, aged = 0, []
    for path in _cached_files(folder):
        with suppress(OSError):  # another process may have deleted it
            aged.append((path.stat().st_mtime, path.stat().st_size, path))
    for _, size, path in sorted(aged, reverse=True):
        total += size
        if total > MAX_SIZE:
            _delete(path)


def _clear_place(path: Path) -> None:
    """Remove anything that is not a regular file from the paths of machine code and checksum."""
    for file in (path, _seal(path)):
        if file.is_dir() and not file.is_symlink():
            shutil.rmtree(file)
        elif file.is_symlink() or (file.exists() and not file.is_file()):
            file.unlink()


def _delete(path: Path) -> None:
    for file in (_seal(path), path):
        with suppress(OSError):
            file.unlink(missing_ok=True)
