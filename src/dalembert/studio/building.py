"""Processes that make pictures, while the server answers; outdated work is cancelled."""

from __future__ import annotations

import threading
import time
import traceback
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path

from dalembert.studio.assemblies import assemblies_of
from dalembert.studio.child import MEMORY, TIME, begin_child, child_context, memory_of
from dalembert.studio.pictures import Picture, picture_of
from dalembert.studio.problems import Problem

GRACE = 1.5
"""Time after which outdated work is cancelled; earlier its process is worth more [s]."""
READY = "ready"
"""First message of a process, once it has started."""
FRESH = "the building process ended unexpectedly; change the model to build it again"
CANCELLED = "building was stopped; change the model to build it again"
NO_PROCESS = "no building process can be started ({}); free memory, then change the model"
SMALLER = "use a shorter duration, fewer outputs or a coarser mesh"
ATTEMPTS = 3
"""Number of attempts to start a process."""
PERIOD = 0.25
"""Time between checks of the limits of the process [s]."""


KINDS: dict[str, Callable[[str, Path], Picture]] = {
    "still": partial(picture_of, live=False),
    "live": partial(picture_of, live=True),
    "assemblies": assemblies_of,
}
"""Kind of pictures of a process → makes one of a text and the path of its file."""

FIRST = "still"
"""Kind of the picture that is shown first."""
PAUSES = {"live": 0.4}
"""Kind of pictures → time without another request before one is made [s]: during quick edits no
module is compiled that the next edit outdates."""
REHEARSAL = """format = 1
gravity = [0.0, -9.81]
[bodies]
crank = { type = "Bar", length = 0.3, mass = 1.0 }
rod = { type = "Bar", length = 0.5, mass = 1.0 }
[joints]
O = { type = "Revolute", connect = ["ground", "crank.start"] }
A = { type = "Revolute", connect = ["crank.end", "rod.start"] }
"""
"""Model whose picture is made while there is nothing to do: later ones find all modules loaded."""
QUIET = 0.3
"""Time without a request after which this is done [s]."""


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
    kind : of the pictures, of ``KINDS``
    receive : called in a thread with the number of the request and its picture
    memory : upper limit of the memory of the process [bytes]
    time : upper limit of the time for one picture [s]
    """

    def __init__(
        self,
        kind: str,
        receive: Callable[[int, Picture], None],
        memory: float = MEMORY,
        time: float = TIME,
    ):
        self.kind = kind
        self.receive = receive
        self.memory, self.time = memory, time
        self._reason = FRESH
        self._lock = threading.Lock()
        self._waiting: Request | None = None
        self._working: Request | None = None
        self._since = 0.0
        self._closed = False
        self._changed = threading.Condition(self._lock)
        self._process: BaseProcess | None = None
        self._is_ready, self._is_ended = False, False
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._watch = threading.Thread(target=self._keep_limits, daemon=True)
        self._watch.start()

    def _start(self) -> None:
        """Start a process; the first one waits until modules are imported."""
        self._is_ended = True
        for _ in range(ATTEMPTS):
            try:
                context = child_context()
                self._connection, other = context.Pipe()
                process = context.Process(target=work, args=(other, self.kind), daemon=True)
                process.start()
                other.close()
            except (OSError, EOFError) as error:  # such as the end of the parent of children
                self._reason = NO_PROCESS.format(error)
            else:
                self._process, self._is_ready, self._is_ended = process, False, False
                return

    def request(self, request: Request) -> None:
        """Make a picture of a text, in place of former requests."""
        with self._changed:
            self._waiting = request
            self._changed.notify_all()

    def cancel(self) -> None:
        """Stop making a picture."""
        with self._changed:
            self._waiting = None
            if self._working is not None:
                self._end(CANCELLED)

    def close(self) -> None:
        """End the process."""
        with self._changed:
            self._closed = True
            self._kill()
            self._changed.notify_all()
        self._thread.join(5.0)
        if self._process is not None:
            self._process.join(5.0)

    def _run(self) -> None:
        """Start the process, send it requests and receive their pictures."""
        self._start()
        while True:
            with self._changed:
                self._await_request()
                if self._closed:
                    self._kill()
                    return
                request, self._waiting = self._waiting, None
                self._working, self._since = request, time.monotonic()
                self._reason = FRESH
                self._changed.notify_all()
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
                self.receive(request.number, Picture(problems=(Problem("error", self._reason),)))

    def _await_request(self) -> None:
        """Wait for a request that no other one follows during the pause of this kind."""
        while not self._closed:
            latest = self._waiting
            pause = None if latest is None else PAUSES.get(self.kind, 0.0)
            if not self._changed.wait_for(partial(self._is_outdated, latest), pause):
                return

    def _is_outdated(self, latest: Request | None) -> bool:
        """Whether another request has come, or none is to be worked on any more."""
        return self._closed or self._waiting is not latest

    def _picture(self, request: Request) -> Picture | None:
        """Picture of a request; None if the process has ended meanwhile."""
        if self._process is None or self._is_ended or not self._process.is_alive():
            self._restart()
            if self._is_ended:
                return None
        try:
            self._connection.send(request)
            if not self._is_ready:
                self._connection.recv()
                with self._changed:  # the time to start a process is none of the work
                    self._is_ready, self._since = True, time.monotonic()
            picture: Picture = self._connection.recv()
            return picture
        except (EOFError, OSError):
            self._restart()
            return None

    def _restart(self) -> None:
        """Start another process in place of one that has ended."""
        with self._changed:
            if not self._closed:
                if self._process is not None:
                    self._process.join(5.0)
                self._start()

    def _keep_limits(self) -> None:
        """End the process if its work is outdated, or takes too much time or memory."""
        with self._changed:
            while not self._closed:
                if self._working is None:
                    self._changed.wait()
                    continue
                spent = time.monotonic() - self._since
                if self._waiting is not None and self._is_ready and spent > GRACE:
                    self._end(FRESH)
                elif spent > self.time:
                    self._end(f"building took more than {self.time:g} s and was stopped; {SMALLER}")
                elif memory_of(getattr(self._process, "pid", None) or 0) > self.memory:
                    size = f"{self.memory / 1e9:.3g} GB"
                    self._end(
                        f"building took more than {size} of memory and was stopped; {SMALLER}"
                    )
                self._changed.wait(PERIOD)

    def _end(self, reason: str) -> None:
        """End the work of the process, which is started again."""
        self._reason = reason
        self._is_ended = True
        self._kill()
        self._working = None

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()


def work(connection: Connection, kind: str) -> None:
    """Loop of the process: requests in, pictures out."""
    begin_child(urgent=kind == FIRST)
    warnings.simplefilter("ignore")
    with suppress(EOFError, OSError, KeyboardInterrupt):
        connection.send(READY)
        connection.send(_picture(connection.recv(), kind))
        if kind == FIRST and not connection.poll(QUIET):
            _picture(Request(0, REHEARSAL, Path("rehearsal.toml")), kind)
        while True:
            connection.send(_picture(connection.recv(), kind))


def _picture(request: Request, kind: str) -> Picture:
    try:
        return KINDS[kind](request.text, request.path)
    except Exception:
        message = f"internal error; please report it:\n{traceback.format_exc(limit=-3)}"
        return Picture(problems=(Problem("error", message),))
