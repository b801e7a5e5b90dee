"""Law of a table, interpolated by a C² cubic spline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Rows, option
from dalembert.elements.laws.base import Law
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.spline import CubicSpline

FREE = {"unit": "", "minimum": -np.inf, "above": -np.inf}
"""Limits of table entries: none."""


@dataclass(eq=False)
class Table(Law):
    """C² cubic spline through ``(time, value)`` pairs.

    Parameters
    ----------
    times : sequence of numbers or formulas, increasing [s]
    values : sequence of numbers or formulas
    periodic : bool
        The table repeats (first and last value must be equal). Otherwise the spline continues along
        its end slopes.
    ends : str
        ``"not-a-knot"``, one cubic over the first two pieces, for sampled motions; ``"clamped"``,
        zero speeds, for motions from rest to rest; ``"natural"``, zero accelerations.

    Raises
    ------
    ModelError
        Fewer than three rows, times not increasing, entries that are not finite, unknown ends.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("robot axis")
    >>> arm = system.add(planar.Bar("arm", length=0.5))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, arm.start))
    >>> taught = da.Table(times=[0, 1, 2, 3], values=[0.0, 0.4, 0.4, 0.0])
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, arm, taught))
    >>> motion = da.solve_kinematics(system.build(), 3.0, step=1.0)
    >>> motion["arm.angle"].values.round(6)
    array([0. , 0.4, 0.4, 0. ])
    """

    times: Rows = option("times [s], increasing; numbers or formulas")
    values: Rows = option("values, one per time; numbers or formulas")
    periodic: bool = option("the table repeats", default=False)
    ends: str = option("`not-a-knot`, `clamped` or `natural`", default="not-a-knot")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.periodic, bool):
            raise ModelError(f"periodic is {self.periodic!r}; it must be true or false", "Table")
        for name in ("times", "values"):
            if not isinstance(getattr(self, name), (Sequence, np.ndarray)):
                value = getattr(self, name)
                raise ModelError(f"{name} must be a list, got {value!r:.60}", "Table")
        times, values = list(self.times), list(self.values)
        if len(times) != len(values):
            raise ModelError(f"{len(times)} times but {len(values)} values", "Table")
        self.spline = CubicSpline(times, values, self.periodic, "Table", self.ends)

    def value(self, time: ca.SX) -> ca.SX:
        return self.spline(time)

    def splines(self) -> tuple:
        return (self.spline,)

    def conditions(self) -> list[Condition]:
        return [*self.spline.conditions()]

    def checked_quantities(self, owner: str) -> list[tuple[str, Expression, Mapping]]:
        rows = {"times": self.spline.knots, "values": self.spline.values}
        return [
            (f"{owner}.{name}[{k}]", Expression(x), FREE)
            for name, entries in rows.items()
            for k, x in enumerate(entries)
            if not isinstance(x, float)
        ]
