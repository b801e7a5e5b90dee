"""Controls over time: a parabola in every interval, through its ends and its middle."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.symbolic.formulas.expression import t


@dataclass(frozen=True, eq=False)
class Control:
    """An optimal control as a function of time.

    Attributes
    ----------
    name, unit : name and unit of its parameter
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
        """(N,) starts of the intervals [s], and (N, 3) polynomial coefficients in ``t − start``."""
        h = self.times[2::2] - self.times[:-1:2]
        first, middle, last = self.values[:-1:2], self.values[1::2], self.values[2::2]
        slope = (4 * middle - 3 * first - last) / h
        bend = 2 * (first - 2 * middle + last) / h**2
        return self.times[:-1:2], np.column_stack([first, slope, bend])

    def __call__(self, times: np.ndarray | float) -> np.ndarray:
        """Values of the control at times."""
        starts, rows = self.pieces
        instants = np.asarray(times, dtype=float)
        k = np.clip(np.searchsorted(starts, instants, side="right") - 1, 0, starts.size - 1)
        elapsed = instants - starts[k]
        return np.asarray(rows[k, 0] + elapsed * (rows[k, 1] + elapsed * rows[k, 2]))

    @property
    def formula(self) -> ca.SX:
        """The control as a formula of time; continuous, so that its pieces are not switches."""
        starts, rows = self.pieces
        active = [(1 + ca.copysign(1, t.sx - b)) / 2 for b in starts[1:]]

        def pick(column: np.ndarray) -> ca.SX:
            jumps = [float(after - before) for before, after in pairwise(column)]
            return float(column[0]) + sum(
                (jump * switch for jump, switch in zip(jumps, active, strict=True)), ca.SX(0)
            )

        elapsed = t.sx - pick(starts)
        constant, slope, bend = (pick(column) for column in rows.T)
        return constant + elapsed * (slope + elapsed * bend)
