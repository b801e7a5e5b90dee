"""Sudden ends of a studio at random moments of edits and saves.

A page without a browser edits, undoes, saves and reloads; the server is killed meanwhile. Each
answer that has come is a promise: the next server has that text, or a later one that was sent.
"""

from __future__ import annotations

import json
import random
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from processor_times import descendants
from studio_runs import Studio, running_studio
from test_studio_losses import running
from test_studio_server import FOUR_BAR, page, receive, send
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

ENDED = 60.0
"""Time within which the processes of a killed server end, on a busy machine [s]."""


@dataclass
class Kills:
    """A file that is edited by servers which are killed.

    Attributes
    ----------
    path : of the file
    rng : that selects the edits and the moments
    text : last one that a server has acknowledged
    sent : texts that were sent after it, whose answers have not come
    written : contents that the file may have
    processes : that the servers have started
    count : number of kills
    """

    path: Path
    rng: random.Random
    text: str = FOUR_BAR
    sent: list[str] = field(default_factory=list)
    written: set[str] = field(default_factory=lambda: {FOUR_BAR})
    processes: set[int] = field(default_factory=set)
    count: int = 0

    def kill(self) -> None:
        """Edit with a new server, which has the last text, and kill it."""
        with running_studio(self.path.parent, self.path) as server:
            with page(server) as socket, suppress(ConnectionClosed):
                self._starts(receive(socket, "text"))
                moment = (
                    time.monotonic() + self.rng.choice([0.0, 0.02, 0.2, 0.6]) * self.rng.random()
                )
                self._edit(socket, moment)
                self.processes |= set(descendants(server.process.pid))
                self._end(server)
                self._answers(socket, wait=5.0)
            self._end(server)
        assert self.path.read_text() in self.written, "the file is neither an old nor a new one"
        self.count += 1

    def no_process_remains(self) -> None:
        """All processes that the servers started end soon after them."""
        end = time.monotonic() + ENDED
        while any(map(running, self.processes)) and time.monotonic() < end:
            time.sleep(0.1)
        assert not any(map(running, self.processes)), "processes outlive their server"

    def _end(self, server: Studio) -> None:
        server.process.kill()
        server.process.wait()

    def _starts(self, state: dict[str, Any]) -> None:
        """The first text of a server is the last one of the former server."""
        assert state["text"] in (self.text, *self.sent), (self.count, state["text"][-200:])
        self.text = state["text"]
        self.sent = []
        self.revision = state["revision"]

    def _edit(self, socket: ClientConnection, moment: float) -> None:
        """Edit until a moment."""
        begun = False
        while time.monotonic() < moment or not begun:
            begun = True
            now = (self.sent or [self.text])[-1]
            if self.rng.random() < 0.7:
                mark = f"# {self.count} {self.rng.random()}\n" * self.rng.choice([1, 1, 3000])
                text = now[: len(FOUR_BAR)] + mark
                send(socket, kind="text", text=text, revision=self.revision + len(self.sent))
                self.sent.append(text)
            else:
                self.written.add(now)
                send(socket, kind="save")
            if self.rng.random() < 0.5:
                self._answers(socket, wait=self.rng.choice([0.0, 0.01, 0.05]))

    def _answers(self, socket: ClientConnection, wait: float) -> None:
        """Take the answers that have come."""
        end = time.monotonic() + wait
        with suppress(TimeoutError, ConnectionClosed):
            while True:
                message = json.loads(socket.recv(timeout=max(0.0, end - time.monotonic())))
                assert message["kind"] not in ("failure", "conflict"), message
                if message["kind"] == "text":
                    while self.revision < message["revision"]:
                        self.revision += 1
                        self.text = self.sent.pop(0)
