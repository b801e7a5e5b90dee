"""One thread of BLAS for algebra with many small dense matrices.

Threads of BLAS wait in loops for each other. Factors of a few hundred rows then take twice the
processor time, and on busy processors more than a hundred times as long.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache

from threadpoolctl import ThreadpoolController


@contextmanager
def single_thread() -> Iterator[None]:
    """A context, or a decorator, with one thread of BLAS.

    Examples
    --------
    >>> import numpy as np
    >>> from dalembert.sparse.single_thread import single_thread
    >>> with single_thread():
    ...     np.linalg.qr(np.eye(2))[0].shape
    (2, 2)
    """
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@lru_cache
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
