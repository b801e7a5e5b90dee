"""Changes of a model file that leave everything else in it as it is.

Values, entries and names are replaced at their places in the text, so that comments, order and
formulas remain byte for byte. A TOML library that writes whole documents does not keep them.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.messages import key_path
from dalembert.io.toml_places import Keys, Place
from dalembert.studio.key_edits import add_dotted, cut
from dalembert.studio.toml_text import TomlText
from dalembert.studio.toml_values import NAME, as_toml, in_unit, is_number, neat, with_unit
from dalembert.studio.uses import VALUES, uses_of

ORDER = (
    *("parameters", "derived", "inputs", "outputs", "ground", "nodes", "elements", "meshes"),
    *("bodies", "beams", "joints", "drivers", "forces", "blocks"),
    *("supports", "loads", "line_loads", "tractions", "temperatures", "analysis"),
)
"""Order of the sections of a file, for new ones."""


class TextEdits(TomlText):
    """Changes of a TOML text, one after the other.

    Parameters
    ----------
    text : valid TOML

    Raises
    ------
    ModelError
        It is not valid.
    """

    def names(self) -> set[str]:
        """Names of all elements, parameters and other entries."""
        tables = (self.data.get(section) for section in ORDER)
        return {name for table in tables if isinstance(table, dict) for name in table}

    def keys_at(self, at: int) -> Keys:
        """Keys of the innermost value at a character; empty if there is none."""
        inside = [
            (place.end - place.value, keys)
            for keys, place in self.places.items()
            if place.start <= at <= place.end and keys
        ]
        return min(inside, default=(0, ()))[1]

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

    def add(self, section: str, name: str, fields: Mapping[str, Any] | list[Any]) -> None:
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
        inline = isinstance(fields, list) or self._is_inline(section)
        if inline:
            entry = f"{name} = {as_toml(fields)}\n"
        elif isinstance(fields, Mapping):
            rows = "".join(f"{key} = {as_toml(value)}\n" for key, value in fields.items())
            entry = f"[{section}.{name}]\n{rows}"
        heading = f"[{section}]\n" if inline and section not in self.data else ""
        self.insert(section, inline, heading + entry, "\n" if inline and not heading else "\n\n")

    def insert(self, section: str, inline: bool, lines: str, gap: str) -> None:
        """Insert lines at the end of a section, behind a gap; ``inline`` as in ``end_of``."""
        at = self.end_of(section, inline)
        before, after = self.text[:at].rstrip("\n"), self.text[at:].lstrip("\n")
        self.set_text(before + (gap if before else "") + lines + ("\n" + after if after else ""))

    def _is_inline(self, section: str) -> bool:
        """Whether the entries of a section are written in one line each."""
        entries = self.data.get(section)
        if not entries:
            return True
        return any(
            len(keys) == 2 and keys[0] == section and place.value > place.start
            for keys, place in self.places.items()
        )

    def end_of(self, section: str, inline: bool) -> int:
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
            return self.line_end(max(ends))
        rank = ORDER.index(section)
        former = [
            place.end
            for keys, place in self.places.items()
            if keys[0] in ORDER[:rank] or (len(keys) == 1 and place.value > place.start)
        ]
        return self.line_end(max(former)) if former else len(self.text)

    def remove(self, section: str, name: str) -> None:
        """Remove an entry with its tables.

        Raises
        ------
        ModelError
            There is none.
        """
        if not cut(self, (section, name)):
            raise ModelError("there is no such entry", key_path(section, name))
        if not self.data.get(section, True):  # an empty table of a section
            place = self.places.get((section,))
            if place is not None and place.is_header:
                end = self.line_end(place.end)
                self.set_text(self.text[: place.start] + self.text[end:])

    def set_value(self, keys: Sequence[str | int], value: Any, as_written: bool = False) -> None:
        """Replace a value, or add a key to a table; numbers are in SI units.

        A number keeps its unit. A value that is the name of a parameter stays; the parameter gets
        the number. A value ``as_written``, such as ``45 mm``, replaces units and formulas too.

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
        if isinstance(old, str) and is_number(value) and not as_written:
            if old in self.data.get("parameters", {}):
                self.set_parameter(old, value)
                return
            value = with_unit(old, value)
            if value is None:
                message = f"is the formula {old!r}; change it in the text"
                raise ModelError(message, key_path(*path))
        self._replace(place, value)

    def append(self, lines: str) -> None:
        """Add lines at the end of the text."""
        before = self.text.rstrip("\n")
        self.set_text(f"{before}\n\n{lines}" if before else lines)

    def replace(self, keys: Keys, value: Any) -> None:
        """Replace a value as it is written, formulas included."""
        self._replace(self.places[keys], value)

    def _replace(self, place: Place, value: Any) -> None:
        self.set_text(self.text[: place.value] + as_toml(value) + self.text[place.end :])

    def set_parameter(self, name: str, value: float) -> None:
        """Give a parameter or input a value in SI units, written in its own unit.

        Raises
        ------
        ModelError
            There is none of this name, or its value is a formula.
        """
        section = next((s for s in VALUES if name in self.data.get(s, {})), "parameters")
        entry = self.data.get(section, {}).get(name)
        is_table = isinstance(entry, dict)
        keys: Keys = (section, name, "value") if is_table else (section, name)
        old: Any = entry.get("value") if isinstance(entry, dict) else entry
        written: Any = value
        if isinstance(old, str):
            written = with_unit(old, value)
        elif isinstance(entry, dict) and isinstance(entry.get("unit"), str):
            written = in_unit(value, entry["unit"])
        if is_number(written):
            written = neat(written)
        if not is_number(value) or old is None or written is None or keys not in self.places:
            raise ModelError("has no number to replace; change it in the text", key_path(*keys))
        self._replace(self.places[keys], written)

    def extract(self, keys: Sequence[str | int], base: str) -> str:
        """Replace a number by a new parameter with bounds around it; returns its name.

        Raises
        ------
        ModelError
            There is no number.
        """
        path = tuple(keys)
        place = self.places.get(path)
        text = self.text[place.value : place.end] if place is not None else '""'
        value = tomllib.loads(f"k = {text}")["k"]
        if place is None or not is_number(value) or path[0] in ("format", *VALUES):
            raise ModelError("is no number of an element", key_path(*path))
        name = base if NAME.fullmatch(base) and base not in self.names() else self.free_name(base)
        spread = 0.5 * abs(value) or 1.0
        bounds = [float(f"{value - spread:.9g}"), float(f"{value + spread:.9g}")]
        self._replace(place, name)
        self.add("parameters", name, {"value": value, "bounds": bounds})
        return name

    def _add_key(self, path: Keys, value: Any) -> None:
        table = self.places.get(path[:-1])
        if table is None and add_dotted(self, path, value):
            return
        if table is None or not isinstance(path[-1], str):
            raise ModelError("there is no such entry", key_path(*path))
        if not table.is_header:  # an inline table
            inner = self.text[table.value : table.end].rstrip("}").rstrip()
            comma = "" if inner == "{" else ","
            new = f"{inner}{comma} {path[-1]} = {as_toml(value)} }}"
            self.set_text(self.text[: table.value] + new + self.text[table.end :])
            return
        at = self.line_end(table.end)
        own = [p.end for k, p in self.places.items() if k[:-1] == path[:-1] and p.value > p.start]
        at = self.line_end(max(own)) if own else at
        before = self.text[:at] if self.text[:at].endswith("\n") else self.text[:at] + "\n"
        self.set_text(f"{before}{path[-1]} = {as_toml(value)}\n{self.text[at:]}")

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
        entries = self.data.get(section)
        if not isinstance(entries, dict) or old not in entries:
            raise ModelError("there is no such entry", key_path(section, old))
        text = self.text
        for start, end in sorted(uses_of(text, self.places, section, old), reverse=True):
            text = text[:start] + new + text[end:]
        self.set_text(text)
