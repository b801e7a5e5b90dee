"""One explicit Runge–Kutta step with its exact tangent and adjoint.

Forward: ``k_i = F(t + c_i h, X_i, p)``, ``X_i = x + h Σ a_ij k_j``, ``x⁺ = P(x + h Σ b_i k_i)``
with ``P`` the correction of the stabilisation. The adjoint runs the same sums backwards,
``k̄_i = h b_i x̄ + h Σ_{j>i} a_ji X̄_j``, so it is the exact derivative of the step taken.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.integrators.step import Step
from dalembert.integrators.tableau import ButcherTableau
from dalembert.symbolic.implicit import ImplicitFunction


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

    def _symbols(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        return (
            ca.SX.sym("t"),
            ca.SX.sym("h"),
            ca.SX.sym("x", self.size),
            ca.SX.sym("p", self.parameter_count),
        )

    def stages(self, t, h, x, p, count: int | None = None) -> tuple[list[ca.SX], list[ca.SX]]:
        """Stage states ``X_i`` and slopes ``k_i``."""
        states: list[ca.SX] = []
        slopes: list[ca.SX] = []
        for i in range(self.tableau.stages if count is None else count):
            state = x
            for a, k in zip(self.tableau.a[i - 1] if i else (), slopes, strict=True):
                if a != 0:
                    state = state + (h * a) * k
            states.append(state)
            slopes.append(self.rhs.function(t + self.tableau.c[i] * h, state, p))
        return states, slopes

    @property
    def needed(self) -> int:
        """Stages the new state depends on."""
        return max(self.used) + 1

    def advance(self, h, x, slopes) -> ca.SX:
        """``x + h Σ b_i k_i``; slopes of equal weight are added first."""
        groups: dict[float, ca.SX] = {}
        for i in self.used:
            weight = self.tableau.b[i]
            groups[weight] = groups[weight] + slopes[i] if weight in groups else slopes[i]
        return x + sum(((h * weight) * total for weight, total in groups.items()), ca.SX(0))

    def correct(self, t, x, p) -> ca.SX:
        """The state after the correction."""
        return x if self.finish is None else self.finish.function(t, x, p)

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols()
        _, slopes = self.stages(t, h, x, p, self.needed)
        new = self.correct(t + h, self.advance(h, x, slopes), p)
        return ca.Function("step", [t, h, x, p], [new], {"cse": True})

    @cached_property
    def plain(self) -> ExplicitStep:
        return ExplicitStep(self.tableau, self.rhs, None, self.upkeep)

    @cached_property
    def tangent(self) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺``."""
        t, h, x, p = self._symbols()
        dx, dp = ca.SX.sym("dx", self.size), ca.SX.sym("dp", self.parameter_count)
        states, slopes = self.stages(t, h, x, p, self.needed)
        rates: list[ca.SX] = []
        for i, state in enumerate(states):
            change = dx
            for a, r in zip(self.tableau.a[i - 1] if i else (), rates, strict=True):
                if a != 0:
                    change = change + (h * a) * r
            rates.append(self.rhs.tangent(t + self.tableau.c[i] * h, state, p, 0, change, dp))
        change = self.advance(h, dx, rates)
        if self.finish is not None:
            new = self.advance(h, x, slopes)
            change = self.finish.tangent(t + h, new, p, 0, change, dp)
        inputs, out = [t, h, x, p, dx, dp], [ca.densify(change)]
        return ca.Function("step_tangent", inputs, out, {"cse": True})

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺) → (x̄, p̄)``."""
        t, h, x, p = self._symbols()
        weight = ca.SX.sym("w", self.size)
        states, slopes = self.stages(t, h, x, p, self.needed)
        end, p_bar = weight, ca.SX.zeros(self.parameter_count)
        if self.finish is not None:
            new = self.advance(h, x, slopes)
            _, end, p_bar = self.finish.adjoint(t + h, new, p, weight)
        x_bar = end
        state_bars: dict[int, ca.SX] = {}
        for i in reversed(range(len(states))):
            seed = h * self.tableau.b[i] * end
            for j, bar in state_bars.items():
                if self.tableau.a[j - 1][i] != 0:
                    seed = seed + (h * self.tableau.a[j - 1][i]) * bar
            _, state_bars[i], more = self.rhs.adjoint(t + self.tableau.c[i] * h, states[i], p, seed)
            x_bar, p_bar = x_bar + state_bars[i], p_bar + more
        return ca.Function("step_adjoint", [t, h, x, p, weight], [x_bar, p_bar], {"cse": True})
