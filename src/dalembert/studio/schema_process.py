"""JSON Schema of model files, made in a process of its own: it takes a second."""

from __future__ import annotations

import json
import threading
from multiprocessing.connection import Connection

from dalembert.studio.child import begin_child, child_context

_lock = threading.Lock()
_texts: list[str] = []


def schema_text() -> str:
    """The JSON Schema, for completion; made once, while other threads wait.

    Raises
    ------
    EOFError
        The process has ended without it.
    """
    with _lock:
        if not _texts:
            context = child_context()
            own, other = context.Pipe(duplex=False)
            process = context.Process(target=send_schema, args=(other,), daemon=True)
            process.start()
            other.close()
            with own:
                _texts.append(own.recv())
            process.join()
        return _texts[0]


def send_schema(connection: Connection) -> None:
    """Send the JSON Schema and end."""
    begin_child()
    from dalembert.io.documents import json_schema

    connection.send(json.dumps(json_schema()))
    connection.close()
