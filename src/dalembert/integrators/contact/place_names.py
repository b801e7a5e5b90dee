"""Names of places in the C text of loops over contacts, and their numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import lru_cache

from dalembert.integrators.contact.other_places import (
    SearchCounts,
    SearchInputs,
    SearchOutputs,
    SweepCounts,
    SweepOutputs,
    SweepSettings,
)
from dalembert.integrators.contact.places import Counts, Inputs, Outputs, Places, Settings, Status
from dalembert.integrators.contact.step_calls import Calls, Modes, States, StepOutcome
from dalembert.integrators.contact.step_places import (
    Descriptions,
    Forms,
    Limits,
    RecordColumns,
    ShapePlaces,
    Shares,
    Sizes,
)

TABLES: Mapping[str, type[Places]] = {
    "arg": Inputs,
    "ahead": Inputs,
    "inputs": Inputs,
    "res": Outputs,
    "outputs": Outputs,
    "iw": Counts,
    "settings": Settings,
    "arg[SETTINGS]": Settings,
    "arg[LIMITS]": Limits,
    "arg[SHARES]": Shares,
    "sizes": Sizes,
    "arg[SIZES]": Sizes,
    "status": Status,
    "res[STATUS]": Status,
    "numbers": RecordColumns,
    "last": RecordColumns,
    "contact": Descriptions,
    "arg[DESCRIPTIONS]": Descriptions,
    "res[STORED_DESCRIPTIONS]": Descriptions,
    "place": ShapePlaces,
    "number": ShapePlaces,
    "form": Forms,
    "a": Forms,
    "b": Forms,
}
"""Places of each array, by its name in the C text."""
OTHER_TABLES: Mapping[str, Mapping[str, type[Places]]] = {
    "sweeps.c": {"res": SweepOutputs, "iw": SweepCounts, "settings": SweepSettings},
    "hull_search.c": {"arg": SearchInputs, "res": SearchOutputs, "iw": SearchCounts},
}
"""The same of files of other loops, where they differ."""
VALUES: Mapping[str, int] = {
    **{outcome.name: int(outcome) for outcome in StepOutcome},
    **Calls.table(),
    **Modes.table(),
    **States.table(),
}
"""Numbers outside of indices."""
MACROS = frozenset({"CASADI_SYMBOL_EXPORT", "INFINITY"})
"""Names that the compiler knows."""
NAME = re.compile(r"\b[A-Z][A-Z0-9_]+\b")
"""Name of a place, of a value or of a macro."""
WORDS = re.compile(rf"/\*.*?\*/|{NAME.pattern}", re.DOTALL)
"""Comments, which keep their names, and names."""
ARRAY = re.compile(r"(\w+(?:\[\w+\])?)\)?$")
"""Name of an array before an index, perhaps with a cast."""
LONGEST = 80
"""Upper limit of the length of the name of an array."""


@lru_cache
def with_numbers(text: str, file: str) -> str:
    """A C text with numbers in place of names: places in its indices, and values elsewhere.

    Parameters
    ----------
    file : name of its file

    Raises
    ------
    LookupError
        A name is unknown.
    """
    tables = {**TABLES, **OTHER_TABLES.get(file, {})}

    def number(match: re.Match[str]) -> str:
        name = match[0]
        if name.startswith("/*"):
            return name
        array = _indexed(text, match.start())
        if array is None:
            return _value(name, file)
        if array not in tables:
            raise LookupError(f"{file}: {name} is unknown; places of {array!r} have no names")
        place = getattr(tables[array], name, None)
        if place is None:
            owner, names = tables[array].__name__, ", ".join(tables[array].table())
            raise LookupError(f"{file}: {array}[{name}] is unknown; {owner} has {names}")
        return str(place)

    return WORDS.sub(number, text)


def _value(name: str, file: str) -> str:
    """The number of a name outside of indices; macros remain."""
    if name in MACROS:
        return name
    if name not in VALUES:
        raise LookupError(f"{file}: {name} is unknown; values are {', '.join(VALUES)}")
    return str(VALUES[name])


def _indexed(text: str, place: int) -> str | None:
    """The array of which a place in a text is an index; None outside of brackets."""
    depth = 0
    for k in range(place - 1, -1, -1):
        if text[k] in ";{}":
            return None
        depth += (text[k] == "]") - (text[k] == "[")
        if depth < 0:
            array = ARRAY.search(text[max(k - LONGEST, 0) : k])
            return array[1] if array else ""
    return None
