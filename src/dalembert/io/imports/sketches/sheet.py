"""Parameters and numbers of a model file in the unit of a drawing."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.errors import DalembertError
from dalembert.io.imports.sketches.names import Names, numbered
from dalembert.io.imports.toml_text import number_text
from dalembert.model.system import System
from dalembert.symbolic.formulas.functions import FORMULA_FUNCTIONS
from dalembert.units.unit import unit

DIGITS = 9
"""Digits of a length that is as large as the drawing."""
ANGLE_DIGITS = 6
"""Decimal places of angles in degrees."""


@dataclass
class Sheet:
    """Parameters of the model, and texts of numbers.

    Parameters
    ----------
    unit : of lengths, such as ``"mm"``
    size : of the drawing in this unit
    """

    unit: str
    size: float
    parameters: dict[str, Any] = field(default_factory=dict)
    names: Names = field(default_factory=lambda: Names([*System.meanings, *FORMULA_FUNCTIONS]))

    def rounded(self, length: float) -> float:
        """A length without digits below the precision of drawings."""
        places = DIGITS - math.ceil(math.log10(self.size))
        return round(float(length), places) + 0.0

    def text(self, length: float) -> str | float:
        """A length with its unit, ``"12.5 mm"``; a plain zero."""
        value = self.rounded(length)
        return f"{number_text(value)} {self.unit}" if value else 0.0

    def vector(self, point: np.ndarray) -> list[str | float]:
        return [self.text(value) for value in point]

    def angle(self, radians: float) -> str | float:
        """An angle in degrees, ``"63.4 deg"``; a plain zero."""
        value = round(math.degrees(radians), ANGLE_DIGITS) + 0.0
        return f"{number_text(value)} deg" if value else 0.0

    def direction(self, vector: np.ndarray) -> list[float]:
        """The components of a unit vector."""
        return [round(float(value), 12) + 0.0 for value in vector]

    def length(self, wish: str, value: float, description: str) -> str:
        """Declare a parameter of a length; returns its name."""
        return self.declare(wish, self.rounded(value), self.unit, description)

    def declare(self, wish: str, value: float, unit: str, description: str) -> str:
        """Declare a parameter; returns its name, which is no unit."""
        if _is_unit(wish):
            wish = f"{wish}_length"
        name = self.names.unique(wish, numbered("length"))
        self.parameters[name] = {"value": value, "unit": unit, "description": description}
        return name

    def sum(self, *terms: tuple[str, str | float]) -> str | float:
        """A formula of signed terms without zeros: ``[("", "a"), ("-", 0.0)]`` is ``a``."""
        text = ""
        for sign, term in terms:
            if term != 0.0:
                text += f" {sign or '+'} {term}" if text else f"{sign}{term}"
        return text.replace("+ -", "- ").replace("- -", "+ ") or 0.0


def _is_unit(name: str) -> bool:
    try:
        unit(name)
    except DalembertError:
        return False
    return True


def merged(*tables: Mapping[str, Any]) -> dict[str, Any]:
    """Entries of tables that are not empty."""
    return {key: value for table in tables for key, value in table.items() if value not in ({}, [])}
