"""Uses of a name in a model file: its own key, references and formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping

from dalembert.io.toml_places import Keys, Place

VALUES = ("parameters", "derived", "inputs", "outputs")
"""Sections whose names formulas use without a dot."""
Span = tuple[int, int]


def uses_of(text: str, places: Mapping[Keys, Place], section: str, name: str) -> set[Span]:
    """Ranges of characters of the name of an entry.

    Parameters
    ----------
    text : of the file
    places : of its keys
    section, name : of the entry
    """
    word = re.compile(rf"(?<![\w.]){re.escape(name)}(?!\w)")
    spans: set[Span] = set()
    for keys, place in places.items():
        if keys[:2] == (section, name):
            end = place.value if place.value > place.start else place.end
            spans |= _own_name(text, name, section, place.start, end, len(keys) == 2)
        value = text[place.value : place.end]
        if value[:1] in ('"', "'"):
            spans |= _uses(word, value, place.value, section in VALUES)
    return spans


def _own_name(
    text: str, name: str, section: str, start: int, end: int, is_entry: bool
) -> set[tuple[int, int]]:
    """Place of the name of an entry in its key or in a header."""
    key = text[start:end]
    if key.startswith("["):
        match = re.search(rf"{section}\s*\.\s*(\"?{re.escape(name)}\"?)(?=\s*[.\]])", key)
    else:
        match = re.match(rf"((?<![\w.])\"?{re.escape(name)}\"?)\s*[.=]", key) if is_entry else None
    return {(start + match.start(1), start + match.end(1))} if match else set()


def _uses(word: re.Pattern[str], value: str, at: int, is_value: bool) -> set[tuple[int, int]]:
    """Places of a name in a text value: of an element as a whole or before a dot."""
    spans = set()
    for match in word.finditer(value):
        whole = value[1:-1] == match[0]
        dotted = value[match.end() : match.end() + 1] == "."
        if whole or dotted != is_value:
            spans.add((at + match.start(), at + match.end()))
    return spans
