"""One step of Newmark's method or a relative, for structures.

The rule of ``integrators/newmark/rule.py``; the equations of motion hold at the end of the step.
Newton's method begins where the equations that are linear about the beginning of the step lead:
kept accelerations would carry nodes under loads of their own across their neighbours, and stiff
waves with them. It goes on with the factors at the beginning, and takes new ones only where they do
not lead fast to the root; what it finds is corrected once more with those at the end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy

from dalembert.analysis.structural.balance import Balance, full_steps
from dalembert.analysis.structural.instant import Instant, Unknown
from dalembert.analysis.structural.transient_equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    factors,
    moved,
)
from dalembert.integrators.newmark.family import NewmarkFamily
from dalembert.integrators.newmark.rule import Course, Moving, StepRule
from dalembert.sparse.solver import Factors
from dalembert.structures.evaluation.pattern import combined
from dalembert.symbolic.equations.newton import Equations, Residual, solve

SINGULAR = (
    "the equations of a step are singular: some displacement has neither mass nor stiffness; give "
    "its elements a density, or support it"
)


FAST = 0.1
"""Share of the residual that a step with factors from elsewhere may leave."""


class Ahead(NamedTuple):
    """A step without acceleration at its end: where it begins, and its course."""

    u: np.ndarray
    course: Course


class TransientStep:
    """Steps of one length.

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
        self.kept: Unknown | None = None
        self.end: Moving | None = None
        """Of the step before, and the equations there."""
        self.balance, self.iterations = Balance(equation.model, equation.p), 0
        self.left = 0.0
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
        ahead, held, loads = self.predicted(x), e.support_motion(time), e.loads(time)
        a = np.zeros_like(x.a)
        if not e.linear:
            a = self._guess(x, ahead, held, loads, time)
            found = self._solved(EndOfStep(self, ahead, held, loads, time, FAST), a)
            if found is None:
                found = self._solved(EndOfStep(self, ahead, held, loads, time, 0.0), a)
            if found is None:
                return None
            a = found
        motion = moved(self.placed(ahead, held, a))
        self.kept = self.unknown(Instant(e, motion, time))
        rest = (e.forces(motion) - loads)[e.free]
        a[e.free] += self.kept.correction(rest)  # after convergence: round-off only is left
        self.end = self.placed(ahead, held, a)
        return self.end

    def _guess(
        self, x: Moving, ahead: Ahead, held: Motions, loads: np.ndarray, time: float
    ) -> np.ndarray:
        """(n,) accelerations at the end by forces that are linear about the beginning."""
        e, begin, a = self.equation, moved(x), np.zeros_like(x.a)
        if self.kept is None or self.end is not x:
            self.kept = self.unknown(Instant(e, begin, time - self.rule.h))
        end = moved(self.placed(ahead, held, a))
        change = Motions(*(new - old for new, old in zip(end, begin, strict=True)))
        rest = e.forces(begin) + self.kept.at.slopes.along(change) - loads
        a[e.free] = self.kept.correction(rest[e.free])
        return a

    def push(self, end: Instant, change: Moving) -> Moving:
        """Change of what the step ends with, from that of what it begins with."""
        ahead, held = self.predicted(change), end.parameters.supports(end.time)
        a = np.zeros_like(change.u)
        known = moved(self.placed(ahead, held, a))
        a[self.equation.free] = self.unknown(end).tangent(known)
        return self.placed(ahead, held, a)

    def pull(self, end: Instant, weights: Moving) -> Moving:
        """Weights of what the step begins with, from those of what it ends with.

        With multipliers ``λ`` of the equations at its end, ``(M + κ(h γ C + h² β K))ᵀ λ`` is the
        weight of the accelerations there.
        """
        by_a = self.rule.weigh_acceleration(weights)[self.equation.free]
        through = self.unknown(end).adjoint(by_a)
        return self.rule.weigh_start(end.freed(weights, through))

    def _solved(self, end: EndOfStep, a: np.ndarray) -> np.ndarray | None:
        """Accelerations at the end, None where Newton's method fails."""
        solution = solve(end, a, self.settings)
        self.iterations, self.left = self.iterations + solution.iterations + 1, solution.residual
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

    def predicted(self, x: Moving) -> Ahead:
        """The step as it is without acceleration at its end."""
        return Ahead(x.u, self.rule.predicted(x.v, x.a, x.s))

    def placed(self, ahead: Ahead, held: Motions, a: np.ndarray) -> Moving:
        """The end of the step for accelerations of the free displacements."""
        course, where = self.rule.corrected(ahead.course, a), self.equation.held
        u = ahead.u + self.rule.h * course.mean
        new = Moving(u, course.end, a.copy(), self.rule.memory(course, a))
        for column, prescribed in zip(new, (*held, 0.0), strict=True):
            column[where] = prescribed
        return new


class EndOfStep(Equations[np.ndarray]):
    """The equations of motion at the end of a step, in the accelerations (n,) there.

    Parameters
    ----------
    by : the step
    ahead : its end without acceleration
    held : prescribed motion at its end
    loads : (n,) applied forces there
    time : instant there [s]
    fast : share of the residual that a step may leave for its factors to be taken again
    """

    def __init__(
        self,
        by: TransientStep,
        ahead: Ahead,
        held: Motions,
        loads: np.ndarray,
        time: float,
        fast: float,
    ):
        self.by, self.ahead, self.held, self.loads, self.fast = by, ahead, held, loads, fast
        self.time, self._near, self._left = time, by.kept if fast else None, np.inf

    def motion(self, a: np.ndarray) -> Motions:
        """The motion at the end."""
        return moved(self.by.placed(self.ahead, self.held, a))

    def _unknown(self, motion: Motions) -> Unknown:
        return self.by.unknown(Instant(self.by.equation, motion, self.time))

    def residual(self, x: np.ndarray) -> Residual:
        motion, e = self.motion(x), self.by.equation
        if self._near is None:
            self._near = self._unknown(motion)
        return self.by.residual(motion, self.loads, e.free, self._near.at.sizes)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        before, self._left = self._left, residual.relative(self.by.settings.tolerance)
        if self._near is None or self._left > self.fast * before:
            self._near = self._unknown(self.motion(x))
        return self._near.solve(residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        found = x.copy()
        found[self.by.equation.free] += step
        return found
