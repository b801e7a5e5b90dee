"""Text of a model file, with its values and their places."""

from __future__ import annotations

import tomllib
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.toml_places import Keys, Place, toml_places


class TomlText:
    """A valid TOML text.

    Parameters
    ----------
    text : valid TOML

    Attributes
    ----------
    text, data : the text and its contents

    Raises
    ------
    ModelError
        It is not valid.
    """

    def __init__(self, text: str):
        self.set_text(text)

    def set_text(self, text: str) -> None:
        """Replace the whole text, which is valid TOML."""
        try:
            self.data: dict[str, Any] = tomllib.loads(text)
        except (tomllib.TOMLDecodeError, RecursionError) as error:
            raise ModelError(f"the text is not valid TOML ({error}); correct it first") from None
        self.text = text
        self._places: dict[Keys, Place] | None = None

    @property
    def places(self) -> dict[Keys, Place]:
        """Places of the entries in the text, located when they are first needed."""
        if self._places is None:
            self._places = toml_places(self.text)
        return self._places

    @property
    def statements(self) -> dict[Keys, Place]:
        """Headers, and keys that are not inside the value of another one, in their order."""
        statements: dict[Keys, Place] = {}
        end = 0
        for keys, place in self.places.items():
            if place.start >= end:
                statements[keys] = place
                end = place.end
        return statements

    def line_end(self, at: int) -> int:
        """Character behind the line of a place."""
        end = self.text.find("\n", at)
        return len(self.text) if end < 0 else end + 1

    def ranges(self, entry: Keys) -> list[tuple[int, int]]:
        """Ranges of characters of the whole lines that an entry occupies, with its tables.

        There are none of an entry inside the value of another key.
        """
        ranges: list[tuple[int, int]] = []
        for keys, place in self.statements.items():
            if keys[: len(entry)] != entry or (ranges and place.start < ranges[-1][1]):
                continue
            if place.is_header:
                ranges.append((place.start, self._end_of_table(place.end)))
            else:
                start = self.text.rfind("\n", 0, place.start) + 1
                ranges.append((start, self.line_end(place.end)))
        return ranges

    def _end_of_table(self, at: int) -> int:
        """Start of the next header behind a character, or of the comment above it."""
        headers = (p.start for p in self.places.values() if p.start >= at and p.is_header)
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
