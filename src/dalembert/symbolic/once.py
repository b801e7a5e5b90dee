"""Memoisation on the first argument of a function."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

Owner = TypeVar("Owner")
Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

CACHE_SIZE = 256
"""Upper limit of cached results per owner and function; the least recently used is dropped."""


def once(
    function: Callable[Concatenate[Owner, Arguments], Result],
) -> Callable[Concatenate[Owner, Arguments], Result]:
    """Decorator: cache the results of a function on its first argument, the owner.

    The cache is freed with its owner. The other arguments are hashable: strategies by their
    values, expressions and steps by their identity.
    """

    @wraps(function)
    def cached(owner: Owner, *arguments: Arguments.args, **options: Arguments.kwargs) -> Result:
        key = (arguments, tuple(sorted(options.items())))
        cache: dict[Any, Result] = vars(owner).setdefault("_once", {}).setdefault(function, {})
        result = cache.pop(key) if key in cache else function(owner, *arguments, **options)
        cache[key] = result  # the most recently used is last
        if len(cache) > CACHE_SIZE:
            del cache[next(iter(cache))]
        return result

    return cached


def forget(owner: object) -> None:
    """Clear the cache of an owner, for instance to measure the time of its functions."""
    vars(owner).pop("_once", None)
