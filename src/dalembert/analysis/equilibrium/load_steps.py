"""Equilibria of one load case under loads that grow step by step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np

from dalembert.analysis.equilibrium.static_equations import (
    ForceResidual,
    StaticEquations,
    StaticsRecord,
    full_steps,
)
from dalembert.symbolic.equations.newton import Ending, Equations, Residual, solve

SHORTEST = 1e-6
"""Lower limit of a load step, as a share of the load."""


@dataclass(frozen=True)
class StepControl:
    """Load steps and the Newton iterations in them.

    Parameters
    ----------
    steps : number of equal load steps; a step in which Newton's method fails is halved
    tolerance : residual relative to the largest force
    max_iterations : upper limit of the iterations in a step
    """

    steps: int = 10
    tolerance: float = 1e-10
    max_iterations: int = 25

    @classmethod
    def of(cls, analysis: Any) -> Self:
        """The fields of an analysis; the default number of iterations where it states none."""
        iterations = analysis.max_iterations or cls.max_iterations
        return cls(analysis.steps, analysis.tolerance, iterations)


class LoadedState(NamedTuple):
    """Forces (n,), applied and reactions, the residual [N], and data for gradients."""

    forces: np.ndarray
    residual: float
    record: StaticsRecord


class LoadSteps:
    """Equilibria of one load case under increasing shares of the load."""

    def __init__(self, control: StepControl, equations: StaticEquations):
        self.control, self.equations = control, equations
        self.case, self.u = equations.case, np.zeros(len(equations.model.degrees))
        self.reached, self.iterations, self.residual = 0.0, 0, 0.0

    @property
    def failure(self) -> str:
        """Message where no equilibrium under the whole load was found; empty otherwise."""
        if self.reached >= 1.0:
            return ""
        return (
            f"load case {self.case!r}: no equilibrium beyond {self.reached:.4g} of the load "
            "(a limit point?); lower the load"
        )

    def follow(self) -> Iterator[float]:
        """Shares of the load with an equilibrium, up to the whole load or until a step fails."""
        step = 1.0 / self.control.steps
        while self.reached < 1.0:
            target = min(1.0, self.reached + step)
            u = self._newton(target)
            if u is not None:
                self.u, self.reached = u, target
                yield target
                continue
            step /= 2
            if step < SHORTEST:
                break

    def _newton(self, share: float) -> np.ndarray | None:
        """Equilibrium under a share of the load; None where Newton's method fails.

        Raises
        ------
        SingularityError
            The structure is a mechanism before any load acts.
        """
        u, equations = self.u.copy(), self.equations
        u[equations.held] = share * equations.prescribed
        balance = LoadedBalance(equations, share)
        solution = solve(balance, u, full_steps(self.control))
        self.iterations += solution.iterations
        if solution.ending is Ending.SINGULAR and self.reached == 0 and not self.iterations:
            balance.step(u, balance.residual(u))  # raises with the nodes that can move
        if not solution.accepted:
            return None
        self.residual = solution.residual
        return solution.x

    def end(self) -> LoadedState:
        """The last equilibrium; without factors after a failure."""
        e, stiffness = self.equations, self.equations.stiffness(self.u, self.reached)
        unbalanced = e.unbalanced(self.u, self.reached)
        record = StaticsRecord(None if self.failure else e.factor(stiffness), stiffness)
        return LoadedState(e.with_reactions(self.reached, unbalanced), e.size(unbalanced), record)


class LoadedBalance(Equations[np.ndarray]):
    """Equilibrium of the free displacements under a share of the load."""

    def __init__(self, equations: StaticEquations, share: float):
        self.equations, self.share = equations, share

    def residual(self, x: np.ndarray) -> ForceResidual:
        return self.equations.residual(x, self.share)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, ForceResidual)
        factor = self.equations.factor(residual.stiffness)
        return np.zeros(0) if factor is None else factor.solve(residual.value)

    def retract(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        u = x.copy()
        u[self.equations.free] += step
        return u
