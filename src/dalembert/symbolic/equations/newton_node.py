"""Newton's method as a node of a graph: full steps, by the criterion of ``newton.py``."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.equations.newton import NewtonSettings
from dalembert.symbolic.evaluation.condensed import condensed

FACTORS = 0.2
"""Time of a floating-point operation of a factorisation, relative to one of the graph."""
ITERATIONS = 3.5
"""Mean number of iterations of a solution, about."""


class NewtonNode:
    """``u(guess, given)`` with ``g(u, given) = 0``; NaN where it was not found.

    Derivatives are those of the equation, by the implicit function theorem.

    Parameters
    ----------
    name : str
    unknown, given : SX symbols ``u`` and what else ``g`` depends on
    residual : SX, ``g``
    zero : SX, positive, residuals that count as zero; expression of u and given, taken at the guess
    settings : iterations, and the tolerance that is within ``zero``
    sizes : (n,) natural sizes of the unknowns, in which their equations are solved
    outputs : SX expressions of u and given that are wanted
    """

    def __init__(
        self,
        name: str,
        unknown: ca.SX,
        given: ca.SX,
        residual: ca.SX,
        zero: ca.SX,
        settings: NewtonSettings,
        sizes: np.ndarray,
        outputs: list[ca.SX] | None = None,
    ):
        self._sizes = ca.DM(sizes)
        self.settings = settings
        unit = ca.SX.sym("unit", unknown.numel())
        relative = residual / unit
        alike = ca.substitute(relative, unknown, self._sizes * unknown)
        self._zero = constant("zero", [unknown, given], zero)
        wanted = [ca.densify(out) for out in (outputs or [])]
        seen: list[bool] = [False, *(True for _ in wanted)]
        self._finish = condensed(
            "finish",
            [unknown, given, unit],
            [_largest(ca.densify(relative)), *wanted],
            options={"never_inline": True, "is_diff_out": seen},
        )
        self._find = ca.rootfinder(
            name,
            "fast_newton",
            condensed("residual", [unknown, ca.vertcat(given, unit)], [alike]),
            {
                "abstol": 1.0,
                "abstolStep": 0.0,
                "max_iter": settings.max_iterations,
                "linear_solver": "qr",
                "error_on_fail": False,
            },
        )

    @cached_property
    def work(self) -> float:
        """Operations of a solution, about: the Jacobian and its factors in every iteration."""
        jacobian = self._find.get_function("jac_g_x")
        reflectors, triangle, *_ = jacobian.sparsity_out(0).qr_sparse()
        columns = np.diff(reflectors.colind())
        rows = np.bincount(triangle.row(), minlength=triangle.size1())[: columns.size]
        each = jacobian.n_instructions() + FACTORS * np.sum(4 * columns * rows)
        return float(ITERATIONS * each)

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
        unit = self._zero(guess, given)
        found = self._sizes * self._find(guess / self._sizes, ca.vertcat(given, unit))
        worst, *wanted = self._finish.call([found, given, unit])
        refusal = ca.if_else(worst <= self.settings.slack, 0, np.nan)  # false for NaN as well
        return [found, refusal, worst * self.settings.tolerance, *wanted]


def _largest(relative: ca.SX) -> ca.SX:
    """Largest magnitude, NaN where one of them is: a maximum alone would overlook that."""
    if not relative.numel():
        return ca.SX(0)
    return ca.if_else(ca.sumsqr(relative) <= np.inf, ca.norm_inf(relative), np.nan)


def constant(name: str, inputs: list[ca.SX], output: ca.SX) -> ca.Function:
    """A function that derivatives do not look into: guesses and scales."""
    options: Any = {"never_inline": True, "is_diff_out": [False]}
    return condensed(name, inputs, [ca.densify(output)], options=options)
