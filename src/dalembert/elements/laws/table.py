"""Law given by a table, made twice continuously differentiable by a cubic spline."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import option
from dalembert.elements.laws.base import Law
from dalembert.errors import ModelError
from dalembert.symbolic.spline import CubicSpline


@dataclass(eq=False)
class Table(Law):
    """C² cubic spline through ``(time, value)`` pairs.

    Parameters
    ----------
    times : sequence of float, increasing [s]
    values : sequence of float
    periodic : bool
        The table repeats (first and last value must agree). Otherwise the spline is natural
        and continues along its end slopes.

    Raises
    ------
    ModelError
        Fewer than three rows, times not increasing, numbers not finite.
    """

    times: object = option("times [s], increasing")
    values: object = option("values, one per time")
    periodic: bool = option("the table repeats", default=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        times, values = (np.asarray(a, dtype=float).ravel() for a in (self.times, self.values))
        if times.size != values.size:
            raise ModelError(f"{times.size} times but {values.size} values", "Table")
        self.spline = CubicSpline(times, list(values), bool(self.periodic), "Table")

    def value(self, time: ca.SX) -> ca.SX:
        return self.spline(time)
