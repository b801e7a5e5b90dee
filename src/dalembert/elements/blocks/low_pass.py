"""Low-pass filter of Butterworth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.blocks.block import Block, Signals
from dalembert.elements.stateful import signal
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack

HIGHEST = 20
"""Upper limit of the order of a filter."""


@dataclass(eq=False)
class LowPass(Block):
    """Butterworth filter, ``|G(iω)|² = 1/(1 + (ω/ω_c)^(2n))``; of first order ``1/(1 + s/ω_c)``.

    A cascade of sections of second order with unit gain, and one of first order if ``n`` is odd
    (Butterworth 1930).

    Parameters
    ----------
    input : formula of measures
    cutoff : ``ω_c``, where the gain is ``1/√2`` [rad/s]
    order : ``n``, 1 to 20
    start : input at rest before the start, by which the states begin

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sensor")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> smooth = system.add(da.blocks.LowPass("smooth", body.x, cutoff=10.0))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=1e-3)
    >>> round(motion["smooth.output"][-1].item(), 4)  # 2 (1 - exp(-1))
    1.2642
    """

    input: Scalar = signal(None, "formula of measures")
    cutoff: Scalar = quantity("rad/s", "angular frequency of the gain 1/√2", default=1.0, above=0.0)
    order: int = option("order", default=1)
    start: Scalar = quantity(None, "input before the start", default=0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.order, int) or not 1 <= self.order <= HIGHEST:
            text = f"order is {self.order!r}; give a number from 1 to {HIGHEST}"
            raise ModelError(text, f"{self.name}.order")
        super().__post_init__()

    def state_names(self) -> Sequence[str]:
        return tuple(f"state{k + 1}" for k in range(self.order))

    def initial_states(self) -> list[ca.SX]:
        values: list[ca.SX] = []
        for _ in range(self.order // 2):
            values += [self.start.sx, ca.SX(0)]
        return values + [self.start.sx] * (self.order % 2)

    def rates(self) -> ca.SX:
        """Of each section ``z̈ + 2 ζ ω_c ż + ω_c² z = ω_c² u``, the states ``z`` and ``ż/ω_c``."""
        x, w, u, rates = self.states.pose, self.cutoff.sx, self.input_of("input"), []
        for k in range(self.order // 2):
            z, slope = x[2 * k], x[2 * k + 1]
            damping = 2 * math.sin(math.pi * (2 * k + 1) / (2 * self.order))
            rates += [w * slope, w * (u - z - damping * slope)]
            u = z
        if self.order % 2:
            rates.append(w * (u - x[-1]))
        return stack(rates)

    def outputs(self) -> Signals:
        return {"output": (self.states.pose[-1 if self.order % 2 else -2], "")}
