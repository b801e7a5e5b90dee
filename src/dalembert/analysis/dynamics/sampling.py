"""Samples of blocks of discrete time: instants, and transitions of zero length with derivatives.

Sample instants are fixed, so they are ends of steps and do not move with parameters. A sample reads
the state just before it, accelerations and multipliers included.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.variant import Variant
from dalembert.elements.blocks.sampled import Sampled, sampled_values
from dalembert.formulations.base import state_symbols
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.steps import Samples
from dalembert.integrators.step import GraphStep
from dalembert.model.graph.model import Model
from dalembert.symbolic.formulas.expression import stack

TOGETHER = 1e-9
"""Difference of sample instants, relative to the shortest sample time, that counts as zero."""
Due = tuple[Sampled, ...]
"""Blocks with a common sample instant."""


class Sample(Variant):
    """Sample of some blocks: a step of zero length between steps of a variant.

    Parameters
    ----------
    variant : Variant of the steps before and after
    blocks : sampled at this instant
    """

    def __init__(self, variant: Variant, blocks: Due):
        strategies = variant.formulation, variant.stabilization, variant.integrator
        super().__init__(variant.view, variant.rows, *strategies, variant.phases, variant.bare)
        self.variant, self.blocks = variant, blocks

    @cached_property
    def step(self) -> GraphStep:
        step = self.variant.step
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        x, p = ca.MX.sym("x", step.size), ca.MX.sym("p", step.parameter_count)
        state, memory = x[: step.state_size], x[step.state_size :]
        for stage in _stages(self.blocks):
            state = self._after(stage, t, state, p)
        memory = memory if step.begin is None else step.begin.function(t, state, p)
        function = ca.Function("sample", [t, h, x, p], [ca.vertcat(state, memory)])
        return GraphStep(_scalar(function), step.state_size, begin=step.begin)

    def _after(self, stage: Due, t: ca.MX, x: ca.MX, p: ca.MX) -> ca.MX:
        """The state after the samples of one stage."""
        e = self.equations
        block = stage[0]
        if block.python_law is not None:
            symbols = block.held_symbols
            reading = [block.python_law.reading, symbols]
            lifted = [ca.densify(self.view.lift(column)) for column in reading]
            values = block.python_law(t, *self._of_view(e, lifted, "plant").function(t, x, p))
        else:
            symbols, formulas = sampled_values(stage)
            values = self._of_view(e, [self.view.lift(formulas)], "sampled").function(t, x, p)
        rows, columns = (
            ca.jacobian(self.view.lift(symbols), state_symbols(e)).sparsity().get_triplet()
        )
        entries = [int(columns[k]) for k in np.argsort(rows)]
        others = [k for k in range(x.numel()) if k not in set(entries)]
        order = [int(k) for k in np.argsort([*others, *entries])]
        return ca.vertcat(x[others], values)[order]

    @property
    def conditioning(self) -> None:  # type: ignore[override]
        return None

    @property
    def attempt(self) -> Attempt | None:  # type: ignore[override]
        return self.variant.attempt


def _stages(blocks: Due) -> list[Due]:
    """Blocks whose values are computed together: before, by, and after Python functions."""
    functions = [block for block in blocks if block.python_law is not None]
    others = [block for block in blocks if block not in functions]
    if not functions:
        return [blocks]
    set_by = stack(block.held_symbols for block in functions)
    later = [block for block in others if ca.depends_on(block.sampled_outputs(), set_by)]
    first = tuple(block for block in others if block not in later)
    stages = [first, *((block,) for block in functions), tuple(later)]
    return [stage for stage in stages if stage]


def _scalar(function: ca.Function) -> ca.Function:
    """The function as one scalar graph, if it contains no other nodes."""
    try:
        return function.expand()
    except RuntimeError:
        return function


class Sampling:
    """Sampled blocks of a model with the transitions of their samples.

    Parameters
    ----------
    blocks : of the model
    variants : of the kernel, to which transitions are appended
    """

    def __init__(self, blocks: Due, variants: list[Variant]):
        self.blocks, self.variants = blocks, variants
        self.sets: list[Due] = []
        self._modes: dict[tuple[int, int], int] = {}

    @classmethod
    def of(cls, model: Model, variants: list[Variant]) -> Sampling | None:
        """The sampled blocks of a model; None if it has none."""
        blocks = tuple(e for e in model.parts.elements.values() if isinstance(e, Sampled))
        return cls(blocks, variants) if blocks else None

    def forget(self) -> None:
        """Forget the recorded values of Python functions, for a new run."""
        for block in self.blocks:
            if block.python_law is not None:
                block.python_law.record.clear()

    def mode(self, mode: int, due: int) -> int:
        """The mode of the sample of a set of blocks between steps of a mode."""
        key = (mode, due)
        if key not in self._modes:
            self.variants.append(Sample(self.variants[mode], self.sets[due]))
            self._modes[key] = len(self.variants) - 1
        return self._modes[key]

    def samples(self, start: float, end: float) -> Samples:
        """Samples from the start, and before the end."""
        times, due = self.instants(start, end)
        return Samples(times, due, self.mode)

    def instants(self, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
        """Times, and numbers of the sets of blocks that are sampled."""
        shortest = min(block.period for block in self.blocks)
        slack = TOGETHER * shortest
        rates = dict.fromkeys((block.period, block.beginning) for block in self.blocks)
        each = [_multiples(*rate, start, end, slack) for rate in rates]
        times = np.concatenate(each)
        number = np.repeat(np.arange(len(each)), [part.size for part in each])
        order = np.argsort(times, kind="stable")
        times, number = times[order], number[order]
        group = np.cumsum(np.diff(times, prepend=-np.inf) > slack) - 1
        distinct = times[np.flatnonzero(np.diff(group, prepend=-1))] if times.size else times
        members: list[list[int]] = [[] for _ in distinct]
        for k, rate in zip(group, number, strict=True):
            members[k].append(int(rate))
        due = np.array([self._set(rates, chosen) for chosen in members], dtype=int)
        return distinct, due

    def _set(self, rates: Iterable[tuple[float, float]], chosen: list[int]) -> int:
        """Number of the set of the blocks with some of the rates."""
        sampled = [rate for k, rate in enumerate(rates) if k in chosen]
        return self.number(tuple(b for b in self.blocks if (b.period, b.beginning) in sampled))

    def number(self, blocks: Due) -> int:
        """Number of a set of blocks."""
        if blocks not in self.sets:
            self.sets.append(blocks)
        return self.sets.index(blocks)


def _multiples(
    period: float, beginning: float, start: float, end: float, slack: float
) -> np.ndarray:
    """``beginning + k period`` from start to before the end, ``k ≥ 0``."""
    first = max(0, int(np.ceil((start - beginning - slack) / period)))
    last = int(np.ceil((end - beginning - slack) / period))
    return beginning + period * np.arange(first, max(last, first))
