"""Command line: ``dalembert check | run | sensitivity | optimize | sweep | report``, and more."""

from __future__ import annotations

import atexit
import signal
import sys
from collections.abc import Sequence

INTERRUPTED = 130
"""Exit code of a command that Ctrl-C ended."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; Ctrl-C during the import is handled as well."""
    atexit.register(signal.signal, signal.SIGINT, signal.SIG_IGN)  # all files are complete by then
    try:
        from dalembert.cli.app import main as run_command

        return run_command(arguments)
    except KeyboardInterrupt:
        print("Error: interrupted", file=sys.stderr)
        return INTERRUPTED
