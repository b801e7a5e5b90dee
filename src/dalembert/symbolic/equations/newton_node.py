"""Newton's method as a node of a graph: full steps, by the criterion of ``newton.py``."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.equations.newton import NewtonSettings
from dalembert.symbolic.evaluation.kernel import condensed

FACTORS = 0.2
"""Time of a floating-point operation of a factorisation relative to an operation of the graph."""
ITERATIONS = 3.5
"""Approximate mean number of iterations per solution."""


class NewtonNode:
    """``u(guess, inputs)`` with ``g(u, inputs) = 0``; NaN without convergence.

    Derivatives follow from the implicit function theorem.

    Parameters
    ----------
    name : str
    unknown, inputs : SX symbols: ``u`` and all else that ``g`` depends on
    residual : SX, ``g``
    zero : SX, positive, thresholds of the residuals; expression of u and inputs, evaluated at the
        guess
    settings : iterations, and the tolerance contained in ``zero``
    sizes : (n,) natural sizes of the unknowns, by which they are scaled
    outputs : SX expressions of u and inputs to return
    """

    def __init__(
        self,
        name: str,
        unknown: ca.SX,
        inputs: ca.SX,
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
        scaled = ca.substitute(relative, unknown, self._sizes * unknown)
        self._zero = constant("zero", [unknown, inputs], zero)
        results = [ca.densify(out) for out in (outputs or [])]
        differentiable: list[bool] = [False, *(True for _ in results)]
        self._finish = condensed(
            "finish",
            [unknown, inputs, unit],
            [_largest(ca.densify(relative)), *results],
            options={"never_inline": True, "is_diff_out": differentiable},
        )
        self._rootfinder = ca.rootfinder(
            name,
            "fast_newton",
            condensed("residual", [unknown, ca.vertcat(inputs, unit)], [scaled]),
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
        """Approximate operations per solution: Jacobian and factors in every iteration."""
        jacobian = self._rootfinder.get_function("jac_g_x")
        reflectors, triangle, *_ = jacobian.sparsity_out(0).qr_sparse()
        columns = np.diff(reflectors.colind())
        rows = np.bincount(triangle.row(), minlength=triangle.size1())[: columns.size]
        per_iteration = jacobian.n_instructions() + FACTORS * np.sum(4 * columns * rows)
        return float(ITERATIONS * per_iteration)

    def solve(self, guess: ca.MX, inputs: ca.MX) -> tuple[ca.MX, ca.MX]:
        """Solution, and its residual relative to the terms of the equations."""
        root, mask, residual, *_ = self._solve(guess, inputs)
        return root + mask, residual

    def results(self, guess: ca.MX, inputs: ca.MX) -> tuple[list[ca.MX], ca.MX]:
        """``outputs`` at the solution, and its residual relative to the terms of the equations."""
        _, mask, residual, *outputs = self._solve(guess, inputs)
        return [out + mask for out in outputs], residual

    def _solve(self, guess: ca.MX, inputs: ca.MX) -> list[ca.MX]:
        """Solution, 0 or NaN, residual and outputs."""
        unit = self._zero(guess, inputs)
        root = self._sizes * self._rootfinder(guess / self._sizes, ca.vertcat(inputs, unit))
        worst, *outputs = self._finish.call([root, inputs, unit])
        mask = ca.if_else(worst <= self.settings.slack, 0, np.nan)  # false for NaN as well
        return [root, mask, worst * self.settings.tolerance, *outputs]


def _largest(relative: ca.SX) -> ca.SX:
    """Largest magnitude, NaN if any entry is NaN, which a maximum alone would ignore."""
    if not relative.numel():
        return ca.SX(0)
    return ca.if_else(ca.sumsqr(relative) <= np.inf, ca.norm_inf(relative), np.nan)


def constant(name: str, inputs: list[ca.SX], output: ca.SX) -> ca.Function:
    """A function that is constant to differentiation: guesses and scales."""
    options: Any = {"never_inline": True, "is_diff_out": [False]}
    return condensed(name, inputs, [ca.densify(output)], options=options)
