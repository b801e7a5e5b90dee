"""Compilation of a unit for one or several platforms.

The C compiler of the system builds for the machine itself; the ``ziglang`` package also builds
for other systems and processors.
"""

from __future__ import annotations

import platform
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from dalembert.errors import UnsupportedError
from dalembert.packages import optional_package
from dalembert.symbolic.native.c_compiler import find_compiler, require_compiler
from dalembert.text.wording import unknown

NATIVE = "native"
FLAGS = ("-shared", "-fvisibility=hidden", "-ffp-contract=off", "-w", "-std=c99", "-g0")
OPTIMISED = "-O1"
"""Higher levels compile long straight code several times as slowly and gain a few per cent."""


@dataclass(frozen=True)
class Platform:
    """An operating system with a processor.

    Attributes
    ----------
    folder3, folder2 : of its binaries in units of FMI 3.0 and 2.0; empty if FMI 2.0 has none
    suffix : of its libraries
    target : name for the compiler of ziglang
    """

    folder3: str
    folder2: str
    suffix: str
    target: str


PLATFORMS: Mapping[str, Platform] = {
    "x86_64-linux": Platform("x86_64-linux", "linux64", ".so", "x86_64-linux-gnu.2.17"),
    "aarch64-linux": Platform("aarch64-linux", "", ".so", "aarch64-linux-gnu.2.17"),
    "x86_64-windows": Platform("x86_64-windows", "win64", ".dll", "x86_64-windows-gnu"),
    "aarch64-windows": Platform("aarch64-windows", "", ".dll", "aarch64-windows-gnu"),
    "x86_64-darwin": Platform("x86_64-darwin", "darwin64", ".dylib", "x86_64-macos"),
    "aarch64-darwin": Platform("aarch64-darwin", "", ".dylib", "aarch64-macos"),
}
"""Name → platform for which units are compiled."""


def native_platform() -> str:
    """Name of the platform of this machine."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(
        platform.machine().lower(), platform.machine().lower()
    )
    system = {"win32": "windows", "darwin": "darwin"}.get(sys.platform, "linux")
    return f"{machine}-{system}"


def library_path(name: str, identifier: str, version: int) -> str:
    """Path of a library in the archive.

    Raises
    ------
    UnsupportedError
        FMI 2.0 has no folder for the platform.
    """
    chosen = PLATFORMS[name]
    folder = chosen.folder3 if version == 3 else chosen.folder2
    if not folder:
        raise UnsupportedError(f"FMI 2.0 has no folder for the platform {name}; use fmi=3")
    return f"binaries/{folder}/{identifier}{chosen.suffix}"


def check_platforms(names: Sequence[str], version: int) -> list[str]:
    """Names of platforms, with that of this machine in place of ``"native"``.

    Raises
    ------
    UnsupportedError
        Unknown platform, or one for which FMI 2.0 has no folder.
    """
    resolved = [native_platform() if name == NATIVE else name for name in names]
    for name in resolved:
        if name not in PLATFORMS:
            raise UnsupportedError(unknown("platform", name, [NATIVE, *PLATFORMS]))
        library_path(name, "unit", version)
    return list(dict.fromkeys(resolved))


def compile_unit(folder: Path, source: str, name: str, identifier: str) -> bytes:
    """Library of a unit for a platform.

    The compiler runs in the folder and strips symbols, so that no path is in the library and equal
    sources give equal libraries.

    Parameters
    ----------
    folder : of the sources; the library is written there, too
    source : the file to compile
    name : of the platform
    identifier : name of the library without its suffix

    Raises
    ------
    UnsupportedError
        There is no compiler for the platform, or it fails.
    """
    target = f"{identifier}{PLATFORMS[name].suffix}"
    command = [*_command(name), OPTIMISED, *FLAGS, "-I", "headers", source, "-o", target]
    if not name.endswith("windows"):
        command += ["-fPIC", "-lm"]
    if name.endswith("darwin"):
        command.append(f"-Wl,-install_name,@rpath/{target}")
    if "ziglang" in command or not name.endswith("darwin"):  # obsolete in Apple's linker
        command.append("-s")
    process = subprocess.run(command, capture_output=True, text=True, cwd=folder)
    if process.returncode or not (folder / target).exists():
        lines = [x for x in process.stderr.splitlines() if "error" in x] or ["no message"]
        raise UnsupportedError(f"the unit cannot be compiled for {name}: {lines[0].strip()}")
    return (folder / target).read_bytes()


def _command(name: str) -> tuple[str, ...]:
    """Compiler for a platform."""
    if name == native_platform() and (compiler := find_compiler()) is not None:
        return compiler.command
    if name == native_platform() and find_spec("ziglang") is None:
        return require_compiler().command
    optional_package("ziglang", f"compilation for {name}", "export on that machine")
    return (sys.executable, "-m", "ziglang", "cc", "-target", PLATFORMS[name].target)
