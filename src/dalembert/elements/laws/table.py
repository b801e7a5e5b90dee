"""Law given by a table, made twice continuously differentiable by a cubic spline."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import casadi as ca
import numpy as np

from dalembert.elements.base import option
from dalembert.elements.laws.base import Law
from dalembert.errors import FileError, ModelError
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

    @classmethod
    def from_csv(cls, path: str | Path, periodic: bool = False) -> Table:
        """Read two columns, time and value; a heading line is allowed.

        Raises
        ------
        FileError
            Missing file or a line that is not two numbers (its number is told).
        """
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise FileError(f"{path}: cannot be read ({error})") from None
        rows = []
        for number, row in enumerate(csv.reader(text.splitlines()), 1):
            if not row or row[0].lstrip().startswith("#"):
                continue
            try:
                rows.append((float(row[0]), float(row[1])))
            except (ValueError, IndexError):
                if rows or number > 1:
                    raise FileError(
                        f"{path}: line {number}: expected 'time, value', got {','.join(row)!r}"
                    ) from None
        if not rows:
            raise FileError(f"{path}: no rows 'time, value' found")
        times, values = zip(*rows, strict=True)
        return cls(times=times, values=values, periodic=periodic)

    def value(self, time: ca.SX) -> ca.SX:
        return self.spline(time)
