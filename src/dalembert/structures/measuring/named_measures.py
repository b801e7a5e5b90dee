"""Measures of a structure by name, as symbols in formulas."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import casadi as ca
import numpy as np

from dalembert.structures.evaluation.block import ElementBlock
from dalembert.structures.evaluation.numbering import Numbering
from dalembert.structures.measuring.measures import (
    Compliance,
    Displacement,
    ElementMeasure,
    ExternalForce,
    LoadFactor,
    Measure,
    Total,
)
from dalembert.structures.measuring.motion_measures import moving_measure
from dalembert.symbolic.formulas.expression import Expression

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
