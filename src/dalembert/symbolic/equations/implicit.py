"""Functions defined by equations, with exact derivatives in both directions.

A stage is an unknown ``z`` with ``r(z, x) = 0``, an expression that computes it and a way to
solve linear systems with ``∂r/∂z``. Stages follow one another, each seeing the ones before it,
and explicit outputs ``h(x, z)`` come last. Differentiating the equation instead of the solver
gives, with one further solve (adjoint: one transposed solve) by the *same* factors,

    ż = −(∂r/∂z)⁻¹ (∂r/∂x) ẋ,        x̄ = −(∂r/∂x)ᵀ (∂r/∂z)⁻ᵀ z̄.

Both are chains of the same kind, so derivatives of any order follow by repetition.
Positions, accelerations, multipliers, projections, equilibria and the start of a mechanism are
implicit functions of this kind. Implicit steps (``integrators``) and structures, whose systems are
large, are differentiated by the same two formulas with their own factors.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.symbolic.equations.linear_map import LinearChain, LinearMap, TriangularMap
from dalembert.symbolic.evaluation.kernel import CSE_OPERATIONS, SELDOM, condensed
from dalembert.symbolic.evaluation.prelude import Prelude, before_tangent
from dalembert.symbolic.evaluator import Evaluator
from dalembert.symbolic.once import CacheOwner, once

Solver = Callable[[ca.SX], ca.SX]


@dataclass(frozen=True)
class Trial:
    """A cheaper solution for an unknown, which usually suffices.

    Parameters
    ----------
    value : SX expression of the inputs and earlier unknowns
    excess : SX expression of these and the unknown, at most one where the value is accepted
    """

    value: ca.SX
    excess: ca.SX


@dataclass(frozen=True)
class Stage(Evaluator):
    """One implicitly defined unknown.

    Parameters
    ----------
    unknown : SX symbols ``z``
    residual : SX expression ``r(z, x)``
    value : SX expression of the inputs and earlier unknowns that satisfies ``r = 0``
    solver, transposed : right-hand side → solution with ``∂r/∂z`` and its transpose
    trial : a cheaper solution to try first, if there is one
    """

    unknown: ca.SX
    residual: ca.SX
    value: ca.SX
    solver: Solver
    transposed: Solver
    trial: Trial | None = None

    def solve(self, rhs: ca.SX) -> ca.SX:
        return self.solver(rhs)

    def solve_transposed(self, weights: ca.SX) -> ca.SX:
        return self.transposed(weights)

    def push(self, change: tuple[ca.SX, ca.SX]) -> ca.SX:
        """Change of the residual with symbols, given as ``(symbols, their changes)``."""
        return _directional(self.residual, *change)

    def pull(self, weights: ca.SX) -> ca.SX:
        """Weighted sum of the residuals, whose gradients are the weights of all symbols."""
        return ca.dot(weights, self.residual)


class ImplicitFunction(CacheOwner):
    """``outputs(inputs)`` through a chain of implicit stages.

    Parameters
    ----------
    name : str
    inputs : list of SX symbol columns
    stages : list of Stage
    outputs : list of SX, expressions of inputs and unknowns
    most : see ``condensed``; the default is for functions evaluated at starts, outputs and for
        derivatives, the other is that of ``frequent``
    """

    def __init__(
        self,
        name: str,
        inputs: list[ca.SX],
        stages: list[Stage],
        outputs: list[ca.SX],
        most: int = SELDOM,
    ):
        self.name, self.most = name, most
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
    def frequent(self) -> ImplicitFunction:
        """The same for evaluations in every step."""
        return ImplicitFunction(self.name, self.inputs, self.stages, self.outputs, CSE_OPERATIONS)

    @cached_property
    def function(self) -> ca.Function:
        """inputs → outputs."""
        tried = any(stage.trial is not None for stage in self.stages)
        most = SELDOM if tried else self.most  # trials usually suffice
        return self._compile(self.name, self.outputs, most)

    @cached_property
    def trial(self) -> ca.Function | None:
        """inputs → outputs by trial values, and the sum of their excess; see ``Trial``."""
        trials = [stage.trial for stage in self.stages if stage.trial is not None]
        if not trials:
            return None
        excess = ca.densify(sum((trial.excess for trial in trials), ca.SX(0)))
        return self._compile(f"{self.name}_trial", [*self.outputs, excess], self.most, True)

    @property
    def tangent(self) -> ca.Function:
        """inputs, their rates → rates of the outputs."""
        return self.forward.function

    @property
    def adjoint(self) -> ca.Function:
        """inputs, weights of the outputs → weights of the inputs."""
        return self.reverse.function

    @cached_property
    def linear(self) -> LinearMap:
        """The tangent at a point and fixed time, with its entries and the outputs there."""
        return LinearMap(self._tangent_at_fixed_time, len(self.inputs), [self.function])

    @cached_property
    def prepared(self) -> tuple[Prelude, LinearMap]:
        """``linear`` after the prelude, which depends on the last input alone."""
        prelude, tangent, function = self._after_prelude
        return prelude, LinearMap(tangent, len(self.inputs), [function])

    @cached_property
    def prepared_adjoint(self) -> ca.Function:
        """inputs after the prelude, weights of outputs → weights of all but the first input."""
        _, tangent, _ = self._after_prelude
        inputs, count = tangent.sx_in(), len(self.inputs)
        outputs = ca.vertcat(*tangent.call(inputs))
        weight = ca.SX.sym("w", outputs.numel())
        back = ca.densify(ca.jtimes(outputs, ca.vertcat(*inputs[count:]), weight, True))
        return ca.Function("prepared_adjoint", [*inputs[:count], weight], [back], {"cse": True})

    @property
    def prepared_prelude(self) -> Prelude:
        """The prelude of ``prepared``, without the map."""
        return self._after_prelude[0]

    @property
    def prepared_function(self) -> ca.Function:
        """inputs after the prelude → outputs."""
        return self._after_prelude[2]

    @cached_property
    def _after_prelude(self) -> tuple[Prelude, ca.Function, ca.Function]:
        """The prelude, and the rest of the tangent at fixed time and of the function."""
        return before_tangent(self._tangent_at_fixed_time, self.function)

    @property
    def _tangent_at_fixed_time(self) -> ca.Function:
        """The tangent for a zero rate of the first input, time."""
        first, *rest = self.inputs
        rates = [ca.SX.sym(f"d{i}", *x.shape) for i, x in enumerate(rest)]
        return self.along([ca.SX.zeros(*first.shape), *rates], rates).function

    def at(self, *inputs: ca.MX) -> TriangularMap:
        """The tangent at a point and fixed time: rates of the other inputs → rates of outputs."""
        chain = LinearChain(sum(self.input_sizes[1:]))
        *_, entries = self.linear.point(*inputs)
        return chain.closed(chain.through(self.linear, range(chain.input_count), entries))

    @once
    def tangents(self, count: int) -> ca.Function:
        """inputs, rates of all but the first in ``count`` columns → rates of the outputs."""
        inputs = [ca.MX.sym(f"i{i}", x.numel()) for i, x in enumerate(self.inputs)]
        rates = [ca.MX.sym(f"d{i}", x.numel(), count) for i, x in enumerate(self.inputs)][1:]
        return ca.Function("tangents", [*inputs, *rates], [self.at(*inputs).tangent(rates)])

    @cached_property
    def forward(self) -> ImplicitFunction:
        """The tangent as an implicit function: rates of unknowns solve ``r_z ż + r_x ẋ = 0``."""
        rates = [ca.SX.sym(f"d{i}", *x.shape) for i, x in enumerate(self.inputs)]
        return self.along(rates, rates)

    def along(self, rates: list[ca.SX], symbols: list[ca.SX]) -> ImplicitFunction:
        """The tangent for rates of the inputs, expressions of symbols: inputs, symbols → rates."""
        symbols_so_far, changes = ca.vertcat(*self.inputs), ca.vertcat(*rates)
        stages = list(self.stages)
        for stage in self.stages:
            rate = ca.SX.sym("dz", *stage.unknown.shape)
            by_inputs = stage.push((symbols_so_far, changes))
            residual = by_inputs + stage.push((stage.unknown, rate))
            value = stage.correction(by_inputs)
            rate_stage = replace(stage, unknown=rate, residual=residual, value=value, trial=None)
            stages.append(rate_stage)
            symbols_so_far, changes = (
                ca.vertcat(symbols_so_far, stage.unknown),
                ca.vertcat(changes, rate),
            )
        change = _directional(ca.veccat(*self.outputs), symbols_so_far, changes)
        out = _split(change, self.outputs)
        inputs = [*self.inputs, *symbols]
        return ImplicitFunction(f"{self.name}_tangent", inputs, stages, out)

    @cached_property
    def reverse(self) -> ImplicitFunction:
        """The adjoint as an implicit function: weights of residuals solve ``r_zᵀ m = z̄``."""
        seeds = [ca.SX.sym(f"w{i}", *o.shape) for i, o in enumerate(self.outputs)]
        scalar = sum((ca.dot(s, o) for s, o in zip(seeds, self.outputs, strict=True)), ca.SX(0))
        stages = list(self.stages)
        for i, stage in reversed(list(enumerate(self.stages))):
            # weights are symbols, so that each gradient stays a small graph
            weight = ca.SX.sym(f"m{i}", *stage.unknown.shape)
            by_unknown = ca.gradient(scalar, stage.unknown)
            scalar = scalar - stage.pull(weight)
            residual = -ca.gradient(scalar, stage.unknown)
            value = stage.solve_transposed(by_unknown)
            stages.append(Stage(weight, residual, value, stage.solve_transposed, stage.solve))
        gradients = _split(ca.gradient(scalar, ca.vertcat(*self.inputs)), self.inputs)
        inputs = [*self.inputs, *seeds]
        return ImplicitFunction(f"{self.name}_adjoint", inputs, stages, gradients)

    def _compile(
        self, name: str, outputs: list[ca.SX], most: int, by_trial: bool = False
    ) -> ca.Function:
        unknowns: list[ca.SX] = []
        values: list[ca.SX] = []
        for stage in self.stages:  # each graph is copied once, as values replace earlier unknowns
            trial = stage.trial if by_trial else None
            value = ca.densify(stage.value if trial is None else trial.value)
            if values:
                (value,) = ca.substitute([value], unknowns, values)
            unknowns.append(stage.unknown)
            values.append(value)
        if values:
            outputs = ca.substitute(outputs, unknowns, values)
        return condensed(name, self.inputs, [ca.densify(o) for o in outputs], most)


def _split(column: ca.SX, like: list[ca.SX]) -> list[ca.SX]:
    """A column in parts of the same shapes as these matrices."""
    ends = np.cumsum([0, *(part.numel() for part in like)]).tolist()
    parts = ca.vertsplit(column, ends) if like else []
    return [ca.reshape(part, *matrix.shape) for part, matrix in zip(parts, like, strict=True)]


def _directional(expression: ca.SX, x: ca.SX, dx: ca.SX) -> ca.SX:
    if not x.numel() or not expression.numel():
        return ca.SX.zeros(*expression.shape)
    return ca.jtimes(expression, x, dx)
