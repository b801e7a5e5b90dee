"""Text deck of spring structures of the book (algorithm 1 and example 8.13).

Records of numbers separated by commas or blanks, in this order: the counts of nodes, elements,
forces and prescribed displacements; per element its left node, right node and stiffness; per force
its node and value; per prescribed displacement its node and value; then, optionally, the count of
parameters and per parameter its type (``'spring'``, ``'force'`` or ``'displacement'``), the number
of the entity and its value, which replaces the one above; two more numbers bound it (example 8.17).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from dalembert.budget import check_budget, numeral
from dalembert.elements.fem.lines import AxialSpring
from dalembert.elements.fem.node import Node
from dalembert.errors import FileError, ModelError
from dalembert.files import read_text
from dalembert.model.structure import Structure
from dalembert.text.wording import visible

QUOTES = "'\"‘’`´"
KINDS = ("spring", "force", "displacement")
NODE = 25
"""Estimated cost per node with its spring, in the rounds of the budget."""
FIELD = re.compile(rf"[{QUOTES}]([^{QUOTES}]*)[{QUOTES}]|([^\s,;]+)")


@dataclass(frozen=True)
class Record:
    """One line of the deck: its number and its fields."""

    number: int
    fields: list[str]


class Deck:
    """Sequential reader of the records of a deck.

    Parameters
    ----------
    path : file
    """

    def __init__(self, path: Path):
        self.path = path
        text = read_text(path)
        self.records = self._split(text)
        self.last = text.count("\n") + 1

    @staticmethod
    def _split(text: str) -> Iterator[Record]:
        for number, line in enumerate(text.splitlines(), 1):
            content = line.split("!")[0]
            fields = [quoted or plain for quoted, plain in FIELD.findall(content)]
            if fields:
                yield Record(number, fields)

    def error(self, number: int, text: str) -> FileError:
        """An error at a line."""
        return FileError(f"{self.path}:{number}: {text}")

    def read(
        self, subject: str, kinds: tuple[type, ...], optional: tuple[type, ...] = ()
    ) -> tuple[int, list]:
        """Number of the next line and its fields, converted; ``more`` may follow, all or none.

        Raises
        ------
        FileError
            The deck ends, or the line has wrong fields; states its number.
        """
        record = next(self.records, None)
        if record is None:
            raise self.error(self.last, f"the deck ends before {subject}")
        if len(record.fields) == len(kinds) + len(optional):
            kinds = kinds + optional
        if len(record.fields) != len(kinds):
            expected = f"{len(kinds)}{f' or {len(kinds) + len(optional)}' if optional else ''}"
            raise self.error(
                record.number,
                f"{subject} needs {expected} values, this line has {len(record.fields)}: "
                f"{', '.join(record.fields)}",
            )
        return record.number, [
            self._converted(record, subject, field, kind)
            for field, kind in zip(record.fields, kinds, strict=True)
        ]

    def _converted(self, record: Record, subject: str, field: str, kind: type) -> Any:
        try:
            if kind is float:
                return float(re.sub("[dD]", "e", field))
            return kind(field)
        except ValueError:
            expected = "a whole number" if kind is int else "a number"
            raise self.error(record.number, f"{subject}: {field!r} is not {expected}") from None

    def optional(self, subject: str, kinds: tuple[type, ...]) -> list | None:
        """Like ``read``; None at the end of the deck."""
        record = next(self.records, None)
        if record is None:
            return None
        rest = self.records
        self.records = iter([record, *rest])
        return self.read(subject, kinds)[1]

    def finish(self) -> None:
        """Refuse further records."""
        record = next(self.records, None)
        if record is not None:
            raise self.error(record.number, "more lines than the counts on the first line say")


def load_deck(path: str | Path) -> Structure:
    """The structure of a deck, with nodes ``n1, …``, springs ``s1, …`` and parameters ``d1, …``.

    Raises
    ------
    FileError
        Anything wrong with the deck, with the number of the line.
    """
    deck = Deck(Path(path))
    number, counts = deck.read("the line of counts", (int, int, int, int))
    if counts[0] < 1 or min(counts[1:]) < 0:
        raise deck.error(number, f"counts {counts} do not describe a structure")
    springs = [deck.read(f"element {k + 1}", (int, int, float)) for k in range(counts[1])]
    forces = [deck.read(f"force {k + 1}", (int, float)) for k in range(counts[2])]
    supports = [deck.read(f"displacement {k + 1}", (int, float)) for k in range(counts[3])]
    _check_count(deck, number, counts)
    structure = Structure(visible(Path(path).stem))
    overridden = _parameters(deck, structure, counts)
    _build(deck, structure, counts[0], springs, forces, supports, overridden)
    return structure


def _check_count(deck: Deck, number: int, counts: list[int]) -> None:
    """Refuse nodes that no record can name, and more than can be solved in reasonable time."""
    nodes, springs, _, supports = counts
    connected = 2 * springs + supports
    if nodes > connected:
        raise deck.error(
            number,
            f"there are {numeral(nodes)} nodes, but {springs} elements and {supports} "
            f"displacements can hold {connected} of them at most; correct the count of nodes",
        )
    subject = f"{deck.path}:{number}: {numeral(nodes)} nodes and {springs} elements"
    check_budget(subject, rounds=NODE * max(nodes, springs), cure="give fewer")


def _parameters(deck: Deck, structure: Structure, counts: list[int]) -> dict:
    """(type, number of the entity) → parameter."""
    declared = deck.optional("the count of parameters", (int,))
    parameters: dict[tuple[str, int], object] = {}
    limits = {"spring": counts[1], "force": counts[2], "displacement": counts[3]}
    units = {"spring": "N/m", "force": "N", "displacement": "m"}
    for k in range(declared[0] if declared else 0):
        number, (kind, entity, value, *bounds) = deck.read(
            f"parameter {k + 1}", (str, int, float), (float, float)
        )
        if kind not in KINDS:
            raise deck.error(number, f"unknown type {kind!r}; known: {', '.join(KINDS)}")
        if not 1 <= entity <= limits[kind]:
            raise deck.error(number, f"there is no {kind} {entity}; there are {limits[kind]}")
        if (kind, entity) in parameters:
            raise deck.error(number, f"{kind} {entity} has a parameter already")
        try:
            parameter = structure.parameter(f"d{k + 1}", value, units[kind], tuple(bounds) or None)
        except ModelError as error:
            raise deck.error(number, str(error)) from None
        parameters[kind, entity] = parameter
    deck.finish()
    return parameters


def _build(
    deck: Deck,
    structure: Structure,
    count: int,
    springs: list,
    forces: list,
    supports: list,
    parameters: Any,
) -> None:
    nodes = [structure.node(f"n{k + 1}", float(k)) for k in range(count)]

    def node(number: int, k: int) -> Node:
        if not 1 <= k <= count:
            raise deck.error(number, f"there is no node {k}; there are {count}")
        return nodes[k - 1]

    for k, (number, (i, j, stiffness)) in enumerate(springs, 1):
        if i == j:
            raise deck.error(number, f"element {k} connects node {i} to itself")
        value = parameters.get(("spring", k), stiffness)
        structure.add(AxialSpring(f"s{k}", node(number, i), node(number, j), stiffness=value))
    supported: set[int] = set()
    for k, (number, (i, value)) in enumerate(supports, 1):
        if i in supported:
            raise deck.error(number, f"the displacement of node {i} is prescribed twice")
        supported.add(i)
        structure.support(node(number, i), ux=parameters.get(("displacement", k), value))
    for k, (number, (i, value)) in enumerate(forces, 1):
        if i in supported:
            raise deck.error(number, f"node {i} has a prescribed displacement and a force")
        structure.load(node(number, i), fx=parameters.get(("force", k), value))
