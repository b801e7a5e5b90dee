"""Caches beside the objects whose functions they serve, and graphs written once as templates."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property, wraps
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar

import casadi as ca

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

CACHE_SIZE = 256
"""Upper limit of cached results per owner and function; the least recently used is dropped."""


class CacheOwner(Protocol):
    """Object with a cache, which is freed with it, even if results refer to their owner.

    Copies of the object, in memory or in files, start without cached values.
    """

    @cached_property
    def cache(self) -> dict[Callable[..., Any], dict[Any, Any]]:
        """Function → its results by arguments."""
        return {}

    def __getstate__(self) -> dict[str, Any]:
        kind = type(self)
        cached = {n for n in vars(self) if isinstance(getattr(kind, n, None), cached_property)}
        return {name: value for name, value in vars(self).items() if name not in cached}


Owner = TypeVar("Owner", bound=CacheOwner)


def once(
    function: Callable[Concatenate[Owner, Arguments], Result],
) -> Callable[Concatenate[Owner, Arguments], Result]:
    """Decorator: cache the results of a function on its first argument, the owner.

    The other arguments are hashable: strategies by their values, expressions and steps by their
    identity.
    """

    @wraps(function)
    def cached(owner: Owner, *arguments: Arguments.args, **options: Arguments.kwargs) -> Result:
        key = (arguments, tuple(sorted(options.items())))
        results: dict[Any, Result] = owner.cache.setdefault(function, {})
        result = results.pop(key) if key in results else function(owner, *arguments, **options)
        results[key] = result  # the most recently used is last
        if len(results) > CACHE_SIZE:
            del results[next(iter(results))]
        return result

    return cached


def template(*sizes: int) -> Callable[[Callable[..., ca.SX]], Callable[..., ca.SX]]:
    """Decorator: write the graph of a function once, for inputs of these sizes, and copy it.

    The graph is the same. CasADi copies it twenty times faster than Python writes it operation by
    operation, which is noticeable for a mechanism of a thousand bodies.
    """

    def decorated(write: Callable[..., ca.SX]) -> Callable[..., ca.SX]:
        @cache
        def graph() -> ca.Function:
            symbols = [ca.SX.sym(f"x{k}", size) for k, size in enumerate(sizes)]
            return ca.Function("template", symbols, [write(*symbols)])

        @wraps(write)
        def copied(*expressions: ca.SX) -> ca.SX:
            return graph()(*expressions)

        return copied

    return decorated
