"""Numbers with units in formulas: ``2*45 mm``, ``l1 + 5 mm``, ``60 rpm``."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from dalembert.errors import ExpressionError
from dalembert.units.unit import SYMBOL, UNIT, Unit, made_unit, unit

NUMBER = r"(?<![\w.])(?>(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
_AMOUNT = re.compile(rf"({NUMBER})\s*(?!(?:e|pi|t)\b)({UNIT})(?![\w(.\[])")
_FURTHER = re.compile(rf"([ ]?[*·/][ ]?|\s+)({UNIT})(?![\w(.\[])")
NO_UNITS = re.compile(r"(?:e|pi|t)\b")
"""Names of formulas that are no units: a number, a number, time."""
_WITH_VARIABLE = re.compile(r"^(?:e|pi)\b|[*·/]\s*(?:e|pi|t)\b")
"""In a text of one amount: a number or the time as a factor; the unit of ``1.4 t`` is tonnes."""
_PLAIN = re.compile(SYMBOL)
_ALONE = re.compile(rf"\s*({NUMBER})\s*((?:{UNIT}|1(?=\s*/))(?:(?:\s*[*·/]\s*|\s+){UNIT})*)\s*")


@dataclass(frozen=True)
class Amount:
    """A number of SI units whose dimension is known.

    Attributes
    ----------
    value : in SI units
    unit : of which dimension
    """

    value: float
    unit: Unit

    def __float__(self) -> float:
        return self.value

    @property
    def si(self) -> str:
        """The coherent unit of its value; ``1`` where it has none."""
        return self.unit.si or "1"

    def __abs__(self) -> Amount:
        return Amount(abs(self.value), self.unit)

    @property
    def is_plain(self) -> bool:
        """A number without dimension, or an angle."""
        return set(self.unit.dimension) <= {"rad"}

    def __neg__(self) -> Amount:
        return Amount(-self.value, self.unit)

    def __pos__(self) -> Amount:
        return self

    def __add__(self, other: Any) -> Any:
        return self._alike(other, operator.add)

    def __radd__(self, other: Any) -> Any:
        return self._alike(other, lambda a, b: b + a)

    def __sub__(self, other: Any) -> Any:
        return self._alike(other, operator.sub)

    def __rsub__(self, other: Any) -> Any:
        return self._alike(other, lambda a, b: b - a)

    def __mul__(self, other: Any) -> Any:
        return self._raised(other, 1, operator.mul)

    def __rmul__(self, other: Any) -> Any:
        return self * other

    def __truediv__(self, other: Any) -> Any:
        return self._raised(other, -1, operator.truediv)

    def __rtruediv__(self, other: Any) -> Any:
        one = _as_amount(other)
        return NotImplemented if one is None else one / self

    def __pow__(self, other: Any) -> Any:
        if not isinstance(other, (int, float)):
            return NotImplemented
        powers = {base: n * other for base, n in self.unit.dimension.items()}
        if self.value < 0 and other != int(other):
            raise ExpressionError("a root of a negative number")
        return Amount(self.value**other, made_unit(powers))

    def _alike(self, other: Any, operate: Callable[[float, float], float]) -> Any:
        one = _as_amount(other)
        if one is None:
            return NotImplemented
        if not (self.is_plain and one.is_plain) and one.si != self.si:
            raise ExpressionError(f"{self} and {one} cannot be added; give both units that fit")
        return Amount(operate(self.value, one.value), self.unit if one.si == "1" else one.unit)

    def _raised(self, other: Any, sign: int, operate: Callable[[float, float], float]) -> Any:
        one = _as_amount(other)
        if one is None:
            return NotImplemented
        powers = dict(self.unit.dimension)
        for base, n in one.unit.dimension.items():
            powers[base] = powers.get(base, 0) + sign * n
        kept = {base: n for base, n in powers.items() if n}
        return Amount(operate(self.value, one.value), made_unit(kept))

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit.si}".strip()


NO_UNIT = made_unit({})


def _as_amount(value: Any) -> Amount | None:
    if isinstance(value, Amount):
        return value
    return Amount(float(value), NO_UNIT) if isinstance(value, (int, float)) else None


def with_names(text: str, is_name: Callable[[str], bool]) -> tuple[str, dict[str, Amount]]:
    """The formula with a name in place of each number that has a unit, and these names.

    A unit follows its number, ``2*45 mm``. It goes on after a space, and after ``/`` or ``*``
    where what follows is a unit and no name of the model.

    Raises
    ------
    ExpressionError
        An unknown unit, or what may be a unit as well as a name.
    """
    alone = _ALONE.fullmatch(text)
    if alone and not _WITH_VARIABLE.search(alone[2]) and _is_unit(alone[2]):
        return "_0", {"_0": _amount(alone[1], alone[2])}
    found: dict[str, Amount] = {}
    made, place = "", 0
    for match in _AMOUNT.finditer(text):
        if match.start() < place:
            continue
        end = _end(text, match.end(), is_name)
        name = f"_{len(found)}"
        found[name] = _amount(match[1], text[match.start(2) : end])
        made += text[place : match.start()] + name
        place = end
    return made + text[place:], found


def _end(text: str, end: int, is_name: Callable[[str], bool]) -> int:
    """Where a unit ends that has begun."""
    while further := _FURTHER.match(text, end):
        symbol = _PLAIN.match(further[2])
        assert symbol is not None
        if further[1].strip():
            known, named = _is_unit(further[2]), is_name(symbol[0])
            if NO_UNITS.match(symbol[0]):
                break
            if known and named:
                raise ExpressionError(
                    f"{symbol[0]!r} is a unit and a name of the model; write "
                    f"(… {further[1].strip()} {symbol[0]}) with brackets round the number and "
                    f"its unit, or name the quantity"
                )
            if not known:
                break
        end = further.end()
    return end


def _is_unit(text: str) -> bool:
    try:
        unit(text)
    except ExpressionError:
        return False
    return True


def _amount(number: str, text: str) -> Amount:
    meant = unit(text)
    value = float(number) * meant.factor
    if not math.isfinite(value):
        raise ExpressionError(f"{number} {text} is not finite")
    return Amount(value, meant)


def check_unit(given: str, expected: str, entity: str, shown: str) -> None:
    """A unit stands where one of its dimension is expected.

    Parameters
    ----------
    shown : what has this unit, as messages tell it

    Raises
    ------
    ExpressionError
        Names the entity, what was given and the unit expected.
    """
    if unit(given).fits(expected):
        return
    what = expected if expected not in ("", "1") else "a plain number"
    usual = SUGGESTED.get(expected.split("|")[0].strip())
    cure = f"; write it with a unit of that kind, such as {usual!r}" if usual else ""
    raise ExpressionError(f"{shown} does not fit, expected {what}{cure}", entity)


SUGGESTED: Mapping[str, str] = {
    "m": "mm",
    "rad": "deg",
    "rad/s": "rpm",
    "s": "ms",
    "N": "kN",
    "kg": "g",
    "Pa": "MPa",
    "N/m": "N/mm",
}
"""Unit of a field → one that people write."""
