"""One step of a stepper as a function: substeps, samples of blocks, outputs and their validity."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.symbolic.evaluation.columns import dense
from dalembert.symbolic.evaluation.prelude import before
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.once import CacheOwner

UNROLLED = 20_000
"""Upper limit of operations of a step whose substeps are written one after the other."""
LARGEST = 1e300
"""Threshold for an infinite state: sum of its magnitudes."""


class StepMap(CacheOwner):
    """``(z, u, r) → (z⁺, y, share)`` with ``z = [x; t]``.

    ``r`` are the parameters that are no inputs. The step is valid if ``share ≤ 1``: it is the
    conditioning of the equations at the end, and not ≤ 1 if a number is not finite.

    Parameters
    ----------
    kernel : DynamicsKernel
    mode : of the steps
    h : length of a substep [s]
    due : of each substep, the number of the sample that precedes it, −1 for none
    inputs : numbers of the inputs among the parameters
    outputs : measures at the end
    """

    def __init__(
        self,
        kernel: DynamicsKernel,
        mode: int,
        h: float,
        due: tuple[int, ...],
        inputs: Sequence[int],
        outputs: Sequence[Expression],
    ):
        self.kernel, self.mode, self.h, self.due = kernel, mode, h, due
        self.inputs, self.outputs = list(inputs), list(outputs)
        self.variant = kernel.variants[mode]
        self.size = self.variant.step.size
        self.count = self.variant.step.parameter_count
        self.others = [k for k in range(self.count) if k not in set(self.inputs)]

    @cached_property
    def function(self) -> ca.Function:
        """``(z, u, r) → (z⁺, y, share)``."""
        parts = [self.variant.step.function, *self._samples.values(), *self._ends]
        operations = sum(f.n_instructions() for f in parts[:1]) * len(self.due)
        scalar = operations <= UNROLLED and all(f.is_a("SXFunction") for f in parts)
        kind: Any = ca.SX if scalar else ca.MX
        z, u = kind.sym("z", self.size + 1), kind.sym("u", len(self.inputs))
        r = kind.sym("r", len(self.others))
        x, t = z[: self.size], z[self.size]
        p = self._parameters(u, r)
        for due in self.due:
            if due >= 0:
                x = self._samples[due](t, 0.0, x, p)
            x = self.variant.step.function(t, self.h, x, p)
            t = t + self.h
        state = x[: self.variant.step.state_size]
        values = [f(t, state, p) for f in self._ends[:1]]
        share = kind(0)
        if self.variant.conditioning is not None:
            y = state[: self.kernel.equations.coordinate_count]
            share = ca.mmax(ca.vertcat(*self.variant.conditioning(t, y, p)))
        finite = ca.sum1(ca.fabs(ca.vertcat(x, *values, u))) < LARGEST  # limits may hide a NaN
        share = ca.if_else(finite, share, 2)
        column = ca.vertcat(*values) if values else kind(0, 1)
        options = {"cse": True} if scalar else {}
        results = [ca.vertcat(x, t), ca.densify(column), ca.densify(share)]
        return dense(ca.Function("step_map", [z, u, r], results, options))

    @cached_property
    def split(self) -> tuple[ca.Function, ca.Function]:
        """``r → q``, and ``(z, u, q) → (z⁺, y, share)``: terms of parameters are evaluated once."""
        values, function = before(self.function, 2)
        return values, dense(function)

    @cached_property
    def timed(self) -> bool:
        """Whether the motion or the outputs depend on the time itself."""
        if not self.function.is_a("SXFunction"):
            return True
        (z, _, _), (following, y) = self._traced
        return bool(ca.depends_on(ca.vertcat(following[:-1], y), z[-1]))

    @cached_property
    def jacobian(self) -> ca.Function:
        """``(z, u, r) → ∂z⁺/∂z, ∂z⁺/∂u, ∂y/∂z, ∂y/∂u``."""
        (z, u, r), (following, y) = self._traced
        pairs = [(following, z), (following, u), (y, z), (y, u)]
        return ca.Function("jacobian", [z, u, r], [ca.densify(ca.jacobian(*k)) for k in pairs])

    @cached_property
    def by_parameters(self) -> ca.Function:
        """``(z, u, r) → ∂z⁺/∂z, ∂z⁺/∂r, ∂y/∂z, ∂y/∂r``."""
        (z, u, r), (following, y) = self._traced
        pairs = [(following, z), (following, r), (y, z), (y, r)]
        slopes = [ca.densify(ca.jacobian(*k)) for k in pairs]
        return ca.Function("by_parameters", [z, u, r], slopes)

    @cached_property
    def reading(self) -> ca.Function:
        """``(z, u, r) → ∂y/∂z, ∂y/∂u`` of the outputs at the beginning of the step."""
        (z, u, r), _ = self._traced
        x = z[: self.variant.step.state_size]
        column = [f(z[-1], x, self._parameters(u, r)) for f in self._ends]
        y = ca.densify(ca.vertcat(*column)) if column else type(z)(0, 1)
        slopes = [ca.densify(ca.jacobian(y, k)) for k in (z, u)]
        return ca.Function("reading", [z, u, r], slopes)

    def _parameters(self, u: Any, r: Any) -> Any:
        """All parameters from inputs and others."""
        order = [int(k) for k in np.argsort([*self.inputs, *self.others])]
        return ca.vertcat(u, r)[order]

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(z, u, r, z̄⁺, ȳ) → (z̄, ū)``."""
        return self._pulled("adjoint", 2)

    @cached_property
    def parameter_adjoint(self) -> ca.Function:
        """``(z, u, r, z̄⁺, ȳ) → (z̄, ū, r̄)``."""
        return self._pulled("parameter_adjoint", 3)

    def _pulled(self, name: str, count: int) -> ca.Function:
        """Weights of the first inputs from those of the results."""
        (z, u, r), (following, y) = self._traced
        kind: Any = type(z)
        weights = kind.sym("w", following.numel()), kind.sym("v", y.numel())
        back = [
            ca.densify(ca.jtimes(ca.vertcat(following, y), s, ca.vertcat(*weights), True))
            for s in (z, u, r)[:count]
        ]
        return ca.Function(name, [z, u, r, *weights], back)

    @property
    def _traced(self) -> tuple[list, list]:
        """Symbols, and results of the step."""
        f = self.function
        symbols = f.sx_in() if f.is_a("SXFunction") else f.mx_in()
        return symbols, f.call(symbols, True, False)[:2]

    @cached_property
    def _samples(self) -> dict[int, ca.Function]:
        sampling, numbers = self.kernel.sampling, sorted(set(self.due) - {-1})
        if sampling is None:
            return {}
        return {k: self.kernel.variants[sampling.mode(self.mode, k)].step.function for k in numbers}

    @cached_property
    def _ends(self) -> list[ca.Function]:
        """Function of the outputs, if there are any."""
        if not self.outputs:
            return []
        return [self.variant.measured(_joined(tuple(self.outputs))).function]


def _joined(outputs: tuple[Expression, ...]) -> Expression:
    return Expression(stack(output.sx for output in outputs), "outputs")
