"""A studio that runs for a test."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

STILL = Path(__file__).with_name("still_studio.py")


@dataclass
class Studio:
    """A running studio.

    Attributes
    ----------
    address : of its page, with the token
    process : of the server
    folder : in which it runs
    """

    address: str
    process: subprocess.Popen[str]
    folder: Path

    @property
    def host(self) -> str:
        """Host and port."""
        return self.address.split("/")[2]

    @property
    def token(self) -> str:
        """Token of the address."""
        return self.address.split("/")[3]


@contextmanager
def running_studio(folder: Path, *arguments: Any, live: bool = True) -> Iterator[Studio]:
    """A studio in a folder, with drafts of its own; it is stopped at the end.

    Without ``live`` it makes no pictures that compute.
    """
    program = ["-m", "dalembert"] if live else [str(STILL)]
    environment = os.environ | {"XDG_STATE_HOME": str(folder / "state")}
    process = subprocess.Popen(
        [sys.executable, *program, "studio", *map(str, arguments), "--no-open"],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        cwd=folder,
        env=environment,
    )
    assert process.stdout is not None
    try:
        line = process.stdout.readline()
        assert line.startswith("studio: http://127.0.0.1:"), line + process.stdout.read()
        yield Studio(line.split()[1], process, folder)
    finally:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()
