"""What the commands tell of a model and of what was computed from it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, Generic, TypeVar

M = TypeVar("M")


class Teller(ABC, Generic[M]):
    """A model in the words of the command line.

    Parameters
    ----------
    model : a mechanism or a structure, as the class says
    """

    def __init__(self, model: M):
        self.model = model

    @property
    @abstractmethod
    def description(self) -> dict[str, Any]:
        """What it consists of, for programs."""

    @property
    @abstractmethod
    def sentence(self) -> str:
        """What it is, in one line."""

    @property
    def messages(self) -> list[tuple[str, str]]:
        """(level, text) of what is doubtful about it."""
        return []

    @abstractmethod
    def explain(self) -> None:
        """Print all that is known of it."""

    @abstractmethod
    def show(self, made: dict[str, Any]) -> None:
        """Print the summary of a result."""
