"""The server of the studio: on this machine only, until it is stopped."""

from __future__ import annotations

import asyncio
import logging
import secrets
import socket
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import uvicorn

from dalembert.errors import FileError, UnsupportedError
from dalembert.studio.child import prepare_children
from dalembert.studio.draft import Draft

if TYPE_CHECKING:
    from dalembert.studio.session import Session

MAX_MESSAGE = 8_000_000
"""Upper limit of a message of a page [bytes]."""


class QuietServer(uvicorn.Server):
    """Server whose end is no error of the requests that it ends, such as an upload."""

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End the requests and connections."""
        logging.getLogger("uvicorn.error").setLevel(logging.CRITICAL)
        await super().shutdown(sockets)


def serve(
    path: Path | None,
    port: int,
    ready: Callable[[str], None],
    begin: Callable[[str], None] = lambda address: None,
) -> None:
    """Serve the studio for a model file until Ctrl-C or a request of the page.

    The browser starts, and the parent of children imports modules, while this process does.

    Parameters
    ----------
    path : of the model file; None for a new model
    port : of the loopback interface; zero for a free one
    ready : called with the address of the page, which contains a random token
    begin : called with it earlier, before modules are imported; requests wait for their answers

    Raises
    ------
    FileError
        The file cannot be read, or the port is in use.
    UnsupportedError
        The system refuses a process or thread.
    """
    Draft(path, "")  # a file that cannot be read is reported before the page is opened
    listener = socket.socket()
    try:
        listener.bind(("127.0.0.1", port))
        listener.listen()
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise FileError(f"port {port}: {reason}; choose another with --port") from None
    port = listener.getsockname()[1]
    token = secrets.token_urlsafe(24)
    address = f"http://127.0.0.1:{port}/{token}/"
    prepare_children()
    begin(address)
    from dalembert.studio.application import make_application
    from dalembert.studio.session import Session

    session = Session(path)
    server = QuietServer(
        uvicorn.Config(
            lambda: make_application(session, token, port, stop),
            factory=True,
            log_level="error",
            ws_max_size=MAX_MESSAGE,
            lifespan="off",
            timeout_graceful_shutdown=1,
        )
    )

    def stop() -> None:
        server.should_exit = True

    async def run() -> None:
        try:
            start_processes(session)
            ready(address)
            await server.serve(sockets=[listener])
        finally:
            session.close()

    asyncio.run(run())


def start_processes(session: Session) -> None:
    """Start the processes and threads of a session.

    Raises
    ------
    UnsupportedError
        The system refuses one, such as for lack of memory.
    """
    try:
        session.start()
    except (RuntimeError, MemoryError, OSError) as error:  # threads raise a RuntimeError
        reason = str(error) or type(error).__name__
        raise UnsupportedError(
            f"the studio cannot start its processes ({reason}); raise the limit of memory "
            "(ulimit -v) or of processes (ulimit -u)"
        ) from None
