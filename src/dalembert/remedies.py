"""Remedies that errors carry beside their text: names to write, keys to add, units that fit."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class Remedy:
    """A change of the input that removes an error.

    Attributes
    ----------
    place : path of the entry in a model file, such as ``joints.A.type``; empty for the place of
        the error
    """

    place: str = ""


@dataclass(frozen=True)
class Rename(Remedy):
    """Write another name or number.

    Attributes
    ----------
    wrong : text at the place of the error; empty for its key
    right : text to write
    """

    wrong: str = ""
    right: str = ""


@dataclass(frozen=True)
class Insert(Remedy):
    """Add a key.

    Attributes
    ----------
    key : in the table of the error; empty for the key at which the error is
    value : its value; None for a usual one
    """

    key: str = ""
    value: Any = None


@dataclass(frozen=True)
class FitUnit(Remedy):
    """Write a number with a unit of another dimension.

    Attributes
    ----------
    expected : units that fit, separated by ``|``; empty for a plain number
    """

    expected: str = ""


class Advice(str):
    """A message with its remedies."""

    remedies: tuple[Remedy, ...]

    def __new__(cls, text: str, remedies: Iterable[Remedy] = ()) -> Advice:
        """A message; those of its parts are given with it."""
        advice = super().__new__(cls, text)
        advice.remedies = tuple(remedies)
        return advice


def remedies_in(message: Any) -> tuple[Remedy, ...]:
    """Remedies of a message, or of the error that states it."""
    if isinstance(message, BaseException):
        return next(_remedies_of(message), ())
    return message.remedies if isinstance(message, Advice) else ()


def _remedies_of(error: BaseException | None) -> Iterator[tuple[Remedy, ...]]:
    """Remedies of an error, or of the one while which it was raised, where there are any."""
    while error is not None:
        own = tuple(remedy for part in error.args for remedy in remedies_in(part))
        own = getattr(error, "remedies", ()) or own
        if own:
            yield own
        error = error.__context__


def at_place(place: str, remedies: Iterable[Remedy]) -> tuple[Remedy, ...]:
    """Remedies with the path of their entry, where they have none."""
    return tuple(r if r.place else replace(r, place=place) for r in remedies)
