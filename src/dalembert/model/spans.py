"""Numbers of nodes and elements, single ones and those of sets."""

from __future__ import annotations

from bisect import bisect_right


class Spans:
    """``name → number``; a set has a range of numbers, its members are called ``set[k]``."""

    def __init__(self) -> None:
        self.size = 0
        self._first: dict[str, tuple[int, int | None]] = {}
        self._names: list[str] = []
        self._starts: list[int] = []

    def add(self, name: str, count: int | None = None) -> int:
        """Number an object, or a set of ``count`` members; returns the first number."""
        first = self.size
        self._first[name] = first, count
        self._names.append(name)
        self._starts.append(first)
        self.size += 1 if count is None else count
        return first

    def first(self, name: str) -> int:
        """First number of an object or set."""
        return self._first[name][0]

    def number(self, name: str) -> int | None:
        """Number of an object or of a member of a set; None for an unknown name."""
        owner, bracket, inside = name.partition("[")
        if owner not in self._first:
            return None
        first, count = self._first[owner]
        if count is None or not bracket:
            return first if count is None and not bracket else None
        inside = inside.removesuffix("]")
        return first + int(inside) if inside.isdigit() and int(inside) < count else None

    def numbers(self, name: str) -> range | None:
        """All numbers of an object or set; None for an unknown name."""
        if name not in self._first:
            number = self.number(name)
            return None if number is None else range(number, number + 1)
        first, count = self._first[name]
        return range(first, first + (1 if count is None else count))

    def name(self, number: int) -> str:
        """Name of the object or member with this number."""
        owner = self._names[bisect_right(self._starts, number) - 1]
        first, count = self._first[owner]
        return owner if count is None else f"{owner}[{number - first}]"

    @property
    def names(self) -> list[str]:
        """Names of all objects and members."""
        return [self.name(k) for k in range(self.size)]

    @property
    def owners(self) -> list[str]:
        """Names of the objects and sets."""
        return list(self._names)

    def __contains__(self, name: str) -> bool:
        return self.number(name) is not None

    def __len__(self) -> int:
        return self.size
