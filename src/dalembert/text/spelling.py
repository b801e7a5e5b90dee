"""Keywords that nothing takes, told with the nearest one that there is, and missing arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from dalembert.errors import KeywordError
from dalembert.text.wording import listed, nearest

P = ParamSpec("P")
T = TypeVar("T")
POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
OPEN = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def check_keywords(owner: str, given: Iterable[str], known: Iterable[str]) -> None:
    """Refuse a keyword that is not known.

    Raises
    ------
    KeywordError
        Names the owner, the keyword and the nearest one.
    """
    names = list(known)
    for name in given:
        if name not in names:
            raise KeywordError(
                f"unknown keyword {name!r}{nearest(name, names)}; known: {listed(names)}", owner
            )


def check_complete(
    owner: str, wanted: Sequence[inspect.Parameter], given: int, named: Iterable[str]
) -> None:
    """Refuse a call that leaves out an argument without default, or has too many without keyword.

    Raises
    ------
    KeywordError
        Names the owner, what is missing and all that is needed, or what needs a keyword.
    """
    ordered = [one.name for one in wanted if one.kind in POSITIONAL]
    there = {*ordered[:given], *named}
    needed = [one.name for one in wanted if one.default is one.empty and one.kind not in OPEN]
    missing = [name for name in needed if name not in there]
    if given > len(ordered) and not any(one.kind is one.VAR_POSITIONAL for one in wanted):
        rest = [one.name for one in wanted if one.kind is one.KEYWORD_ONLY]
        by_name = missing or [name for name in rest if name not in named]
        cure = f"; write {by_name[0]}=…" if by_name else ""
        raise KeywordError(
            f"{given} argument(s) without a keyword, at most {len(ordered)} can be "
            f"({listed(ordered)}){cure}",
            owner,
        )
    if missing:
        optional = [name for name in ordered[:given] if name not in needed]
        read = f" (without a keyword, the order is {listed(ordered)})" if optional else ""
        raise KeywordError(f"missing {listed(missing)}{read}; needed: {listed(needed)}", owner)


def spelled_fields(cls: type, *given: Any, **named: Any) -> Any:
    """A ``__new__`` that looks at arguments before ``__init__`` does.

    Without any it is left to Python, for that is how objects are copied, too.
    """
    wanted = arguments_of(cls)
    if named:
        check_keywords(cls.__name__, named, [one.name for one in wanted])
    if given or named:
        check_complete(cls.__name__, wanted, len(given), named)
    return object.__new__(cls)


@functools.cache
def arguments_of(cls: type) -> list[inspect.Parameter]:
    """What making one takes."""
    return list(inspect.signature(cls).parameters.values())


class OfInit:
    """What ``inspect`` says of a class with ``spelled_fields``: the arguments of ``__init__``."""

    def __get__(self, made: Any, cls: Any) -> inspect.Signature:
        own = inspect.signature(cls.__init__)
        return own.replace(parameters=list(own.parameters.values())[1:])


class Spelled:
    """A class that tells what is missing, and the nearest keyword of a wrong one."""

    __slots__ = ()
    if not TYPE_CHECKING:
        __new__ = spelled_fields
        __signature__ = OfInit()


def spelled(function: Callable[P, T]) -> Callable[P, T]:
    """The function or method, which tells what is missing, and the nearest of a wrong keyword."""
    every = list(inspect.signature(function).parameters.values())
    own = int(bool(every) and every[0].name == "self")
    wanted = every[own:]
    known = [one.name for one in wanted]
    closed = not any(one.kind is one.VAR_KEYWORD for one in wanted)

    @functools.wraps(function)
    def checked(*given: P.args, **named: P.kwargs) -> T:
        if closed:
            check_keywords(function.__name__, named, known)
        check_complete(function.__name__, wanted, len(given) - own, named)
        return function(*given, **named)

    return checked
