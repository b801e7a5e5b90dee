"""Processes of the studio: their begin, their end with the server, and their use of memory."""

from __future__ import annotations

import gc
import multiprocessing.connection
import os
import sys
import threading
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from multiprocessing.context import ForkServerContext, SpawnContext

MEMORY = 3e9
"""Upper limit of the memory of a building process [bytes]."""
TIME = 300.0
"""Upper limit of the time in which a picture is made [s]."""
NICENESS = 10
"""Increase of the niceness of processes whose work is not urgent."""
PR_SET_PDEATHSIG = 1
"""Option of prctl(2): signal at the end of the thread that started this process."""

PRELOADED = (
    "dalembert.studio.building",
    "dalembert.studio.task_work",
    "dalembert.studio.export_process",
    "dalembert.results.dataset",
    "dalembert.results.files.payload",
    "dalembert.analysis.live.dynamics_module",
    "dalembert.symbolic.native.webassembly",
    "scipy.sparse.linalg",
)
"""Modules that children on Linux share; the last ones are those that pictures import late."""


def child_context() -> SpawnContext | ForkServerContext:
    """Context in which children start.

    Importing all modules takes one to two seconds. On Linux a process imports them once, and
    children are copies of it.
    """
    if sys.platform != "linux":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(list(PRELOADED))
    return context


def prepare_children() -> None:
    """Start the process of ``child_context``, which imports modules while the server does."""
    if sys.platform == "linux":
        from multiprocessing.forkserver import ensure_running

        child_context()
        ensure_running()


def begin_child(urgent: bool = True) -> None:
    """Leave interruptions to the server, end with it, and leave the output of models unprinted.

    Parameters
    ----------
    urgent : whether its work has the same priority as the server and the browser; the processor
        serves them first otherwise
    """
    end_with_parent()
    if not urgent and hasattr(os, "nice"):
        os.nice(NICENESS)
    gc.freeze()  # objects of imported modules are not searched for garbage again
    if os.name == "posix":
        import signal

        signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends the process
    silent = os.open(os.devnull, os.O_WRONLY)
    sys.stdout.flush()
    os.dup2(silent, 1)
    os.close(silent)


def end_with_parent() -> None:
    """End this process when its parent has ended, however that happened.

    On Linux the system ends it at once, also within a long computation; elsewhere a thread does.
    """
    if sys.platform == "linux":
        import ctypes
        import signal

        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_await_end, args=(parent.sentinel,), daemon=True).start()


def _await_end(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


def memory_of(process: int) -> float:
    """Resident memory of a process [bytes]; zero where the system does not state it."""
    with suppress(OSError, ValueError, IndexError):
        pages = Path(f"/proc/{process}/statm").read_text().split()[1]
        return int(pages) * float(os.sysconf("SC_PAGE_SIZE"))
    return 0.0
