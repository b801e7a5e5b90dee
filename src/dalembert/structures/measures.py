"""Measures of a structure: displacements, reactions, quantities of elements, and totals.

A measure knows its value at a state and hands weights back to what it was made of, so that any
formula of measures has exact gradients.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.structures.block import ElementBlock
from dalembert.symbolic.expression import Expression


@dataclass
class State:
    """Displacements (n,), external forces (n,) with reactions, parameters."""

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray


@dataclass
class Weights:
    """The same for weights; ``forces`` at prescribed displacements weigh reactions."""

    u: np.ndarray
    forces: np.ndarray
    p: np.ndarray

    @classmethod
    def zero(cls, size: int, parameters: int) -> Weights:
        return cls(np.zeros(size), np.zeros(size), np.zeros(parameters))


class Measure:
    """One scalar."""

    unit = ""

    def value(self, s: State) -> float:
        raise NotImplementedError

    def pull(self, s: State, weight: float, into: Weights) -> None:
        """Add the weights of the state."""
        raise NotImplementedError


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
class ElementMeasure(Measure):
    """A quantity of one element."""

    block: ElementBlock
    row: int
    name: str
    unit: str = ""

    def value(self, s: State) -> float:
        b, k = self.block, [self.row]
        return float(b.kind.measure(self.name, b.gather(s.u)[:, k], b.data(s.p)[:, k])[0, 0])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        b, k = self.block, [self.row]
        data = b.data(s.p)
        u_bar, data_bar = b.kind.pull_measure(
            self.name, b.gather(s.u)[:, k], data[:, k], np.array([[weight]])
        )
        np.add.at(into.u, b.degrees[:, k], u_bar)
        whole = np.zeros_like(data)
        whole[:, k] = data_bar
        into.p += b.pull_data(s.p, whole)


@dataclass
class Total(Measure):
    """Sum of a quantity over all elements."""

    blocks: list[ElementBlock]
    name: str
    unit: str = ""

    def value(self, s: State) -> float:
        return float(
            sum(b.kind.measure(self.name, b.gather(s.u), b.data(s.p)).sum() for b in self.blocks)
        )

    def pull(self, s: State, weight: float, into: Weights) -> None:
        for b in self.blocks:
            u_bar, data_bar = b.kind.pull_measure(
                self.name, b.gather(s.u), b.data(s.p), np.full((1, b.count), weight)
            )
            into.u += b.scatter(u_bar, into.u.size)
            into.p += b.pull_data(s.p, data_bar)


@dataclass
class Compliance(Measure):
    """Work of all external forces on their displacements, ``Pᵀ U`` (Ex. 8.14)."""

    unit: str = "J"

    def value(self, s: State) -> float:
        return float(s.forces @ s.u)

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.u += weight * s.forces
        into.forces += weight * s.u


@dataclass
class StructuralMeasures:
    """Measures by name; each is a symbol in formulas.

    Parameters
    ----------
    degrees : (node, direction) → number of the displacement
    blocks : all elements
    """

    degrees: dict[tuple[str, str], int]
    blocks: list[ElementBlock]
    _made: dict[str, Expression] = field(default_factory=dict)
    _behind: dict[str, Measure] = field(default_factory=dict)

    def find(self, name: str) -> Expression | None:
        """The measure of this name, None if there is none."""
        if name not in self._made:
            measure = self._measure(name)
            if measure is None:
                return None
            symbol = ca.SX.sym(name)
            self._made[name] = Expression(symbol, name, measure.unit)
            self._behind[name] = measure
        return self._made[name]

    def of(self, name: str) -> Measure:
        """The measure behind the name of a symbol."""
        self.find(name)
        return self._behind[name]

    def _measure(self, name: str) -> Measure | None:
        if name == "compliance":
            return Compliance()
        if name in ("strain_energy", "mass"):
            energy = name == "strain_energy"
            return Total(self.blocks, "energy" if energy else "mass", "J" if energy else "kg")
        owner, _, quantity = name.partition(".")
        if (owner, quantity) in self.degrees:
            unit = "m" if quantity.startswith("u") else "rad"
            return Displacement(self.degrees[owner, quantity], unit)
        motion = quantity.replace("f", "u", 1).replace("m", "r", 1)
        if quantity[:1] in ("f", "m") and (owner, motion) in self.degrees:
            unit = "N" if quantity.startswith("f") else "N m"
            return ExternalForce(self.degrees[owner, motion], unit)
        for block in self.blocks:
            if owner in block.names and quantity in block.kind.measures:
                unit = block.kind.measures[quantity][1]
                return ElementMeasure(block, block.names.index(owner), quantity, unit)
        return None

    def names(self) -> list[str]:
        """Names of all measures."""
        found = ["compliance", "strain_energy", "mass"]
        for node, direction in self.degrees:
            force = direction.replace("u", "f").replace("r", "m")
            found += [f"{node}.{direction}", f"{node}.{force}"]
        for block in self.blocks:
            found += [f"{name}.{m}" for name in block.names for m in block.kind.measures]
        return found
