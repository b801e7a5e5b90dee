"""One step of Newmark's method and its relatives, for structures.

The rule is that of ``integrators/newmark/rule.py``; the equations of motion hold at the end of the
step. Newton's method starts from the solution of the equations linearised at the start of the step:
constant accelerations would move separately loaded nodes past their neighbours and excite stiff
waves. It keeps the factors of the start and updates them only where convergence is slow; the result
is corrected once more with the factors at the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy

from dalembert.analysis.equilibrium.static_equations import Balance, full_steps
from dalembert.analysis.transient.equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    factors,
    motion_of,
)
from dalembert.analysis.transient.instant import Instant, Unknown
from dalembert.integrators.newmark.family import NewmarkFamily
from dalembert.integrators.newmark.rule import Course, Moving, StepRule
from dalembert.model.assembled.evaluation.pattern import combine
from dalembert.sparse.solver import Factors
from dalembert.symbolic.equations.newton import Equations, Residual, solve

SINGULAR = (
    "the equations of a step are singular: some displacement has neither mass nor stiffness; give "
    "its elements a density, or support it"
)


FAST = 0.1
"""Upper limit of the residual reduction of an iteration with old factors."""


class Prediction(NamedTuple):
    """A step without acceleration at its end: initial displacements, and velocities."""

    u: np.ndarray
    course: Course


class TransientStep:
    """Step of a fixed length.

    Parameters
    ----------
    equation : EquationOfMotion
    integrator : method with its tolerance
    h : length [s]
    """

    def __init__(self, equation: EquationOfMotion, integrator: NewmarkFamily, h: float):
        self.equation, self.rule = equation, StepRule.of(integrator.coefficients, h)
        self.settings = full_steps(integrator)
        self.factorisations = 0
        self._steady = self._factors(equation.slopes(equation.rest)) if equation.linear else None
        self.previous: Unknown | None = None
        self.end: Moving | None = None
        """End of the previous step; ``previous`` holds the equations there."""
        self.balance, self.iterations = Balance(equation.model, equation.p), 0
        self.relative_residual = 0.0
        """Relative residual at which Newton's method ended."""

    def unknown(self, at: Instant) -> Unknown:
        """The accelerations of the free displacements at the end of the step."""

        def factor() -> Factors | None:
            return self._factors(at.slopes) if self._steady is None else self._steady

        return Unknown(at, self.equation.free, factor)

    def _factors(self, slopes: Slopes) -> Factors | None:
        """Factors of ``M + κ(h γ C + h² β K)`` in the free displacements."""
        e, rule = self.equation, self.rule
        by_u, by_v = rule.slopes
        matrix = combine((1.0, slopes.a), (by_v, slopes.v), (by_u, slopes.u))
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
        prediction, held, loads = self.predict(x), e.support_motion(time), e.loads(time)
        a = np.zeros_like(x.a)
        if not e.linear:
            a = self._initial_guess(x, prediction, held, loads, time)
            solution = self._newton(EndOfStep(self, prediction, held, loads, time, FAST), a)
            if solution is None:
                solution = self._newton(EndOfStep(self, prediction, held, loads, time, 0.0), a)
            if solution is None:
                return None
            a = solution
        motion = motion_of(self.state(prediction, held, a))
        self.previous = self.unknown(Instant(e, motion, time))
        imbalance = (e.forces(motion) - loads)[e.free]
        # after convergence: reduces the residual to round-off
        a[e.free] += self.previous.correction(imbalance)
        self.end = self.state(prediction, held, a)
        return self.end

    def _initial_guess(
        self, x: Moving, prediction: Prediction, held: Motions, loads: np.ndarray, time: float
    ) -> np.ndarray:
        """(n,) accelerations at the end, with forces linearised at the start."""
        e, start, a = self.equation, motion_of(x), np.zeros_like(x.a)
        if self.previous is None or self.end is not x:
            self.previous = self.unknown(Instant(e, start, time - self.rule.h))
        end = motion_of(self.state(prediction, held, a))
        change = Motions(*(new - old for new, old in zip(end, start, strict=True)))
        imbalance = e.forces(start) + self.previous.at.slopes.along(change) - loads
        a[e.free] = self.previous.correction(imbalance[e.free])
        return a

    def push(self, end: Instant, change: Moving) -> Moving:
        """Change of the end of the step with that of its start and of the parameters."""
        prediction, held = self.predict(change), end.parameters.supports(end.time)
        a = np.zeros_like(change.u)
        without_acceleration = motion_of(self.state(prediction, held, a))
        a[self.equation.free] = self.unknown(end).tangent(without_acceleration)
        return self.state(prediction, held, a)

    def pull(self, end: Instant, weights: Moving) -> Moving:
        """Weights of the start of the step from those of its end.

        With multipliers ``λ`` of the equations at its end, ``(M + κ(h γ C + h² β K))ᵀ λ`` is the
        weight of the accelerations there.
        """
        by_a = self.rule.weigh_acceleration(weights)[self.equation.free]
        by_motion = self.unknown(end).adjoint(by_a)
        return self.rule.weigh_start(end.free_weights(weights, by_motion))

    def _newton(self, end: EndOfStep, a: np.ndarray) -> np.ndarray | None:
        """Accelerations at the end; None where Newton's method fails."""
        solution = solve(end, a, self.settings)
        self.iterations, self.relative_residual = (
            self.iterations + solution.iterations + 1,
            solution.residual,
        )
        return solution.x if solution.accepted else None

    def residual(
        self, motion: Motions, loads: np.ndarray, rows: np.ndarray, sizes: scipy.sparse.csc_matrix
    ) -> Residual:
        """Unbalanced forces on some displacements.

        Parameters
        ----------
        sizes : (n, n) magnitudes of the entries of the stiffness, for rounding
        """
        e, (u, v, a) = self.equation, (np.abs(x) for x in motion)
        inertia, damper = e.sizes
        magnitudes = sizes @ u + damper @ v
        magnitudes += inertia @ (a + v / self.rule.h)  # an acceleration is a change of speed
        terms = [loads, *(-part for part in e.parts(motion))]
        return self.balance.residual(terms, magnitudes, rows)

    def predict(self, x: Moving) -> Prediction:
        """The step without acceleration at its end."""
        return Prediction(x.u, self.rule.predicted(x.v, x.a, x.s))

    def state(self, prediction: Prediction, held: Motions, a: np.ndarray) -> Moving:
        """The end of the step for accelerations of the free displacements."""
        course, held_rows = self.rule.corrected(prediction.course, a), self.equation.held
        u = prediction.u + self.rule.h * course.mean
        new = Moving(u, course.end, a.copy(), self.rule.memory(course, a))
        for column, prescribed in zip(new, (*held, 0.0), strict=True):
            column[held_rows] = prescribed
        return new


