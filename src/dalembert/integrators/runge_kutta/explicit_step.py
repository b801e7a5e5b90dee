"""One explicit Runge–Kutta step with its exact tangent and adjoint.

Forward: ``k_i = F(t + c_i h, X_i, p)``, ``X_i = x + h Σ a_ij k_j``, ``x⁺ = P(x + h Σ b_i k_i)``
with ``P`` the correction of the stabilisation. The adjoint runs the same sums backwards,
``k̄_i = h b_i x̄ + h Σ_{j>i} a_ji X̄_j``, so it is the exact derivative of the step taken.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.integrators.runge_kutta.tableau import ButcherTableau
from dalembert.integrators.step import Marching, Step
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.linear_map import LinearChain, TriangularMap
from dalembert.symbolic.evaluation.columns import LONG
from dalembert.symbolic.evaluation.lane_tangents import LinearStep
from dalembert.symbolic.evaluation.prelude import Prelude, before

Following = tuple[ca.Function, Any]
"""What follows the stages, ``(t, x, q) → x``, and its part of q."""


def _corrected(t: Any, x: Any, correction: Following) -> Any:
    """The state after a correction."""
    function, q = correction
    return function(t, x, q)


def _thorough_where_needed(t: ca.MX, x: ca.MX, correction: Following, trial: Following) -> ca.MX:
    """The state after a shorter correction, or the whole one where that does not arrive."""
    (function, q), (short, seen) = correction, trial
    found, excess = short(t, x, seen)
    inputs = [
        ca.MX.sym(name, given.numel()) for name, given in zip("ftxq", (x, t, x, q), strict=True)
    ]
    kept = ca.Function("kept", inputs, inputs[:1])
    whole = ca.Function("whole", inputs, [function(*inputs[1:])])
    return ca.Function.if_else("correction", kept, whole)(excess <= 1, found, t, x, q)


def _none_where_bad(t: ca.MX, x: ca.MX, _: Following, trial: Following) -> ca.MX:
    """The state after a shorter correction, NaN where that does not arrive."""
    short, seen = trial
    found, excess = short(t, x, seen)
    return found + ca.if_else(excess <= 1, 0, np.nan)


class ExplicitStep(Step):
    """``(t, h, x, p) → x⁺``.

    Parameters
    ----------
    tableau : ButcherTableau
    rhs : ImplicitFunction ``(t, x, p) → ẋ``
    correction : ImplicitFunction ``(t, x, p) → x``, or None
    upkeep : the same for a step without correction, or None
    """

    def __init__(
        self,
        tableau: ButcherTableau,
        rhs: ImplicitFunction,
        correction: ImplicitFunction | None,
        upkeep: ImplicitFunction | None = None,
    ):
        self.tableau, self.rhs, self.upkeep = tableau, rhs, upkeep
        self.finish = upkeep if correction is None else correction
        _, self.size, self.parameter_count = rhs.input_sizes
        self.state_size = self.size
        self.corrects = correction is not None
        self.used = [i for i in range(tableau.stages) if tableau.b[i] != 0]

    def stages(self, t, h, x, p, count: int | None = None) -> tuple[list[Any], list[Any]]:
        """Stage states ``X_i`` and slopes ``k_i``."""
        return self._staged(self.rhs.function, t, h, x, p, count)

    def _staged(self, rhs: ca.Function, t, h, x, p, count: int | None = None):
        """The same with a right-hand side that may take q for p."""
        states: list[Any] = []
        slopes: list[Any] = []
        for i in range(self.tableau.stages if count is None else count):
            state = x
            for a, k in zip(self.tableau.a[i - 1] if i else (), slopes, strict=True):
                if a != 0:
                    state = state + (h * a) * k
            states.append(state)
            slopes.append(rhs(t + self.tableau.c[i] * h, state, p))
        return states, slopes

    @property
    def rate(self) -> ImplicitFunction:
        return self.rhs

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray]:
        return self.tableau.stability

    @property
    def needed(self) -> int:
        """Stages the new state depends on."""
        return max(self.used) + 1

    def advance(self, h, x, slopes) -> Any:
        """``x + h Σ b_i k_i``; slopes of equal weight are added first."""
        groups: dict[float, Any] = {}
        for i in self.used:
            weight = self.tableau.b[i]
            groups[weight] = groups[weight] + slopes[i] if weight in groups else slopes[i]
        return x + sum((h * weight) * total for weight, total in groups.items())

    def correct(self, t, x, p) -> ca.SX:
        """The state after the correction."""
        return x if self.finish is None else self.finish.function(t, x, p)

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols(ca.SX)
        _, slopes = self.stages(t, h, x, p, self.needed)
        new = self.correct(t + h, self.advance(h, x, slopes), p)
        return ca.Function("step", [t, h, x, p], [new], self._shared)

    @cached_property
    def _shared(self) -> dict[str, Any]:
        """Stages have nothing in common but what depends on time alone; looking for it is slow."""
        moving = any(f.function.jac_sparsity(0, 0).nnz() for f in self._functions)
        return {"cse": True} if moving else {}

    @cached_property
    def marching(self) -> Marching:
        functions = [f.function for f in self._functions]
        trial = None if self.finish is None else self.finish.trial
        works = [f.n_instructions() for f in functions]
        if trial is not None and sum(works) + (self.needed - 1) * works[0] > LONG:
            functions.append(trial)
        parts = [before(f, 2) for f in functions]
        p = ca.SX.sym("p", self.parameter_count)
        values = ca.Function("prelude", [p], [ca.vertcat(*(h(p) for h, _ in parts))], {"cse": True})
        if len(parts) < 3:
            return Marching(values, *(self._after(values, parts, k) for k in (ca.SX, ca.MX)))
        function = self._after(values, parts, ca.MX, _thorough_where_needed)
        return Marching(values, function, None, self._after(values, parts, ca.MX, _none_where_bad))

    def _after(
        self,
        values: ca.Function,
        parts: Sequence[tuple[ca.Function, ca.Function]],
        kind: Any,
        finished: Callable[..., Any] = _corrected,
    ) -> ca.Function:
        """The step of ``q``; as a graph of matrices the slopes and the correction are calls."""
        t, h, x, _ = self._symbols(kind)
        q, edges = kind.sym("q", values.numel_out(0)), [0]
        for part, _ in parts:
            edges.append(edges[-1] + part.numel_out(0))
        (rhs, seen), *following = [
            (part[1], q[a:b]) for part, (a, b) in zip(parts, pairwise(edges), strict=True)
        ]
        _, slopes = self._staged(rhs, t, h, x, seen, self.needed)
        new = self.advance(h, x, slopes)
        if following:
            new = finished(t + h, new, *following)
        options: Any = self._shared if kind is ca.SX else {}
        return ca.Function("step", [t, h, x, q], [new], options)

    @cached_property
    def plain(self) -> ExplicitStep:
        return ExplicitStep(self.tableau, self.rhs, None, self.upkeep)

    @cached_property
    def prelude(self) -> Prelude:
        """What the slopes and the correction need of the parameters alone."""
        return Prelude.joined([f.prepared[0] for f in self._functions])

    @property
    def _functions(self) -> list[ImplicitFunction]:
        return [self.rhs] if self.finish is None else [self.rhs, self.finish]

    @cached_property
    def _linear(self) -> tuple[list[ca.MX], TriangularMap]:
        """Symbols ``t, h, x, q`` and the tangent of the step there."""
        t, h, x, _ = self._symbols()
        q = ca.MX.sym("q", self.prelude.value_count)
        chain = LinearChain(self.size + self.prelude.rate_count)
        start, fixed = list(range(self.size)), list(range(self.size, chain.count))
        before, rhs = self.rhs.prepared
        seen, still = q[: before.value_count], fixed[: before.rate_count]
        slopes: list[ca.MX] = []
        rates: list[list[int]] = []
        for i in range(self.needed):
            weights = self.tableau.a[i - 1] if i else ()
            used = [j for j, a in enumerate(weights) if a != 0]
            state = x + sum((h * weights[j]) * slopes[j] for j in used)
            parts = [(rates[j], h * weights[j]) for j in used]
            rows = chain.weighted([(start, 1.0), *parts]) if parts else start
            slope, entries = rhs.point(t + self.tableau.c[i] * h, state, seen)
            slopes.append(slope)
            rates.append(chain.through(rhs, [*rows, *still], entries))
        end = chain.weighted(
            [(start, 1.0), *((rates[i], h * self.tableau.b[i]) for i in self.used)]
        )
        if self.finish is not None:
            seen, still = q[before.value_count :], fixed[before.rate_count :]
            _, finish = self.finish.prepared
            _, entries = finish.point(t + h, self.advance(h, x, slopes), seen)
            end = chain.through(finish, [*end, *still], entries)
        return [t, h, x, q], chain.closed(end)

    def prepared_tangents(self, count: int) -> ca.Function:
        point, linear = self._linear
        dx = ca.MX.sym("dx", self.size, count)
        dq = ca.MX.sym("dq", self.prelude.rate_count, count)
        return ca.Function("step_tangent", [*point, dx, dq], [linear.tangent([dx, dq])])

    @cached_property
    def linear(self) -> LinearStep:
        point, linear = self._linear
        dx, dq = ca.SX.sym("dx", self.size), ca.SX.sym("dq", self.prelude.rate_count)
        e = ca.SX.sym("e", linear.entries.numel())
        along = linear.along([self.size, self.prelude.rate_count])(e, dx, dq)
        return LinearStep(
            ca.Function("entries", point, [ca.densify(linear.entries)]),
            ca.Function("along", [dx, e, dq], [ca.densify(along)]),
        )

    @cached_property
    def prepared_adjoint(self) -> ca.Function:
        """``(t, h, x, q, x̄⁺) → (x̄, q̄)`` by substitution in one sparse matrix of all stages.

        On the virtual machine 1.5 to 1.9 times a step, where stages one by one cost 1.8 to 3.3.
        """
        point, linear = self._linear
        weight = ca.MX.sym("w", self.size)
        found = linear.adjoint(weight)
        return ca.Function(
            "step_adjoint", [*point, weight], [found[: self.size], found[self.size :]]
        )

    @cached_property
    def compiled_adjoint(self) -> ca.Function:
        """The same, stage by stage: as C 1.1 to 1.2 times a step, by substitution 1.3 to 1.9."""
        t, h, x, _ = self._symbols()
        q, weight = ca.MX.sym("q", self.prelude.value_count), ca.MX.sym("w", self.size)
        n, before = self.size, self.rhs.prepared[0]
        seen, rhs = q[: before.value_count], self.rhs.prepared_function
        states, slopes = self._staged(rhs, t, h, x, seen, self.needed)
        end, finish_bar = weight, ca.MX(0, 1)
        if self.finish is not None:
            new = self.advance(h, x, slopes)
            back = self.finish.prepared_adjoint(t + h, new, q[before.value_count :], weight)
            end, finish_bar = back[:n], back[n:]
        x_bar, state_bars = end, dict[int, ca.MX]()
        rhs_bar = ca.MX.zeros(before.rate_count)
        for i in reversed(range(len(states))):
            seed = (h * self.tableau.b[i]) * end
            for j, bar in state_bars.items():
                if self.tableau.a[j - 1][i] != 0:
                    seed = seed + (h * self.tableau.a[j - 1][i]) * bar
            back = self.rhs.prepared_adjoint(t + self.tableau.c[i] * h, states[i], seen, seed)
            state_bars[i] = back[:n]
            x_bar, rhs_bar = x_bar + state_bars[i], rhs_bar + back[n:]
        out = [x_bar, ca.vertcat(rhs_bar, finish_bar)]
        return ca.Function("step_adjoint", [t, h, x, q, weight], out)
