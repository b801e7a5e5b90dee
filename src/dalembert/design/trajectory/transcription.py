"""Transcription of a motion: states and controls at knots and in the middles of intervals.

Integrals follow Simpson's rule. The equations between knots are defined by the methods.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.design.trajectory.physics import Physics


@dataclass
class Points:
    """Columns of unknowns at instants, in the order of the arguments of functions of states."""

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
        """Values at the k-th instant."""
        return function(*(part[:, k] for part in vars(self).values()))


@dataclass
class Block:
    """Unknowns of one kind: shape, natural sizes and bounds."""

    name: str
    size: np.ndarray
    columns: int
    lower: np.ndarray
    upper: np.ndarray
    symbol: ca.MX = field(init=False)

    def __post_init__(self) -> None:
        self.symbol = ca.MX.sym(self.name, self.size.size, self.columns)

    @classmethod
    def free(cls, name: str, size: np.ndarray, columns: int) -> Block:
        """A block without bounds."""
        open_end = np.full(size.size, np.inf)
        return cls(name, size, columns, -open_end, open_end)

    @property
    def value(self) -> ca.MX:
        """Unknowns in physical units."""
        return ca.mtimes(ca.MX(ca.diag(ca.DM(self.size))), self.symbol)

    def scaled(self, values: np.ndarray) -> np.ndarray:
        """Values divided by their natural sizes, column by column."""
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


class Transcription(ABC):
    """The unknowns of a motion in N intervals and the equations between them.

    A subclass implements ``middles`` and ``equations``, and adds the unknowns that these need to
    ``blocks``.

    Parameters
    ----------
    physics : equations of the mechanism
    intervals : number of intervals of equal length
    duration : minimum and maximum [s]
    """

    def __init__(self, physics: Physics, intervals: int, duration: tuple[float, float]):
        self.physics, self.n = physics, intervals
        e, s, model = physics.equations, physics.model.scales, physics.model

        def bounded(name: str, names: list[str], columns: int) -> Block:
            ends = np.array([model.parameters[n].bounds for n in names]).reshape(-1, 2)
            nominal = np.array([abs(model.parameters[n].value) for n in names])
            largest = np.where(np.isfinite(ends), abs(ends), 0.0).max(axis=1, initial=0.0)
            size = np.maximum(largest, nominal)
            size[size == 0] = 1.0
            return Block(name, size, columns, ends[:, 0], ends[:, 1])

        knots, u, q = intervals + 1, physics.controls, physics.vary
        multipliers = e.scales.multipliers
        self.blocks = {
            "y": Block.free("y", s.coordinates, knots),
            "v": Block.free("v", s.speeds, knots),
            "a": Block.free("a", s.speeds / s.time, knots),
            "multiplier": Block.free("multiplier", multipliers, knots),
            "u": bounded("u", u, knots),
            "u_middle": bounded("u_middle", u, intervals),
            "multiplier_middle": Block.free("multiplier_middle", multipliers, intervals),
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
    def variables(self, name: str) -> ca.MX:
        """Unknowns of a kind, in physical units."""
        return self.blocks[name].value

    @cached_property
    def knots(self) -> Points:
        """The ends of the intervals."""
        share = ca.MX(ca.DM(np.linspace(0, 1, self.n + 1)).T)
        y, v, a, multiplier, u = map(self.variables, ("y", "v", "a", "multiplier", "u"))
        q = ca.repmat(self.variables("q"), 1, self.n + 1)
        return Points(self.duration * share, y, v, a, multiplier, u, q)

    @property
    @abstractmethod
    def middles(self) -> Points:
        """The middles of the intervals."""

    @abstractmethod
    def equations(self) -> list[Rows]:
        """Equations that the unknowns of a motion satisfy."""

    def between(self, y: ca.MX, v: ca.MX, a: ca.MX) -> Points:
        """The middles of the intervals, with states there."""
        share = ca.MX(ca.DM((np.arange(self.n) + 0.5) / self.n).T)
        multiplier, u = self.variables("multiplier_middle"), self.variables("u_middle")
        q = ca.repmat(self.variables("q"), 1, self.n)
        return Points(self.duration * share, y, v, a, multiplier, u, q)

    # numbers -----------------------------------------------------------------------------
    def integral(self, function: ca.Function) -> ca.MX:
        """``∫`` of a function of states over the motion, by Simpson's rule."""
        ends, middle = self.knots.of(function), self.middles.of(function)
        total = ca.sum2(ends[:, :-1]) + ca.sum2(ends[:, 1:]) + 4 * ca.sum2(middle)
        return self.h / 6 * total

    def peak(self, function: ca.Function) -> ca.MX:
        """An unknown upper bound of a function of states; at its minimum, the largest value."""
        name = f"peak_{len(self.peaks)}"
        block = self.blocks[name] = Block.free(name, np.ones(1), 1)
        for points in (self.knots, self.middles):
            below = points.of(function) - ca.repmat(block.value, 1, points.count)
            self.peaks.append(Rows(f"largest value of {name}", below, -np.inf, 0.0))
        return block.value

    # all unknowns ------------------------------------------------------------------------
    @property
    def unknowns(self) -> ca.MX:
        return ca.vertcat(*(ca.vec(block.symbol) for block in self.blocks.values()))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        limits = [block.limits() for block in self.blocks.values()]
        return np.concatenate([b[0] for b in limits]), np.concatenate([b[1] for b in limits])

    def pack(self, guess: dict[str, np.ndarray]) -> np.ndarray:
        """A guess as vector of scaled unknowns; zero for missing blocks."""
        zero = np.zeros(1)
        parts = [block.scaled(guess.get(n, zero)) for n, block in self.blocks.items()]
        return np.concatenate(parts)

    def unpack(self, x: np.ndarray) -> dict[str, np.ndarray]:
        """Unknowns by kind, in physical units."""
        values, start = {}, 0
        for name, block in self.blocks.items():
            count = block.symbol.numel()
            part = x[start : start + count].reshape((block.size.size, block.columns), order="F")
            values[name], start = part * block.size[:, None], start + count
        return values
