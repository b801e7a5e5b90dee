"""Changes of a model file that leave everything else in it as it is.

Values, entries and names are replaced at their places in the text, so that comments, order and
formulas remain byte for byte. A TOML library that writes whole documents does not keep them.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.io.toml_places import Keys, Place, toml_places

ORDER = (
    *("parameters", "derived", "inputs", "outputs", "ground"),
    *("bodies", "beams", "joints", "drivers", "forces", "blocks", "analysis"),
)
"""Order of the sections of a file, for new ones."""
VALUES = ("parameters", "derived", "inputs", "outputs")
"""Sections whose names formulas use without a dot."""
MAX_TEXT = 400
"""Upper limit of the length of a text value [characters]."""
NAME = re.compile(r"[A-Za-z_]\w{0,79}", re.ASCII)


class TextEdits:
    """Changes of a TOML text, one after the other.

    Parameters
    ----------
    text : valid TOML

    Raises
    ------
    ModelError
        It is not valid.
    """

    def __init__(self, text: str):
        self._set(text)

    def _set(self, text: str) -> None:
        try:
            self.data: dict[str, Any] = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise ModelError(f"the text is not valid TOML ({error}); correct it first") from None
        self.text = text
        self.places: dict[Keys, Place] = toml_places(text)

    def names(self) -> set[str]:
        """Names of all elements, parameters and other entries."""
        tables = (self.data.get(section) for section in ORDER)
        return {name for table in tables if isinstance(table, dict) for name in table}

    def free_name(self, base: str, first: str = "") -> str:
        """A name that no entry has.

        Parameters
        ----------
        base : to which a number is appended; empty for capital letters
        """
        names = self.names()
        letters = [chr(code) for code in range(ord("A"), ord("Z") + 1)] if not base else []
        numbered = (f"{base or 'J'}{k}" for k in range(1, len(names) + 2))
        return next(name for name in (*letters, *numbered) if name not in names)

    def add(self, section: str, name: str, fields: Mapping[str, Any]) -> None:
        """Add an entry at the end of a section, in the style of its other entries.

        Raises
        ------
        ModelError
            Invalid or used name, or value.
        """
        if not NAME.fullmatch(name):
            raise ModelError(f"{name[:60]!r} is no name; use letters, digits and _", section)
        if section not in ORDER:
            raise ModelError("entries cannot be added to this section", section)
        if name in self.names():
            raise ModelError("the name is already used; choose another", key_path(section, name))
        inline = self._is_inline(section)
        if inline:
            entry = f"{name} = {as_toml(dict(fields))}\n"
        else:
            rows = "".join(f"{key} = {as_toml(value)}\n" for key, value in fields.items())
            entry = f"[{section}.{name}]\n{rows}"
        at = self._end_of(section, inline)
        before = self.text[:at].rstrip("\n")
        after = self.text[at:].lstrip("\n")
        heading = f"[{section}]\n" if inline and section not in self.data else ""
        gap = "\n" if inline and not heading else "\n\n"
        joined = (
            before + (gap if before else "") + heading + entry + ("\n" + after if after else "")
        )
        self._set(joined)

    def _is_inline(self, section: str) -> bool:
        """Whether the entries of a section are written in one line each."""
        entries = self.data.get(section)
        if not entries:
            return True
        return any(
            len(keys) == 2 and keys[0] == section and place.value > place.start
            for keys, place in self.places.items()
        )

    def _end_of(self, section: str, inline: bool) -> int:
        """Character behind a section, or where it begins if it is new.

        Parameters
        ----------
        inline : behind the entries in one line, which tables of the section may follow
        """
        ends = [
            place.end
            for keys, place in self.places.items()
            if keys[0] == section
            and (not inline or (len(keys) == 2 and place.value > place.start) or len(keys) == 1)
        ]
        if ends:
            return self._line_end(max(ends))
        rank = ORDER.index(section)
        former = [
            place.end
            for keys, place in self.places.items()
            if keys[0] in ORDER[:rank] or (len(keys) == 1 and place.value > place.start)
        ]
        return self._line_end(max(former)) if former else len(self.text)

    def _line_end(self, at: int) -> int:
        """Character behind the line of a place."""
        end = self.text.find("\n", at)
        return len(self.text) if end < 0 else end + 1

    def remove(self, section: str, name: str) -> None:
        """Remove an entry with its tables.

        Raises
        ------
        ModelError
            There is none.
        """
        ranges = self._ranges((section, name))
        if not ranges:
            raise ModelError("there is no such entry", key_path(section, name))
        text = self.text
        for start, end in sorted(ranges, reverse=True):
            text = text[:start] + text[end:]
        self._set(text)
        if not self.data.get(section, True):  # an empty table of a section
            place = self.places.get((section,))
            if place is not None and place.value == place.start:
                end = self._line_end(place.end)
                self._set(self.text[: place.start] + self.text[end:])

    def _ranges(self, entry: Keys) -> list[tuple[int, int]]:
        """Ranges of whole lines that an entry occupies."""
        ranges = []
        for keys, place in self.places.items():
            if keys[: len(entry)] != entry:
                continue
            if place.value == place.start and self._begins_line(place.start):
                ranges.append((place.start, self._end_of_table(place.end)))
            elif keys == entry:
                start = self.text.rfind("\n", 0, place.start) + 1
                ranges.append((start, self._line_end(place.end)))
        return ranges

    def _end_of_table(self, at: int) -> int:
        """Start of the next header behind a character, or of the comment above it."""
        headers = (
            place.start
            for place in self.places.values()
            if place.start >= at and place.value == place.start and self._begins_line(place.start)
        )
        end = min(headers, default=len(self.text))
        if end == len(self.text):
            return end
        end = self.text.rfind("\n", 0, end) + 1
        while end > at:
            start = self.text.rfind("\n", 0, end - 1) + 1
            if start <= at or not self.text[start:end].lstrip().startswith("#"):
                break
            end = start
        return end

    def _begins_line(self, start: int) -> bool:
        """Whether a header starts here: the first character of its line is a bracket."""
        line = self.text.rfind("\n", 0, start) + 1
        return self.text[start] == "[" and not self.text[line:start].strip()

    def set_value(self, keys: Sequence[str | int], value: Any) -> None:
        """Replace a value, or add a key to a table.

        A value that is the name of a parameter stays; the parameter gets the new one.

        Raises
        ------
        ModelError
            The value is a formula, or there is no such table.
        """
        path = tuple(keys)
        place = self.places.get(path)
        if place is None:
            self._add_key(path, value)
            return
        old = tomllib.loads(f"k = {self.text[place.value : place.end]}")["k"]
        if isinstance(old, str) and isinstance(value, (int, float)):
            target = self._parameter(old)
            if target is None:
                message = f"is the formula {old!r}; change it in the text"
                raise ModelError(message, key_path(*path))
            place = self.places[target]
        self._set(self.text[: place.value] + as_toml(value) + self.text[place.end :])

    def _parameter(self, name: str) -> Keys | None:
        """Place of the number of a parameter without a unit of its own."""
        entry = self.data.get("parameters", {}).get(name)
        if isinstance(entry, (int, float)):
            return ("parameters", name)
        if isinstance(entry, dict) and isinstance(entry.get("value"), (int, float)):
            return ("parameters", name, "value")
        return None

    def _add_key(self, path: Keys, value: Any) -> None:
        table = self.places.get(path[:-1])
        if table is None or not isinstance(path[-1], str):
            raise ModelError("there is no such entry", key_path(*path))
        if table.value > table.start:  # an inline table
            inner = self.text[table.value : table.end].rstrip("}").rstrip()
            comma = "" if inner == "{" else ","
            new = f"{inner}{comma} {path[-1]} = {as_toml(value)} }}"
            self._set(self.text[: table.value] + new + self.text[table.end :])
            return
        at = self._line_end(table.end)
        own = [p.end for k, p in self.places.items() if k[:-1] == path[:-1] and p.value > p.start]
        at = self._line_end(max(own)) if own else at
        before = self.text[:at] if self.text[:at].endswith("\n") else self.text[:at] + "\n"
        self._set(f"{before}{path[-1]} = {as_toml(value)}\n{self.text[at:]}")

    def rename(self, section: str, old: str, new: str) -> None:
        """Give an entry another name, in references and formulas too.

        Raises
        ------
        ModelError
            Invalid or used name.
        """
        if not NAME.fullmatch(new):
            raise ModelError(f"{new[:60]!r} is no name; use letters, digits and _", section)
        if new in self.names():
            raise ModelError("the name is already used; choose another", new)
        if old not in self.data.get(section, {}):
            raise ModelError("there is no such entry", key_path(section, old))
        word = re.compile(rf"(?<![\w.]){re.escape(old)}(?!\w)")
        is_value = section in VALUES
        spans: set[tuple[int, int]] = set()
        for keys, place in self.places.items():
            if keys[:2] == (section, old):
                end = place.value if place.value > place.start else place.end
                spans |= self._own_name(old, section, place.start, end, len(keys) == 2)
            value = self.text[place.value : place.end]
            if value[:1] in ('"', "'"):
                spans |= _uses(word, value, place.value, is_value)
        text = self.text
        for start, end in sorted(spans, reverse=True):
            text = text[:start] + new + text[end:]
        self._set(text)

    def _own_name(
        self, name: str, section: str, start: int, end: int, is_entry: bool
    ) -> set[tuple[int, int]]:
        """Place of the name of an entry in its key or in a header."""
        key = self.text[start:end]
        if key.startswith("["):
            match = re.search(rf"{section}\s*\.\s*(\"?{re.escape(name)}\"?)(?=\s*[.\]])", key)
        else:
            match = (
                re.match(rf"((?<![\w.])\"?{re.escape(name)}\"?)\s*[.=]", key) if is_entry else None
            )
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


def as_toml(value: Any) -> str:
    """A value as TOML.

    Raises
    ------
    ModelError
        Not a finite number, a short text, or a list or table of such values.
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float) and abs(value) < 1e300:
        return repr(value)
    if isinstance(value, str) and len(value) <= MAX_TEXT and value.isprintable():
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(as_toml, value)) + "]"
    if isinstance(value, dict) and all(NAME.fullmatch(key) for key in value):
        entries = ", ".join(f"{key} = {as_toml(item)}" for key, item in value.items())
        return f"{{ {entries} }}" if entries else "{}"
    raise ModelError(f"{str(value)[:60]!r} is no value of a model file")
