"""Numbers that options of analyses may have."""

from __future__ import annotations

from typing import Any

from dalembert.errors import UnsupportedError


def need_count(strategy: Any) -> None:
    """Some modes must be asked for.

    Raises
    ------
    UnsupportedError
        None are.
    """
    if not strategy.count > 0:
        kind = type(strategy).__name__
        raise UnsupportedError(f"{kind}: count is {strategy.count}; it must be positive")


def require(strategy: Any, positive: tuple[str, ...], whole: tuple[str, ...] = ()) -> None:
    """Options must be positive, some of them whole numbers.

    Raises
    ------
    UnsupportedError
        One is not.
    """
    kind = type(strategy).__name__
    for name in (*positive, *whole):
        value = getattr(strategy, name)
        if not value > 0:
            raise UnsupportedError(f"{kind}: {name} must be positive, it is {value}")
        if name in whole and value != int(value):
            raise UnsupportedError(f"{kind}: {name} must be a whole number, it is {value}")
