"""The equations of motion of a structure at one instant, and what they make of changes and weights.

``r = g(u, v, a, p) − P(t, p)``, with ``g`` the forces that the motion needs and ``P`` the applied
ones. What is unknown differs: accelerations at the end of a step, on which displacements depend by
its rule; those at the start; displacements at rest.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from dalembert.analysis.structural.transient_equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    moved,
)
from dalembert.integrators.newmark.rule import Moving
from dalembert.sparse.solver import Factors
from dalembert.symbolic.evaluator import Evaluator


class Instant:
    """The equations near a motion.

    Parameters
    ----------
    equation : EquationOfMotion
    motion : (n,) each
    time : [s]
    parameters : what takes changes, or weights, of the parameters; for gradients only
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
        """Sizes of the entries of the stiffness."""
        return abs(self.stiffness)

    @cached_property
    def slopes(self) -> Slopes:
        """Derivatives by the motion."""
        return self.equation.slopes(self.motion, self.stiffness)

    @cached_property
    def loaded(self) -> np.ndarray:
        """(n, c) change of the applied forces with the parameters."""
        return np.asarray(self.parameters.loads(self.time))

    @cached_property
    def own(self) -> np.ndarray:
        """(n, c) change with the parameters alone."""
        changes = self.parameters
        found = changes.equations(self.motion) - changes.expansion(self.time) - self.loaded
        return np.asarray(found)

    def push(self, change: Motions) -> np.ndarray:
        """(n, c) change with the motion and the parameters."""
        return self.own + self.slopes.along(change)

    def pull(self, weights: np.ndarray) -> Motions:
        """Weights of the motion from (n, rows) of the equations; the parameters take theirs."""
        self.parameters.equations(self, weights)
        return self.slopes.weigh(weights)

    def freed(self, weights: Moving, more: Motions) -> Moving:
        """The sum of weights; of what is prescribed they go to the parameters."""
        u, v, a = (one + other for one, other in zip(moved(weights), more, strict=True))
        found, held = Moving(u, v, a, weights.s.copy()), self.equation.held
        self.parameters.supports(Motions(*(part[held] for part in moved(found))), self.time)
        for part in found:
            part[held] = 0.0
        return found

    def push_forces(self, change: Motions) -> np.ndarray:
        """(n, c) change of applied forces, and of reactions at prescribed displacements."""
        found, held = self.loaded.copy(), self.equation.held
        found[held] = self.push(change)[held]
        return found

    def pull_forces(self, weights: np.ndarray) -> Motions:
        """Weights of the motion from (n, rows) of these forces."""
        reactions, held = np.zeros_like(weights), self.equation.held
        reactions[held] = weights[held]
        self.parameters.loads(self, weights - reactions)
        return self.pull(reactions)


class Unknown(Evaluator):
    """Equations at some displacements, as many unknowns, and factors of the one by the other.

    Parameters
    ----------
    at : the instant
    where : (k,) numbers of the displacements
    make : gives factors of the derivatives; called once, where they are needed
    """

    def __init__(self, at: Instant, where: np.ndarray, make: Callable[[], Factors | None]):
        self.at, self.where, self._make = at, where, make

    @cached_property
    def factor(self) -> Factors | None:
        """None where nothing is unknown."""
        return self._make()

    def solve(self, rhs: np.ndarray) -> np.ndarray:
        return rhs if self.factor is None else self.factor.solve(rhs)

    def solve_transposed(self, weights: np.ndarray) -> np.ndarray:
        return weights if self.factor is None else self.factor.solve(weights, "T")

    @property
    def value(self) -> np.ndarray:
        """(k,) what is left of the equations."""
        return self.at.value[self.where]

    def push(self, change: Motions) -> np.ndarray:
        return self.at.push(change)[self.where]

    def pull(self, weights: np.ndarray) -> Motions:
        whole = np.zeros((self.at.equation.assembly.size, weights.shape[1]))
        whole[self.where] = weights
        return self.at.pull(whole)
