"""Limits of quantities of elements, and conditions, at values of the parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.budget import LARGEST
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import check_magnitude


@dataclass(frozen=True, eq=False)
class ValueLimit:
    """Numbers of a quantity with their limits, or conditions with the values of their message.

    Attributes
    ----------
    entity : owner and quantity
    graph : SX or MX column of parameters: the numbers, or conditions followed by values
    unit : of the numbers
    minimum : lower limit of each number
    above : lower limit that each number exceeds
    message : of a violated condition, formatted with the values; empty for a quantity
    count : number of conditions, each ≥ 0
    """

    entity: str
    graph: Any
    unit: str = ""
    minimum: float = -math.inf
    above: float = -math.inf
    message: str = ""
    count: int = 0

    def check(self, numbers: np.ndarray) -> None:
        """Check the values of the graph.

        Raises
        ------
        ModelError
            Names the entity and the first invalid number.
        """
        if not self.message:
            for number in numbers:
                check_number(float(number), self.entity, self.unit, self.minimum, self.above)
        elif not np.all(numbers[: self.count] >= 0):
            values = numbers[self.count :]
            raise ModelError(
                self.message.format(*values) if values.size else self.message, self.entity
            )

    @property
    def ranges(self) -> list[tuple[float, float]]:
        """Minimum of each value of the graph, and the number that it exceeds."""
        if not self.message:
            return [(self.minimum, self.above)] * self.graph.numel()
        values = self.graph.numel() - self.count
        return [(0.0, -np.inf)] * self.count + [(-np.inf, -np.inf)] * values

    def data(self) -> dict[str, Any]:
        """The limit as plain data; infinite limits are null."""
        size = {"entity": self.entity, "size": self.graph.numel()}
        if self.message:
            return size | {"message": self.message, "count": self.count}
        limits = {"minimum": self.minimum, "above": self.above}
        finite = {name: limit if math.isfinite(limit) else None for name, limit in limits.items()}
        return size | {"unit": self.unit} | finite


def check_number(number: float, entity: str, unit: str, minimum: float, above: float) -> None:
    """Check that a number is finite, of usable size and within its limits.

    Raises
    ------
    ModelError
        Names the entity and the number.
    """
    of_unit = f" {unit}" if unit else ""
    if not math.isfinite(number):
        raise ModelError(f"its value is {number}; give a finite number", entity)
    check_magnitude(number, entity)
    if number < minimum:
        limit = "negative" if minimum == 0 else f"below {minimum:g}"
        raise ModelError(f"is {number:g}{of_unit}, but it must not be {limit}", entity)
    if number <= above:
        raise ModelError(f"is {number:g}{of_unit}, but it must be above {above:g}", entity)


def valid_numbers(numbers: np.ndarray, minimum: Any, above: Any) -> np.ndarray:
    """Whether ``check_number`` accepts the numbers; limits are broadcast against them."""
    size = np.abs(numbers)
    usable = (size == 0) | ((size >= 1 / LARGEST) & (size <= LARGEST))
    return usable & (numbers >= minimum) & (numbers > above)


class ValueChecks:
    """Check of the numbers of a mechanism: finite and within their limits.

    Parameters
    ----------
    limits : of all quantities
    p : SX (np,) symbols of the parameters
    """

    def __init__(self, limits: Sequence[ValueLimit], p: ca.SX):
        self.limits = limits
        self._allowed = [pair for limit in limits for pair in limit.ranges]
        self._ends = np.cumsum([limit.graph.numel() for limit in limits], dtype=int)
        column = ca.vertcat(*(limit.graph for limit in limits))
        self._values = ca.Function("quantities", [p], [ca.densify(column)])

    def __call__(self, values: Sequence[float] | np.ndarray) -> None:
        """Check the numbers at parameter values.

        Raises
        ------
        ModelError
            Names the first invalid quantity with its value.
        """
        numbers = np.split(self._values(values).full().ravel(), self._ends[:-1])
        for limit, part in zip(self.limits, numbers, strict=False):
            limit.check(part)

    def unverified(self, table: np.ndarray) -> np.ndarray:
        """(designs,) whether a row of parameter values may be invalid and must be checked alone."""
        with np.errstate(all="ignore"):
            numbers = np.asarray(self._values.map(len(table))(table.T).full())
            low, above = (np.array(column)[:, None] for column in zip(*self._allowed, strict=True))
            valid = valid_numbers(numbers, low, above)
        return ~np.all(valid, axis=0) | ~np.all(np.isfinite(table), axis=1)