class EndOfStep(Equations[np.ndarray]):
    """The equations of motion at the end of a step, in the accelerations (n,) there.

    Parameters
    ----------
    step_of : TransientStep
    prediction : the end without acceleration
    held : prescribed motion at the end
    loads : (n,) applied forces at the end
    time : end of the step [s]
    fast : residual reduction of an iteration up to which factors are reused
    """

    def __init__(
        self,
        step_of: TransientStep,
        prediction: Prediction,
        held: Motions,
        loads: np.ndarray,
        time: float,
        fast: float,
    ):
        self.step_of, self.prediction, self.held, self.loads = step_of, prediction, held, loads
        self.fast, self.time, self._near, self._left = (
            fast,
            time,
            step_of.previous if fast else None,
            np.inf,
        )

    def motion(self, a: np.ndarray) -> Motions:
        """The motion at the end."""
        return motion_of(self.step_of.state(self.prediction, self.held, a))

    def _unknown(self, motion: Motions) -> Unknown:
        return self.step_of.unknown(Instant(self.step_of.equation, motion, self.time))

    def residual(self, x: np.ndarray) -> Residual:
        motion, e = self.motion(x), self.step_of.equation
        if self._near is None:
            self._near = self._unknown(motion)
        return self.step_of.residual(motion, self.loads, e.free, self._near.at.sizes)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        before, self._left = self._left, residual.relative(self.step_of.settings.tolerance)
        if self._near is None or self._left > self.fast * before:
            self._near = self._unknown(self.motion(x))
        return self._near.solve(residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        a = x.copy()
        a[self.step_of.equation.free] += step
        return a
