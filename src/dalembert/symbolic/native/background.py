"""Compilation in a separate process, while the virtual machine continues.

The result is written to the cache, so it is not lost if the run ends first.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from dalembert.errors import UnsupportedError
from dalembert.symbolic.native.code_cache import build, cache_path
from dalembert.symbolic.native.toolchain import Toolchain

SCRIPT = """
import sys
sys.path[:] = {path!r}
from {module} import {maker}
from dalembert.symbolic.native.background import finish
finish({maker}(), {target!r})
"""


def possible() -> bool:
    """Whether a Python process can be started; not if Python is embedded in another program."""
    return bool(sys.executable) and not getattr(sys, "frozen", False)


class _DetachedProcess(subprocess.Popen):
    """A process that may outlive its parent, as its result serves later runs."""

    def __del__(self) -> None:
        super().__del__(_warn=lambda *_, **__: None)  # type: ignore[call-arg]


class Compilation:
    """A compilation in progress.

    Parameters
    ----------
    text : C
    toolchain : Toolchain
    """

    def __init__(self, text: str, toolchain: Toolchain):
        target = str(cache_path(text, toolchain))
        module, name = toolchain.maker
        script = SCRIPT.format(path=sys.path, module=module, maker=name, target=target)
        with tempfile.TemporaryFile("w+", encoding="utf-8") as source:
            source.write(text)
            source.seek(0)
            self._process = _DetachedProcess(
                [sys.executable, "-c", script],
                stdin=source,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),
            )

    @property
    def running(self) -> bool:
        return self._process.poll() is None


def finish(toolchain: Toolchain, target: str) -> None:
    """Entry point of the compiling process: compile standard input to a file."""
    try:
        build(sys.stdin.buffer.read().decode(), toolchain, Path(target))
    except UnsupportedError as error:
        sys.exit(str(error))
