"""Equations of motion of a structure at one instant, with their tangent and adjoint products.

``r = g(u, v, a, p) − P(t, p)``, with ``g`` the forces required by the motion and ``P`` the applied
ones. The unknowns are accelerations at the end of a step, on which displacements depend by the rule
of the method; accelerations at the start; or displacements at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from dalembert.analysis.transient.equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    motion_of,
)
from dalembert.integrators.newmark.rule import Moving
from dalembert.sparse.solver import Factors
from dalembert.symbolic.evaluator import Evaluator


class Instant:
    """Equations of motion linearised about a motion.

    Parameters
    ----------
    equation : EquationOfMotion
    motion : (n,) each
    time : [s]
    parameters : derivatives by the parameters, forwards or backwards; for gradients only
    """

    def __init__(
        self, equation: EquationOfMotion, motion: Motions, time: float, parameters: Any = None
    ):
        self.equation, self.motion, self.time, self.parameters = equation, motion, time, parameters

    def at_rest(self) -> Instant:
        """The same displacements without motion: statics."""
        still = np.zeros_like(self.motion.u)
        motion = Motions(self.motion.u, still, still)
        return Instant(self.equation, motion, self.time, self.parameters)

    @property
    def value(self) -> np.ndarray:
        """(n,) ``r``; reactions at prescribed displacements."""
        return self.equation.forces(self.motion) - self.equation.loads(self.time)

    @cached_property
    def stiffness(self) -> scipy.sparse.csc_matrix:
        """``∂²W/∂u²``."""
        return self.equation.tangent(self.motion.u)

    @cached_property
    def sizes(self) -> scipy.sparse.csc_matrix:
        """Magnitudes of the entries of the stiffness."""
        return abs(self.stiffness)

    @cached_property
    def slopes(self) -> Slopes:
        """Derivatives by the motion."""
        return self.equation.slopes(self.motion, self.stiffness)

    @cached_property
    def load_change(self) -> np.ndarray:
        """(n, c) change of the applied forces with the parameters."""
        return np.asarray(self.parameters.loads(self.time))

    @cached_property
    def parameter_change(self) -> np.ndarray:
        """(n, c) change with the parameters, the motion held."""
        changes = self.parameters
        change = changes.equations(self.motion) - changes.expansion(self.time) - self.load_change
        return np.asarray(change)

    def push(self, change: Motions) -> np.ndarray:
        """(n, c) change with the motion and the parameters."""
        return self.parameter_change + self.slopes.along(change)

    def pull(self, weights: np.ndarray) -> Motions:
        """Weights of the motion from (n, rows) of the equations; adds those of the parameters."""
        self.parameters.equations(self, weights)
        return self.slopes.weigh(weights)

    def free_weights(self, weights: Moving, more: Motions) -> Moving:
        """The sum of weights; those of prescribed displacements pass to the parameters."""
        u, v, a = (first + second for first, second in zip(motion_of(weights), more, strict=True))
        total, held = Moving(u, v, a, weights.s.copy()), self.equation.held
        self.parameters.supports(Motions(*(part[held] for part in motion_of(total))), self.time)
        for part in total:
            part[held] = 0.0
        return total

    def push_forces(self, change: Motions) -> np.ndarray:
        """(n, c) change of applied forces, and of reactions at prescribed displacements."""
        forces, held = self.load_change.copy(), self.equation.held
        forces[held] = self.push(change)[held]
        return forces

    def pull_forces(self, weights: np.ndarray) -> Motions:
        """Weights of the motion from (n, rows) of these forces."""
        reactions, held = np.zeros_like(weights), self.equation.held
        reactions[held] = weights[held]
        self.parameters.loads(self, weights - reactions)
        return self.pull(reactions)


class Unknown(Evaluator):
    """Equations of some displacements for as many unknowns, with factors of their Jacobian.

    Parameters
    ----------
    at : Instant
    rows : (k,) numbers of the displacements
    factorise : returns factors of the Jacobian; called once, on demand
    """

    def __init__(self, at: Instant, rows: np.ndarray, factorise: Callable[[], Factors | None]):
        self.at, self.rows, self._factorise = at, rows, factorise

    @cached_property
    def factor(self) -> Factors | None:
        """Factors of the Jacobian; None without unknowns."""
        return self._factorise()

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        return rhs if self.factor is None else self.factor.solve(rhs)

    def solve_transposed(self, weights: np.ndarray) -> np.ndarray:
        return weights if self.factor is None else self.factor.solve(weights, "T")

    @property
    def value(self) -> np.ndarray:
        """(k,) residuals."""
        return self.at.value[self.rows]

    def push(self, change: Motions) -> np.ndarray:
        return self.at.push(change)[self.rows]

    def pull(self, weights: np.ndarray) -> Motions:
        all_weights = np.zeros((self.at.equation.assembly.size, weights.shape[1]))
        all_weights[self.rows] = weights
        return self.at.pull(all_weights)
