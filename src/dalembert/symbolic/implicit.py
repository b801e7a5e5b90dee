"""Functions defined by equations, with exact first derivatives in both directions.

A stage is an unknown ``z`` with ``r(z, x) = 0``, an expression that computes it and a way to
solve linear systems with ``∂r/∂z``. Stages follow one another, each seeing the ones before it,
and explicit outputs ``h(x, z)`` come last. Differentiating the equation instead of the solver
gives, with one further solve (adjoint: one transposed solve) by the *same* factors,

    ż = −(∂r/∂z)⁻¹ (∂r/∂x) ẋ,        x̄ = −(∂r/∂x)ᵀ (∂r/∂z)⁻ᵀ z̄.

Everything that is solved in this package and can be differentiated is one of these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import casadi as ca

Solver = Callable[[ca.SX], ca.SX]


@dataclass(frozen=True)
class Stage:
    """One implicitly defined unknown.

    Parameters
    ----------
    unknown : SX symbols ``z``
    residual : SX expression ``r(z, x)``
    value : SX expression of the inputs and earlier unknowns that satisfies ``r = 0``
    solve, solve_transposed : right-hand side → solution with ``∂r/∂z`` and its transpose
    """

    unknown: ca.SX
    residual: ca.SX
    value: ca.SX
    solve: Solver
    solve_transposed: Solver


class ImplicitFunction:
    """``outputs(inputs)`` through a chain of implicit stages.

    Parameters
    ----------
    name : str
    inputs : list of SX symbol columns
    stages : list of Stage
    outputs : list of SX, expressions of inputs and unknowns
    """

    def __init__(self, name: str, inputs: list[ca.SX], stages: list[Stage], outputs: list[ca.SX]):
        self.name = name
        self.inputs = inputs
        self.stages = stages
        self.outputs = [ca.densify(o) for o in outputs]

    @property
    def input_sizes(self) -> list[int]:
        return [x.numel() for x in self.inputs]

    @property
    def output_sizes(self) -> list[int]:
        return [o.numel() for o in self.outputs]

    @cached_property
    def function(self) -> ca.Function:
        """inputs → outputs."""
        return self._compile(self.name, self.inputs, self.outputs)

    @cached_property
    def tangent(self) -> ca.Function:
        """inputs, their rates → rates of the outputs."""
        rates = [ca.SX.sym(f"d{i}", *x.shape) for i, x in enumerate(self.inputs)]
        x, dx = ca.vertcat(*self.inputs), ca.vertcat(*rates)
        unknown, unknown_rates = ca.SX(0, 1), ca.SX(0, 1)
        for stage in self.stages:
            rhs = ca.jtimes(stage.residual, x, dx)
            if unknown.numel():
                rhs += ca.jtimes(stage.residual, unknown, unknown_rates)
            unknown = ca.vertcat(unknown, stage.unknown)
            unknown_rates = ca.vertcat(unknown_rates, -stage.solve(rhs))
        out = [
            _directional(o, x, dx) + _directional(o, unknown, unknown_rates) for o in self.outputs
        ]
        return self._compile(f"{self.name}_tangent", [*self.inputs, *rates], out)

    @cached_property
    def adjoint(self) -> ca.Function:
        """inputs, weights of the outputs → weights of the inputs."""
        seeds = [ca.SX.sym(f"w{i}", *o.shape) for i, o in enumerate(self.outputs)]
        scalar = sum((ca.dot(s, o) for s, o in zip(seeds, self.outputs, strict=True)), ca.SX(0))
        # weights are symbols until the end, so that each gradient stays a small graph
        weights = [ca.SX.sym(f"m{i}", *s.unknown.shape) for i, s in enumerate(self.stages)]
        solved: list[ca.SX] = []
        for stage, weight in zip(reversed(self.stages), reversed(weights), strict=True):
            solved.insert(0, stage.solve_transposed(ca.gradient(scalar, stage.unknown)))
            scalar = scalar - ca.dot(weight, stage.residual)
        gradients = [ca.gradient(scalar, x) for x in self.inputs]
        for weight, value in zip(weights, solved, strict=True):  # each depends on later ones only
            gradients = ca.substitute(gradients, [weight], [value])
        return self._compile(f"{self.name}_adjoint", [*self.inputs, *seeds], gradients)

    def _compile(self, name: str, inputs: list[ca.SX], outputs: list[ca.SX]) -> ca.Function:
        for stage in reversed(self.stages):
            outputs = ca.substitute(outputs, [stage.unknown], [stage.value])
        outputs = [ca.densify(o) for o in outputs]
        return ca.Function(name, inputs, outputs, {"cse": True})


def _directional(expression: ca.SX, x: ca.SX, dx: ca.SX) -> ca.SX:
    if not x.numel() or not expression.numel():
        return ca.SX.zeros(*expression.shape)
    return ca.jtimes(expression, x, dx)
