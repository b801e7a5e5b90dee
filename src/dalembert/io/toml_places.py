"""Places of the keys and values of a TOML text, for messages and for editors."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass

Keys = tuple[str | int, ...]

_SPACE = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BLANK = re.compile(r"[ \t]*")
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_STRING = re.compile(
    r'"""(?:[^\\]|\\.)*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'', re.DOTALL
)
_SCALAR = re.compile(r"[^,\]}\n#]+")


@dataclass(frozen=True)
class Place:
    """Range of characters of a key and its value.

    Attributes
    ----------
    start : of the key; of the value for entries of arrays
    value : start of the value
    end : behind the value; behind the header for tables
    is_header : whether it is a header such as ``[bodies.crank]``
    """

    start: int
    value: int
    end: int
    is_header: bool = False


def toml_places(text: str) -> dict[Keys, Place]:
    """Key path → place, for all keys of a valid TOML text.

    Parameters
    ----------
    text : that ``tomllib`` reads

    Examples
    --------
    >>> text = "[bodies]\\nbar = { length = 0.3 }"
    >>> place = toml_places(text)["bodies", "bar", "length"]
    >>> text[place.value : place.end]
    '0.3'
    """
    return dict(_Scanner(text).run())


def line_and_column(text: str, offset: int) -> tuple[int, int]:
    """Line and column of a character, both from 1 on."""
    before = text.rfind("\n", 0, offset) + 1
    return text.count("\n", 0, offset) + 1, offset - before + 1


def parse_keys(path: str) -> Keys:
    """Keys of a path as messages write it: ``joints.A.connect[1]``.

    Examples
    --------
    >>> parse_keys("joints.A.connect[1]")
    ('joints', 'A', 'connect', 1)
    """
    keys: list[str | int] = []
    for part in re.finditer(r'"((?:[^"\\]|\\.)*)"|\[(\d+)\]|([A-Za-z0-9_-]+)', path):
        quoted, index, bare = part.groups()
        keys.append(int(index) if index is not None else bare if quoted is None else quoted)
    return tuple(keys)


class _Scanner:
    """One pass over a valid text."""

    def __init__(self, text: str):
        self.text = text
        self.at = 0
        self.counts: dict[Keys, int] = {}
        """Tables of an array of tables so far."""

    def run(self) -> Iterator[tuple[Keys, Place]]:
        table: Keys = ()
        while True:
            self.skip(_SPACE)
            if self.at >= len(self.text):
                return
            if self.text[self.at] == "[":
                start = self.at
                table, is_entry = self.header()
                if is_entry:
                    number = self.counts.get(table, 0)
                    self.counts[table] = number + 1
                    table = (*table, number)
                yield table, Place(start, start, self.at, is_header=True)
            else:
                yield from self.entry(table)

    def header(self) -> tuple[Keys, bool]:
        """Keys of ``[a.b]`` or ``[[a.b]]``, and whether it begins an entry of an array."""
        double = self.text.startswith("[[", self.at)
        self.at += 2 if double else 1
        keys: Keys = ()
        names = self.dotted()
        for k, name in enumerate(names):
            keys = (*keys, name)
            if keys in self.counts and not (double and k == len(names) - 1):
                keys = (*keys, self.counts[keys] - 1)
        self.at += 2 if double else 1
        return keys, double

    def entry(self, table: Keys) -> Iterator[tuple[Keys, Place]]:
        """A key with its value, and all that the value contains."""
        start = self.at
        keys = (*table, *self.dotted())
        self.at += 1  # =
        self.skip(_BLANK)
        value = self.at
        inner = list(self.value(keys))
        yield keys, Place(start, value, self.at)
        yield from inner

    def dotted(self) -> Keys:
        """Names of a dotted key; the scan ends behind it and the spaces that follow."""
        names: list[str] = []
        while True:
            self.skip(_BLANK)
            bare = _BARE.match(self.text, self.at)
            if bare:
                names.append(bare[0])
                self.at = bare.end()
            else:
                names.append(self.string())
            self.skip(_BLANK)
            if not self.text.startswith(".", self.at):
                return tuple(names)
            self.at += 1

    def string(self) -> str:
        match = _STRING.match(self.text, self.at)
        if match is None:
            raise ValueError(f"no TOML at character {self.at}")
        self.at = match.end()
        name: str = tomllib.loads(f"k = {match[0]}")["k"]
        return name

    def value(self, keys: Keys) -> Iterator[tuple[Keys, Place]]:
        opening = self.text[self.at]
        if opening == "[":
            yield from self.array(keys)
        elif opening == "{":
            yield from self.inline_table(keys)
        elif match := _STRING.match(self.text, self.at):
            self.at = match.end()
        elif match := _SCALAR.match(self.text, self.at):
            self.at += len(match[0].rstrip())

    def array(self, keys: Keys) -> Iterator[tuple[Keys, Place]]:
        self.at += 1
        number = 0
        while True:
            self.skip(_SPACE)
            if self.text[self.at] == "]":
                self.at += 1
                return
            start = self.at
            inner = list(self.value((*keys, number)))
            yield (*keys, number), Place(start, start, self.at)
            yield from inner
            number += 1
            self.skip(_SPACE)
            self.at += self.text[self.at] == ","

    def inline_table(self, keys: Keys) -> Iterator[tuple[Keys, Place]]:
        self.at += 1
        while True:
            self.skip(_SPACE)
            if self.text[self.at] == "}":
                self.at += 1
                return
            yield from self.entry(keys)
            self.skip(_SPACE)
            self.at += self.text[self.at] == ","

    def skip(self, pattern: re.Pattern[str]) -> None:
        match = pattern.match(self.text, self.at)
        self.at = match.end() if match else self.at
