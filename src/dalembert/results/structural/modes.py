"""Modes of vibration and of buckling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.model.assembled.evaluation.inertia import from_rest
from dalembert.model.assembled.measures import Measure, State, Weights
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.modes import Modes
from dalembert.results.structural.eigenmodes import EIGENVALUE, EigenModes
from dalembert.symbolic.formulas.expression import Expression

OMEGA = ca.sign(EIGENVALUE) * ca.sqrt(ca.fabs(EIGENVALUE))
GROWS = EIGENVALUE < 0
GROWTH = ca.if_else(GROWS, -OMEGA, 0)
"""``Re s``; of an undamped mode it is zero, or positive where the structure is unstable."""
PARTICIPATION, EFFECTIVE = "participation.", "effective_mass."


@dataclass
class Participation(Measure):
    """``Γ = φᵀ M r`` with a unit motion ``r`` of all nodes in one direction (Clough and Penzien).

    Parameters
    ----------
    model : StructuralModel
    direction : ux, uy or uz
    lumped : whether the mass matrix is lumped
    """

    model: StructuralModel
    direction: str
    lumped: bool
    unit: str = "kg^0.5"

    @property
    def motion(self) -> np.ndarray:
        """(n,) ``r``."""
        degrees = self.model.degrees
        vector = np.zeros(len(degrees))
        vector[degrees.table[:, degrees.directions.index(self.direction)]] = 1.0
        return vector

    def value(self, s: State) -> float:
        return float(s.u @ self._moved(s))

    def pull(self, s: State, weight: float, into: Weights) -> None:
        into.u += weight * self._moved(s)
        into.p += weight * self.model.assembly.pull_inertia(
            from_rest(self.motion), s.p, s.u, self.lumped
        )

    def _moved(self, s: State) -> np.ndarray:
        return self.model.assembly.mass(s.p, self.lumped) @ self.motion


class VibrationModes(EigenModes, Modes):
    """Modes of ``K φ = ω² M φ`` by increasing ``ω²``, scaled to ``φᵀ M φ = 1 kg m²``.

    If the structure is unstable ``ω²`` is negative; ``frequency`` and ``angular_frequency`` then
    have its sign. ``participation.ux`` is ``Γ``, ``effective_mass.ux`` is ``Γ²``, also with uy and
    uz: the part of the mass that a motion of all supports in this direction excites through the
    mode.
    """

    named: ClassVar[dict[str, Expression]] = {
        "frequency": Expression(OMEGA / (2 * np.pi), "frequency", "Hz"),
        "angular_frequency": Expression(OMEGA, "angular_frequency", "rad/s"),
        "eigenvalue": Expression(EIGENVALUE, "eigenvalue", "rad^2/s^2"),
    }
    derived: ClassVar[dict[str, Expression]] = {
        "damping_ratio": Expression(ca.if_else(GROWS, -1, 0), "damping_ratio", "1"),
        "eigenvalue_real": Expression(GROWTH, "eigenvalue_real", "1/s"),
        "eigenvalue_imag": Expression(OMEGA + GROWTH, "eigenvalue_imag", "rad/s"),
    }

    def measure(self, name: str) -> Measure:
        return self._measure_of(self.model, name, self.analysis.lumped)  # type: ignore[attr-defined]

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
    def _measure_of(cls, model: StructuralModel, name: str, lumped: bool = False) -> Measure:
        direction = name.removeprefix(PARTICIPATION)
        if name != direction and direction in _directions(model):
            return Participation(model, direction, lumped)
        return super()._measure_of(model, name, lumped)

    @property
    def reported_measures(self) -> list[str]:
        return [*self.named, *(EFFECTIVE + direction for direction in _directions(self.model))]


def _directions(model: StructuralModel) -> tuple[str, ...]:
    """Translational directions of all nodes."""
    return tuple(d for d in model.degrees.directions if d.startswith("u"))


class BucklingModes(EigenModes):
    """Modes of ``(K + λ K_g) φ = 0`` by the magnitude of the load factor ``λ``.

    They are computed from ``−K_g φ = μ K φ``, scaled to ``φᵀ K φ = 1 J``: ``eigenvalues`` are
    ``μ = 1/λ``.
    """

    named: ClassVar[dict[str, Expression]] = {
        "load_factor": Expression(1 / EIGENVALUE, "load_factor", ""),
    }
    main = "load_factor"

    @property
    def load_factors(self) -> np.ndarray:
        """(k,) ``λ``."""
        return self.values("load_factor")
