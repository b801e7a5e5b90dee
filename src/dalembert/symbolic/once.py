"""Results that are made once and kept by what they belong to."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

Owner = TypeVar("Owner")
Given = ParamSpec("Given")
Made = TypeVar("Made")

MOST = 256
"""Results that an owner keeps of one function; the one not asked for longest goes first."""


def once(
    make: Callable[Concatenate[Owner, Given], Made],
) -> Callable[Concatenate[Owner, Given], Made]:
    """Decorator: what a function makes of its first argument is kept there, for the others.

    It goes when its owner goes. The other arguments are hashable: strategies by their values,
    expressions and steps by their identity.
    """

    @wraps(make)
    def kept(owner: Owner, *given: Given.args, **named: Given.kwargs) -> Made:
        key = (given, tuple(sorted(named.items())))
        found: dict[Any, Made] = vars(owner).setdefault("_once", {}).setdefault(make, {})
        made = found.pop(key) if key in found else make(owner, *given, **named)
        found[key] = made  # the newest stands last
        if len(found) > MOST:
            del found[next(iter(found))]
        return made

    return kept


def forget(owner: object) -> None:
    """Drop all that is kept on an object, so that the time to make it is seen again."""
    vars(owner).pop("_once", None)
