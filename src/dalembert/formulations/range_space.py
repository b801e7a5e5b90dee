"""Explicit elimination of the accelerations (5.11–5.12), the range-space method."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.formulations.augmented_mass import mean_effective_mass
from dalembert.formulations.base import Formulation, SaddleSolver
from dalembert.model.graph.inertia import BlockInertia, Inertia
from dalembert.symbolic.equations.factor import LdlFactor


class RangeSpaceSolver(SaddleSolver):
    """``λ = (C M⁻¹ Cᵀ)⁻¹ (C M⁻¹ r1 − r2)``, ``x = M⁻¹ (r1 − Cᵀ λ)`` (5.11–5.12).

    Coordinates without mass make M singular. The rows ``S`` of C that involve them are then
    added as ``M + ρ SᵀS`` and ``r1 + ρ Sᵀ r2``, which leaves the solution unchanged because it
    satisfies ``S x = r2``.
    """

    def __init__(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]):
        self.speed_count = inertia.size
        self.jacobian = jacobian
        self.rows = _rows_on(massless, jacobian)
        self.weight = ca.SX(0)
        if self.rows:
            mass = inertia.matrix
            s = jacobian[self.rows, :]
            self.weight = mean_effective_mass(mass, s, massless)
            inertia = BlockInertia(mass + self.weight * ca.mtimes(s.T, s))
        self.inertia = inertia
        self.factor = LdlFactor(ca.mtimes(jacobian, inertia.solve(jacobian.T)))

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        c = self.jacobian
        if self.rows:
            r1 = r1 + self.weight * ca.mtimes(c[self.rows, :].T, r2[self.rows])
        negative = self.factor.solve(r2 - ca.mtimes(c, self.inertia.solve(r1)))
        return self.inertia.solve(r1 + ca.mtimes(c.T, negative)), -negative


def _rows_on(massless: tuple[int, ...], jacobian: ca.SX) -> list[int]:
    """Constraint rows that involve a coordinate without mass."""
    pattern = ca.sparsify(jacobian).sparsity()
    rows: set[int] = set()
    for k in massless:
        rows |= set(pattern.row()[pattern.colind()[k] : pattern.colind()[k + 1]])
    return sorted(rows)


@dataclass(frozen=True)
class RangeSpace(Formulation):
    """Elimination of the accelerations, ``C M⁻¹Cᵀ λ = C M⁻¹(f − d) − ξ`` (5.11–5.12).

    The default: fastest in absolute coordinates. Supports massless members fixed by constraints.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("Atwood", gravity=(0, -10))
    >>> a = system.add(planar.Particle("a", mass=3.0, position=(-1, 0)))
    >>> b = system.add(planar.Particle("b", mass=1.0, position=(1, 0)))
    >>> cord = system.add(planar.UserConstraint("cord", a.y + b.y))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1, formulation=da.RangeSpace())
    >>> round(motion["b.ay"][0].item(), 6)  # g (m1 - m2)/(m1 + m2)
    5.0
    """

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> RangeSpaceSolver:
        return RangeSpaceSolver(inertia, jacobian, massless)
