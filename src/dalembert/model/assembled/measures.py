"""Measures of a structure: displacements, reactions, quantities of elements, and totals.

A measure returns its value at a state and the derivatives by the state, so that any formula of
measures has exact gradients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.load_case import Temperatures


@dataclass
class State:
    """Displacements (n,), external forces (n,) with reactions, parameters, load factor.

    Temperatures are those of a load case, times the load factor, at an instant.
    """

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray
    load_factor: float = 1.0
    temperatures: Temperatures = Temperatures()
    time: float = 0.0

    def data(self, b: ElementBlock) -> np.ndarray:
        """(m, ne) data of elements, with the temperatures of the state."""
        return self.temperatures.data(b, self.p, self.load_factor, self.time)

    def push_data(self, b: ElementBlock, change: State) -> np.ndarray:
        """(m, ne) change of the data."""
        source = self.temperatures.source(b).push_data(self.p, change.p, self.time)
        return self.temperatures.scale(b, source, self.load_factor)

    def pull_data(self, b: ElementBlock, weights: np.ndarray, into: Weights) -> None:
        """Add the weights of parameters and load factor from weights (m, ne) of the data."""
        source, rows = self.temperatures.source(b), self.temperatures.rows(b)
        if rows:
            into.load_factor += float((weights[rows] * source.data(self.p, self.time)[rows]).sum())
        shared = self.temperatures.scale(b, weights, self.load_factor)
        into.p += source.pull_data(self.p, shared, self.time)

    def turn_data(self, b: ElementBlock, weights: np.ndarray, change: State) -> np.ndarray:
        """Change of the weights of the parameters in ``pull_data`` with the parameters."""
        return self.temperatures.source(b).turn_data(self.p, weights, change.p)


@dataclass
class Weights:
    """Weights of a state; ``forces`` at prescribed displacements are weights of reactions."""

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray
    load_factor: float = 0.0

    @classmethod
    def zero(cls, size: int, parameters: int) -> Weights:
        return cls(np.zeros(size), np.zeros(size), np.zeros(parameters))

    def along(self, change: State) -> float:
        """Product with a change of the state."""
        total = self.u @ change.u + self.forces @ change.forces + self.p @ change.p
        return float(total + self.load_factor * change.load_factor)


class Measure:
    """Scalar function of a state."""

    unit = ""

    def value(self, s: State) -> float:
        raise NotImplementedError

    def pull(self, s: State, weight: float, into: Weights) -> None:
        """Add the weights of the state."""
        raise NotImplementedError

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        """Add the change of these weights with the state; zero where ``value`` is linear.

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
    """Load factor."""

    unit: str = ""

    def value(self, s: State) -> float:
        return s.load_factor

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.load_factor += weight


@dataclass
class ElementMeasure(Measure):
    """A quantity of one element, or a reduction of the quantity over several elements.

    Parameters
    ----------
    block : block of the elements
    rows : rows of the elements in their block
    name : name of the quantity
    reduction : ``max``, ``min`` or ``sum``; for one element they agree
    smooth : ``ρ`` of the aggregate ``(1/ρ) ln Σ exp(ρ m_k)`` (Kreisselmeier and Steinhauser 1979)
        instead of the exact maximum or minimum; unit: one over the unit of the quantity
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
        values = self.field(s)
        if self.reduction == "sum":
            return float(values.sum())
        sign = 1.0 if self.reduction == "max" else -1.0
        top = float((sign * values).max())
        if self.smooth is not None:
            rest = np.exp(self.smooth * (sign * values - top))
            top += float(np.log(rest.sum())) / self.smooth
        return sign * top

    def slopes(self, s: State) -> np.ndarray:
        """(k,) derivatives of the value by the quantity of each element."""
        values = self.field(s)
        if self.reduction == "sum":
            return np.ones_like(values)
        signed = values if self.reduction == "max" else -values
        if self.smooth is None:
            return np.eye(1, values.size, int(np.argmax(signed))).ravel()
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
        nonzero = np.flatnonzero(slopes)  # a single one for an exact maximum
        k = self.rows[nonzero]
        u_bar, data_bar = b.kind.pull_measure(
            self.name, b.gather(s.u)[:, k], s.data(b)[:, k], weight * slopes[None, nonzero]
        )
        np.add.at(into.u, b.degrees[:, k], u_bar)
        s.pull_data(b, self._spread(data_bar, k), into)

    def turn(self, s: State, change: State, weight: float, into: Weights) -> None:
        b, k = self.block, self.rows
        at = self.name, b.gather(s.u)[:, k], s.data(b)[:, k]
        du, ddata = b.gather(change.u)[:, k], s.push_data(b, change)[:, k]
        by_u, by_data = b.kind.pull_measure(*at, np.ones((1, k.size)))
        change_of_values = (by_u * du).sum(axis=0) + (by_data * ddata).sum(axis=0)
        slopes, turned = weight * self.slopes(s), weight * self.slopes_change(s, change_of_values)
        u_bar, data_bar = b.kind.turn_measure(*at, slopes[None, :], du, ddata)
        np.add.at(into.u, b.degrees[:, k], u_bar + turned * by_u)
        s.pull_data(b, self._spread(data_bar + turned * by_data, k), into)
        into.p += s.turn_data(b, self._spread(slopes * by_data, k), change)

    def _spread(self, selected: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """(m, ne) data of all elements from those of selected rows, zero elsewhere."""
        all_data = np.zeros((selected.shape[0], self.block.count))
        all_data[:, rows] = selected
        return all_data


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
