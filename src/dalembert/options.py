"""Options: frozen dataclasses whose numbers are checked by their annotations before all else."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform

import numpy as np

from dalembert.budget import LARGEST, afford, numeral
from dalembert.errors import ExpressionError, UnsupportedError
from dalembert.text.spelling import OfInit, spelled_fields
from dalembert.units.measured import measured

Class = TypeVar("Class", bound=type)
ROUNDS = {"max_iterations", "steps", "max_points", "repeat"}
"""Options that say how often something is done."""
UNROLLED = {"iterations"}
"""Options that say how often something stands in a graph."""
MOST = 10**15
"""Size of the largest whole number."""
COPY = 4_000_000
"""Bytes of one time, with its derivatives, in a mechanism of a few bodies."""


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field,))
def options(cls: Class | None = None, /, **how: bool) -> Any:
    """Make a frozen dataclass that refuses what its annotations do not say.

    ``float`` is a number of usable size, or a text that gives it with its unit, ``int`` a whole
    one, ``bool`` true or false, ``str`` a text; with ``| None`` there may be none. What else a
    class demands is told by its ``__post_init__``.

    Parameters
    ----------
    **how : ``kw_only``, ``eq`` of the dataclass
    """
    if cls is None:
        return lambda cls: options(cls, **how)
    demands: Callable[[Any], None] | None = getattr(cls, "__post_init__", None)

    def __post_init__(self: Any) -> None:
        for field in dataclasses.fields(self):
            if isinstance(given := getattr(self, field.name), str):
                object.__setattr__(self, field.name, _read(field, given))
            check_option(type(self).__name__, field, getattr(self, field.name))
        if demands is not None:
            demands(self)

    cls.__post_init__ = __post_init__  # type: ignore[attr-defined]
    setattr(cls, "__new__", spelled_fields)  # noqa: B010
    setattr(cls, "__signature__", OfInit())  # noqa: B010
    return dataclasses.dataclass(frozen=True, **how)(cls)  # type: ignore[call-overload]


def _read(field: dataclasses.Field, text: str) -> Any:
    """The number behind the text of a number with its unit, where numbers stand."""
    if str(field.type) not in ("float", "float | None"):
        return text
    try:
        return measured(text)
    except ExpressionError:  # told as what is no number
        return text


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
    what, cure = f"{owner}({field.name}={shown})", f"give fewer {field.name}"
    if field.name in ROUNDS:
        afford(what, rounds=value, cure=cure)
    if field.name in UNROLLED:
        afford(what, memory=COPY * value, cure=cure)


def is_number(value: Any) -> bool:
    """A real number that can be computed with; true and false are none."""
    if isinstance(value, (bool, np.bool_, np.complexfloating)):
        return False
    if not isinstance(value, (int, float, np.number)):
        return False
    size: Any = abs(value)
    return bool(size == 0 or 1 / LARGEST <= size <= LARGEST)


def is_whole(value: Any) -> bool:
    """A whole number that fits; ``10.0`` is none."""
    whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    return whole and abs(value) <= MOST


def random_generator(rng: Any) -> np.random.Generator:
    """The generator of random numbers that an argument ``rng`` stands for.

    Raises
    ------
    UnsupportedError
        It is neither a generator nor a whole number from which one starts.
    """
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise UnsupportedError(
            f"rng is {rng!r:.60}; give a whole number from 0 on, or numpy.random.default_rng(…)"
        ) from None


def are_names(value: Any) -> bool:
    """A name, or several."""
    listed = value if isinstance(value, (list, tuple)) else [value]
    return all(isinstance(name, str) for name in listed)


_WANTED: dict[str, tuple[Callable[[Any], bool], str]] = {
    "float": (is_number, f"a number, from {1 / LARGEST:g} to {LARGEST:g} in size or 0"),
    "int": (is_whole, f"a whole number up to {numeral(MOST)} in size"),
    "bool": (lambda value: isinstance(value, (bool, np.bool_)), "true or false"),
    "str": (lambda value: isinstance(value, str), "a text"),
    "tuple[str, ...]": (are_names, "names"),
}


SECTIONS = ("Parameters", "Raises")
EXAMPLES = "\n\nExamples\n--------\n"


def inherit_texts(cls: type) -> None:
    """Give a class's docstring the parameters that its bases describe and it does not.

    Its examples stay the last of it, and are of no other class.
    """
    intro, own, examples = _sections(cls.__doc__ or "")
    for base in cls.__mro__[1:]:
        for title, entries in _sections(base.__doc__ or "")[1].items():
            if title == "Parameters" or title not in own:
                own[title] = own.get(title, {}) | {
                    name: text for name, text in entries.items() if name not in own.get(title, {})
                }
    for title in SECTIONS:
        if title in own:
            intro += "\n".join(["\n", title, "-" * len(title), *own[title].values()])
    cls.__doc__ = intro + examples


def _sections(doc: str) -> tuple[str, dict[str, dict[str, str]], str]:
    """The text before the sections, title → first word → entry, and the section of examples."""
    text, section, examples = inspect.cleandoc(doc).partition(EXAMPLES)
    intro, *rest = re.split(rf"\n\n({'|'.join(SECTIONS)})\n-+\n", text)
    found: dict[str, dict[str, str]] = {}
    for title, body in zip(rest[::2], rest[1::2], strict=True):
        entries = re.split(r"\n(?=\S)", body)
        found[title] = {entry.split(maxsplit=1)[0]: entry for entry in entries}
    return intro, found, section + examples
