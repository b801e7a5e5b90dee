"""Solved equations inside a step: Newton's method as a node of the graph."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Integrator, Problem
from dalembert.integrators.step import Step

STALLED = 1e3
"""Residuals, in tolerances, that are accepted where rounding keeps Newton from doing better."""


@dataclass(frozen=True, kw_only=True)
class NewtonSettings:
    """When the iteration ends: ``tolerance`` relative to the scale of the residuals."""

    tolerance: float
    max_iterations: int


@dataclass(frozen=True, kw_only=True)
class ImplicitIntegrator(Integrator, ABC):
    """Integrator that solves equations in every step by Newton's method.

    Equations count as solved when each residual is below ``tolerance`` times the terms of its
    equation (for constraints: times their change within the step), or below rounding.

    Parameters
    ----------
    tolerance : relative residual at which the iteration ends [-]
    max_iterations : of Newton's method; a step that needs more has failed

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or no iteration.
    """

    tolerance: float = 1e-12
    max_iterations: int = 20

    def __post_init__(self) -> None:
        if not self.tolerance > 0 or self.max_iterations < 1:
            raise UnsupportedError(
                f"{self.name}(tolerance={self.tolerance}, max_iterations={self.max_iterations}): "
                "the tolerance must be positive and at least one iteration allowed"
            )

    @property
    def implicit(self) -> bool:
        return True

    @property
    def newton(self) -> NewtonSettings:
        return NewtonSettings(tolerance=self.tolerance, max_iterations=self.max_iterations)

    @abstractmethod
    def step(self, problem: Problem) -> Step:
        """One step of given length."""


class NewtonNode:
    """``u(guess, given)`` with ``g(u, given) = 0``; NaN where it was not found.

    Derivatives are those of the equation, by the implicit function theorem.

    Parameters
    ----------
    name : str
    unknown, given : SX symbols ``u`` and what else ``g`` depends on
    residual : SX, ``g``
    scale : SX, positive, what each residual is compared with; expression of u and given, taken at
        the guess
    settings : tolerance and iterations
    outputs : SX expressions of u and given that are wanted
    """

    def __init__(
        self,
        name: str,
        unknown: ca.SX,
        given: ca.SX,
        residual: ca.SX,
        scale: ca.SX,
        settings: NewtonSettings,
        outputs: list[ca.SX] | None = None,
    ):
        self.tolerance = settings.tolerance
        unit = ca.SX.sym("unit", unknown.numel())
        relative = residual / unit
        self._scale = constant("scale", [unknown, given], scale)
        worst = ca.sqrt(ca.sumsqr(ca.densify(relative)))  # a maximum would overlook NaN
        wanted = [ca.densify(out) for out in (outputs or [])]
        seen: list[bool] = [False, *(True for _ in wanted)]
        options: Any = {"never_inline": True, "is_diff_out": seen, "cse": True}
        self._finish = ca.Function(
            "finish",
            [unknown, given, unit],
            [worst, *wanted],
            options,
        )
        self._find = ca.rootfinder(
            name,
            "fast_newton",
            ca.Function("residual", [unknown, ca.vertcat(given, unit)], [relative], {"cse": True}),
            {
                "abstol": 1.0,
                "abstolStep": 0.0,
                "max_iter": settings.max_iterations,
                "linear_solver": "qr",
                "error_on_fail": False,
            },
        )

    def solve(self, guess: ca.MX, given: ca.MX) -> tuple[ca.MX, ca.MX]:
        """Solution, and its residual relative to the terms of the equations."""
        found, refusal, residual, *_ = self._solved(guess, given)
        return found + refusal, residual

    def results(self, guess: ca.MX, given: ca.MX) -> tuple[list[ca.MX], ca.MX]:
        """``outputs`` at the solution, and its residual relative to the terms of the equations."""
        _, refusal, residual, *wanted = self._solved(guess, given)
        return [out + refusal for out in wanted], residual

    def _solved(self, guess: ca.MX, given: ca.MX) -> list[ca.MX]:
        """Solution, 0 or NaN, residual and outputs."""
        unit = self._scale(guess, given)
        found = self._find(guess, ca.vertcat(given, unit))
        worst, *wanted = self._finish.call([found, given, unit])
        refusal = ca.if_else(worst <= STALLED, 0, np.nan)  # false for NaN as well
        return [found, refusal, worst * self.tolerance, *wanted]


def constant(name: str, inputs: list[ca.SX], output: ca.SX) -> ca.Function:
    """A function that derivatives do not look into: guesses and scales."""
    options: Any = {"never_inline": True, "is_diff_out": [False], "cse": True}
    return ca.Function(name, inputs, [ca.densify(output)], options)
