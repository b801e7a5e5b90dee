"""Transfer functions of one input and one output, of continuous and of discrete time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.blocks.block import Block, Coefficients, Signals, coefficients
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.stateful import signal
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, stack


@dataclass(eq=False)
class TransferFunction(Block):
    """``G(s) = (b_m sᵐ + … + b_0)/(a_n sⁿ + … + a_0)``, ``m ≤ n``, in controllable canonical form.

    With ``a_n = 1``, ``ẋ_1 = x_2``, …, ``ẋ_n = u − Σ a_k x_{k+1}``, ``w = Σ c_k x_{k+1} + b_n u``,
    with ``c_k = b_k − a_k b_n`` (Kailath, Linear Systems, 1980, 2.1).

    Parameters
    ----------
    input : formula of measures
    numerator, denominator : coefficients, of the highest power first; numbers or formulas
    start : input at rest before the start, by which the states begin; needs ``a_0 ≠ 0``

    Raises
    ------
    ModelError
        No denominator, or a numerator of higher degree.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lag")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> function = da.blocks.TransferFunction("lag", body.x, numerator=(3,), denominator=(0.1, 1))
    >>> lag = system.add(function)  # 3/(0.1 s + 1)
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=1e-3)
    >>> round(motion["lag.output"][-1].item(), 4)  # 3 · 2 (1 - exp(-1))
    3.7927
    """

    input: Scalar = signal(None, "formula of measures")
    numerator: Coefficients = option("coefficients, highest power first", default=(1.0,))
    denominator: Coefficients = option("coefficients, highest power first", default=(1.0, 1.0))
    start: Scalar = quantity(None, "input before the start", default=0.0)

    def __post_init__(self) -> None:
        self.numerator = coefficients(self.numerator, f"{self.name}.numerator")
        self.denominator = coefficients(self.denominator, f"{self.name}.denominator")
        if len(self.numerator) > len(self.denominator):
            text = (
                f"the numerator has the degree {len(self.numerator) - 1}, above that of the "
                f"denominator, {len(self.denominator) - 1}; add a pole, such as a filter"
            )
            raise ModelError(text, self.name)
        if float_of(self.denominator[0]) == 0:
            text = "the first coefficient is 0; leave it out"
            raise ModelError(text, f"{self.name}.denominator")
        super().__post_init__()

    @property
    def degree(self) -> int:
        """Number of poles."""
        return len(self.denominator) - 1

    def state_names(self) -> Sequence[str]:
        return tuple(f"state{k + 1}" for k in range(self.degree))

    def initial_states(self) -> Sequence[ca.SX | None]:
        if float_of(self.start) == 0 or not self.degree:
            return super().initial_states()
        first = self.denominator[0].sx * self.start.sx / self.denominator[-1].sx
        return [first] + [ca.SX(0)] * (self.degree - 1)

    def rates(self) -> ca.SX:
        x, poles = self.states.pose[: self.degree], self._scaled(self.denominator)
        if not self.degree:
            return ca.SX(0, 1)
        last = self.input_of("input") - ca.dot(poles[:-1], x)
        return stack([*(x[k] for k in range(1, self.degree)), last])

    def outputs(self) -> Signals:
        x = self.states.pose[: self.degree]
        poles, zeros = self._scaled(self.denominator), self._zeros()
        output = ca.dot(zeros[:-1] - poles[:-1] * zeros[-1], x) if self.degree else ca.SX(0)
        if not zeros[-1].is_zero():
            output += zeros[-1] * self.input_of("input")
        return {"output": (output, "")}

    def _scaled(self, values: Sequence[Expression]) -> ca.SX:
        """Coefficients over ``a_n``, of the lowest power first."""
        return stack(value.sx for value in reversed(values)) / self.denominator[0].sx

    def _zeros(self) -> ca.SX:
        """(n + 1,) coefficients of the numerator, of the lowest power first."""
        zeros = self._scaled(self.numerator)
        return ca.vertcat(zeros, ca.SX.zeros(self.degree + 1 - zeros.numel()))


@dataclass(eq=False)
class SampledTransferFunction(Sampled, TransferFunction):
    """``G(z) = (b_m zᵐ + … + b_0)/(a_n zⁿ + … + a_0)``, ``m ≤ n``, in controllable canonical form.

    Parameters
    ----------
    input : formula of measures
    numerator, denominator : coefficients, of the highest power of ``z`` first; numbers or formulas
    start : input at rest before the start, by which the states begin; needs ``Σ a_k ≠ 0``

    Raises
    ------
    ModelError
        No denominator, or a numerator of higher degree.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lag")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> law = dict(numerator=(0.5,), denominator=(1, -0.5), sample_time=0.1)
    >>> lag = system.add(da.blocks.SampledTransferFunction("lag", body.x, **law))
    >>> motion = da.solve_dynamics(system.build(), 0.3, step=0.1)
    >>> motion["lag.output"].values.tolist()  # 2 (1 - 0.5^k)
    [0.0, 1.0, 1.5, 1.5]
    """

    def initial_states(self) -> Sequence[ca.SX | None]:
        if self.start.sx.is_zero() or not self.degree:
            return [ca.SX(0)] * len(self.state_names())
        rest = self.start.sx / ca.sum1(self._scaled(self.denominator))
        return [rest] * self.degree + [ca.SX(0)]

    def next_memory(self) -> ca.SX:
        return TransferFunction.rates(self)

    def sampled_outputs(self) -> ca.SX:
        return TransferFunction.outputs(self)["output"][0]


def float_of(value: Expression) -> float | None:
    """A constant; None for a formula."""
    return float(value.sx) if value.sx.is_constant() else None
