"""What turns C text into a function that can be called."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar

from dalembert.errors import UnsupportedError


class NotTranslated(UnsupportedError):
    """A toolchain does not know something in a text; others may."""


Call = Callable[..., int]
"""The loop over columns of ``source.py``, on addresses; it returns how many columns are done."""


class Toolchain(ABC):
    """A way to machine code.

    Attributes
    ----------
    name : what it is called in a report
    backend : what it is called where it is chosen
    suffix : of its files
    maker : module and name of the function that makes it, for another process
    longest : characters of C from which its code gains little over the virtual machine, whose
        instructions are shorter: code that does not fit the caches is read from memory in every
        step; None where that is not seen from their number
    """

    name: ClassVar[str]
    backend: ClassVar[str]
    suffix: ClassVar[str]
    maker: ClassVar[tuple[str, str]]
    longest: ClassVar[int | None] = None

    @abstractmethod
    def least_effort(self, text: str) -> float:
        """Rough: the least seconds that compiling a text may take."""

    def effort(self, text: str) -> float:
        """Rough: seconds that compiling it takes, by a closer look."""
        return self.least_effort(text)

    @property
    @abstractmethod
    def identity(self) -> tuple[str, ...]:
        """What its files depend on, besides the text."""

    @abstractmethod
    def build(self, text: str, target: Path) -> None:
        """Make a file of a text.

        Raises
        ------
        UnsupportedError
            That is not possible; with the reason. ``NotTranslated`` where the text is at fault.
        """

    @abstractmethod
    def load(self, path: Path) -> Call:
        """The loop of a whole file.

        Raises
        ------
        OSError
            It cannot be loaded.
        """
