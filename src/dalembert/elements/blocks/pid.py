"""PID controllers with limits, of continuous and of discrete time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, quantity
from dalembert.elements.blocks.block import Block, Signals, ordered_limits
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.stateful import signal
from dalembert.symbolic.formulas.expression import stack


@dataclass(eq=False)
class PID(Block):
    """Controller of a measured signal ``y`` to its setpoint ``r``.

        v = K (β r − y) + z + D s/(1 + T_f s) (γ r − y),    w = min(max(v, lower), upper)
        ż = I (r − y) + (w − v)/T_t

    With limits the integral follows the limited output within the tracking time ``T_t``, so that
    it does not wind up (Åström & Hägglund, Advanced PID Control, 2006, 3.4 and 3.5). Without the
    gain ``I`` there is no integral, and ``z`` is the constant ``start``. The filter of the
    derivative starts at rest, at ``γ r − y``.

    Parameters
    ----------
    setpoint, measured : ``r`` and ``y``, formulas of measures and ``t``
    proportional, integral, derivative : gains ``K``, ``I`` [1/s], ``D`` [s]
    filter_time : ``T_f`` of the derivative [s]
    setpoint_weight, derivative_weight : ``β``, ``γ``
    lower, upper : limits of the output; none by default
    tracking_time : ``T_t`` [s]
    start : ``z`` at the start

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lift", gravity=(0, -10))
    >>> cabin = system.add(planar.Particle("cabin", mass=2.0))
    >>> ends = system.ground.center, cabin.center
    >>> rail = system.add(planar.PinInSlot("rail", *ends, axis=(0, 1)))
    >>> gains = dict(proportional=80.0, integral=60.0, derivative=40.0, filter_time=0.01)
    >>> control = system.add(da.blocks.PID("control", 1.0, cabin.y, **gains))
    >>> drive = system.add(planar.Force("drive", cabin.center, (0, control.output)))
    >>> motion = da.solve_dynamics(system.build(), 20.0, step=2e-3)
    >>> round(motion["cabin.y"][-1].item(), 3), round(motion["control.output"][-1].item(), 3)
    (1.0, 20.0)
    """

    setpoint: Scalar = signal(None, "setpoint, a formula of measures and t", default=0.0)
    measured: Scalar = signal(None, "controlled signal, a formula of measures")
    proportional: Scalar = quantity(None, "gain K", default=1.0)
    integral: Scalar = quantity(None, "gain I of the integral", default=0.0)
    derivative: Scalar = quantity(None, "gain D of the derivative", default=0.0)
    filter_time: Scalar = quantity("s", "time constant of the derivative", default=0.01, above=0.0)
    setpoint_weight: Scalar = quantity("", "weight β of the setpoint", default=1.0)
    derivative_weight: Scalar = quantity("", "weight γ in the derivative", default=0.0)
    lower: Scalar = quantity(None, "lower limit of the output", default=None)
    upper: Scalar = quantity(None, "upper limit of the output", default=None)
    tracking_time: Scalar = quantity("s", "time of the anti-windup", default=1.0, above=0.0)
    start: Scalar = quantity(None, "integral at the start", default=0.0)

    def state_names(self) -> Sequence[str]:
        names = (("integral", self._integrates), ("filtered", self._differentiates))
        return tuple(name for name, present in names if present)

    @property
    def _integrates(self) -> bool:
        return not self.integral.sx.is_zero()

    @property
    def _differentiates(self) -> bool:
        return not self.derivative.sx.is_zero()

    def initial_states(self) -> Sequence[ca.SX | None]:
        starts = {"integral": self.start.sx, "filtered": None}
        return [starts[name] for name in self.state_names()]

    def conditions(self) -> list[Condition]:
        return ordered_limits(self.lower, self.upper)

    def rates(self) -> ca.SX:
        r, y = self.input_of("setpoint"), self.input_of("measured")
        wish, output = self._outputs()
        rates = []
        if self._integrates:
            rates.append(self.integral.sx * (r - y) + (output - wish) / self.tracking_time.sx)
        if self._differentiates:
            rates.append((self._differentiated - self.states.pose[-1]) / self.filter_time.sx)
        return stack(rates)

    @property
    def _differentiated(self) -> ca.SX:
        """``γ r − y``."""
        return self.derivative_weight.sx * self.input_of("setpoint") - self.input_of("measured")

    def _derived(self) -> ca.SX:
        """Output of the derivative part."""
        change = self._differentiated - self.states.pose[-1]
        return self.derivative.sx * change / self.filter_time.sx

    def _outputs(self) -> tuple[ca.SX, ca.SX]:
        """``v`` and ``w``."""
        r, y = self.input_of("setpoint"), self.input_of("measured")
        wish = self.proportional.sx * (self.setpoint_weight.sx * r - y)
        wish += self.states.pose[0] if self._integrates else self.start.sx
        if self._differentiates:
            wish += self._derived()
        output = wish
        if self.lower is not None:
            output = ca.fmax(output, self.lower.sx)
        if self.upper is not None:
            output = ca.fmin(output, self.upper.sx)
        return wish, output

    def outputs(self) -> Signals:
        wish, output = self._outputs()
        error = self.input_of("setpoint") - self.input_of("measured")
        return {"output": (output, ""), "unlimited": (wish, ""), "error": (error, "")}


@dataclass(eq=False)
class SampledPID(Sampled, PID):
    """PID controller of discrete time, with the parameters of ``PID``.

        v[k] = K (β r − y) + z[k] + d[k],    w[k] = min(max(v, lower), upper)
        z[k+1] = z[k] + T I (r − y) + (T/T_t) (w − v)
        d[k] = (T_f d[k−1] + D (c[k] − c[k−1]))/(T_f + T),    c = γ r − y

    Forward differences for the integral, backward differences for the derivative (Åström &
    Wittenmark, Computer-Controlled Systems, 1997, 8.5). The derivative begins at the second sample.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lift", gravity=(0, -10))
    >>> cabin = system.add(planar.Particle("cabin", mass=2.0))
    >>> ends = system.ground.center, cabin.center
    >>> rail = system.add(planar.PinInSlot("rail", *ends, axis=(0, 1)))
    >>> gains = dict(proportional=80.0, integral=60.0, derivative=40.0, sample_time=0.01)
    >>> control = system.add(da.blocks.SampledPID("control", 1.0, cabin.y, **gains))
    >>> drive = system.add(planar.Force("drive", cabin.center, (0, control.output)))
    >>> motion = da.solve_dynamics(system.build(), 20.0, step=5e-3)
    >>> round(motion["cabin.y"][-1].item(), 3), round(motion["control.output"][-1].item(), 3)
    (1.0, 20.0)
    """

    def memory_names(self) -> Sequence[str]:
        names = ("integral",) if self._integrates else ()
        return (*names, "derived", "previous", "running") if self._differentiates else names

    def initial_states(self) -> Sequence[ca.SX | None]:
        starts = {"integral": self.start.sx}
        return [starts.get(name, ca.SX(0)) for name in self.state_names()]

    def _derived(self) -> ca.SX:
        """``d[k]``; zero at the first sample."""
        derived, previous, running = ca.vertsplit(self.memory[-3:])
        step = self.derivative.sx * (self._differentiated - previous)
        time = self.filter_time.sx
        return running * (time * derived + step) / (time + self.period)

    def sampled_outputs(self) -> ca.SX:
        return self._outputs()[1]

    def next_memory(self) -> ca.SX:
        r, y = self.input_of("setpoint"), self.input_of("measured")
        wish, output = self._outputs()
        values = []
        if self._integrates:
            rate = self.integral.sx * (r - y) + (output - wish) / self.tracking_time.sx
            values.append(self.memory[0] + self.period * rate)
        if self._differentiates:
            values += [self._derived(), self._differentiated, ca.SX(1)]
        return stack(values)
