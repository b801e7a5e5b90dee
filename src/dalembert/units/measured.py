"""Numbers read from texts with a unit: ``"10 mm"`` is 0.01 and records that it is a length."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of


class Measured(float):
    """A number in SI units that records its unit.

    Attributes
    ----------
    si : its unit
    text : the original text, quoted in messages
    """

    si: str
    text: str

    def __new__(cls, value: float, si: str, text: str) -> Measured:
        number = super().__new__(cls, value)
        number.si, number.text = si, text
        return number

    def __getnewargs__(self) -> Any:
        return float(self), self.si, self.text


def measured(value: Any) -> Any:
    """The number in a text, with its unit if it has one; other values are returned unchanged.

    Raises
    ------
    ExpressionError
        The text is not a number with a unit.
    """
    if not isinstance(value, str):
        return value
    amount = amount_of(value)
    if not isinstance(amount, Amount):
        return amount
    return Measured(amount.value, amount.si, value.strip())


def check_measured(values: Iterable[Any], expected: str, entity: str) -> None:
    """Check that numbers with units have the dimension of the expected unit.

    Raises
    ------
    ExpressionError
        Names the entity, the number and the expected unit.
    """
    for value in values:
        if isinstance(value, Measured) and expected:
            check_unit(value.si, expected, entity, value.text)
