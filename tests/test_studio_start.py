"""Start of the studio: the browser is started first, and nothing delays its connection."""

from __future__ import annotations

import asyncio
import json
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import pytest

from dalembert.studio.event_loop import in_thread
from dalembert.studio.schema_process import schema_text

READY = """
import os, sys
from dalembert.studio.server import serve
def begin(address):
    slow = ("casadi", "pydantic", "dalembert.studio.session")
    print([name for name in slow if name in sys.modules], flush=True)
    os._exit(0)
serve(None, 0, print, begin)
"""


def test_the_browser_is_started_before_modules_are_imported(tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", READY], capture_output=True, text=True, cwd=tmp_path, timeout=120
    )
    assert (done.stdout.strip(), done.stderr) == ("[]", "")


def test_the_loop_goes_on_while_a_thread_computes() -> None:
    """As a first WebSocket that is opened while the schema is made."""
    go_on = threading.Event()

    async def run() -> list[str]:
        order: list[str] = []

        async def answer() -> None:
            order.append("socket")
            go_on.set()

        async def schema() -> None:
            order.append(await in_thread(lambda: "schema" if go_on.wait(20) else "blocked"))

        await asyncio.gather(schema(), answer())
        with pytest.raises(EOFError):
            await in_thread(failing)
        return order

    assert asyncio.run(run()) == ["socket", "schema"]


def failing() -> None:
    raise EOFError


def test_the_schema_of_the_process_is_that_of_the_package(schema: Any) -> None:
    assert json.loads(schema_text()) == schema.schema
    assert schema_text() is schema_text()
