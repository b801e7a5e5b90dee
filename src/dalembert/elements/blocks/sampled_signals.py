"""Sampled signals: hold, delay, quantisation and states of discrete time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, option, quantity
from dalembert.elements.blocks.block import ordered_limits
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.stateful import signal
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, stack

LONGEST_DELAY = 1000
"""Upper limit of the number of samples of a delay, each of which is a state."""


@dataclass(eq=False)
class SampledState(Sampled):
    """``x⁺ = f(x⁻)`` at every sample, with a formula ``f`` of measures, ``t`` and parameters.

    The measure is ``value``. The formula may contain the state itself: assign it after the
    construction.

    Parameters
    ----------
    next : ``f`` [unit]
    start : value before the first sample
    unit : of the state

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("counter")
    >>> body = system.add(planar.Particle("body", mass=1.0))
    >>> count = system.add(da.blocks.SampledState("count", sample_time=0.1))
    >>> count.next = count.value + 1
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.05)
    >>> motion["count.value"][-1].item()  # samples at 0, 0.1, …, 0.9
    10.0
    """

    next: Scalar = signal(None, "value after a sample, a formula of measures, t and parameters")
    start: Scalar = quantity(None, "value before the first sample", default=0.0)
    unit: str = option("unit of the state", default="")

    held = ("value",)

    def state_units(self) -> Sequence[str]:
        return (self.unit,)

    def initial_states(self) -> Sequence[ca.SX | None]:
        return [self.start.sx]

    @property
    def value(self) -> Expression:
        """The state in formulas."""
        return self.measure("value")

    def sampled_outputs(self) -> ca.SX:
        return self.input_of("next")


@dataclass(eq=False)
class ZeroOrderHold(Sampled):
    """Sample and hold, ``w(t) = u(t_k)`` for ``t_k ≤ t < t_{k+1}``.

    Parameters
    ----------
    input : formula of measures

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sensor")
    >>> body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    >>> hold = system.add(da.blocks.ZeroOrderHold("hold", body.x, sample_time=0.2))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.05)
    >>> round(motion["hold.output"].sel(time=0.35, method="nearest").item(), 12)
    0.2
    """

    input: Scalar = signal(None, "formula of measures")

    def sampled_outputs(self) -> ca.SX:
        return self.input_of("input")


@dataclass(eq=False)
class Delay(Sampled):
    """Delay by ``n`` samples, ``w[k] = u[k − n]``.

    Parameters
    ----------
    input : formula of measures
    samples : ``n``, 1 to 1000
    start : input before the start

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sensor")
    >>> body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    >>> late = system.add(da.blocks.Delay("late", body.x, samples=3, sample_time=0.1))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.05)
    >>> round(motion["late.output"].sel(time=0.95, method="nearest").item(), 12)
    0.6
    """

    input: Scalar = signal(None, "formula of measures")
    samples: int = option("number of samples", default=1)
    start: Scalar = quantity(None, "input before the start", default=0.0)

    def __post_init__(self) -> None:
        if not isinstance(self.samples, int) or not 1 <= self.samples <= LONGEST_DELAY:
            text = f"samples is {self.samples!r}; give a number from 1 to {LONGEST_DELAY}"
            raise ModelError(text, f"{self.name}.samples")
        super().__post_init__()

    def memory_names(self) -> Sequence[str]:
        return tuple(f"earlier{k + 1}" for k in range(self.samples))

    def initial_states(self) -> Sequence[ca.SX | None]:
        return [self.start.sx] * len(self.state_names())

    def sampled_outputs(self) -> ca.SX:
        return self.memory[-1]

    def next_memory(self) -> ca.SX:
        return stack([self.input_of("input"), *(self.memory[k] for k in range(self.samples - 1))])


@dataclass(eq=False)
class Quantizer(Sampled):
    """Analog–digital converter, ``w[k] = q floor(u[k]/q + 1/2)`` within limits.

    The output is piecewise constant, so its derivative by the input is zero: gradients do not
    pass through it.

    Parameters
    ----------
    input : formula of measures
    resolution : ``q``
    lower, upper : limits of the output; none by default

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sensor")
    >>> body = system.add(planar.Particle("body", mass=1.0, velocity=(1.0, 0)))
    >>> adc = da.blocks.Quantizer("adc", body.x, resolution=0.25, sample_time=0.1)
    >>> part = system.add(adc)
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.05)
    >>> motion["adc.output"].sel(time=0.65, method="nearest").item()  # of 0.6
    0.5
    """

    input: Scalar = signal(None, "formula of measures")
    resolution: Scalar = quantity(None, "smallest difference of outputs", default=1.0, above=0.0)
    lower: Scalar = quantity(None, "lower limit of the output", default=None)
    upper: Scalar = quantity(None, "upper limit of the output", default=None)

    def conditions(self) -> list[Condition]:
        return ordered_limits(self.lower, self.upper)

    def sampled_outputs(self) -> ca.SX:
        q = self.resolution.sx
        output = q * ca.floor(self.input_of("input") / q + 0.5)
        if self.lower is not None:
            output = ca.fmax(output, self.lower.sx)
        if self.upper is not None:
            output = ca.fmin(output, self.upper.sx)
        return output
