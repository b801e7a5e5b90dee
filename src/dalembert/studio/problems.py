"""Errors, warnings and notes of a model with their places in its text."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from dalembert.errors import DalembertError
from dalembert.io.toml_places import Keys, Place, line_and_column, parse_keys, toml_places
from dalembert.remedies import Remedy, remedies_in
from dalembert.studio.drawing_edits import MAX_OPERATIONS, apply
from dalembert.studio.fixes import Fix, fix_between, fixes_of
from dalembert.studio.redundancy import redundancy_fixes

PATH = re.compile(r'\s*((?:"(?:[^"\\]|\\.)*"|[A-Za-z0-9_-]+)(?:\.(?:"[^"]*"|[\w-]+)|\[\d+\])*): ')
LOOSE = "is not connected to any element, and not in the picture; connect or remove it"
MOST_REMOVALS = 3
"""Loose nodes with a remedy of their own."""
SYNTAX = re.compile(r"\(at line (\d+), column (\d+)\)|\(at end of document\)|: line (\d+): ")


@dataclass(frozen=True)
class Problem:
    """An error or a warning at a place of the text.

    Attributes
    ----------
    level : ``error``, ``warning`` or ``note``
    message : text
    start, end : characters of the place; None if it has no place
    line : from 1 on; zero without a place
    fixes : remedies as replacements in the text
    """

    level: str
    message: str
    start: int | None = None
    end: int | None = None
    line: int = 0
    fixes: tuple[Fix, ...] = ()


def problems_of(error: DalembertError, text: str, path: Path) -> list[Problem]:
    """Problems of an error, with their places in the text.

    Parameters
    ----------
    error : whose message names the file and key paths in it
    """
    message = str(error).replace(f"{path}: ", "").replace(f"{path}:", "")
    syntax = SYNTAX.search(message)
    if syntax:
        line = int(syntax[1] or syntax[3] or text.count("\n") + 1)
        column = int(syntax[2] or 1)
        start = sum(len(row) + 1 for row in text.split("\n")[: line - 1]) + column - 1
        start = min(start, len(text))
        return [Problem("error", message, start, min(start + 1, len(text)), line)]
    try:
        places = toml_places(text)
    except (ValueError, IndexError, RecursionError):  # not valid, or nested deep
        places = {}
    lines = [line for line in message.split("\n") if line.strip()]
    if not all(PATH.match(line) for line in lines):
        lines = ["\n".join(lines)]
    remedies = remedies_in(error)
    return [_problem(line.strip(), remedies, places, text) for line in lines]


def _problem(
    message: str, remedies: tuple[Remedy, ...], places: Mapping[Keys, Place], text: str
) -> Problem:
    match = PATH.match(message)
    keys = parse_keys(match[1]) if match else ()
    own = [remedy for remedy in remedies if not (match and remedy.place not in ("", match[1]))]
    fixes = fixes_of(own, keys, places, text)
    place = _place(keys, places)
    if place is None:
        return Problem("error", message, fixes=fixes)
    line = line_and_column(text, place.start)[0]
    return Problem("error", message, place.start, place.end, line, fixes)


def _place(keys: Keys, places: Mapping[Keys, Place]) -> Place | None:
    """Place of keys in the text: of their entry, of its first part, or of the table around it."""
    while keys:
        if keys in places:
            return places[keys]
        parts = [place for path, place in places.items() if path[: len(keys)] == keys]
        if parts:
            return min(parts, key=lambda place: place.start)
        keys = keys[:-1]
    return None


def notes_of(model: Any, text: str, path: Path) -> tuple[Problem, ...]:
    """Problems that the diagnosis of a mechanism states.

    Parameters
    ----------
    model : of the text
    text, path : of the model file
    """
    diagnosis = model.diagnosis
    fixes = redundancy_fixes(text, path, model)
    places = toml_places(text) if fixes else {}
    joints = [item.joint for item in diagnosis.redundancies]  # stated first
    notes = []
    for k, (level, message) in enumerate(diagnosis.messages):
        place = places.get(("joints", joints[k])) if k < len(joints) else None
        if place is None:
            notes.append(Problem(level, message))
            continue
        own = fixes[joints[k]] if joints.index(joints[k]) == k else ()
        line = line_and_column(text, place.start)[0]
        notes.append(Problem(level, message, place.start, place.end, line, own))
    return tuple(notes)


def loose_notes(names: Sequence[str], text: str, path: Path) -> Iterator[Problem]:
    """Problems of nodes that no element connects; a remedy removes them.

    Parameters
    ----------
    names : of the nodes
    text, path : of the model file
    """
    for k, name in enumerate(names):
        error = DalembertError(f"nodes.{name}: {LOOSE}")
        fixes = (_removal([name], text),) if k < MOST_REMOVALS else ()
        if k == 0 and len(names) > 1:
            fixes = (*fixes, _removal(names, text))
        for problem in problems_of(error, text, path):
            yield replace(problem, fixes=fixes)


def _removal(names: Sequence[str], text: str) -> Fix:
    """Remedy that removes nodes with their supports and loads."""
    parts = [{"op": "remove", "section": "nodes", "name": name} for name in names]
    title = f"Remove {names[0]}" if len(names) == 1 else f"Remove all {len(names)}"
    return fix_between(title, text, apply(text, parts[:MAX_OPERATIONS]))
