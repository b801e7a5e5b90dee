"""Modes of vibration: frequencies, shapes, and what a motion of the supports moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.results.structural.eigenmodes import EIGENVALUE, EigenModes
from dalembert.structures.evaluation.inertia import from_rest
from dalembert.structures.measuring.measures import Measure, State, Weights
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.formulas.expression import Expression

OMEGA = ca.sign(EIGENVALUE) * ca.sqrt(ca.fabs(EIGENVALUE))
PARTICIPATION, EFFECTIVE = "participation.", "effective_mass."


@dataclass
class Participation(Measure):
    """``Γ = φᵀ M r`` with a unit motion ``r`` of all nodes in one direction (Clough and Penzien).

    Parameters
    ----------
    model : StructuralModel
    direction : ux, uy or uz
    lumped : the mass matrix
    """

    model: StructuralModel
    direction: str
    lumped: bool
    unit: str = "kg^0.5"

    @property
    def motion(self) -> np.ndarray:
        """(n,) ``r``."""
        degrees = self.model.degrees
        found = np.zeros(len(degrees))
        found[degrees.table[:, degrees.directions.index(self.direction)]] = 1.0
        return found

    def value(self, s: State) -> float:
        return float(s.u @ self._moved(s))

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.u += weight * self._moved(s)
        into.p += weight * self.model.assembly.pull_inertia(
            from_rest(self.motion), s.p, s.u, self.lumped
        )

    def _moved(self, s: State) -> np.ndarray:
        return self.model.assembly.mass(s.p, self.lumped) @ self.motion


class VibrationModes(EigenModes):
    """Modes of ``K φ = ω² M φ`` by increasing ``ω²``, scaled to ``φᵀ M φ = 1 kg m²``.

    Where the structure is unstable ``ω²`` is negative; then so are ``frequency`` and
    ``angular_frequency``, of its size. ``participation.ux`` is ``Γ``, ``effective_mass.ux`` is
    ``Γ²``, also with uy and uz: the part of the mass that a motion of all supports in this
    direction sets in motion through the mode.
    """

    named: ClassVar[dict[str, Expression]] = {
        "frequency": Expression(OMEGA / (2 * np.pi), "frequency", "Hz"),
        "angular_frequency": Expression(OMEGA, "angular_frequency", "rad/s"),
        "eigenvalue": Expression(EIGENVALUE, "eigenvalue", "rad^2/s^2"),
    }
    main = "frequency"

    @property
    def frequencies(self) -> np.ndarray:
        """(k,) [Hz]."""
        return self.values("frequency")

    def measure(self, name: str) -> Measure:
        return self._behind(self.model, name, self.analysis.lumped)  # type: ignore[attr-defined]

    @classmethod
    def _find(cls, model: StructuralModel, name: str) -> Expression | None:
        for prefix in (PARTICIPATION, EFFECTIVE):
            direction = name.removeprefix(prefix)
            if name != direction and direction in _directions(model):
                symbol = ca.SX.sym(PARTICIPATION + direction)
                if prefix == EFFECTIVE:
                    return Expression(symbol**2, name, "kg")
                return Expression(symbol, name, Participation.unit)
        return super()._find(model, name)

    @classmethod
    def _behind(cls, model: StructuralModel, name: str, lumped: bool = False) -> Measure:
        direction = name.removeprefix(PARTICIPATION)
        if name != direction and direction in _directions(model):
            return Participation(model, direction, lumped)
        return super()._behind(model, name, lumped)

    @property
    def told(self) -> list[str]:
        return [*self.named, *(EFFECTIVE + way for way in _directions(self.model))]


def _directions(model: StructuralModel) -> tuple[str, ...]:
    """Displacements in which supports can move all nodes."""
    return tuple(d for d in model.degrees.directions if d.startswith("u"))
