"""Firefox for tests of pages: Debian's firefox-esr, driven by WebDriver BiDi."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from browser import missing

ADDRESS = re.compile(r"WebDriver BiDi listening on (ws://\S+)")
SECONDS = 120.0
"""Longest time to wait for an answer."""


class Firefox:
    """One tab: evaluation of expressions, errors and warnings of the console, requests.

    Parameters
    ----------
    socket : connection of the session
    """

    def __init__(self, socket: Any):
        self.socket, self.number = socket, 0
        self.console: list[str] = []
        self.requests: list[str] = []
        self.command("session.new", capabilities={})
        self.command("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        (tab,) = self.command("browsingContext.getTree")["contexts"]
        self.context = tab["context"]

    def command(self, method: str, **parameters: Any) -> dict[str, Any]:
        self.number += 1
        request = {"id": self.number, "method": method, "params": parameters}
        self.socket.send(json.dumps(request))
        while True:
            message = json.loads(self.socket.recv(timeout=SECONDS))
            if message.get("method") == "log.entryAdded":
                entry = message["params"]
                if entry["level"] in ("error", "warn"):
                    self.console.append(str(entry["text"]))
            elif message.get("method") == "network.beforeRequestSent":
                self.requests.append(message["params"]["request"]["url"])
            if message.get("id") == self.number:
                assert message["type"] == "success", message
                result: dict[str, Any] = message["result"]
                return result

    def open(self, path: Path) -> None:
        """Open a file."""
        url = path.resolve().as_uri()
        self.command("browsingContext.navigate", context=self.context, url=url, wait="complete")

    def js(self, expression: str) -> Any:
        """Value of a JavaScript expression, by way of JSON."""
        text = f"Promise.resolve({expression}).then((value) => JSON.stringify(value ?? null))"
        target = {"context": self.context}
        answer = self.command("script.evaluate", expression=text, target=target, awaitPromise=True)
        assert answer["type"] == "success", answer.get("exceptionDetails", {}).get("text")
        return json.loads(answer["result"]["value"])

    def until(self, expression: str) -> None:
        """Wait until a JavaScript expression holds."""
        end = time.monotonic() + SECONDS
        while not self.js(expression):
            assert time.monotonic() < end, f"not true after {SECONDS} s: {expression}"
            time.sleep(0.02)


@contextmanager
def firefox() -> Iterator[Firefox]:
    """Start Firefox with a new profile; skip, or under CI=true fail, without it."""
    from websockets.sync.client import connect

    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        missing("firefox-esr")
    with TemporaryDirectory() as profile:
        arguments = ["--headless", "--no-remote", "--profile", profile]
        process = subprocess.Popen(
            [program, *arguments, "--remote-debugging-port", "0"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            address = _address(process)
            with connect(f"{address}/session", origin=None, max_size=None) as socket:
                yield Firefox(socket)
        finally:
            process.terminate()
            process.wait()


def _address(process: subprocess.Popen) -> str:
    """Address on which Firefox listens."""
    assert process.stderr is not None
    for line in process.stderr:
        if match := ADDRESS.search(line):
            return match[1]
    raise AssertionError(f"Firefox ended with code {process.wait()}")
