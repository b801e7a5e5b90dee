"""Checks of arguments: unknown keywords, with the nearest known one, and missing arguments."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

from dalembert.errors import KeywordError
from dalembert.text.wording import listed, misspelt

P = ParamSpec("P")
T = TypeVar("T")
POSITIONAL = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
OPEN = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)


def check_keywords(owner: str, keywords: Iterable[str], known: Iterable[str]) -> None:
    """Refuse an unknown keyword.

    Raises
    ------
    KeywordError
        Names the owner, the keyword and the nearest one.
    """
    names = list(known)
    for name in keywords:
        if name not in names:
            raise KeywordError(
                misspelt(f"unknown keyword {name!r}", name, names, f"; known: {listed(names)}"),
                owner,
            )


def check_complete(
    owner: str, parameters: Sequence[inspect.Parameter], count: int, keywords: Iterable[str]
) -> None:
    """Refuse a call without a required argument, or with too many positional ones.

    Parameters
    ----------
    owner : the function or class that is called
    parameters : of its signature
    count : number of positional arguments
    keywords : names of the keyword arguments

    Raises
    ------
    KeywordError
        Names the owner and the missing and required arguments, or those that need a keyword.
    """
    positional = [p.name for p in parameters if p.kind in POSITIONAL]
    supplied = {*positional[:count], *keywords}
    required = [p.name for p in parameters if p.default is p.empty and p.kind not in OPEN]
    missing = [name for name in required if name not in supplied]
    if count > len(positional) and not any(p.kind is p.VAR_POSITIONAL for p in parameters):
        keyword_only = [p.name for p in parameters if p.kind is p.KEYWORD_ONLY]
        by_name = missing or [name for name in keyword_only if name not in keywords]
        cure = f"; write {by_name[0]}=…" if by_name else ""
        raise KeywordError(
            f"{count} argument(s) without a keyword, at most {len(positional)} can be "
            f"({listed(positional)}){cure}",
            owner,
        )
    if missing:
        optional = [name for name in positional[:count] if name not in required]
        order = f" (without a keyword, the order is {listed(positional)})" if optional else ""
        raise KeywordError(f"missing {listed(missing)}{order}; needed: {listed(required)}", owner)


def check_constructor(cls: type, *args: Any, **kwargs: Any) -> Any:
    """A ``__new__`` that checks arguments before ``__init__`` runs.

    A call without arguments is not checked: objects are copied that way.
    """
    parameters = arguments_of(cls)
    if kwargs and not any(p.kind is p.VAR_KEYWORD for p in parameters):
        check_keywords(cls.__name__, kwargs, [p.name for p in parameters])
    if args or kwargs:
        check_complete(cls.__name__, parameters, len(args), kwargs)
    return object.__new__(cls)


@functools.cache
def arguments_of(cls: type) -> list[inspect.Parameter]:
    """Parameters of the constructor of a class."""
    return list(inspect.signature(cls).parameters.values())


class ConstructorSignature:
    """Signature of a class with ``check_constructor``: the arguments of its ``__init__``."""

    def __get__(self, instance: Any, cls: Any) -> inspect.Signature:
        signature = inspect.signature(cls.__init__)
        return signature.replace(parameters=list(signature.parameters.values())[1:])


class CheckedArguments:
    """Base of classes whose constructor names missing arguments and suggests keywords."""

    __slots__ = ()
    if not TYPE_CHECKING:
        __new__ = check_constructor
        __signature__ = ConstructorSignature()


def check_arguments(function: Callable[P, T]) -> Callable[P, T]:
    """Decorator of a function or method: names missing arguments and suggests keywords."""
    parameters = list(inspect.signature(function).parameters.values())
    is_method = int(bool(parameters) and parameters[0].name in ("self", "cls"))
    parameters = parameters[is_method:]
    names = [p.name for p in parameters]
    closed = not any(p.kind is p.VAR_KEYWORD for p in parameters)

    @functools.wraps(function)
    def checked(*args: P.args, **kwargs: P.kwargs) -> T:
        if closed:
            check_keywords(function.__name__, kwargs, names)
        check_complete(function.__name__, parameters, len(args) - is_method, kwargs)
        return function(*args, **kwargs)

    return checked
