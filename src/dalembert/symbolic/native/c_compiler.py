"""The system's C compiler, or the one of the ``ziglang`` package."""

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
from dalembert.symbolic.native.loop import ENTRY, SIGNATURE
from dalembert.symbolic.native.toolchain import Call, Toolchain

FLAGS = ("-fPIC", "-shared", "-ffp-contract=off", "-w")
"""Sums of products are rounded as the virtual machine rounds them, so that both agree."""
OPTIMISED = "-O1"
LONGEST = 5_000_000
BEGIN, RATE = 0.1, 8e-6
"""Rough: seconds to begin, and for a character."""


@dataclass(frozen=True)
class Compiler(Toolchain):
    """A C compiler: how it is called, and what it says it is."""

    name: ClassVar[str] = "C"
    backend: ClassVar[str] = "c"
    suffix: ClassVar[str] = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
    maker: ClassVar[tuple[str, str]] = (__name__, "needed_compiler")
    longest: ClassVar[int | None] = LONGEST

    command: tuple[str, ...]
    version: str

    @property
    def identity(self) -> tuple[str, ...]:
        return (self.version, *self.command, OPTIMISED, *FLAGS)

    def least_effort(self, text: str) -> float:
        return BEGIN + RATE * len(text)

    def build(self, text: str, target: Path) -> None:
        command = [*self.command, OPTIMISED, *FLAGS, "-x", "c", "-", "-o", str(target), "-lm"]
        done = subprocess.run(command, input=text, capture_output=True, text=True)
        if done.returncode:
            said = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[0]
            raise UnsupportedError(
                f"backend 'c': {shlex.join(self.command)} failed ({said}); set CC to a compiler "
                "that works, or use backend='vm'"
            )

    def load(self, path: Path) -> Call:
        library = ctypes.CDLL(str(path))
        return SIGNATURE((ENTRY, library))


def find_compiler() -> Compiler | None:
    """``$CC``, or the first of cc, gcc, clang and ziglang that is installed; None without any."""
    asked = os.environ.get("CC")
    for name in [asked] if asked else ["cc", "gcc", "clang"]:
        command = shlex.split(name)
        if command and (found := shutil.which(command[0])):
            return _compiler((found, *command[1:]))
    if not asked and find_spec("ziglang") is not None:
        return _compiler((sys.executable, "-m", "ziglang", "cc"))
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
            f"backend 'c': {missing} found; install gcc or clang, 'pip install ziglang', or set CC "
            "to one; or use backend='jit' or 'vm', which give the same results"
        )
    return compiler
