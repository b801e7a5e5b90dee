"""Linear systems of several inputs and outputs, of continuous and of discrete time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Rows, option
from dalembert.elements.blocks.block import Block, Coefficients, Signals, coefficients
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.stateful import signals
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack


@dataclass(eq=False)
class StateSpace(Block):
    """``ẋ = A x + B u``, ``w = C x + D u``; outputs ``output1``, ``output2``, …

    Parameters
    ----------
    inputs : ``u``, formulas of measures, which may be assigned after the construction
    A, B, C : rows of numbers or formulas
    D : rows; zero by default
    start : (n,) states at the start; zero by default

    Raises
    ------
    ModelError
        Rows that do not fit.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lag")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> lag = da.blocks.StateSpace("lag", (body.x,), A=[[-10]], B=[[10]], C=[[3]])
    >>> part = system.add(lag)
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=1e-3)
    >>> round(motion["lag.output1"][-1].item(), 4)  # 3 · 2 (1 - exp(-1))
    3.7927
    """

    inputs: Coefficients = signals("formulas of measures")
    A: Rows = option("rows of the matrix of the states", default=())
    B: Rows = option("rows of the matrix of the inputs", default=())
    C: Rows = option("rows of the matrix of the outputs", default=())
    D: Rows = option("rows of the direct gains; zero by default", default=())
    start: Coefficients = option("states at the start; zero by default", default=())

    def __post_init__(self) -> None:
        self._a, self._b, self._c = (self._matrix(name) for name in "ABC")
        n = self._a.shape[0]
        self._d = self._matrix("D") if len(self.D) else ca.SX(self._c.shape[0], self._b.shape[1])
        shapes = {"A": (n, n), "B": (n, self._b.shape[1]), "C": (self._c.shape[0], n)}
        shapes["D"] = self._c.shape[0], self._b.shape[1]
        for name, shape in shapes.items():
            own = getattr(self, f"_{name.lower()}").shape
            if own != shape:
                text = f"is {own[0]} by {own[1]}; {shape[0]} by {shape[1]} fits the others"
                raise ModelError(text, f"{self.name}.{name}")
        if len(self.start) not in (0, n):
            text = f"has {len(self.start)} numbers for {n} states"
            raise ModelError(text, f"{self.name}.start")
        self.start = coefficients(self.start, f"{self.name}.start") if len(self.start) else ()
        super().__post_init__()

    def __setattr__(self, name: str, value: object) -> None:
        if name == "inputs" and value:
            value = coefficients(value, f"{self.name}.inputs")  # type: ignore[arg-type]
        super().__setattr__(name, value)

    def _matrix(self, field: str) -> ca.SX:
        """Rows of numbers or formulas as a matrix."""
        rows, entity = getattr(self, field), f"{self.name}.{field}"
        if not len(rows):
            raise ModelError("has no rows; give rows of numbers", entity)
        lines = [coefficients(row, f"{entity}[{k}]") for k, row in enumerate(rows)]
        if len({len(line) for line in lines}) > 1:
            raise ModelError("has rows of different lengths", entity)
        return ca.vertcat(*(ca.horzcat(*(value.sx for value in line)) for line in lines))

    @property
    def _signals(self) -> ca.SX:
        if len(self.inputs) != self._b.shape[1]:
            text = f"has {len(self.inputs)} inputs, B has {self._b.shape[1]} columns; give inputs"
            raise ModelError(text, self.name)
        return stack(value.sx for value in self.inputs)

    @property
    def _x(self) -> ca.SX:
        return self.states.pose[: self._a.shape[0]]

    def state_names(self) -> Sequence[str]:
        return tuple(f"state{k + 1}" for k in range(self._a.shape[0]))

    def initial_states(self) -> Sequence[ca.SX | None]:
        return [value.sx for value in self.start] or super().initial_states()

    def rates(self) -> ca.SX:
        return ca.mtimes(self._a, self._x) + ca.mtimes(self._b, self._signals)

    def outputs(self) -> Signals:
        outputs = ca.mtimes(self._c, self._x)
        if not self._d.is_zero():
            outputs += ca.mtimes(self._d, self._signals)
        return {f"output{k + 1}": (outputs[k], "") for k in range(outputs.numel())}


@dataclass(eq=False)
class SampledStateSpace(Sampled, StateSpace):
    """``x[k+1] = A x[k] + B u[k]``, ``w[k] = C x[k] + D u[k]``; outputs ``output1``, ``output2``, …

    Parameters
    ----------
    inputs : ``u``, formulas of measures, which may be assigned after the construction
    A, B, C : rows of numbers or formulas
    D : rows; zero by default
    start : (n,) states at the start; zero by default

    Raises
    ------
    ModelError
        Rows that do not fit.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sum")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(2.0, 0)))
    >>> rows = dict(A=[[1]], B=[[1]], C=[[1]], sample_time=0.1)
    >>> total = system.add(da.blocks.SampledStateSpace("total", (body.x,), **rows))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["total.state1"][-1].item()
    20.0
    """

    def held_names(self) -> Sequence[str]:
        return tuple(f"output{k + 1}" for k in range(self._c.shape[0]))

    def next_memory(self) -> ca.SX:
        return StateSpace.rates(self)

    def sampled_outputs(self) -> ca.SX:
        return stack(value for value, _ in StateSpace.outputs(self).values())
