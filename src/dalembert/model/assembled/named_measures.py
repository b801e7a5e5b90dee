"""Measures of a structure by name, as symbols in formulas; measures of its motions."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
import scipy

from dalembert.errors import AnalysisError
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.measures import (
    Compliance,
    Displacement,
    ElementMeasure,
    ExternalForce,
    LoadFactor,
    Measure,
    State,
    Total,
    Weights,
)
from dalembert.symbolic.formulas.expression import Expression


@dataclass(kw_only=True)
class MovingState(State):
    """A state with velocities and accelerations (n,), and the mass matrix of the analysis."""

    v: np.ndarray
    a: np.ndarray
    mass: scipy.sparse.csc_matrix
    lumped: bool


@dataclass(kw_only=True)
class MovingWeights(Weights):
    """Weights of a moving state."""

    v: np.ndarray
    a: np.ndarray

    @classmethod
    def zero(cls, size: int, parameters: int) -> MovingWeights:
        u, forces, v, a = (np.zeros(size) for _ in range(4))
        return cls(u=u, forces=forces, p=np.zeros(parameters), v=v, a=a)


def _moving(s: State) -> MovingState:
    if not isinstance(s, MovingState):
        raise AnalysisError(
            "velocities, accelerations and kinetic energy are defined for motions only; use "
            "solve_transient"
        )
    return s


@dataclass
class Velocity(Measure):
    """Time derivative of a displacement."""

    degree: int
    unit: str = "m/s"

    def value(self, s: State) -> float:
        return float(_moving(s).v[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.v[self.degree] += weight  # type: ignore[attr-defined]


@dataclass
class Acceleration(Measure):
    """Second time derivative of a displacement."""

    degree: int
    unit: str = "m/s^2"

    def value(self, s: State) -> float:
        return float(_moving(s).a[self.degree])

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.a[self.degree] += weight  # type: ignore[attr-defined]


@dataclass
class KineticEnergy(Measure):
    """``vᵀ M v / 2`` with the mass matrix of the analysis, which rotates with the elements."""

    blocks: list[ElementBlock]
    unit: str = "J"

    def value(self, s: State) -> float:
        moving = _moving(s)
        turning = [b for b in self.blocks if b.kind.turning(moving.lumped)]
        if not turning:
            return float(moving.v @ (moving.mass @ moving.v)) / 2
        return float(sum(self._of(b, moving)[0].sum() for b in self.blocks))

    def pull(self, s: State, weight: float, into: Weights) -> None:
        moving = _moving(s)
        for b in self.blocks:
            _, by_u, by_v, by_data = self._of(b, moving)
            into.u += weight * b.scatter(by_u, into.u.size)
            into.v += weight * b.scatter(by_v, into.u.size)  # type: ignore[attr-defined]
            into.p += weight * b.pull_data(s.p, by_data)

    @staticmethod
    def _of(b: ElementBlock, s: MovingState) -> tuple[np.ndarray, ...]:
        """Energies of the elements of a block, and their derivatives."""
        return b.kind.kinetic_energy(b.gather(s.u), b.gather(s.v), b.data(s.p), s.lumped)


def moving_measure(name: str, degrees: Numbering, blocks: list[ElementBlock]) -> Measure | None:
    """``node.vx``, ``node.ax``, ``node.vrz``, …, ``kinetic_energy``; None for other names."""
    if name == "kinetic_energy":
        return KineticEnergy(blocks)
    owner, _, quantity = name.partition(".")
    kind: type[Velocity | Acceleration] | None
    kind = {"v": Velocity, "a": Acceleration}.get(quantity[:1])  # type: ignore[assignment]
    if kind is None:
        return None
    for direction, unit in ((f"u{quantity[1:]}", "m"), (quantity[1:], "rad")):
        degree = degrees.get((owner, direction))
        if degree is not None and degrees.rotations[degree] == (unit == "rad"):
            return kind(degree, f"{unit}/s" if kind is Velocity else f"{unit}/s^2")
    return None


REDUCTIONS = ("max", "min", "sum")
REDUCTION = re.compile(
    r"(?P<plain>max|min|sum)|(?P<kind>max|min)\((?P<smooth>\d+(\.\d*)?([eE][+-]?\d+)?)\)"
)
"""``max``, or ``max(ρ)`` for the smooth aggregate."""


@dataclass
class StructuralMeasures:
    """``node.ux``, ``node.fx``, ``element.stress``, ``set[3].stress``, ``set.stress.max``, totals.

    Parameters
    ----------
    degrees : numbers of the displacements
    blocks : all elements
    """

    degrees: Numbering
    blocks: list[ElementBlock]
    _expressions: dict[str, Expression] = field(default_factory=dict)
    _measures: dict[str, Measure] = field(default_factory=dict)

    def find(self, name: str) -> Expression | None:
        """The symbol of the measure of this name; None for an unknown name."""
        if name not in self._expressions:
            measure = self._measure(name)
            if measure is None:
                return None
            self.add(name, measure)
        return self._expressions[name]

    def add(self, name: str, measure: Measure) -> Expression:
        """Register a measure under a name; returns its symbol."""
        self._expressions[name] = Expression(ca.SX.sym(name), name, measure.unit)
        self._measures[name] = measure
        return self._expressions[name]

    def of(self, name: str) -> Measure:
        """The measure of a symbol, by its name."""
        self.find(name)
        return self._measures[name]

    def elements(self, name: str, quantity: str) -> ElementMeasure | None:
        """A quantity of an element or of all elements of a set."""
        for block in self.blocks:
            rows = block.names.numbers(name)
            unit = None if rows is None else block.kind.unit(quantity)
            if unit is not None:
                return ElementMeasure(block, np.asarray(rows), quantity, unit)
        return None

    def _measure(self, name: str) -> Measure | None:
        if name == "compliance":
            return Compliance()
        if name == "load_factor":
            return LoadFactor()
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
        moving = moving_measure(name, self.degrees, self.blocks)
        if moving is not None:
            return moving
        quantity, _, reduction = quantity.partition(".")
        measure = self.elements(owner, quantity)
        if measure is None or (not reduction and measure.rows.size > 1):
            return None  # a field is not a number
        if reduction:
            match = REDUCTION.fullmatch(reduction)
            if match is None:
                return None
            measure.reduction = match["kind"] or match["plain"]
            measure.smooth = float(match["smooth"]) if match["smooth"] else None
            if measure.smooth is not None and not 0 < measure.smooth < np.inf:
                return None
        return measure

    def names(self) -> list[str]:
        """Names of all measures; for sets the reductions of their quantities."""
        names = ["compliance", "strain_energy", "kinetic_energy", "mass", "load_factor"]
        for node, direction in self._few(self.degrees):
            force = direction.replace("u", "f").replace("r", "m")
            names += [f"{node}.{direction}", f"{node}.{force}"]
        for block in self.blocks:
            quantities = list(block.kind.measures)
            for name in block.names.owners:
                many = name not in block.names
                ends = [f".{r}" for r in REDUCTIONS] if many else [""]
                names += [f"{name}.{q}{end}" for q in quantities for end in ends]
        return names

    @staticmethod
    def _few(degrees: Numbering, most: int = 10_000) -> list[tuple[str, str]]:
        return [degrees.place(k) for k in range(min(len(degrees), most))]
