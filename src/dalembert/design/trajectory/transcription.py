"""Hermite–Simpson collocation: a motion as a nonlinear programme.

States and controls at the knots, controls in the middle of every interval. There the cubic through
both ends meets the equations of motion (Hargraves and Paris 1987), and integrals are Simpson's.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.design.trajectory.physics import Physics


@dataclass
class Points:
    """Columns of unknowns at instants, in the order that functions of states take them."""

    t: ca.MX
    y: ca.MX
    v: ca.MX
    a: ca.MX
    multiplier: ca.MX
    u: ca.MX
    q: ca.MX

    @property
    def count(self) -> int:
        return int(self.t.numel())

    def of(self, function: ca.Function) -> ca.MX:
        """(rows, count) values of a function of states."""
        return function.map(self.count)(*vars(self).values())

    def at(self, k: int, function: ca.Function) -> ca.MX:
        """Values at one of the instants."""
        return function(*(part[:, k] for part in vars(self).values()))


@dataclass
class Block:
    """Unknowns of one kind: how many rows and columns, their natural sizes and bounds."""

    name: str
    size: np.ndarray
    columns: int
    lower: np.ndarray
    upper: np.ndarray
    symbol: ca.MX = field(init=False)

    def __post_init__(self) -> None:
        self.symbol = ca.MX.sym(self.name, self.size.size, self.columns)

    @property
    def value(self) -> ca.MX:
        """In their units."""
        return ca.mtimes(ca.MX(ca.diag(ca.DM(self.size))), self.symbol)

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """As the solver sees them, column by column."""
        shaped = np.broadcast_to(values, (self.size.size, self.columns))
        return np.asarray(shaped / self.size[:, None]).ravel(order="F")

    def limits(self) -> tuple[np.ndarray, np.ndarray]:
        return self.scaled(self.lower[:, None]), self.scaled(self.upper[:, None])


@dataclass
class Rows:
    """Equations or limits of one kind."""

    label: str
    value: ca.MX
    lower: float = 0.0
    upper: float = 0.0


class Transcription:
    """The unknowns of a motion in N intervals and the equations between them.

    Parameters
    ----------
    physics : of the mechanism
    intervals : how many, of the same length
    duration : least and largest [s]
    """

    def __init__(self, physics: Physics, intervals: int, duration: tuple[float, float]):
        self.physics, self.n = physics, intervals
        e, s, model = physics.equations, physics.model.scales, physics.model
        free = np.full(1, np.inf)

        def unknown(name: str, size: np.ndarray, columns: int) -> Block:
            return Block(name, size, columns, -free.repeat(size.size), free.repeat(size.size))

        def bounded(name: str, names: list[str], columns: int) -> Block:
            ends = np.array([model.parameters[n].bounds for n in names]).reshape(-1, 2)
            nominal = np.array([abs(model.parameters[n].value) for n in names])
            known = np.where(np.isfinite(ends), abs(ends), 0.0).max(axis=1, initial=0.0)
            size = np.maximum(known, nominal)
            size[size == 0] = 1.0
            return Block(name, size, columns, ends[:, 0], ends[:, 1])

        knots, u, q = intervals + 1, physics.controls, physics.vary
        multipliers = e.scales.multipliers
        self.blocks = {
            "y": unknown("y", s.coordinates, knots),
            "v": unknown("v", s.speeds, knots),
            "a": unknown("a", s.speeds / s.time, knots),
            "multiplier": unknown("multiplier", multipliers, knots),
            "u": bounded("u", u, knots),
            "u_middle": bounded("u_middle", u, intervals),
            "multiplier_middle": unknown("multiplier_middle", multipliers, intervals),
            "slack": unknown("slack", np.ones(physics.held.numel()), intervals),
            "q": bounded("q", q, 1),
            "duration": Block(
                "duration",
                np.array([duration[1]]),
                1,
                np.array([duration[0]]),
                np.array([duration[1]]),
            ),
        }
        self.duration = self.blocks["duration"].value
        self.peaks: list[Rows] = []
        self.h = self.duration / intervals

    # points ------------------------------------------------------------------------------
    def _own(self, name: str) -> ca.MX:
        return self.blocks[name].value

    @cached_property
    def knots(self) -> Points:
        """The ends of the intervals."""
        share = ca.MX(ca.DM(np.linspace(0, 1, self.n + 1)).T)
        y, v, a, multiplier, u = map(self._own, ("y", "v", "a", "multiplier", "u"))
        q = ca.repmat(self._own("q"), 1, self.n + 1)
        return Points(self.duration * share, y, v, a, multiplier, u, q)

    @cached_property
    def _rates(self) -> ca.MX:
        """(n_y, N + 1) ``A(y) v`` at the knots."""
        e = self.physics.equations
        if e.manifold.flat and e.coordinate_count == e.speed_count:
            return self.knots.v
        rate = ca.Function("rate", [e.y, e.v], [e.pose_rate])
        return rate.map(self.n + 1)(self.knots.y, self.knots.v)

    def _between(self, values: ca.MX, rates: ca.MX) -> tuple[ca.MX, ca.MX]:
        """Value and slope, in the middle, of the cubics through both ends."""
        a, b, da, db = values[:, :-1], values[:, 1:], rates[:, :-1], rates[:, 1:]
        return (a + b) / 2 + self.h / 8 * (da - db), 1.5 / self.h * (b - a) - (da + db) / 4

    @cached_property
    def _middle(self) -> tuple[Points, ca.MX]:
        share = ca.MX(ca.DM((np.arange(self.n) + 0.5) / self.n).T)
        y, rate = self._between(self.knots.y, self._rates)
        v, a = self._between(self.knots.v, self.knots.a)
        multiplier, u = self._own("multiplier_middle"), self._own("u_middle")
        q = ca.repmat(self._own("q"), 1, self.n)
        return Points(self.duration * share, y, v, a, multiplier, u, q), rate

    @property
    def middles(self) -> Points:
        """The middles of the intervals."""
        return self._middle[0]

    # equations ---------------------------------------------------------------------------
    def equations(self) -> list[Rows]:
        """What makes a motion of the unknowns."""
        middles, rate = self._middle
        given = [rate, self._own("slack"), *vars(middles).values()]
        between = self.physics.middle.map(self.n)(*given)
        return [
            Rows("equations of motion", self.knots.of(self.physics.knot)),
            Rows("equations between the knots", between),
        ]

    def integral(self, function: ca.Function) -> ca.MX:
        """``∫`` of a function of states over the motion, by Simpson's rule."""
        ends, middle = self.knots.of(function), self.middles.of(function)
        total = ca.sum2(ends[:, :-1]) + ca.sum2(ends[:, 1:]) + 4 * ca.sum2(middle)
        return self.h / 6 * total

    def peak(self, function: ca.Function) -> ca.MX:
        """An unknown that a function of states stays below all the way: where it is made small,
        the largest value."""
        name, free = f"peak_{len(self.peaks)}", np.full(1, np.inf)
        block = self.blocks[name] = Block(name, np.ones(1), 1, -free, free)
        for points in (self.knots, self.middles):
            below = points.of(function) - ca.repmat(block.value, 1, points.count)
            self.peaks.append(Rows(f"largest value of {name}", below, -np.inf, 0.0))
        return block.value

    # the whole ---------------------------------------------------------------------------
    @property
    def unknowns(self) -> ca.MX:
        return ca.vertcat(*(ca.vec(block.symbol) for block in self.blocks.values()))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        both = [block.limits() for block in self.blocks.values()]
        return np.concatenate([b[0] for b in both]), np.concatenate([b[1] for b in both])

    def pack(self, guess: dict[str, np.ndarray]) -> np.ndarray:
        """A guess as the solver sees it; zero where nothing is given."""
        zero = np.zeros(1)
        parts = [block.scaled(guess.get(n, zero)) for n, block in self.blocks.items()]
        return np.concatenate(parts)

    def unpack(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Unknowns by kind, in their units."""
        made, begin = {}, 0
        for name, block in self.blocks.items():
            count = block.symbol.numel()
            part = x[begin : begin + count].reshape((block.size.size, block.columns), order="F")
            made[name], begin = part * block.size[:, None], begin + count
        return made
