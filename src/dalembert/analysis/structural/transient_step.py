"""One step of Newmark's method or a relative with algorithmic damping, for structures.

In the form of Arnold and Brüls (2007), as for mechanisms: the equations of motion hold at the end
of the step with the true acceleration ``a⁺``, and the algorithmic one follows by

    α⁺ = κ a⁺ + w,    w = μ a − ν α,    κ = (1−α_f)/(1−α_m), μ = α_f/(1−α_m), ν = α_m/(1−α_m),
    u⁺ = u + h v + h²((1/2 − β) α + β α⁺),    v⁺ = v + h((1 − γ) α + γ α⁺).

All are linear in ``a⁺``, the one unknown. Newton's method begins with the factors that the step
before ended with, and takes new ones only where they do not lead fast to the root; what it finds is
corrected once more with those at the end.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy

from dalembert.analysis.structural.balance import Balance, relative
from dalembert.analysis.structural.transient_equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    factors,
)
from dalembert.integrators.newmark import NewmarkFamily
from dalembert.sparse.solver import Factors
from dalembert.structures.pattern import combined
from dalembert.symbolic.newton import Equations, NewtonSettings, Residual, solve

SINGULAR = (
    "the equations of a step are singular: some displacement has neither mass nor stiffness; give "
    "its elements a density, or support it"
)


FAST = 0.1
"""Share of the residual that a step with factors from elsewhere may leave."""


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
        self.factorisations = 0
        self._steady = self._factors(equation.slopes(equation.rest)) if equation.linear else None
        self.kept: Linearised | None = None
        self.balance, self.iterations = Balance(equation.model, equation.p), 0

    def factor(self, slopes: Slopes) -> Factors | None:
        """Factors of ``M + κ(h γ C + h² β K)`` in the free displacements."""
        return self._factors(slopes) if self._steady is None else self._steady

    def _factors(self, slopes: Slopes) -> Factors | None:
        e, rule = self.equation, self.rule
        by_u, by_v = (rule.kappa * late for late in rule.late)
        matrix = combined((1.0, slopes.a), (by_v, slopes.v), (by_u, slopes.u))
        self.factorisations += 1
        return factors(e.assembly.inner(matrix), SINGULAR, symmetric=e.symmetric)

    def advance(self, x: Moving, time: float) -> Moving | None:
        """The end of the step at ``time``; None where Newton's method fails.

        Raises
        ------
        SingularityError
            The equations of the step are singular.
        """
        e = self.equation
        ahead, held, loads = self.rule.predicted(x), e.support_motion(time), e.loads(time)
        a = np.zeros_like(x.a)
        if not e.linear:
            a[e.free] = x.a[e.free]
            found = self._solved(ahead, held, loads, a, FAST)
            if found is None:
                found = self._solved(ahead, held, loads, a, 0.0)
            if found is None:
                return None
            a = found
        motion = self.placed(ahead, held, a).motion
        self.kept = Linearised(self, motion)
        rest = (loads - e.forces(motion))[e.free]
        a[e.free] += self.kept.solve(rest)  # once more after convergence: round-off only is left
        return self.placed(ahead, held, a)

    def _solved(
        self, ahead: Moving, held: Motions, loads: np.ndarray, a: np.ndarray, fast: float
    ) -> np.ndarray | None:
        """Accelerations at the end, None where Newton's method fails."""
        solution = solve(EndOfStep(self, ahead, held, loads, fast), a, self.settings)
        self.iterations += solution.iterations + 1
        return solution.x if solution.accepted else None

    def residual(
        self, motion: Motions, loads: np.ndarray, where: np.ndarray, sizes: scipy.sparse.csc_matrix
    ) -> Residual:
        """What is left over of the forces on some displacements.

        Parameters
        ----------
        sizes : (n, n) of the entries of the stiffness, for rounding
        """
        e, (u, v, a) = self.equation, (np.abs(x) for x in motion)
        inertia, damper = e.sizes
        made_of = sizes @ u + damper @ v
        made_of += inertia @ (a + v / self.rule.h)  # an acceleration is a change of speed
        terms = [loads, *(-part for part in e.parts(motion))]
        return self.balance.residual(terms, made_of, where)

    def placed(self, ahead: Moving, held: Motions, a: np.ndarray) -> Moving:
        """The end of the step for accelerations of the free displacements."""
        new, where = self.rule.ended(ahead, a.copy()), self.equation.held
        for column, prescribed in zip(new.motion, held, strict=True):
            column[where] = prescribed
        new.algorithmic[where] = held.a
        return new


class Linearised:
    """The equations of a step near some motion."""

    def __init__(self, step: TransientStep, motion: Motions):
        self.step, self.motion = step, motion
        self.stiffness = step.equation.tangent(motion.u)

    @cached_property
    def sizes(self) -> scipy.sparse.csc_matrix:
        """Sizes of the entries of the stiffness."""
        return abs(self.stiffness)

    @cached_property
    def factor(self) -> Factors | None:
        """Factors of the equations; None where nothing is free."""
        return self.step.factor(self.step.equation.slopes(self.motion, self.stiffness))

    def solve(self, rest: np.ndarray) -> np.ndarray:
        """Accelerations of the free displacements that forces ``rest`` bring."""
        return np.zeros(0) if self.factor is None else self.factor.solve(rest)


class EndOfStep(Equations[np.ndarray]):
    """The equations of motion at the end of a step, in the accelerations (n,) there.

    Parameters
    ----------
    by : the step
    ahead : its end without acceleration
    held : prescribed motion at its end
    loads : (n,) applied forces there
    fast : share of the residual that a step may leave for its factors to be taken again
    """

    def __init__(
        self, by: TransientStep, ahead: Moving, held: Motions, loads: np.ndarray, fast: float
    ):
        self.by, self.ahead, self.held, self.loads, self.fast = by, ahead, held, loads, fast
        self._near, self._left = by.kept if fast else None, np.inf

    def motion(self, a: np.ndarray) -> Motions:
        """The motion at the end."""
        return self.by.placed(self.ahead, self.held, a).motion

    def residual(self, x: np.ndarray) -> Residual:
        motion, e = self.motion(x), self.by.equation
        if self._near is None:
            self._near = Linearised(self.by, motion)
        return self.by.residual(motion, self.loads, e.free, self._near.sizes)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        before, self._left = self._left, relative(residual, self.by.settings.tolerance)
        if self._near is None or self._left > self.fast * before:
            self._near = Linearised(self.by, self.motion(x))
        return self._near.solve(residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        found = x.copy()
        found[self.by.equation.free] += step
        return found
