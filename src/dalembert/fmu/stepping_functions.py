"""Steps of a run of dynamics as functions, for co-simulation."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.residual_check import DRIFT, held_levels
from dalembert.analysis.residual_check import EXACT
from dalembert.errors import ModelError, UnsupportedError
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.evaluation.columns import compiled_form
from dalembert.symbolic.formulas.expression import Expression, stack

MOST_RATES = 4
"""Upper limit of different sample rates: each set of them that is due has its own function."""


class SteppingFunctions:
    """Functions of ``(t, x, p)`` with the steps of an analysis.

    Parameters
    ----------
    model : Model
    analysis : Dynamics with a step of fixed length
    outputs : SX expressions of the bodies

    Attributes
    ----------
    step : length [s]

    Raises
    ------
    UnsupportedError
        The steps cannot run outside of Python, with the reason.
    """

    def __init__(self, model: Model, analysis: Dynamics, outputs: Sequence[ca.SX]):
        self.model, self.outputs = model, outputs
        self.kernel: DynamicsKernel = analysis.kernel(model)
        reason = _obstacle(self.kernel)
        if not reason:
            self.variant, _ = self.kernel.beginning
            reason = self._variant_obstacle()
        if reason:
            raise UnsupportedError(f"{model.name!r} cannot be exported for co-simulation: {reason}")

    def _variant_obstacle(self) -> str:
        if self.kernel.fixed.at_once(0):
            return f"{self.kernel.integrator.name} is not compiled; give another integrator"
        if len(self.sample_rates) > MOST_RATES:
            return (
                f"its blocks have {len(self.sample_rates)} different sample times and first "
                f"samples; give at most {MOST_RATES}"
            )
        if self.variant.formulation.conditioning(self.variant.equations) is not None:
            return (
                "its formulation chooses other coordinates during the run; give "
                "formulation=RangeSpace()"
            )
        return ""

    @cached_property
    def start(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → ``x`` without the memory of multistep methods."""
        return self.kernel.start

    @cached_property
    def begin(self) -> ca.Function | None:
        """``(t, –, x, p) → memory`` of multistep methods; None for others."""
        begin = self.variant.step.begin
        if begin is None:
            return None
        t, x, p = (ca.MX.sym(n, begin.function.numel_in(k)) for k, n in enumerate("txp"))
        return ca.Function("begin", [t, ca.MX.sym("held", 0), x, p], [begin.function(t, x, p)])

    @property
    def values(self) -> ca.Function:
        """``p → q``, the terms of steps that depend on parameters alone."""
        return self.kernel.fixed.marched(0).forms.values

    @cached_property
    def step(self) -> ca.Function:
        """``(x, t, h, flag, q) → x⁺``; a flag of zero leaves out the correction."""
        forms = self.kernel.fixed.marched(0).forms
        return compiled_form(forms.function, forms.called)

    @property
    def sample_rates(self) -> list[tuple[float, float]]:
        """Sample time and first sample of the sampled blocks, without repetitions."""
        sampling = self.kernel.sampling
        blocks = sampling.blocks if sampling else ()
        return list(dict.fromkeys((block.period, block.beginning) for block in blocks))

    @cached_property
    def samples(self) -> dict[int, ca.Function]:
        """Bits of the rates that are due → ``(t, 0, x, p) → x⁺`` at their sample.

        Sets of blocks that depend on each other in a cycle have none.
        """
        sampling, functions = self.kernel.sampling, dict[int, ca.Function]()
        if sampling is None:
            return functions
        rates = self.sample_rates
        for due in range(1, 1 << len(rates)):
            chosen = [rate for k, rate in enumerate(rates) if due >> k & 1]
            blocks = tuple(b for b in sampling.blocks if (b.period, b.beginning) in chosen)
            mode = sampling.mode(0, sampling.number(blocks))
            try:
                functions[due] = sampling.variants[mode].step.function
            except ModelError:
                continue
        return functions

    @property
    def period(self) -> int:
        """Number of steps between corrections."""
        return self.kernel.stabilization.period

    @property
    def halves(self) -> bool:
        """Whether shorter steps may succeed after a step without solution."""
        return self.variant.step.residual is not None

    @cached_property
    def measured(self) -> ImplicitFunction:
        """``(t, –, x, p) → outputs``."""
        function = self.variant.measured(Expression(stack(self.outputs)))
        return _with_held(function, "outputs")

    @cached_property
    def bodies(self) -> ca.Function:
        """``(t, –, x, p) → [y; v]`` of all bodies."""
        e = self.model.all_equations
        both = self.variant.measured(Expression(stack([e.y, e.v])))
        return _with_held(both, "bodies").function

    @cached_property
    def violation(self) -> ca.Function:
        """``(t, –, x, p) → r``, violations of the constraints relative to their limits."""
        e = self.variant.view.whole
        limit = EXACT[Level.POSITION] if Level.POSITION in held_levels(self.kernel) else DRIFT
        _, held, x, _ = self.measured.inputs
        count = self.kernel.equations.coordinate_count
        relative = ca.densify(e.constraints) / (e.scales.rows * limit)
        (relative,) = ca.substitute([relative], [e.y], [x[:count]])
        return ca.Function("violation", [e.t, held, x, e.p], [relative])

    @cached_property
    def conditioning(self) -> ca.Function | None:
        """``(t, –, x, p)`` → share of its limit of the dependence of redundant equations."""
        function = self.variant.conditioning
        if function is None:
            return None
        t, held, x, p = self.measured.inputs
        share, _ = function.call([t, x[: function.numel_in(1)], p])
        return ca.Function("conditioning", [t, held, x, p], [share])

    @property
    def rows(self) -> list[str]:
        """Names of the constraint equations of ``violation``."""
        return constraint_names(self.model, self.variant.view.whole.multiplier)


def constraint_names(model: Model, multipliers: ca.SX) -> list[str]:
    """Names of the constraint equations with these multipliers."""
    every = ca.vertsplit(model.all_equations.multiplier)
    number = {symbol.element_hash(): k for k, symbol in enumerate(every)}
    symbols = ca.vertsplit(multipliers) if multipliers.numel() else []
    return [model.equation_names[number[symbol.element_hash()]] for symbol in symbols]


def _obstacle(kernel: DynamicsKernel) -> str:
    if kernel.contacts is not None:
        return "rigid contacts change during the run; give the bodies compliant contacts"
    if kernel.adaptive is not None:
        return (
            f"{kernel.integrator.name} controls the error; give a step, or a method with fixed "
            "steps such as RK4()"
        )
    return ""


def _with_held(function: ImplicitFunction, name: str) -> ImplicitFunction:
    """``(t, –, x, p)`` function from ``(t, x, p)``, with an empty second argument."""
    t, x, p = function.inputs
    held = ca.SX.sym("held", 0)
    return ImplicitFunction(name, [t, held, x, p], function.stages, function.outputs)
