"""Compiling in a process of its own, while the virtual machine goes on.

The file is left in the cache, so that nothing is lost where the run ends first.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.code_cache import build, kept_path
from dalembert.symbolic.native.toolchain import Toolchain

SCRIPT = """
import sys
sys.path[:] = {path!r}
from {module} import {maker}
from dalembert.symbolic.native.background import finish
finish({maker}(), {target!r})
"""


def possible() -> bool:
    """Python can be started again; not where it is part of another program."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


class _Left(subprocess.Popen):
    """A process that may outlive who asked for it: what it makes serves the next one."""

    def __del__(self) -> None:
        super().__del__(_warn=lambda *_, **__: None)  # type: ignore[call-arg]


class Compilation:
    """A text that is being compiled.

    Parameters
    ----------
    text : C
    toolchain : Toolchain
    """

    def __init__(self, text: str, toolchain: Toolchain):
        target = str(kept_path(text, toolchain))
        module, name = toolchain.maker
        script = SCRIPT.format(path=sys.path, module=module, maker=name, target=target)
        with tempfile.TemporaryFile("w+", encoding="utf-8") as given:
            given.write(text)
            given.seek(0)
            self._process = _Left(
                [sys.executable, "-c", script],
                stdin=given,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )

    @property
    def running(self) -> bool:
        return self._process.poll() is None


def finish(toolchain: Toolchain, target: str) -> None:
    """What the other process does: the text of its input becomes a file."""
    try:
        build(sys.stdin.buffer.read().decode(), toolchain, Path(target))
    except UnsupportedError as error:
        sys.exit(str(error))
