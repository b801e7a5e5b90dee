"""Numbers that texts gave with a unit: ``"10 mm"`` as 0.01, which knows that it is a length."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from dalembert.units.amounts import Amount, check_unit
from dalembert.units.grammar import amount_of


class Measured(float):
    """A number of SI units.

    Attributes
    ----------
    si : its unit
    text : as messages show it
    """

    si: str
    text: str

    def __new__(cls, value: float, si: str, text: str) -> Measured:
        made = super().__new__(cls, value)
        made.si, made.text = si, text
        return made

    def __getnewargs__(self) -> Any:
        return float(self), self.si, self.text


def measured(value: Any) -> Any:
    """The number in a text, which keeps its unit if it has one; what is no text as it is.

    Raises
    ------
    ExpressionError
        A text that is no number with a unit.
    """
    if not isinstance(value, str):
        return value
    amount = amount_of(value)
    if not isinstance(amount, Amount):
        return amount
    return Measured(amount.value, amount.si, value.strip())


def check_measured(values: Iterable[Any], expected: str, entity: str) -> None:
    """Numbers with units stand where ``expected`` is one of their dimension.

    Raises
    ------
    ExpressionError
        Names the entity, what was given and the unit expected.
    """
    for value in values:
        if isinstance(value, Measured) and expected:
            check_unit(value.si, expected, entity, value.text)
