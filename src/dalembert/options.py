"""Options: frozen dataclasses whose numbers are checked by their annotations before all else."""

from __future__ import annotations

import dataclasses
import inspect
import math
import re
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform

import numpy as np

from dalembert.budget import afford, numeral
from dalembert.errors import UnsupportedError

Class = TypeVar("Class", bound=type)
ROUNDS_OF = {"iterations", "max_iterations", "steps", "max_points", "repeat"}
"""Options that say how often something is done."""


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field,))
def options(cls: Class | None = None, /, **how: bool) -> Any:
    """Make a frozen dataclass that refuses what its annotations do not say.

    ``float`` is a finite number, ``int`` a whole one, ``bool`` true or false, ``str`` a text; with
    ``| None`` there may be none. What else a class demands is told by its ``__post_init__``.

    Parameters
    ----------
    **how : ``kw_only``, ``eq`` of the dataclass
    """
    if cls is None:
        return lambda cls: options(cls, **how)
    demands: Callable[[Any], None] | None = getattr(cls, "__post_init__", None)

    def __post_init__(self: Any) -> None:
        for field in dataclasses.fields(self):
            check_option(type(self).__name__, field, getattr(self, field.name))
        if demands is not None:
            demands(self)

    cls.__post_init__ = __post_init__  # type: ignore[attr-defined]
    return dataclasses.dataclass(frozen=True, **how)(cls)  # type: ignore[call-overload]


def check_option(owner: str, field: dataclasses.Field, value: Any) -> None:
    """Refuse a value that the annotation of its field does not allow.

    Raises
    ------
    UnsupportedError
        Names the option and the value.
    BudgetError
        A number of rounds beyond what a task is given.
    """
    kind = str(field.type)
    if value is None and kind.endswith("| None"):
        return
    wanted = _WANTED.get(kind.removesuffix(" | None"))
    if wanted is None:
        return
    allowed, text = wanted
    shown = numeral(value) if isinstance(value, int) else f"{value!r:.60}"
    if not allowed(value):
        raise UnsupportedError(f"{owner}({field.name}={shown}): {field.name} must be {text}")
    if field.name in ROUNDS_OF:
        what = f"{owner}({field.name}={shown})"
        afford(what, rounds=value, cure=f"give fewer {field.name}")


def is_number(value: Any) -> bool:
    """A finite real number; true and false are none."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, float, np.number)):
        return False
    try:
        return not isinstance(value, np.complexfloating) and math.isfinite(value)
    except OverflowError:  # of a whole number
        return False


def is_whole(value: Any) -> bool:
    """A whole number."""
    if isinstance(value, int) and not isinstance(value, bool):
        return True  # however large
    return is_number(value) and float(value).is_integer()


_WANTED: dict[str, tuple[Callable[[Any], bool], str]] = {
    "float": (is_number, "a finite number"),
    "int": (is_whole, "a whole number"),
    "bool": (lambda value: isinstance(value, (bool, np.bool_)), "true or false"),
    "str": (lambda value: isinstance(value, str), "a text"),
}


SECTIONS = ("Parameters", "Raises")


def inherit_texts(cls: type) -> None:
    """Give a class's docstring the parameters that its bases describe and it does not."""
    intro, own = _sections(cls.__doc__ or "")
    for base in cls.__mro__[1:]:
        for title, entries in _sections(base.__doc__ or "")[1].items():
            if title == "Parameters" or title not in own:
                own[title] = own.get(title, {}) | {
                    name: text for name, text in entries.items() if name not in own.get(title, {})
                }
    for title in SECTIONS:
        if title in own:
            intro += "\n".join(["\n", title, "-" * len(title), *own[title].values()])
    cls.__doc__ = intro


def _sections(doc: str) -> tuple[str, dict[str, dict[str, str]]]:
    """The text before the sections, and title → first word → entry."""
    intro, *rest = re.split(rf"\n\n({'|'.join(SECTIONS)})\n-+\n", inspect.cleandoc(doc))
    found: dict[str, dict[str, str]] = {}
    for title, body in zip(rest[::2], rest[1::2], strict=True):
        entries = re.split(r"\n(?=\S)", body)
        found[title] = {entry.split(maxsplit=1)[0]: entry for entry in entries}
    return intro, found
