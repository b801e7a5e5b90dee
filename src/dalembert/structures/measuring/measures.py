"""Measures of a structure: displacements, reactions, quantities of elements, and totals.

A measure knows its value at a state and hands weights back to what it was made of, so that any
formula of measures has exact gradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.structures.evaluation.block import ElementBlock
from dalembert.structures.loads.temperatures import Temperatures


@dataclass
class State:
    """Displacements (n,), external forces (n,) with reactions, parameters, share of the load.

    Temperatures are those of a load case, with its share, at an instant.
    """

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray
    load_factor: float = 1.0
    temperatures: Temperatures = Temperatures()
    time: float = 0.0

    def data(self, b: ElementBlock) -> np.ndarray:
        """(m, ne) numbers of elements, with their temperatures here."""
        return self.temperatures.data(b, self.p, self.load_factor, self.time)

    def push_data(self, b: ElementBlock, change: State) -> np.ndarray:
        """(m, ne) their change."""
        hot = self.temperatures.source(b).push_data(self.p, change.p, self.time)
        return self.temperatures.shared(b, hot, self.load_factor)

    def pull_data(self, b: ElementBlock, weights: np.ndarray, into: Weights) -> None:
        """Add what weights (m, ne) of them weigh the parameters and the share of the load."""
        hot, rows = self.temperatures.source(b), self.temperatures.rows(b)
        if rows:
            into.load_factor += float((weights[rows] * hot.data(self.p, self.time)[rows]).sum())
        shared = self.temperatures.shared(b, weights, self.load_factor)
        into.p += hot.pull_data(self.p, shared, self.time)

    def turn_data(self, b: ElementBlock, weights: np.ndarray, change: State) -> np.ndarray:
        """Change of the parameters in ``pull_data`` with the parameters."""
        return self.temperatures.source(b).turn_data(self.p, weights, change.p)


@dataclass
class Weights:
    """The same for weights; ``forces`` at prescribed displacements weigh reactions."""

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray
    load_factor: float = 0.0

    @classmethod
    def zero(cls, size: int, parameters: int) -> Weights:
        return cls(np.zeros(size), np.zeros(size), np.zeros(parameters))

    def along(self, change: State) -> float:
        """What they make of a change of the state."""
        moved = self.u @ change.u + self.forces @ change.forces + self.p @ change.p
        return float(moved + self.load_factor * change.load_factor)


class Measure:
    """One scalar."""

    unit = ""

    def value(self, s: State) -> float:
        raise NotImplementedError

    def pull(self, s: State, weight: float, into: Weights) -> None:
        """Add the weights of the state."""
        raise NotImplementedError

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        """Add the change of these weights with the state; there is none where ``value`` is linear.

        ``change`` holds the rates of displacements, forces and parameters.
        """


@dataclass
class Displacement(Measure):
    """A displacement of a node."""

    degree: int
    unit: str = "m"

    def value(self, s: State) -> float:
        return float(s.u[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.u[self.degree] += weight


@dataclass
class ExternalForce(Measure):
    """The force on a node: applied, or the reaction of its support (8.18)."""

    degree: int
    unit: str = "N"

    def value(self, s: State) -> float:
        return float(s.forces[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.forces[self.degree] += weight


@dataclass
class LoadFactor(Measure):
    """Share of the load that acts."""

    unit: str = ""

    def value(self, s: State) -> float:
        return s.load_factor

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.load_factor += weight


@dataclass
class ElementMeasure(Measure):
    """A quantity of one element, or drawn from the same quantity of several.

    Parameters
    ----------
    block : of the elements
    rows : of the elements in their block
    name : of the quantity
    reduction : ``max``, ``min`` or ``sum``; of one element they are all the same
    smooth : ``ρ`` of the aggregate ``(1/ρ) ln Σ exp(ρ m_k)`` (Kreisselmeier and Steinhauser 1979)
        instead of the largest and smallest themselves, one over the unit of the quantity
    """

    block: ElementBlock
    rows: np.ndarray
    name: str
    unit: str = ""
    reduction: str = "sum"
    smooth: float | None = None

    def field(self, s: State) -> np.ndarray:
        """(k,) the quantity of each element."""
        b, k = self.block, self.rows
        return b.kind.measure(self.name, b.gather(s.u)[:, k], s.data(b)[:, k]).ravel()

    def value(self, s: State) -> float:
        found = self.field(s)
        if self.reduction == "sum":
            return float(found.sum())
        sign = 1.0 if self.reduction == "max" else -1.0
        top = float((sign * found).max())
        if self.smooth is not None:
            rest = np.exp(self.smooth * (sign * found - top))
            top += float(np.log(rest.sum())) / self.smooth
        return sign * top

    def slopes(self, s: State) -> np.ndarray:
        """(k,) derivatives of the value by the quantity of each element."""
        found = self.field(s)
        if self.reduction == "sum":
            return np.ones_like(found)
        signed = found if self.reduction == "max" else -found
        if self.smooth is None:
            return np.eye(1, found.size, int(np.argmax(signed))).ravel()
        parts = np.exp(self.smooth * (signed - signed.max()))
        return parts / parts.sum()

    def slopes_change(self, s: State, change: np.ndarray) -> np.ndarray:
        """(k,) change of the slopes when the quantities change."""
        if self.reduction == "sum" or self.smooth is None:
            return np.zeros_like(change)
        parts, sign = self.slopes(s), 1.0 if self.reduction == "max" else -1.0
        return sign * self.smooth * parts * (change - parts @ change)

    def pull(self, s: State, weight: float, into: Weights) -> None:
        b, slopes = self.block, self.slopes(s)
        felt = np.flatnonzero(slopes)  # of a largest value just one
        k = self.rows[felt]
        u_bar, data_bar = b.kind.pull_measure(
            self.name, b.gather(s.u)[:, k], s.data(b)[:, k], weight * slopes[None, felt]
        )
        np.add.at(into.u, b.degrees[:, k], u_bar)
        s.pull_data(b, self._spread(data_bar, k), into)

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        b, k = self.block, self.rows
        at = self.name, b.gather(s.u)[:, k], s.data(b)[:, k]
        du, ddata = b.gather(change.u)[:, k], s.push_data(b, change)[:, k]
        by_u, by_data = b.kind.pull_measure(*at, np.ones((1, k.size)))
        moved = (by_u * du).sum(axis=0) + (by_data * ddata).sum(axis=0)
        slopes, turned = weight * self.slopes(s), weight * self.slopes_change(s, moved)
        u_bar, data_bar = b.kind.turn_measure(*at, slopes[None, :], du, ddata)
        np.add.at(into.u, b.degrees[:, k], u_bar + turned * by_u)
        s.pull_data(b, self._spread(data_bar + turned * by_data, k), into)
        into.p += s.turn_data(b, self._spread(slopes * by_data, k), change)

    def _spread(self, chosen: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """(m, ne) numbers of all elements from those of some."""
        whole = np.zeros((chosen.shape[0], self.block.count))
        whole[:, rows] = chosen
        return whole


@dataclass
class Total(Measure):
    """Sum of a quantity over all elements."""

    blocks: list[ElementBlock]
    name: str
    unit: str = ""

    def value(self, s: State) -> float:
        return float(
            sum(b.kind.measure(self.name, b.gather(s.u), s.data(b)).sum() for b in self.blocks)
        )

    def pull(self, s: State, weight: float, into: Weights) -> None:
        for b in self.blocks:
            u_bar, data_bar = b.kind.pull_measure(
                self.name, b.gather(s.u), s.data(b), np.full((1, b.count), weight)
            )
            into.u += b.scatter(u_bar, into.u.size)
            s.pull_data(b, data_bar, into)

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        for b in self.blocks:
            ElementMeasure(b, np.arange(b.count), self.name).turn(s, change, weight, into)


@dataclass
class Compliance(Measure):
    """Work of all external forces on their displacements, ``Pᵀ U`` (Ex. 8.14)."""

    unit: str = "J"

    def value(self, s: State) -> float:
        return float(s.forces @ s.u)

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.u += weight * s.forces
        into.forces += weight * s.u

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        self.pull(change, weight, into)  # it is bilinear
