"""Base class of sampled blocks: signals that change at sample instants and are held between."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.blocks.block import Block, Signals
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack


@dataclass(eq=False)
class Sampled(Block):
    """Signals of discrete time, ``w[k] = h(x[k], u[k])``, ``x[k+1] = g(x[k], u[k])``.

    The samples are at ``t_k = first_sample + k T``. Outputs are held until the next sample, so
    they are states of the model with the rate zero. A new block states ``memory_names``,
    ``sampled_outputs`` and, with a memory, ``next_memory``.

    Parameters
    ----------
    sample_time : ``T``, a number [s]
    first_sample : time of the first sample, a number [s]

    Raises
    ------
    ModelError
        No sample time, one that depends on parameters, or ``steady=True``.
    """

    sample_time: Scalar = quantity(
        "s", "time between samples", default=None, above=0.0, keyword=True
    )
    first_sample: Scalar = quantity("s", "time of the first sample", default=0.0, keyword=True)

    held: ClassVar[tuple[str, ...]] = ("output",)
    """Names of the outputs."""
    python_law: ClassVar[Any] = None
    """Function outside the graph that computes the outputs; None for formulas."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.sample_time is None:
            raise ModelError("has no sample_time; give sample_time=...", self.name)
        for field in ("sample_time", "first_sample"):
            if not getattr(self, field).sx.is_constant():
                text = "depends on parameters; samples are at fixed times, so give a number"
                raise ModelError(text, f"{self.name}.{field}")
        if self.steady:
            raise ModelError("has no steady start: it holds its states; give start=", self.name)

    @property
    def period(self) -> float:
        """``T`` [s]."""
        return float(self.sample_time.sx)

    @property
    def beginning(self) -> float:
        """Time of the first sample [s]."""
        return float(self.first_sample.sx)

    def held_names(self) -> Sequence[str]:
        """Names of the outputs."""
        return self.held

    def memory_names(self) -> Sequence[str]:
        """Names of ``x``."""
        return super().state_names()

    def state_names(self) -> Sequence[str]:
        return (*self.memory_names(), *self.held_names())

    def initial_states(self) -> Sequence[ca.SX | None]:
        """Start of ``x``; outputs are zero until the first sample."""
        memory = list(super().initial_states())[: len(self.memory_names())]
        return [*memory, *(ca.SX(0) for _ in self.held_names())]

    def rates(self) -> ca.SX:
        return ca.SX.zeros(len(self.state_names()))

    @property
    def memory(self) -> ca.SX:
        """Symbols of ``x``."""
        count = len(self.memory_names())
        return self.states.pose[:count] if count else ca.SX(0, 1)  # of one entry, [:0] is (1, 0)

    @property
    def held_symbols(self) -> ca.SX:
        """Symbols of the outputs."""
        return self.states.pose[len(self.memory_names()) :]

    def sampled_outputs(self) -> ca.SX:
        """``h`` at a sample."""
        raise NotImplementedError

    def next_memory(self) -> ca.SX:
        """``g`` at a sample."""
        return ca.SX(0, 1)

    def outputs(self) -> Signals:
        return {}


def sampled_values(blocks: Sequence[Sampled]) -> tuple[ca.SX, ca.SX]:
    """Symbols and new values of blocks with a common sample instant.

    An output that depends on outputs of other blocks takes their new values.

    Raises
    ------
    ModelError
        Outputs depend on each other in a cycle; names the blocks.
    """
    pending = {block: ca.densify(block.sampled_outputs()) for block in blocks}
    symbols: list[ca.SX] = []
    values: list[ca.SX] = []
    while pending:
        free = [
            block
            for block, output in pending.items()
            if not any(
                ca.depends_on(output, other.held_symbols)
                for other in pending
                if other is not block and other.held_symbols.numel()
            )
        ]
        if not free:
            names = ", ".join(block.name for block in pending)
            raise ModelError(
                f"{names} are sampled at the same instant and depend on each other's outputs; put "
                "a Delay between them"
            )
        done = stack(symbols), stack(values)
        for block in free:
            symbols.append(block.held_symbols)
            values.append(ca.substitute(pending.pop(block), *done))
    changed = stack(symbols), stack(values)
    following = [ca.densify(block.next_memory()) for block in blocks]
    memory = stack(block.memory for block in blocks)
    new = ca.substitute(stack(following), *changed)
    return ca.vertcat(memory, changed[0]), ca.vertcat(new, changed[1])
