"""XML elements that know their line and which of their attributes were read.

Every attribute and element of a file is either read, or reported by ``unread``: nothing is ignored
silently.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

from dalembert.budget import LARGEST
from dalembert.errors import ModelError
from dalembert.text.wording import unknown, visible

SHOWN = 60
"""Upper limit of the length of a value in a message."""
TRUE, FALSE = ("true", "1"), ("false", "0")


class XmlElement:
    """An element of an XML file.

    Parameters
    ----------
    file : Path
    line : of its start tag
    tag : name
    attributes : name → text
    parent : None for the root

    Attributes
    ----------
    defaults : elements that supply missing attributes, the first one with priority
    """

    def __init__(
        self,
        file: Path,
        line: int,
        tag: str,
        attributes: dict[str, str],
        parent: XmlElement | None = None,
    ):
        self.file, self.line, self.tag, self.attributes = file, line, tag, attributes
        self.parent = parent
        self.children: list[XmlElement] = []
        self.content = ""
        self.defaults: Sequence[XmlElement] = ()
        self.visited = False
        self._read: set[str] = set()

    def __repr__(self) -> str:
        return self.place

    @property
    def label(self) -> str:
        """``<link name="arm">``."""
        name = self.attributes.get("name")
        return visible(f'<{self.tag} name="{name[:SHOWN]}">' if name else f"<{self.tag}>")

    @property
    def place(self) -> str:
        """File, line and element, for messages."""
        return f"{self.file.name}:{self.line}: {self.label}"

    def error(self, message: str) -> ModelError:
        """An error at this element."""
        return ModelError(message, f"{self.file}:{self.line}: {self.label}")

    # attributes -------------------------------------------------------------------------------
    def has(self, name: str) -> bool:
        """Whether an attribute is present, or has a default in the file."""
        return any(name in element.attributes for element in (self, *self.defaults))

    def text(self, name: str, default: str | None = None) -> str:
        """An attribute.

        Raises
        ------
        ModelError
            Missing without a default.
        """
        value = self.optional(name)
        value = default if value is None else value
        if value is None:
            raise self.error(f"the attribute {name} is missing; write {name}=…")
        return value

    def optional(self, name: str) -> str | None:
        """An attribute, or None."""
        self.ignore(name)
        elements = (self, *self.defaults)
        return next((e.attributes[name] for e in elements if name in e.attributes), None)

    def number(self, name: str, default: float | None = None) -> float:
        """A finite number."""
        if default is not None and not self.has(name):
            return default
        return self.numbers(name, 1)[0]

    def numbers(self, name: str, *counts: int, default: Sequence[float] = ()) -> list[float]:
        """Finite numbers separated by blanks; ``counts`` are the permitted numbers of these."""
        if default and not self.has(name):
            return list(default)
        return self._numbers(self.text(name), name, counts)

    def overlaid(self, name: str, default: Sequence[float] = ()) -> list[float]:
        """Numbers of which an element may give the first ones only; its defaults the others."""
        self.ignore(name)
        numbers = list(default)
        for element in (*reversed(self.defaults), self):
            if name in element.attributes:
                own = element.numbers(name)
                numbers[: len(own)] = own
        return numbers

    def integer(self, name: str, default: int | None = None) -> int:
        """A whole number."""
        number = self.number(name, None if default is None else float(default))
        if number != int(number):
            raise self.error(f"{name} is {number:g}, expected a whole number")
        return int(number)

    def choice(self, name: str, choices: Sequence[str], default: str | None = None) -> str:
        """One of several texts."""
        value = self.text(name, default)
        if value not in choices:
            raise self.error(unknown(name, visible(value[:SHOWN]), choices))
        return value

    def flag(self, name: str, default: bool) -> bool:
        """``true`` or ``false``."""
        value = self.text(name, "true" if default else "false").strip().lower()
        if value not in (*TRUE, *FALSE):
            raise self.error(f"{name} is {visible(value[:SHOWN])!r}, expected true or false")
        return value in TRUE

    # content ----------------------------------------------------------------------------------
    def value(self) -> str:
        """The text between the tags."""
        self._read.add("")
        self.visited = True
        return self.content.strip()

    def content_numbers(self, *counts: int) -> list[float]:
        """The numbers between the tags."""
        return self._numbers(self.value(), "the text", counts)

    def _numbers(self, text: str, name: str, counts: tuple[int, ...]) -> list[float]:
        words = text.split()
        if counts and len(words) not in counts:
            expected = " or ".join(map(str, counts))
            raise self.error(
                f"{name} is {visible(text[:SHOWN])!r}, expected {expected} "
                f"number{'s' if counts != (1,) else ''}"
            )
        return [self._number(word, name) for word in words]

    def _number(self, word: str, name: str) -> float:
        try:
            number = float(word) if "_" not in word else math.nan
        except ValueError:
            number = math.nan
        if "${" in word or "$(" in word:
            raise self.error(
                f"{name} contains {visible(word[:SHOWN])!r}: the file is a template; convert it "
                "first, for example with xacro"
            )
        if not abs(number) < LARGEST:
            raise self.error(
                f"{name} contains {visible(word[:SHOWN])!r}, expected a finite number below "
                f"{LARGEST:g}"
            )
        return number

    # children ---------------------------------------------------------------------------------
    def all(self, *tags: str) -> list[XmlElement]:
        """Child elements with one of these tags, which count as read."""
        found = [child for child in self.children if child.tag in tags]
        for child in found:
            child.visited = True
        return found

    def only(self, tag: str) -> XmlElement | None:
        """The child element with this tag, or None; a second one is an error."""
        elements = self.all(tag)
        if len(elements) > 1:
            raise elements[1].error(
                f"{self.label} has a second <{tag}>, the first one is in line "
                f"{elements[0].line}; keep one of them"
            )
        return elements[0] if elements else None

    def needed(self, tag: str) -> XmlElement:
        """The child element with this tag."""
        element = self.only(tag)
        if element is None:
            raise self.error(f"has no <{tag}>; add one")
        return element

    # what was not read ------------------------------------------------------------------------
    def ignore(self, *names: str) -> None:
        """Attributes without any meaning for a model, such as a name for display."""
        for element in (self, *self.defaults):
            element._read.update(names)

    def unread(self) -> Iterator[tuple[XmlElement, str]]:
        """Elements that were not read, each with ``""``, and attributes of read ones."""
        pending = [self]
        while pending:
            element = pending.pop()
            if not element.visited:
                yield element, ""
                continue
            for name in element.attributes:
                if name not in element._read:
                    yield element, name
            if element.content.strip() and "" not in element._read:
                yield element, "text"
            pending.extend(reversed(element.children))
