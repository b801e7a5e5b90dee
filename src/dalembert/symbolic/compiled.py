"""Functions of the graph as C: generated, compiled once by the system's compiler, kept on disk.

A library is filed under the hash of its C text, the compiler, its flags and the CasADi version, so
that a file found is the right one and a changed model makes a new one. Values of parameters are
arguments of the function and no part of the text. The folder is ``$DALEMBERT_CACHE``, else
``$XDG_CACHE_HOME/dalembert``, else ``~/.cache/dalembert``; ``clear_cache`` empties it.
"""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sys
from contextlib import redirect_stderr, suppress
from dataclasses import dataclass
from functools import lru_cache
from io import StringIO
from pathlib import Path

import casadi as ca

from dalembert.atomic import atomic_path
from dalembert.errors import FileError, UnsupportedError

SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
FLAGS = ("-fPIC", "-shared", "-ffp-contract=off", "-w")
"""Sums of products are rounded as the virtual machine rounds them, so that both agree."""
OPTIMISED = "-O1"
LARGE = 5_000_000
"""Characters of C from which the virtual machine is faster, whose instructions are shorter: code
that does not fit the caches of the processor is read from memory in every step."""
KEPT = 1 << 30
"""Bytes of libraries kept; those unused for longest go first."""


@dataclass(frozen=True)
class Compiler:
    """A C compiler: how it is called, and what it says it is."""

    command: tuple[str, ...]
    version: str

    def compile(self, text: str, target: Path) -> None:
        """Make a shared library.

        Raises
        ------
        UnsupportedError
            The compiler refuses; with its own words.
        """
        command = [*self.command, OPTIMISED, *FLAGS, "-x", "c", "-", "-o", str(target), "-lm"]
        done = subprocess.run(command, input=text, capture_output=True, text=True)
        if done.returncode:
            said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[0]
            raise UnsupportedError(
                f"backend 'c': {shlex.join(self.command)} failed ({said}); set CC to a compiler "
                "that works, or use backend='vm'"
            )


def find_compiler() -> Compiler | None:
    """``$CC``, or the first of cc, gcc and clang that is installed; None without any."""
    asked = os.environ.get("CC")
    for name in [asked] if asked else ["cc", "gcc", "clang"]:
        command = shlex.split(name)
        if command and (found := shutil.which(command[0])):
            return _compiler((found, *command[1:]))
    return None


@lru_cache
def _compiler(command: tuple[str, ...]) -> Compiler | None:
    """The compiler with its version; None for a program that cannot tell it."""
    try:
        said = subprocess.run([*command, "--version"], capture_output=True, text=True, timeout=30)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return None if said.returncode else Compiler(command, said.stdout.partition("\n")[0])


def needed_compiler() -> Compiler:
    """The compiler.

    Raises
    ------
    UnsupportedError
        There is none.
    """
    compiler = find_compiler()
    if compiler is None:
        asked = os.environ.get("CC")
        missing = f"CC={asked!r} is no C compiler" if asked else "no C compiler (cc, gcc, clang)"
        raise UnsupportedError(
            f"backend 'c': {missing} found; install gcc or clang, set CC to one, or use "
            "backend='vm', which gives the same results"
        )
    return compiler


def c_source(function: ca.Function) -> str | None:
    """C text of a function; None where CasADi cannot write it, as for SUNDIALS."""
    generator = ca.CodeGenerator("dalembert.c")
    try:
        with redirect_stderr(StringIO()):  # CasADi warns of what is told here by the answer
            generator.add(function)
            text = generator.dump()
    except RuntimeError:
        return None
    return None if "\n  #error" in text else text


def hindrance(text: str | None) -> str:
    """Why a function stays on the virtual machine; nothing where C pays."""
    if text is None:
        return "CasADi cannot write this integrator as C"
    return f"{len(text) / 1e6:.1f} MB of C would be slower" if len(text) > LARGE else ""


# cache ------------------------------------------------------------------------------
def cache_folder() -> Path:
    """Where compiled functions are kept."""
    if asked := os.environ.get("DALEMBERT_CACHE"):
        return Path(asked).expanduser()
    base = os.environ.get("XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "dalembert"


def clear_cache() -> int:
    """Delete all compiled functions of ``backend="c"``; they are made again when needed.

    Returns
    -------
    int
        How many were deleted.
    """
    found = list(cache_folder().glob(f"*{SUFFIX}"))
    for path in found:
        _delete(path)
    return len(found)


def kept_path(text: str, compiler: Compiler) -> Path:
    """Where the library of this text belongs."""
    made_by = (compiler.version, *compiler.command, OPTIMISED, *FLAGS, ca.CasadiMeta.version())
    key = "\n".join([*made_by, sys.platform, platform.machine(), text])
    return cache_folder() / f"{hashlib.sha256(key.encode()).hexdigest()[:40]}{SUFFIX}"


def is_whole(path: Path) -> bool:
    """The library is there as it was written: loading a damaged one would end the process."""
    try:
        return _seal(path).read_text() == hashlib.sha256(path.read_bytes()).hexdigest()
    except (OSError, UnicodeDecodeError):
        return False


def load(function: ca.Function, text: str, compiler: Compiler) -> ca.Function:
    """The same function from its library, compiled now if it is not in the cache.

    Raises
    ------
    UnsupportedError
        It cannot be compiled, or the cache cannot be written.
    """
    path = kept_path(text, compiler)
    if is_whole(path):
        with suppress(RuntimeError, OSError):
            os.utime(path)
            return ca.external(function.name(), str(path))
    _build(text, compiler, path)
    return ca.external(function.name(), str(path))


def _build(text: str, compiler: Compiler, path: Path) -> None:
    """Compile beside the target and move it there: two processes at once do no harm."""
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with atomic_path(path) as temporary:
            compiler.compile(text, temporary)
            digest = hashlib.sha256(temporary.read_bytes()).hexdigest()
        with atomic_path(_seal(path)) as temporary:
            temporary.write_text(digest)
    except (FileError, OSError) as error:
        raise UnsupportedError(
            f"backend 'c': the cache {path.parent} cannot be written ({error}); set "
            "DALEMBERT_CACHE to another folder, or use backend='vm'"
        ) from None
    _forget_oldest(path.parent)


def _seal(path: Path) -> Path:
    """File with the checksum of a library."""
    return path.with_suffix(".sha256")


def _forget_oldest(folder: Path) -> None:
    total, aged = 0, []
    for path in folder.glob(f"*{SUFFIX}"):
        with suppress(OSError):  # another process may have deleted it
            aged.append((path.stat().st_mtime, path.stat().st_size, path))
    for _, size, path in sorted(aged, reverse=True):
        total += size
        if total > KEPT:
            _delete(path)


def _delete(path: Path) -> None:
    for file in (_seal(path), path):
        with suppress(OSError):
            file.unlink(missing_ok=True)
