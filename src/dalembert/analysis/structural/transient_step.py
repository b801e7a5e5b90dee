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

from dalembert.analysis.structural.balance import Balance, Balanced
from dalembert.analysis.structural.transient_equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    factors,
)
from dalembert.integrators.newmark import NewmarkFamily
from dalembert.symbolic.newton import Equations, NewtonSettings, Residual, solve

SINGULAR = (
    "the equations of a step are singular: some displacement has neither mass nor stiffness; give "
    "its elements a density, or support it"
)


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
        self.equation, self.rule = equation, StepRule.of(integrator, h)
        self.settings = NewtonSettings(
            tolerance=integrator.tolerance, max_iterations=integrator.max_iterations, halvings=0
        )
        self._factor = self._factors(equation.slopes(equation.rest)) if equation.linear else None
        self.balance, self.iterations = Balance(equation.model, equation.p), 0

    def factor(self, slopes: Slopes):
        """Factors of ``M + κ(h γ C + h² β K)`` in the free displacements."""
        return self._factors(slopes) if self._factor is None else self._factor

    def _factors(self, slopes: Slopes):
        e, rule = self.equation, self.rule
        late = slopes.v * (rule.kappa * rule.late[1]) + slopes.u * (rule.kappa * rule.late[0])
        matrix = (slopes.a + late).tocsc()[e.free][:, e.free]
        return factors(matrix, SINGULAR, symmetric=e.symmetric)

    def advance(self, x: Moving, time: float) -> Moving | None:
        """The end of the step at ``time``; None where Newton's method fails.

        Raises
        ------
        SingularityError
            The equations of the step are singular.
        """
        e = self.equation
        ahead, held, loads = self.rule.predicted(x), e.support_motion(time), e.loads(time)
        equations, a = EndOfStep(self, ahead, held, loads), np.zeros_like(x.a)
        if not e.linear:
            a[e.free] = x.a[e.free]
            solution = solve(equations, a, self.settings)
            self.iterations += solution.iterations + 1
            if not solution.accepted:
                return None
            a = solution.x
        a = equations.corrected(a)  # once more after convergence: round-off only is left
        return self.placed(ahead, held, a)

    def residual(self, motion: Motions, loads: np.ndarray, where: np.ndarray) -> Balanced:
        """What is left over of the forces on some displacements."""
        e, (u, v, a) = self.equation, (np.abs(x) for x in motion)
        inertia, damper = e.sizes
        stiffness = e.tangent(motion.u)
        made_of = abs(stiffness) @ u + damper @ v
        made_of += inertia @ (a + v / self.rule.h)  # an acceleration is a change of speed
        terms = [loads, *(-part for part in e.parts(motion))]
        return self.balance.residual(terms, made_of, where, stiffness)

    def placed(self, ahead: Moving, held: Motions, a: np.ndarray) -> Moving:
        """The end of the step for accelerations of the free displacements."""
        new, where = self.rule.ended(ahead, a.copy()), self.equation.held
        for column, prescribed in zip(new.motion, held, strict=True):
            column[where] = prescribed
        new.algorithmic[where] = held.a
        return new


@dataclass(frozen=True)
class EndOfStep(Equations[np.ndarray]):
    """The equations of motion at the end of a step, in the accelerations (n,) there.

    Attributes
    ----------
    by : the step
    ahead : its end without acceleration
    held : prescribed motion at its end
    loads : (n,) applied forces there
    """

    by: TransientStep
    ahead: Moving
    held: Motions
    loads: np.ndarray

    def motion(self, a: np.ndarray) -> Motions:
        """The motion at the end."""
        return self.by.placed(self.ahead, self.held, a).motion

    def residual(self, x: np.ndarray) -> Residual:
        return self.by.residual(self.motion(x), self.loads, self.by.equation.free)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, Balanced)
        slopes = self.by.equation.slopes(self.motion(x), residual.stiffness)
        return self._step(slopes, residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        found = x.copy()
        found[self.by.equation.free] += step
        return found

    def corrected(self, a: np.ndarray) -> np.ndarray:
        """After one more step."""
        e, motion = self.by.equation, self.motion(a)
        rest = (self.loads - e.forces(motion))[e.free]
        return self.retract(a, self._step(e.slopes(motion), rest))

    def _step(self, slopes: Slopes, rest: np.ndarray) -> np.ndarray:
        factor = self.by.factor(slopes)
        return np.zeros(0) if factor is None else factor.solve(rest)
