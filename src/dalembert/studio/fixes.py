"""Remedies of errors as replacements in the text."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.toml_places import Keys, Place, parse_keys
from dalembert.remedies import FitUnit, Insert, Remedy, Rename
from dalembert.studio.text_edits import TextEdits
from dalembert.studio.toml_values import as_toml
from dalembert.units.unit import unit

VALUES: dict[str, Any] = {
    "format": 1,
    "connect": ["ground", "ground"],
    "law": "t",
    "duration": 1.0,
}
"""Missing key → the value with which it is inserted; numbers are one."""
NUMBER = r"(?<![\w.])\d[\d_]*\.?\d*(?:[eE][+-]?\d+)?"
AMOUNT = re.compile(rf"({NUMBER})\s*([^\W\d_](?:[\w^²³/·]|\*(?=[^\W\d]))*)(?![\w(.\[])")
"""A number with a unit, as in ``2*45 mm``."""
KEY = re.compile(r'"(?:[^"\\]|\\.)*"|\'[^\']*\'|[A-Za-z0-9_-]+')
"""A name in a header or a dotted key."""


@dataclass(frozen=True)
class Fix:
    """A replacement in the text.

    Attributes
    ----------
    title : of its button
    start, end : characters that are replaced
    insert : text in their place
    """

    title: str
    start: int
    end: int
    insert: str


def fix_between(title: str, before: str, after: str) -> Fix:
    """The shortest replacement that leads from one text to another."""
    pairs = zip(before, after, strict=False)
    start = next((k for k, (a, b) in enumerate(pairs) if a != b), min(len(before), len(after)))
    most = min(len(before), len(after)) - start
    ends = zip(reversed(before), reversed(after), strict=False)
    end = min(next((k for k, (a, b) in enumerate(ends) if a != b), most), most)
    return Fix(title, start, len(before) - end, after[start : len(after) - end])


def fixes_of(
    remedies: Iterable[Remedy], keys: Keys, places: Mapping[Keys, Place], text: str
) -> tuple[Fix, ...]:
    """Remedies of an error as replacements.

    Parameters
    ----------
    remedies : of the error
    keys : at which it is; they may be missing in the text
    places : of the keys in the text
    text : of the model file
    """
    fixes: list[Fix] = []
    for remedy in remedies:
        where = parse_keys(remedy.place) if remedy.place else keys
        if isinstance(remedy, Rename):
            fixes += _replacement(remedy, where, places, text)
        elif isinstance(remedy, Insert):
            fixes += _insertion(remedy, where, text)
        elif isinstance(remedy, FitUnit):
            fixes += _fitting_units(remedy.expected, where, places, text)
    return tuple(fixes)


def _known(keys: Keys, places: Mapping[Keys, Place]) -> Keys:
    """The part of the keys that the text has."""
    while keys and keys not in places:
        keys = keys[:-1]
    return keys


def _replacement(
    remedy: Rename, keys: Keys, places: Mapping[Keys, Place], text: str
) -> Iterator[Fix]:
    """Replace a name at the place of an error, or in its key."""
    if not remedy.wrong:
        yield from _renamed_key(remedy.right, keys, places, text)
        return
    keys = _known(keys, places)
    if not keys:
        return
    name, place = remedy.wrong, places[keys]
    if re.fullmatch(NUMBER, name):
        numbers = re.finditer(rf"{NUMBER}(?!\w|\s*[^\W\d])", text[place.value : place.end])
        same = [match for match in numbers if float(match[0]) == float(name)]
        over_time = list(_over_time("rad | m", keys, places, text))
        yield from over_time
        if same and not over_time:
            start, end = (place.value + k for k in same[0].span())
            yield Fix(f"Write {remedy.right}", start, end, remedy.right)
        return
    word = re.compile(rf"(?<![\w.]){re.escape(name)}(?!\w)")
    match = word.search(text, place.start, place.end) or word.search(text, place.start)
    if match is not None:
        yield Fix(f"Write {remedy.right}", match.start(), match.end(), remedy.right)


def _renamed_key(right: str, keys: Keys, places: Mapping[Keys, Place], text: str) -> Iterator[Fix]:
    """Replace the last name of a key in all headers and dotted keys that have it."""
    spans = set()
    for path, place in places.items():
        if not keys or path[: len(keys)] != keys:
            continue
        end = place.end if place.is_header else place.value
        names = list(KEY.finditer(text[place.start : end]))
        written = [key for key in path if isinstance(key, str)][-len(names) :] if names else []
        at = sum(isinstance(key, str) for key in keys) - 1
        at -= sum(isinstance(key, str) for key in path) - len(written)
        if at >= 0 and isinstance(keys[-1], str):
            spans.add((place.start + names[at].start(), place.start + names[at].end()))
    mended = text
    for start, end in sorted(spans, reverse=True):
        mended = mended[:start] + right + mended[end:]
    try:
        tomllib.loads(mended)
    except tomllib.TOMLDecodeError:  # both names have a header
        return
    if spans:
        yield fix_between(f"Write {right}", text, mended)


def _insertion(remedy: Insert, keys: Keys, text: str) -> Iterator[Fix]:
    """Add a key to its table."""
    if remedy.key:
        keys = (*keys[:-1], remedy.key)
    if not keys or not isinstance(keys[-1], str):
        return
    value = VALUES.get(keys[-1], 1.0) if remedy.value is None else remedy.value
    if len(keys) == 1:
        insert = f"{keys[0]} = {as_toml(value)}\n"
        yield Fix(f"Insert {insert.strip()}", 0, 0, insert)
        return
    try:
        edits = TextEdits(text)
        edits.set_value(keys, value)
    except DalembertError:
        return
    yield fix_between(f"Insert {keys[-1]} = {as_toml(value)}", text, edits.text)


def _fitting_units(
    expected: str, keys: Keys, places: Mapping[Keys, Place], text: str
) -> Iterator[Fix]:
    """Replace the first unit that does not fit at the place of an error, or in its parameter."""
    keys = _known(keys, places)
    if not keys:
        return
    value = text[places[keys].value : places[keys].end].strip("\"'")
    if ("parameters", value) in places:
        keys = ("parameters", value)
    start = places[keys].value
    over_time = list(_over_time(expected, keys, places, text))
    if over_time:
        yield from over_time
        return
    usual = expected.split("|")[0].strip()
    usual = "" if usual == "1" else usual
    for match in AMOUNT.finditer(text, start, places[keys].end):
        number, written = match[1], match[2]
        if _fits(written, expected):
            continue
        right = f"{number} {usual}".strip()
        yield Fix(f"Write {right}", match.start(), match.end(), right)
        return


def _over_time(expected: str, keys: Keys, places: Mapping[Keys, Place], text: str) -> Iterator[Fix]:
    """Multiply the speed in a law by the time."""
    if keys[-1] == "law":
        for match in AMOUNT.finditer(text, places[keys].value, places[keys].end):
            if not _fits(match[2], expected) and _fits(f"{match[2]} s", expected):
                yield Fix(f"Write {match[0]}*t", match.end(), match.end(), "*t")


def _fits(written: str, expected: str) -> bool:
    """Whether a unit has an expected dimension; that of other words is unknown."""
    try:
        return unit(written).fits(expected)
    except DalembertError:
        return True
