"""Numbers with units in formulas: ``2*45 mm``, ``l1 + 5 mm``, ``60 rpm``."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from dalembert.errors import ExpressionError
from dalembert.remedies import Advice, FitUnit, Rename
from dalembert.units.unit import SYMBOL, UNIT, Unit, coherent_unit, unit

NUMBER = r"(?<![\w.])(?>(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
_AMOUNT = re.compile(rf"({NUMBER})\s*(?!(?:e|pi|t)\b)({UNIT})(?![\w(.\[])")
_FURTHER = re.compile(rf"([ ]?[*·/][ ]?|\s+)({UNIT})(?![\w(.\[])")
NO_UNITS = re.compile(r"(?:e|pi|t)\b")
"""Names of formulas that are not units: two constants and the time."""
_WITH_VARIABLE = re.compile(r"^(?:e|pi)\b|[*·/]\s*(?:e|pi|t)\b")
"""A constant or the time as a factor in a text of one amount; ``1.4 t`` alone is in tonnes."""
_PLAIN = re.compile(SYMBOL)
_ALONE = re.compile(rf"\s*({NUMBER})\s*((?:{UNIT}|1(?=\s*/))(?:(?:\s*[*·/]\s*|\s+){UNIT})*)\s*")


@dataclass(frozen=True)
class Amount:
    """A number in SI units with its dimension.

    Attributes
    ----------
    value : in SI units
    unit : its coherent unit, which states the dimension
    """

    value: float
    unit: Unit

    def __float__(self) -> float:
        return self.value

    @property
    def si(self) -> str:
        """The coherent unit of the value; ``1`` without a dimension."""
        return self.unit.si or "1"

    def __abs__(self) -> Amount:
        return Amount(abs(self.value), self.unit)

    @property
    def is_plain(self) -> bool:
        """Whether it has no dimension or is an angle."""
        return set(self.unit.dimension) <= {"rad"}

    def __neg__(self) -> Amount:
        return Amount(-self.value, self.unit)

    def __pos__(self) -> Amount:
        return self

    def __add__(self, other: Any) -> Any:
        return self._sum(other, operator.add)

    def __radd__(self, other: Any) -> Any:
        return self._sum(other, lambda a, b: b + a)

    def __sub__(self, other: Any) -> Any:
        return self._sum(other, operator.sub)

    def __rsub__(self, other: Any) -> Any:
        return self._sum(other, lambda a, b: b - a)

    def __mul__(self, other: Any) -> Any:
        return self._product(other, 1, operator.mul)

    def __rmul__(self, other: Any) -> Any:
        return self * other

    def __truediv__(self, other: Any) -> Any:
        return self._product(other, -1, operator.truediv)

    def __rtruediv__(self, other: Any) -> Any:
        numerator = _as_amount(other)
        return NotImplemented if numerator is None else numerator / self

    def __pow__(self, other: Any) -> Any:
        if not isinstance(other, (int, float)):
            return NotImplemented
        powers = {base: n * other for base, n in self.unit.dimension.items()}
        if self.value < 0 and other != int(other):
            raise ExpressionError("a root of a negative number")
        return Amount(self.value**other, coherent_unit(powers))

    def _sum(self, other: Any, operate: Callable[[float, float], float]) -> Any:
        term = _as_amount(other)
        if term is None:
            return NotImplemented
        if not (self.is_plain and term.is_plain) and term.si != self.si:
            plain, other = (self, term) if self.si == "1" else (term, self)
            remedy = Rename(wrong=f"{plain.value:g}", right=f"{plain.value:g} {other.si}")
            text = f"{self} and {term} cannot be added; give both units that fit"
            raise ExpressionError(Advice(text, [remedy] if plain.si == "1" else ()))
        return Amount(operate(self.value, term.value), self.unit if term.si == "1" else term.unit)

    def _product(self, other: Any, sign: int, operate: Callable[[float, float], float]) -> Any:
        factor = _as_amount(other)
        if factor is None:
            return NotImplemented
        powers = dict(self.unit.dimension)
        for base, n in factor.unit.dimension.items():
            powers[base] = powers.get(base, 0) + sign * n
        nonzero = {base: n for base, n in powers.items() if n}
        return Amount(operate(self.value, factor.value), coherent_unit(nonzero))

    def __str__(self) -> str:
        return f"{self.value:g} {self.unit.si}".strip()


NO_UNIT = coherent_unit({})


def _as_amount(value: Any) -> Amount | None:
    if isinstance(value, Amount):
        return value
    return Amount(float(value), NO_UNIT) if isinstance(value, (int, float)) else None


def with_names(text: str, is_name: Callable[[str], bool]) -> tuple[str, dict[str, Amount]]:
    """The formula with a name in place of each number with a unit, and name → amount.

    A unit follows its number, ``2*45 mm``. It continues after a space, and after ``/`` or ``*``
    if a unit follows that is not a name of the model.

    Raises
    ------
    ExpressionError
        An unknown unit, or a symbol that is both a unit and a name.
    """
    alone = _ALONE.fullmatch(text)
    if alone and not _WITH_VARIABLE.search(alone[2]) and is_unit(alone[2]):
        return "_0", {"_0": _amount(alone[1], alone[2])}
    amounts: dict[str, Amount] = {}
    formula, position = "", 0
    for match in _AMOUNT.finditer(text):
        if match.start() < position:
            continue
        end = _end(text, match.end(), is_name)
        name = f"_{len(amounts)}"
        amounts[name] = _amount(match[1], text[match.start(2) : end])
        formula += text[position : match.start()] + name
        position = end
    return formula + text[position:], amounts


def _end(text: str, end: int, is_name: Callable[[str], bool]) -> int:
    """Position in the text at which a unit ends."""
    while further := _FURTHER.match(text, end):
        symbol = _PLAIN.match(further[2])
        assert symbol is not None
        if further[1].strip():
            has_unit, is_model_name = is_unit(further[2]), is_name(symbol[0])
            if NO_UNITS.match(symbol[0]):
                break
            if has_unit and is_model_name:
                raise ExpressionError(
                    f"{symbol[0]!r} is a unit and a name of the model; write "
                    f"(… {further[1].strip()} {symbol[0]}) with brackets round the number and "
                    f"its unit, or name the quantity"
                )
            if not has_unit:
                break
        end = further.end()
    return end


def is_unit(text: str) -> bool:
    """Whether a text is a unit."""
    try:
        unit(text)
    except ExpressionError:
        return False
    return True


def _amount(number: str, text: str) -> Amount:
    parsed = unit(text)
    value = float(number) * parsed.factor
    if not math.isfinite(value):
        raise ExpressionError(f"{number} {text} is not finite")
    return Amount(value, parsed)


def check_unit(symbol: str, expected: str, entity: str, subject: str) -> None:
    """Check that a unit has the dimension of the expected one.

    Parameters
    ----------
    symbol : the unit
    expected : units that fit, separated by ``|``
    entity : the field at fault
    subject : the quantity with this unit, as messages quote it

    Raises
    ------
    ExpressionError
        Names the entity, the quantity and the expected unit.
    """
    if unit(symbol).fits(expected):
        return
    required = expected if expected not in ("", "1") else "a plain number"
    usual = SUGGESTED.get(expected.split("|")[0].strip())
    cure = f"; write it with a unit of that kind, such as {usual!r}" if usual else ""
    text = f"{subject} does not fit, expected {required}{cure}"
    raise ExpressionError(Advice(text, [FitUnit(expected=expected)]), entity)


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
"""Unit of a field → unit that messages suggest."""
