"""Toolchain of the system's C compiler, or of the ``ziglang`` package."""

from __future__ import annotations

import ctypes
import os
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from functools import lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import ClassVar

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.toolchain import ENTRY, SIGNATURE, Call, Toolchain

FLAGS = ("-fPIC", "-shared", "-ffp-contract=off", "-w")
"""Sums of products are rounded as by the virtual machine, so that both agree."""
OPTIMISED = "-O1"
LONGEST = 5_000_000
BEGIN, RATE = 0.1, 8e-6
"""Estimated compile time: constant, and per character [s]."""


@dataclass(frozen=True)
class Compiler(Toolchain):
    """A C compiler, by its command and its version text."""

    name: ClassVar[str] = "C"
    backend: ClassVar[str] = "c"
    suffix: ClassVar[str] = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    maker: ClassVar[tuple[str, str]] = (__name__, "require_compiler")
    longest: ClassVar[int | None] = LONGEST

    command: tuple[str, ...]
    version: str

    @property
    def identity(self) -> tuple[str, ...]:
        return (self.version, *self.command, OPTIMISED, *FLAGS)

    def least_compile_time(self, text: str) -> float:
        return BEGIN + RATE * len(text)

    def build(self, text: str, target: Path) -> None:
        command = [*self.command, OPTIMISED, *FLAGS, "-x", "c", "-", "-o", str(target), "-lm"]
        process = subprocess.run(command, input=text, capture_output=True, text=True)
        if process.returncode:
            lines = process.stderr.strip().splitlines() or [f"exit code {process.returncode}"]
            message = next((line for line in lines if " error:" in line), lines[0])
            raise UnsupportedError(
                f"backend 'c': {shlex.join(self.command)} failed ({message}); set CC to a compiler "
                "that works, or use backend='vm'"
            )

    def load(self, path: Path) -> Call:
        library = ctypes.CDLL(str(path))
        return SIGNATURE((ENTRY, library))


def find_compiler() -> Compiler | None:
    """``$CC``, or the first of cc, gcc, clang and ziglang that is installed, or None."""
    requested = os.environ.get("CC")
    for name in [requested] if requested else ["cc", "gcc", "clang"]:
        command = shlex.split(name)
        if command and (path := shutil.which(command[0])):
            return _compiler((path, *command[1:]))
    if not requested and find_spec("ziglang") is not None:
        return _compiler((sys.executable, "-m", "ziglang", "cc"))
    return None


@lru_cache
def _compiler(command: tuple[str, ...]) -> Compiler | None:
    """The compiler with its version; None for a program that does not report one."""
    try:
        process = subprocess.run(
            [*command, "--version"], capture_output=True, text=True, timeout=30
        )
    except (OSError, subprocess.TimeoutExpired):
        return None
    return None if process.returncode else Compiler(command, process.stdout.partition("\n")[0])


def require_compiler() -> Compiler:
    """The installed compiler.

    Raises
    ------
    UnsupportedError
        No compiler is installed.
    """
    compiler = find_compiler()
    if compiler is None:
        requested = os.environ.get("CC")
        missing = (
            f"CC={requested!r}: no C compiler" if requested else "no C compiler (cc, gcc, clang)"
        )
        raise UnsupportedError(
            f"backend 'c': {missing} found; install gcc or clang, 'pip install ziglang', or set CC "
            "to one; or use backend='jit' or 'vm', which give the same results"
        )
    return compiler
