"""Option classes: frozen dataclasses whose fields are checked against their annotations."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable
from typing import Any, TypeVar, dataclass_transform

import numpy as np

from dalembert.budget import LARGEST, check_budget, numeral
from dalembert.errors import ExpressionError, UnsupportedError
from dalembert.text.arguments import ConstructorSignature, check_constructor
from dalembert.units.amounts import check_unit, is_unit
from dalembert.units.measured import Measured, measured

Class = TypeVar("Class", bound=type)
ROUNDS = {"max_iterations", "steps", "max_points", "repeat"}
"""Options that count repetitions of a task."""
UNROLLED = {"iterations"}
"""Options that count copies of equations in an expression graph."""
MOST = 10**15
"""Upper limit of the magnitude of an integer."""
RandomSource = int | np.random.Generator | None
"""Seed or generator of random numbers; None for an arbitrary seed."""
COPY = 4_000_000
"""Memory of one copy, with derivatives, for a mechanism of a few bodies [bytes]."""


def only_for(kind: str, *, default: Any) -> Any:
    """Option that applies to one kind of model, ``"mechanism"`` or ``"structure"``."""
    return dataclasses.field(default=default, metadata={"model": kind})


@dataclass_transform(frozen_default=True, field_specifiers=(dataclasses.field, only_for))
def options(cls: Class | None = None, /, **settings: bool) -> Any:
    """Make a frozen dataclass that checks its fields against their annotations.

    ``float`` is a number of usable magnitude, or a text that states it with its unit, ``int`` a
    whole number, ``bool`` true or false, ``str`` a text; ``| None`` also allows None. A unit has to
    fit the one in brackets in the docstring of the option. Further conditions are checked by the
    ``__post_init__`` of the class.

    Parameters
    ----------
    **settings : ``kw_only``, ``eq`` of the dataclass
    """
    if cls is None:
        return lambda cls: options(cls, **settings)
    check_fields: Callable[[Any], None] | None = getattr(cls, "__post_init__", None)

    def __post_init__(self: Any) -> None:
        for field in dataclasses.fields(self):
            if isinstance(value := getattr(self, field.name), str):
                object.__setattr__(self, field.name, value := _number_in(field, value))
            if isinstance(value, Measured) and (expected := _unit_of(type(self), field.name)):
                text = f"{field.name} = {value.text}"
                check_unit(value.si, expected, type(self).__name__, text)
            check_option(type(self).__name__, field, getattr(self, field.name))
        if check_fields is not None:
            check_fields(self)

    cls.__post_init__ = __post_init__  # type: ignore[attr-defined]
    setattr(cls, "__new__", _checked_and_recorded)  # noqa: B010
    setattr(cls, "__signature__", ConstructorSignature())  # noqa: B010
    return dataclasses.dataclass(frozen=True, **settings)(cls)  # type: ignore[call-overload]


def _checked_and_recorded(cls: type, *args: Any, **kwargs: Any) -> Any:
    """A ``__new__`` that checks arguments and records which options the call states."""
    instance = check_constructor(cls, *args, **kwargs)
    names = [field.name for field in dataclasses.fields(cls) if field.init]  # type: ignore[arg-type]
    stated = {*names[: len(args)], *kwargs}
    if 0 < len(stated) < len(names):  # all of them: a copy by dataclasses.replace
        object.__setattr__(instance, "_stated", frozenset(stated))
    return instance


def is_stated(strategy: Any, name: str) -> bool:
    """Whether an option was stated, or differs from its default.

    A copy by ``dataclasses.replace`` states the options that differ.
    """
    (option,) = (field for field in dataclasses.fields(strategy) if field.name == name)
    if name in getattr(strategy, "_stated", ()):
        return True
    factory = option.default_factory
    default = option.default if factory is dataclasses.MISSING else factory()
    return bool(getattr(strategy, name) != default)


def _number_in(field: dataclasses.Field, text: str) -> Any:
    """The number in a text such as ``"10 ms"`` for fields of numbers; the text for others."""
    if str(field.type) not in ("float", "float | None"):
        return text
    try:
        return measured(text)
    except ExpressionError:  # reported as not a number
        return text


def _unit_of(cls: type, name: str) -> str:
    """The unit in brackets in the docstring of an option; empty without a single one."""
    entries = [_sections(base.__doc__ or "")[1].get("Parameters", {}) for base in cls.__mro__]
    text: str = next((entry[name] for entry in entries if name in entry), "")
    units = {part for part in re.findall(r"\[([^\[\]]+)\]", text) if part == "-" or is_unit(part)}
    return units.pop().replace("-", "1") if len(units) == 1 else ""


def check_option(owner: str, field: dataclasses.Field, value: Any) -> None:
    """Check a value against the annotation of its field.

    Raises
    ------
    UnsupportedError
        Names the option and the value.
    BudgetError
        A number of rounds beyond the limit of a task.
    """
    kind = str(field.type)
    if value is None and kind.endswith("| None"):
        return
    condition = _CONDITIONS.get(kind.removesuffix(" | None"))
    if condition is None:
        return
    allowed, description = condition
    text = numeral(value) if isinstance(value, int) else f"{value!r:.60}"
    option, cure = f"{owner}({field.name}={text})", f"give fewer {field.name}"
    if not allowed(value):
        raise UnsupportedError(f"{option}: {field.name} must be {description}")
    if field.name in ROUNDS:
        check_budget(option, rounds=value, cure=cure)
    if field.name in UNROLLED:
        check_budget(option, memory=COPY * value, cure=cure)


def is_number(value: Any) -> bool:
    """Whether a value is a real number of usable magnitude; booleans are not."""
    if isinstance(value, (bool, np.bool_, np.complexfloating)):
        return False
    if not isinstance(value, (int, float, np.number)):
        return False
    size: Any = abs(value)
    return bool(size == 0 or 1 / LARGEST <= size <= LARGEST)


def is_whole(value: Any) -> bool:
    """Whether a value is an integer of usable magnitude; ``10.0`` is not."""
    is_integer = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    return is_integer and abs(value) <= MOST


def random_generator(rng: RandomSource) -> np.random.Generator:
    """The random number generator of an argument ``rng``.

    Raises
    ------
    UnsupportedError
        Neither a generator nor an integer seed.
    """
    try:
        return np.random.default_rng(rng)
    except (TypeError, ValueError):
        raise UnsupportedError(
            f"rng is {rng!r:.60}; give a whole number from 0 on, or numpy.random.default_rng(…)"
        ) from None


def are_names(value: Any) -> bool:
    """Whether a value is a name or a sequence of names."""
    names = value if isinstance(value, (list, tuple)) else [value]
    return all(isinstance(name, str) for name in names)


_CONDITIONS: dict[str, tuple[Callable[[Any], bool], str]] = {
    "float": (is_number, f"a number, from {1 / LARGEST:g} to {LARGEST:g} in size or 0"),
    "int": (is_whole, f"a whole number up to {numeral(MOST)} in size"),
    "bool": (lambda value: isinstance(value, (bool, np.bool_)), "true or false"),
    "str": (lambda value: isinstance(value, str), "a text"),
    "tuple[str, ...]": (are_names, "names"),
}


SECTIONS = ("Parameters", "Raises")
EXAMPLES = "\n\nExamples\n--------\n"


def inherit_texts(cls: type) -> None:
    """Extend the docstring of a class by the parameters that its bases describe.

    The examples of the class stay last; those of its bases are left out.
    """
    intro, sections, examples = _sections(cls.__doc__ or "")
    for base in cls.__mro__[1:]:
        for title, entries in _sections(base.__doc__ or "")[1].items():
            if title == "Parameters" or title not in sections:
                sections[title] = sections.get(title, {}) | {
                    name: text
                    for name, text in entries.items()
                    if name not in sections.get(title, {})
                }
    for title in SECTIONS:
        if title in sections:
            intro += "\n".join(["\n", title, "-" * len(title), *sections[title].values()])
    cls.__doc__ = intro + examples


def _sections(doc: str) -> tuple[str, dict[str, dict[str, str]], str]:
    """Introduction, title → first word → entry, and the section of examples of a docstring."""
    text, section, examples = inspect.cleandoc(doc).partition(EXAMPLES)
    intro, *titles_and_bodies = re.split(rf"\n\n({'|'.join(SECTIONS)})\n-+\n", text)
    sections: dict[str, dict[str, str]] = {}
    for title, body in zip(titles_and_bodies[::2], titles_and_bodies[1::2], strict=True):
        entries = re.split(r"\n(?=\S)", body)
        sections[title] = {entry.split(maxsplit=1)[0]: entry for entry in entries}
    return intro, sections, section + examples
