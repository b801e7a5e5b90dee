"""Steps of integrators with their tangents and adjoints, in the forms that marches evaluate.

Terms of parameters alone, ``q = h(p)``, are split off and evaluated once for many steps.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca

from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.linear_map import TriangularMap
from dalembert.symbolic.evaluation.columns import LONG, instructions
from dalembert.symbolic.evaluation.lane_tangents import LinearStep
from dalembert.symbolic.evaluation.prelude import Prelude, before

WIDTH = 16
"""Maximum number of directions differentiated at once, which limits the size of the graph."""


@dataclass(frozen=True)
class StepForms:
    """Equivalent forms of a step.

    Attributes
    ----------
    values : ``p → q``, evaluated once for many steps
    function : ``(t, h, x, q) → x⁺``
    called : equivalent function, fastest when compiled, if there is such a form: repeated parts
        are functions that are compiled once
    lanes : equivalent function for SIMD lanes, without branches: NaN in lanes that would branch
    """

    values: ca.Function
    function: ca.Function
    called: ca.Function | None = None
    lanes: ca.Function | None = None

    @property
    def side_by_side(self) -> ca.Function:
        """Function of the step that is fastest in SIMD lanes."""
        if self.lanes is not None or self.called is None:
            return self.lanes or self.function
        return self.called if instructions(self.function) > LONG else self.function


class PreparedStep(ABC):
    """A step, its tangent and its adjoint as functions of ``q``."""

    @property
    @abstractmethod
    def forms(self) -> StepForms:
        """Forms of the step, with terms ``q`` of its own."""

    @property
    @abstractmethod
    def prelude(self) -> Prelude:
        """Terms of the derivatives that depend on parameters alone, ``q`` and ``q̇``."""

    @abstractmethod
    def tangents(self, count: int) -> ca.Function:
        """``(t, h, x, q, dx, dq) → dx⁺`` for ``count`` directions at once, in columns."""

    @property
    @abstractmethod
    def adjoint(self) -> ca.Function:
        """``(t, h, x, q, x̄⁺) → (x̄, q̄)``."""

    @property
    def compiled_adjoint(self) -> ca.Function:
        """``adjoint`` in the form that is fastest when compiled."""
        return self.adjoint

    @property
    def linear(self) -> LinearStep | None:
        """``tangents`` in two parts for SIMD lanes; None if not available."""
        return None


class PreparedGraph(PreparedStep):
    """A step differentiated by CasADi.

    Solved equations inside (rootfinder nodes) are differentiated by the implicit function
    theorem, so derivatives are exact as far as the equations are solved.

    Parameters
    ----------
    function : ``(t, h, x, p) → x⁺``
    uncorrected : the same without correction
    correction : of the leading ``state_size`` entries, which provides its own derivatives, or None
    state_size : length of the state of the system
    """

    def __init__(
        self,
        function: ca.Function,
        uncorrected: ca.Function,
        correction: ImplicitFunction | None,
        state_size: int,
    ):
        self.function, self.uncorrected, self.correction = function, uncorrected, correction
        self.size, self.state_size = function.numel_in(2), state_size

    @cached_property
    def forms(self) -> StepForms:
        return StepForms(*before(self.function, 3))

    @cached_property
    def prelude(self) -> Prelude:
        return Prelude.identity(self.function.numel_in(3))

    def _trace(self) -> tuple[list[ca.MX], ca.MX, ca.MX, TriangularMap | None]:
        """Symbols ``t, h`` and ``[x; p]``, the uncorrected state, tangent of the correction."""
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        both = ca.MX.sym("xp", self.size + self.prelude.value_count)
        x, p = both[: self.size], both[self.size :]
        (new,) = self.uncorrected.call([t, h, x, p], True, False)
        if self.correction is None:
            return [t, h], both, new, None
        return [t, h], both, new, self.correction.at(t + h, new[: self.state_size], p)

    def tangents(self, count: int) -> ca.Function:
        times, both, new, correction = self._trace()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.prelude.rate_count, count)
        cuts, along = [*range(0, count, WIDTH), count], ca.vertcat(dx, dp)
        columns = [ca.jtimes(new, both, along[:, begin:end]) for begin, end in pairwise(cuts)]
        change = ca.densify(ca.horzcat(*columns))
        if correction is not None:
            n = self.state_size
            change = ca.vertcat(correction.tangent([change[:n, :], dp]), change[n:, :])
        inner = ca.Function("tangents", [*times, both, dx, dp], [change])
        return self._split("step_tangent", inner, [dx, dp])

    @cached_property
    def adjoint(self) -> ca.Function:
        times, both, new, correction = self._trace()
        weight, n = ca.MX.sym("w", self.size), self.state_size
        if correction is None:
            weights = ca.jtimes(new, both, weight, True)
        else:
            back = correction.adjoint(weight[:n])
            weights = ca.jtimes(new, both, ca.vertcat(back[:n], weight[n:]), True)
            weights += ca.vertcat(ca.MX(self.size, 1), back[n:])
        weights = ca.densify(weights)
        out = [weights[: self.size], weights[self.size :]]
        inner = ca.Function("adjoint", [*times, both, weight], out)
        return self._split("step_adjoint", inner, [weight])

    def _split(self, name: str, inner: ca.Function, more: list[ca.MX]) -> ca.Function:
        """The function of separate x and p."""
        t, h, x, p = step_symbols(self.size, self.prelude.value_count)
        return ca.Function(name, [t, h, x, p, *more], inner.call([t, h, ca.vertcat(x, p), *more]))


def step_symbols(size: int, parameter_count: int, kind: Any = ca.MX) -> list[Any]:
    """Symbols of ``t, h, x, p``."""
    sizes = {"t": 1, "h": 1, "x": size, "p": parameter_count}
    return [kind.sym(name, count) for name, count in sizes.items()]
