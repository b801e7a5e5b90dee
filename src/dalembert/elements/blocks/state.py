"""A state with a rate of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.blocks.block import Block, Signals
from dalembert.elements.stateful import signal
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class State(Block):
    """``ẋ = f``, with a formula ``f`` of measures, ``t`` and parameters.

    Measures ``value`` and ``rate``. The formula may contain the state itself: assign it after the
    construction.

    Parameters
    ----------
    rate : ``f`` [unit/s]
    start : value at the start
    unit : of the state

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("heated bar")
    >>> bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    >>> hinge = system.add(planar.Revolute("hinge", system.ground.center, bar.start))
    >>> excess = system.add(da.blocks.State("excess", start=40.0, unit="K"))
    >>> excess.rate = -0.5 * excess.value  # cools down
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.01)
    >>> round(motion["excess.value"][-1].item(), 4)  # 40 exp(-1)
    14.7152
    """

    fixed_states = ("value",)

    rate: Scalar = signal(None, "rate of the state, a formula of measures, t and parameters")
    start: Scalar = quantity(None, "value at the start", default=0.0)
    unit: str = option("unit of the state", default="")

    def state_units(self) -> Sequence[str]:
        return (self.unit,)

    def initial_states(self) -> list[ca.SX]:
        return [self.start.sx]

    def rates(self) -> ca.SX:
        return self.input_of("rate")

    @property
    def value(self) -> Expression:
        """The state in formulas."""
        return self.measure("value")

    def outputs(self) -> Signals:
        unit = f"{self.unit}/s" if self.unit else "1/s"
        return {"rate": (self.input_of("rate"), unit)}
