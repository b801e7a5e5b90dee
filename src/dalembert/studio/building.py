"""Processes that make pictures, while the server answers; outdated work is cancelled."""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

from dalembert.studio.pictures import Picture, Problem, picture_of

GRACE = 1.5
"""Time after which outdated work is cancelled; earlier its process is worth more [s]."""
FRESH = "the building process ended unexpectedly; change the model to build it again"


@dataclass(frozen=True)
class Request:
    """A text to make a picture of.

    Attributes
    ----------
    number : of the request
    text, path : of the model file
    """

    number: int
    text: str
    path: Path


class BuildingProcess:
    """A process that makes pictures of the latest request.

    Parameters
    ----------
    live : whether the pictures compute
    receive : called in a thread with the number of the request and its picture
    """

    def __init__(self, live: bool, receive: Callable[[int, Picture], None]):
        self.live = live
        self.receive = receive
        self._lock = threading.Lock()
        self._waiting: Request | None = None
        self._working: Request | None = None
        self._since = 0.0
        self._closed = False
        self._changed = threading.Condition(self._lock)
        self._start()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._watch = threading.Thread(target=self._cancel_outdated, daemon=True)
        self._watch.start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, other = context.Pipe()
        self._process = context.Process(target=work, args=(other, self.live), daemon=True)
        self._process.start()
        other.close()

    def request(self, request: Request) -> None:
        """Make a picture of a text, in place of former requests."""
        with self._changed:
            self._waiting = request
            self._changed.notify_all()

    def close(self) -> None:
        """End the process."""
        with self._changed:
            self._closed = True
            self._process.kill()
            self._changed.notify_all()
        self._thread.join(5.0)
        self._process.join(5.0)

    def _run(self) -> None:
        """Send requests to the process and receive their pictures."""
        while True:
            with self._changed:
                while self._waiting is None and not self._closed:
                    self._changed.wait()
                if self._closed:
                    return
                request, self._waiting = self._waiting, None
                self._working, self._since = request, time.monotonic()
            assert request is not None
            picture = self._picture(request)
            with self._changed:
                self._working = None
                if self._closed:
                    return
                outdated = self._waiting is not None
            if picture is not None:
                self.receive(request.number, picture)
            elif not outdated:
                self.receive(request.number, Picture(problems=(Problem("error", FRESH),)))

    def _picture(self, request: Request) -> Picture | None:
        """Picture of a request; None if the process has ended, which is started again."""
        try:
            self._connection.send(request)
            picture: Picture = self._connection.recv()
            return picture
        except (EOFError, OSError):
            with self._changed:
                if not self._closed:
                    self._process.join(5.0)
                    self._start()
            return None

    def _cancel_outdated(self) -> None:
        """Kill the process while it works for long on a request that a newer one replaces."""
        with self._changed:
            while not self._closed:
                busy = self._working is not None and self._waiting is not None
                left = self._since + GRACE - time.monotonic()
                if busy and left <= 0:
                    self._process.kill()
                    self._working = None
                self._changed.wait(max(left, 0.01) if busy else None)


def work(connection: Connection, live: bool) -> None:
    """Loop of the process: requests in, pictures out."""
    if os.name == "posix":
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends the process
    warnings.simplefilter("ignore")
    with suppress(EOFError, OSError, KeyboardInterrupt):
        while True:
            request: Request = connection.recv()
            connection.send(_picture(request, live))


def _picture(request: Request, live: bool) -> Picture:
    try:
        return picture_of(request.text, request.path, live)
    except Exception:
        message = f"internal error; please report it:\n{traceback.format_exc(limit=-3)}"
        return Picture(problems=(Problem("error", message),))
