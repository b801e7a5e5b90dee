"""A control over time: a parabola in every interval, through its ends and its middle."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.symbolic.formulas.expression import t


@dataclass(frozen=True, eq=False)
class Control:
    """A control that was found.

    Attributes
    ----------
    name, unit : of its parameter
    times : (2N + 1,) ends and middles of the intervals [s]
    values : (2N + 1,)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-20, 20))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> best = da.optimize_trajectory(system.build(), da.integral("push**2"), controls=["push"],
    ...     duration=1.0, end={"cart.x": 1, "cart.vx": 0}, method=da.DirectCollocation(intervals=4))
    >>> control = best.control("push")
    >>> isinstance(control, da.Control), [round(float(control(t)), 3) for t in (0, 1)]  # 6 - 12 t
    (True, [6.0, -6.0])
    """

    name: str
    unit: str
    times: np.ndarray
    values: np.ndarray

    @property
    def pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """(N,) where intervals begin, and (N, 3) their polynomials in ``t − begin``."""
        h = self.times[2::2] - self.times[:-1:2]
        first, middle, last = self.values[:-1:2], self.values[1::2], self.values[2::2]
        slope = (4 * middle - 3 * first - last) / h
        bend = 2 * (first - 2 * middle + last) / h**2
        return self.times[:-1:2], np.column_stack([first, slope, bend])

    def __call__(self, times: np.ndarray | float) -> np.ndarray:
        """Values at times."""
        begins, rows = self.pieces
        asked = np.asarray(times, dtype=float)
        k = np.clip(np.searchsorted(begins, asked, side="right") - 1, 0, begins.size - 1)
        past = asked - begins[k]
        return np.asarray(rows[k, 0] + past * (rows[k, 1] + past * rows[k, 2]))

    @property
    def formula(self) -> ca.SX:
        """As a formula of time; it is continuous, so that its pieces are no switches."""
        begins, rows = self.pieces
        begun = [(1 + ca.copysign(1, t.sx - b)) / 2 for b in begins[1:]]

        def pick(column: np.ndarray) -> ca.SX:
            jumps = [float(after - before) for before, after in pairwise(column)]
            return float(column[0]) + sum(
                (jump * on for jump, on in zip(jumps, begun, strict=True)), ca.SX(0)
            )

        past = t.sx - pick(begins)
        constant, slope, bend = (pick(column) for column in rows.T)
        return constant + past * (slope + past * bend)
