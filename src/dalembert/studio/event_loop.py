"""Calls into the event loop of the server from other threads."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from contextlib import suppress
from typing import Any


def in_loop(act: Callable[..., None]) -> Callable[..., None]:
    """A function that threads call, which is carried out in the running event loop.

    Nothing happens once the loop is closed.
    """
    loop = asyncio.get_running_loop()

    def call(*arguments: Any) -> None:
        with suppress(RuntimeError):  # the loop is closed
            loop.call_soon_threadsafe(act, *arguments)

    return call
