"""Lead–lag element."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.blocks.block import Block, Signals
from dalembert.elements.stateful import signal


@dataclass(eq=False)
class LeadLag(Block):
    """``G(s) = K (1 + T₁ s)/(1 + T₂ s)``: lead for ``T₁ > T₂``, lag for ``T₁ < T₂``.

    Parameters
    ----------
    input : formula of measures
    lead : ``T₁`` [s]
    lag : ``T₂`` [s]
    gain : ``K``
    start : input at rest before the start

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lag")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> lag = system.add(da.blocks.LeadLag("lag", body.x, lead=0.0, lag=0.1))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=1e-3)
    >>> round(motion["lag.output"][-1].item(), 4)  # 2 (1 - exp(-1))
    1.2642
    """

    fixed_states = ("state",)

    input: Scalar = signal(None, "formula of measures")
    lead: Scalar = quantity("s", "time constant of the numerator", default=0.0, minimum=0.0)
    lag: Scalar = quantity("s", "time constant of the denominator", default=1.0, above=0.0)
    gain: Scalar = quantity(None, "gain at rest", default=1.0)
    start: Scalar = quantity(None, "input before the start", default=0.0)

    def initial_states(self) -> list[ca.SX]:
        return [self.start.sx]

    def rates(self) -> ca.SX:
        return (self.input_of("input") - self.states.pose) / self.lag.sx

    def outputs(self) -> Signals:
        share = self.lead.sx / self.lag.sx
        x = self.states.pose
        direct = 0 if share.is_zero() else share * (self.input_of("input") - x)
        return {"output": (self.gain.sx * (x + direct), "")}
