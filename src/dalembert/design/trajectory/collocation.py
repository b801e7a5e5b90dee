"""Direct collocation with cubic splines, collocated in the middle of every interval."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.transcription import Block, Points, Rows, Transcription
from dalembert.options import options


@options
class DirectCollocation(TrajectoryMethod):
    """Hermite–Simpson collocation (Hargraves and Paris 1987): cubics for states.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-4, 4))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> fine = da.DirectCollocation(intervals=8)
    >>> best = da.optimize_trajectory(system.build(), da.final("time"), controls=["push"],
    ...     duration=(0.5, 3), end={"cart.x": 1, "cart.vx": 0}, method=fine)
    >>> round(best.duration, 3)  # 2 √(m x/F), bang-bang
    1.0
    """

    display_name = "direct collocation"

    def transcription(self, physics: Physics, duration: tuple[float, float]) -> Transcription:
        return HermiteSimpson(physics, self.intervals, duration)


class HermiteSimpson(Transcription):
    """Hermite–Simpson defects: the cubic satisfies the equations of motion in the middle."""

    def __init__(self, physics: Physics, intervals: int, duration: tuple[float, float]):
        super().__init__(physics, intervals, duration)
        sizes = np.ones(physics.position_conditions.numel())
        self.blocks["slack"] = Block.free("slack", sizes, intervals)

    @cached_property
    def _rates(self) -> ca.MX:
        """(n_y, N + 1) ``A(y) v`` at the knots."""
        e = self.physics.equations
        if e.manifold.flat and e.coordinate_count == e.speed_count:
            return self.knots.v
        rate = ca.Function("rate", [e.y, e.v], [e.pose_rate])
        return rate.map(self.n + 1)(self.knots.y, self.knots.v)

    def _cubics(self, values: ca.MX, rates: ca.MX) -> tuple[ca.MX, ca.MX]:
        """Values and slopes of the cubic Hermite interpolants in the middles."""
        a, b, da, db = values[:, :-1], values[:, 1:], rates[:, :-1], rates[:, 1:]
        return (a + b) / 2 + self.h / 8 * (da - db), 1.5 / self.h * (b - a) - (da + db) / 4

    @cached_property
    def _middle(self) -> tuple[Points, ca.MX]:
        y, rate = self._cubics(self.knots.y, self._rates)
        v, a = self._cubics(self.knots.v, self.knots.a)
        return self.between(y, v, a), rate

    @property
    def middles(self) -> Points:
        return self._middle[0]

    def equations(self) -> list[Rows]:
        middles, rate = self._middle
        arguments = [rate, self.variables("slack"), *vars(middles).values()]
        defects = self.physics.middle.map(self.n)(*arguments)
        return [
            Rows("equations of motion", self.knots.of(self.physics.rows())),
            Rows("equations between the knots", defects),
        ]
