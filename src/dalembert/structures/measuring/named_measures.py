"""Measures of a structure by name; each is a symbol in formulas."""

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
    _made: dict[str, Expression] = field(default_factory=dict)
    _behind: dict[str, Measure] = field(default_factory=dict)

    def find(self, name: str) -> Expression | None:
        """The measure of this name, None if there is none."""
        if name not in self._made:
            measure = self._measure(name)
            if measure is None:
                return None
            self.add(name, measure)
        return self._made[name]

    def add(self, name: str, measure: Measure) -> Expression:
        """Give a measure a name and a symbol."""
        self._made[name] = Expression(ca.SX.sym(name), name, measure.unit)
        self._behind[name] = measure
        return self._made[name]

    def of(self, name: str) -> Measure:
        """The measure behind the name of a symbol."""
        self.find(name)
        return self._behind[name]

    def elements(self, name: str, quantity: str) -> ElementMeasure | None:
        """The same quantity of an element or of all elements of a set."""
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
        found = self.elements(owner, quantity)
        if found is None or (not reduction and found.rows.size > 1):
            return None  # a field is not a number
        if reduction:
            asked = REDUCTION.fullmatch(reduction)
            if asked is None:
                return None
            found.reduction = asked["kind"] or asked["plain"]
            found.smooth = float(asked["smooth"]) if asked["smooth"] else None
            if found.smooth is not None and not 0 < found.smooth < np.inf:
                return None
        return found

    def names(self) -> list[str]:
        """Names of all measures; of sets with many members those that reduce them."""
        found = ["compliance", "strain_energy", "kinetic_energy", "mass", "load_factor"]
        for node, direction in self._few(self.degrees):
            force = direction.replace("u", "f").replace("r", "m")
            found += [f"{node}.{direction}", f"{node}.{force}"]
        for block in self.blocks:
            quantities = list(block.kind.measures)
            for name in block.names.owners:
                many = name not in block.names
                ends = [f".{r}" for r in REDUCTIONS] if many else [""]
                found += [f"{name}.{q}{end}" for q in quantities for end in ends]
        return found

    @staticmethod
    def _few(degrees: Numbering, most: int = 10_000) -> list[tuple[str, str]]:
        return [degrees.place(k) for k in range(min(len(degrees), most))]
