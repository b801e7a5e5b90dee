"""Transport delay of continuous signals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import comb, factorial

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.blocks.block import Block, Signals
from dalembert.elements.stateful import signal
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack

HIGHEST = 12
"""Upper limit of the order, above which coefficients lose their accuracy."""


@dataclass(eq=False)
class TransportDelay(Block):
    """Delay ``w(t) ≈ u(t − T)`` by the Padé approximation of ``exp(−sT)``.

    Of order n, with ``Q(s) = Σ c_k sᵏ``, ``c_k = (2n−k)!/(2n)! · n!/(k! (n−k)!)``, the transfer
    function ``Q(−sT)/Q(sT)`` has unit gain and agrees with the exact one up to ``s²ⁿ`` (Golub & Van
    Loan, Matrix Computations, 11.3). An input that jumps causes small ripples before ``T``.

    Parameters
    ----------
    input : formula of measures
    delay : ``T`` [s]
    order : n, 1 to 12
    start : input before the start, by which the states begin

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pipe")
    >>> body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    >>> late = system.add(da.blocks.TransportDelay("late", body.x**2, delay=0.3, order=4))
    >>> motion = da.solve_dynamics(system.build(), 2.0)
    >>> round(motion["late.output"][-1].item(), 4)  # (2 - 0.3)²
    2.89
    """

    input: Scalar = signal(None, "formula of measures")
    delay: Scalar = quantity("s", "delay", default=1.0, above=0.0)
    order: int = option("order of the approximation", default=3)
    start: Scalar = quantity(None, "input before the start", default=0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.order, int) or not 1 <= self.order <= HIGHEST:
            text = f"order is {self.order!r}; give a number from 1 to {HIGHEST}"
            raise ModelError(text, f"{self.name}.order")
        super().__post_init__()

    @property
    def _coefficients(self) -> list[float]:
        """``c_0 … c_n``."""
        n = self.order
        return [factorial(2 * n - k) / factorial(2 * n) * comb(n, k) for k in range(n + 1)]

    def state_names(self) -> Sequence[str]:
        return tuple(f"state{k + 1}" for k in range(self.order))

    def initial_states(self) -> Sequence[ca.SX | None]:
        return [self.start.sx] + [ca.SX(0)] * (self.order - 1)

    def rates(self) -> ca.SX:
        """With ``x_k`` the ``k``-th derivative by ``t/T`` of the input through ``1/Q``."""
        x, c = self.states.pose, self._coefficients
        last = (self.input_of("input") - sum(c[k] * x[k] for k in range(self.order))) / c[-1]
        return stack([*(x[k] for k in range(1, self.order)), last]) / self.delay.sx

    def outputs(self) -> Signals:
        """``Σ c_k (−1)ᵏ x_k`` with the highest derivative replaced."""
        x, c, n = self.states.pose, self._coefficients, self.order
        sign = (-1) ** n
        output = sum((c[k] * ((-1) ** k - sign) * x[k] for k in range(n)), ca.SX(0))
        return {"output": (output + sign * self.input_of("input"), "")}
