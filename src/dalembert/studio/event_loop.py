"""Calls between the event loop of the server and other threads."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from contextlib import suppress
from typing import Any, TypeVar

T = TypeVar("T")


def in_loop(act: Callable[..., None]) -> Callable[..., None]:
    """A function that threads call, which is carried out in the running event loop.

    Nothing happens once the loop is closed.
    """
    loop = asyncio.get_running_loop()

    def call(*arguments: Any) -> None:
        with suppress(RuntimeError):  # the loop is closed
            loop.call_soon_threadsafe(act, *arguments)

    return call


async def in_thread(act: Callable[[], T]) -> T:
    """Value of a function that takes long, while the loop goes on.

    The thread does not delay the end of the program, as one of ``asyncio.to_thread`` does.
    """
    future: asyncio.Future[T] = asyncio.get_running_loop().create_future()

    def settle(error: Exception | None, value: Any) -> None:
        if future.done():  # cancelled
            return
        if error is None:
            future.set_result(value)
        else:
            future.set_exception(error)

    report = in_loop(settle)

    def run() -> None:
        try:
            report(None, act())
        except Exception as error:
            report(error, None)

    threading.Thread(target=run, daemon=True).start()
    return await future
