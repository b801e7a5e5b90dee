"""Warnings of a result, some of which are computed when they are first read."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any, overload


class Warnings(Sequence[str]):
    """Texts, and those of checks that cost so much that they wait until somebody reads them.

    Parameters
    ----------
    texts : known at once
    deferred : returns more of them
    """

    def __init__(self, texts: Iterable[str] = (), deferred: Callable[[], list[str]] | None = None):
        self._texts, self._deferred = list(texts), deferred

    @property
    def texts(self) -> list[str]:
        """All texts."""
        if self._deferred is not None:
            deferred, self._deferred = self._deferred, None
            self._texts += deferred()
        return self._texts

    @overload
    def __getitem__(self, index: int) -> str: ...

    @overload
    def __getitem__(self, index: slice) -> list[str]: ...

    def __getitem__(self, index: int | slice) -> str | list[str]:
        return self.texts[index]

    def __len__(self) -> int:
        return len(self.texts)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Sequence) and self.texts == list(other)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self.texts)

    def __reduce__(self) -> tuple[Any, ...]:
        return Warnings, (self.texts,)
