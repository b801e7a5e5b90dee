"""Controller as a Python function, called once per sample."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import option
from dalembert.elements.blocks.block import Coefficients, coefficients
from dalembert.elements.blocks.sampled import Sampled
from dalembert.elements.stateful import signals
from dalembert.errors import AnalysisError
from dalembert.symbolic.formulas.expression import stack

Law = Callable[[float, dict[str, float]], Any]
"""``(t, outputs of the plant) → its inputs``: a mapping by name, or numbers in their order."""


@dataclass(eq=False)
class SampledFunction(Sampled):
    """``u[k] = f(t_k, y[k])`` by a Python function, which may have a memory of its own.

    Each instant is evaluated once; repetitions of the run take the recorded values.

    Parameters
    ----------
    function : ``f``, see ``solve_dynamics``
    signals_in : ``y``, formulas of measures
    arguments : names of ``y``
    results : names of ``u``
    starts : values of ``u`` before the first sample
    """

    function: Law = option("Python function")
    signals_in: Coefficients = signals("formulas of measures")
    arguments: tuple[str, ...] = option("names of the signals", default=())
    results: tuple[str, ...] = option("names of the outputs", default=())
    starts: Coefficients = option("outputs before the first sample", default=())

    def __post_init__(self) -> None:
        self.starts = coefficients(self.starts, f"{self.name}.starts")
        super().__post_init__()
        self.python_law = PythonLaw(self)  # type: ignore[misc]

    def __setattr__(self, name: str, value: Any) -> None:
        if name == "signals_in" and value:
            value = coefficients(value, f"{self.name}.signals_in")
        super(Sampled, self).__setattr__(name, value)

    def held_names(self) -> Sequence[str]:
        return self.results

    def initial_states(self) -> Sequence[ca.SX | None]:
        return [start.sx for start in self.starts]

    @property
    def connected(self) -> bool:
        return True


class PythonLaw(ca.Callback):
    """``(t, y) → u`` of a Python function, recorded.

    Attributes
    ----------
    error : exception of the function, raised after the run; None without
    """

    def __init__(self, block: SampledFunction):
        ca.Callback.__init__(self)
        self.block, self.record = block, dict[float, np.ndarray]()
        self.error: BaseException | None = None
        self.construct(block.name, {})

    @property
    def reading(self) -> ca.SX:
        """Formulas of ``y``."""
        return stack(value.sx for value in self.block.signals_in)

    def get_n_in(self) -> int:
        return 3

    def get_n_out(self) -> int:
        return 1

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        sizes = 1, len(self.block.arguments), len(self.block.results)
        return ca.Sparsity.dense(sizes[i], 1)

    def get_sparsity_out(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(len(self.block.results), 1)

    def eval(self, arguments: Sequence[ca.DM]) -> list[ca.DM]:
        t = float(arguments[0])
        if t not in self.record:
            values = arguments[1].full().ravel().tolist()
            held = arguments[2].full().ravel()
            try:
                outputs = dict(zip(self.block.arguments, values, strict=True))
                self.record[t] = self._inputs(self.block.function(t, outputs), held)
            except BaseException as error:  # CasADi would lose its type
                self.error = error
                return [ca.DM(np.full(held.size, np.nan))]
        return [ca.DM(self.record[t])]

    def _inputs(self, result: Any, held: np.ndarray) -> np.ndarray:
        """Values of all inputs; those that a mapping lacks keep their values."""
        names = self.block.results
        if isinstance(result, Mapping):
            if wrong := [name for name in result if name not in names]:
                text = f"the controller returned {wrong[0]!r}; the inputs are {', '.join(names)}"
                raise AnalysisError(text)
            pairs = zip(names, held, strict=True)
            result = [result.get(name, value) for name, value in pairs]
        column = np.atleast_1d(np.asarray(result, dtype=float)).ravel()
        if column.size != len(names) or not np.all(np.isfinite(column)):
            raise AnalysisError(
                f"the controller returned {result!r:.60}; return finite values of "
                f"{', '.join(names)}, as a dict or in this order"
            )
        return column
