"""Implicit Runge–Kutta step of a differential-algebraic system.

``X_i = x + h Σ a_ij F(t + c_j h, X_j, z_j)``, ``0 = G(t + c_i h, X_i, z_i)``, ``x⁺ = X_s``: for
stiffly accurate methods, whose new state is the last stage and satisfies ``0 = G``.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.integrators.base import ImplicitIntegrator, Problem
from dalembert.integrators.stage_equations import StageEquations
from dalembert.integrators.step import GraphStep
from dalembert.symbolic.equations.newton_node import NewtonNode

Rows = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class ButcherMatrix:
    """Stiffly accurate implicit method: ``b`` is the last row of ``a``.

    A first row of zeros makes the first stage the old state.

    Parameters
    ----------
    a : rows of coefficients
    order : of ordinary differential equations
    """

    a: Rows
    order: int

    @property
    def c(self) -> tuple[float, ...]:
        return tuple(float(sum(row)) for row in self.a)

    @property
    def explicit_first(self) -> bool:
        return not any(self.a[0])

    def stability(self, z: complex | np.ndarray) -> np.ndarray:
        """``R(z) = e_sᵀ (I − zA)⁻¹ 1``."""
        a, z = np.array(self.a), np.asarray(z, dtype=complex)
        eye, ones = np.eye(len(self.a)), np.ones(len(self.a))
        values = [np.linalg.solve(eye - x * a, ones)[-1] for x in z.ravel()]
        return np.array(values).reshape(z.shape)


def stages(
    e: StageEquations, a: Rows, c: tuple[float, ...], at: tuple[ca.SX, ...], begin: ca.SX | None
) -> tuple[list[ca.SX], list[ca.SX], list[ca.SX]]:
    """Stage states, their rates and the residuals as expressions of the unknowns.

    Parameters
    ----------
    a, c : coefficients and nodes of the implicit stages
    at : ``t, h, x, u, p`` with the unknowns of all stages in ``u``
    begin : rate at the old state if ``a`` has a first column for it, else None
    """
    t, h, x, u, p = at
    parts = e.stage_by_stage(u, len(c))
    states = [ca.SX(x) for _ in parts]

    def fill(entries: list[int], rates: list[ca.SX]) -> None:
        for state, row in zip(states, a, strict=True):
            first = [] if begin is None else [begin[entries]]
            pairs = zip(row, [*first, *rates], strict=True)
            state[entries] = x[entries] + h * sum((w * r for w, r in pairs), ca.SX(0))

    def at_stages(function: ca.Function) -> list[ca.SX]:
        points = zip(c, states, parts, strict=True)
        return [function(t + node * h, h, state, part, p) for node, state, part in points]

    if e.coupled:
        fill(e.coupled, [part[e.algebraic :, :] for part in parts])
    for level in e.levels:
        fill(level, [rate[level] for rate in at_stages(e.rate)])
    return states, at_stages(e.rate), at_stages(e.rows)


class CollocationStep(GraphStep):
    """Implicit Runge–Kutta step, with the rates at its stages for error estimates.

    Parameters
    ----------
    matrix : ButcherMatrix
    problem : Problem
    settings : integrator with tolerance and iteration limit of Newton's method
    """

    def __init__(self, matrix: ButcherMatrix, problem: Problem, settings: ImplicitIntegrator):
        self.matrix, self.problem = matrix, problem
        self.equations = e = StageEquations(problem.system)
        s, first = problem.system, 1 if matrix.explicit_first else 0
        self.begin_rates, self.nodes = e.begin(), matrix.c[first:]
        h, u = ca.SX.sym("h"), ca.SX.sym("u", e.count * len(self.nodes))
        old = ca.SX.sym("F0", e.size if first else 0)
        begin = old if first else None
        arguments = ca.vertcat(s.t, h, s.x, s.p, old)
        at = (s.t, h, s.x, u, s.p)
        states, rates, rows = stages(e, matrix.a[first:], self.nodes, at, begin)
        scale_of = e.residual_scale(settings.tolerance)
        parts = e.stage_by_stage(u, len(self.nodes))
        scales = [
            scale_of(s.t + c * h, h, state, part, s.p)
            for c, state, part in zip(self.nodes, states, parts, strict=True)
        ]
        self.newton = NewtonNode(
            "stages",
            u,
            arguments,
            ca.vertcat(*rows),
            ca.vertcat(*scales),
            settings.newton,
            np.tile(e.unknown_sizes, len(self.nodes)),
            [states[-1], ca.horzcat(*rates)],
        )
        symbols = [ca.MX.sym(*n) for n in (("t", 1), ("h", 1), ("x", e.size), ("p", s.p.numel()))]
        new, _, residual = self.solve(*symbols)
        super().__init__(
            ca.Function("bare_step", symbols, [new]),
            e.size,
            problem.correction,
            residual=ca.Function("newton_residual", symbols, [residual]),
            upkeep=problem.upkeep,
        )

    @property
    def work(self) -> float:
        return self.newton.work

    def solve(self, t: ca.MX, h: ca.MX, x: ca.MX, p: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
        """New state without correction, rates at the stages (n, s), relative residual."""
        guess, begin = self.begin_rates(t, h, x, p)
        arguments = ca.vertcat(t, h, x, p, *([begin] if self.matrix.explicit_first else []))
        guesses = ca.repmat(guess, len(self.nodes), 1)
        (new, rates), residual = self.newton.results(guesses, arguments)
        return new, rates, residual
