"""Keywords that nothing takes, told with the nearest one that there is."""

from __future__ import annotations

import dataclasses
import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any, ParamSpec, TypeVar

from dalembert.errors import KeywordError
from dalembert.text.wording import listed, nearest

P = ParamSpec("P")
T = TypeVar("T")


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


def spelled_fields(cls: type, *given: Any, **named: Any) -> Any:
    """A ``__new__`` of dataclasses that looks at keywords before ``__init__`` does."""
    if named:
        known = [f.name for f in dataclasses.fields(cls) if f.init]
        if not known or set(named) - set(known):
            known = list(inspect.signature(cls).parameters)  # of those that have their own
        check_keywords(cls.__name__, named, known)
    return object.__new__(cls)


class OfInit:
    """What ``inspect`` says of a class with ``spelled_fields``: the arguments of ``__init__``."""

    def __get__(self, made: Any, cls: Any) -> inspect.Signature:
        own = inspect.signature(cls.__init__)
        return own.replace(parameters=list(own.parameters.values())[1:])


def spelled(function: Callable[P, T]) -> Callable[P, T]:
    """The function, which tells the nearest keyword of one that it does not take."""
    known = list(inspect.signature(function).parameters)

    @functools.wraps(function)
    def checked(*given: P.args, **named: P.kwargs) -> T:
        check_keywords(function.__name__, named, known)
        return function(*given, **named)

    return checked
