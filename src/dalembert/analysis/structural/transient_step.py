"""One step of Newmark's method or a relative with algorithmic damping, for structures.

In the form of Arnold and Brüls (2007), as for mechanisms: the equations of motion hold at the end
of the step with the true acceleration ``a⁺``, and the algorithmic one follows by

    α⁺ = κ a⁺ + w,    w = μ a − ν α,    κ = (1−α_f)/(1−α_m), μ = α_f/(1−α_m), ν = α_m/(1−α_m),
    u⁺ = u + h v + h²((1/2 − β) α + β α⁺),    v⁺ = v + h((1 − γ) α + γ α⁺).

All are linear in ``a⁺``, the one unknown.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse

from dalembert.analysis.structural.transient_equation import EquationOfMotion, Motions, factors
from dalembert.integrators.newmark import NewmarkFamily

SINGULAR = (
    "the equations of a step are singular: some displacement has neither mass nor stiffness; give "
    "its elements a density, or support it"
)
STANDS = 1e-13
"""Change of the displacements, relative to the largest, that only round-off makes."""
ROUNDING = 1e-7
"""Residual that is then taken for round-off of stiff parts."""


class Moving(NamedTuple):
    """What a step begins with and ends with, (n,) or (n, columns).

    Attributes
    ----------
    u, v, a : motion that fulfils the equations of motion
    algorithmic : ``α``
    """

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    algorithmic: np.ndarray

    @property
    def motion(self) -> Motions:
        """Without the memory of the method."""
        return Motions(self.u, self.v, self.a)


@dataclass(frozen=True)
class StepRule:
    """The step as a linear map of what it begins with and the acceleration it ends with.

    Attributes
    ----------
    h : length [s]
    kappa, mu, nu : as above
    early : parts of ``α`` in displacement and speed, ``h²(1/2 − β)`` and ``h (1 − γ)``
    late : parts of ``α⁺``, ``h² β`` and ``h γ``
    """

    h: float
    kappa: float
    mu: float
    nu: float
    early: tuple[float, float]
    late: tuple[float, float]

    @classmethod
    def of(cls, integrator: NewmarkFamily, h: float) -> StepRule:
        """The rule of a method for steps of length ``h``."""
        c = integrator.coefficients
        left = 1 - c.alpha_m
        return cls(
            h,
            (1 - c.alpha_f) / left,
            c.alpha_f / left,
            c.alpha_m / left,
            (h**2 * (0.5 - c.beta), h * (1 - c.gamma)),
            (h**2 * c.beta, h * c.gamma),
        )

    def predicted(self, x: Moving) -> Moving:
        """The end of the step for ``a⁺ = 0``."""
        w = self.mu * x.a - self.nu * x.algorithmic
        u = x.u + self.h * x.v + self.early[0] * x.algorithmic + self.late[0] * w
        v = x.v + self.early[1] * x.algorithmic + self.late[1] * w
        return Moving(u, v, np.zeros_like(u), w)

    def ended(self, predicted: Moving, a: np.ndarray) -> Moving:
        """The end of the step."""
        part = self.kappa * a
        return Moving(
            predicted.u + self.late[0] * part,
            predicted.v + self.late[1] * part,
            a,
            predicted.algorithmic + part,
        )

    def weigh_acceleration(self, weights: Moving) -> np.ndarray:
        """Weight of ``a⁺``: the transpose of ``ended``."""
        late = self.late[0] * weights.u + self.late[1] * weights.v
        return weights.a + self.kappa * (weights.algorithmic + late)

    def weigh_start(self, weights: Moving) -> Moving:
        """Weights of what the step begins with: the transpose of ``predicted``."""
        late = self.late[0] * weights.u + self.late[1] * weights.v
        w = weights.algorithmic + late
        return Moving(
            weights.u,
            weights.v + self.h * weights.u,
            self.mu * w,
            self.early[0] * weights.u + self.early[1] * weights.v - self.nu * w,
        )


class TransientStep:
    """Steps of one length.

    Parameters
    ----------
    equation : EquationOfMotion
    integrator : method with its tolerance
    h : length [s]
    """

    def __init__(self, equation: EquationOfMotion, integrator: NewmarkFamily, h: float):
        self.equation, self.integrator = equation, integrator
        self.rule = StepRule.of(integrator, h)
        e, rule = equation, self.rule
        spring, damper = rule.kappa * rule.late[0], rule.kappa * rule.late[1]
        self._spring = spring
        self._rest = (1 + damper * e.alpha) * e.mass + damper * e.beta * e.stiffness
        self._factor = self._factors(e.stiffness) if e.linear else None
        self.iterations, self.residual = 0, 0.0

    def factor(self, tangent: sparse.csc_matrix):
        """Factors of ``M + κ(h γ C + h² β K)`` in the free displacements."""
        return self._factors(tangent) if self._factor is None else self._factor

    def _factors(self, tangent: sparse.csc_matrix):
        free = self.equation.free
        matrix = (self._rest + self._spring * tangent).tocsc()
        return factors(matrix[free][:, free], SINGULAR)

    def advance(self, x: Moving, time: float) -> Moving | None:
        """The end of the step at ``time``; None where Newton's method fails.

        Raises
        ------
        SingularityError
            The equations of the step are singular.
        """
        e = self.equation
        ahead, held = self.rule.predicted(x), e.support_motion(time)
        a = np.zeros_like(x.a) if e.linear else x.a.copy()
        a[e.held] = 0.0
        loads = e.loads(time)
        if e.linear:
            return self._corrected(ahead, held, a, loads)[0]
        return self._newton(ahead, held, a, loads)

    def placed(self, ahead: Moving, held: Motions, a: np.ndarray) -> Moving:
        """The end of the step for accelerations of the free displacements."""
        new, where = self.rule.ended(ahead, a), self.equation.held
        for column, prescribed in zip(new.motion, held, strict=True):
            column[where] = prescribed
        new.algorithmic[where] = held.a
        return new

    def _corrected(
        self, ahead: Moving, held: Motions, a: np.ndarray, loads: np.ndarray
    ) -> tuple[Moving, float, float]:
        """After one iteration; residual before it, and change, both relative to the largest."""
        e = self.equation
        new = self.placed(ahead, held, a.copy())
        inner = e.forces(new.motion)
        rest = (loads - inner)[e.free]
        largest = max(np.abs(loads).max(initial=0.0), np.abs(inner).max(initial=0.0), 1e-300)
        factor = self.factor(None if e.linear else e.tangent(new.u))
        if factor is None:
            return new, 0.0, 0.0
        change = factor.solve(rest)
        a[e.free] += change
        new = self.placed(ahead, held, a.copy())
        moved = self._spring * np.abs(change).max()
        size = float(np.abs(rest).max() / largest)
        return new, size, float(moved / max(np.abs(new.u).max(), 1e-300))

    def _newton(
        self, ahead: Moving, held: Motions, a: np.ndarray, loads: np.ndarray
    ) -> Moving | None:
        """Newton's method; one iteration more after convergence leaves round-off only."""
        for _ in range(self.integrator.max_iterations):
            new, size, moved = self._corrected(ahead, held, a, loads)
            self.iterations += 1
            if not (np.isfinite(size) and np.isfinite(moved)):
                return None
            if size < self.integrator.tolerance or (moved < STANDS and size < ROUNDING):
                self.residual = max(self.residual, size)
                return new
        return None
