"""Names of parts, from the labels, groups and entities of a drawing."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from itertools import count

from dalembert.io.imports.sketches.roles import is_generic

AUTOMATIC = re.compile(r"[A-Za-z]+[-_]?\d{2,}(-\d+)*|\d+")
"""Names that drawing programs give, such as ``path1234-5``."""
LONGEST = 40
"""Upper limit of the length of a name from a drawing."""


def identifier(text: str) -> str:
    """A text as a name: letters, digits and ``_``; empty if it has no letter.

    >>> identifier("pièce 2 (link)"), identifier("12")
    ('piece_2_link', '')
    """
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"\W+", "_", plain).strip("_")[:LONGEST].rstrip("_")
    return name if re.match("[A-Za-z]", name) else ""


def is_automatic(name: str) -> bool:
    """Whether a program gave the name, not a person."""
    return bool(AUTOMATIC.fullmatch(name) or is_generic(name))


class Names:
    """Unique names.

    Parameters
    ----------
    reserved : names with a meaning
    """

    def __init__(self, reserved: Iterable[str]):
        self.used = set(reserved)

    def unique(self, wish: str, series: Iterator[str]) -> str:
        """The wish, with a number if it is used; the next of a series without a wish."""
        name = identifier(wish)
        candidates = numbered(name) if name else series
        chosen = next(candidate for candidate in candidates if candidate not in self.used)
        self.used.add(chosen)
        return chosen


def numbered(name: str) -> Iterator[str]:
    """``A``, ``A2``, ``A3``, …"""
    yield name
    yield from (f"{name}{k}" for k in count(2))


def series(prefix: str) -> Iterator[str]:
    """``O1``, ``O2``, …"""
    return (f"{prefix}{k}" for k in count(1))


def letters() -> Iterator[str]:
    """``A``, ``B``, …, ``Z``, ``A1``, …, without ``O``, which is for the ground."""
    alphabet = "ABCDEFGHIJKLMNPQRSTUVWXYZ"
    yield from alphabet
    yield from (f"{letter}{k}" for k in count(1) for letter in alphabet)
