"""A step as calls on fixed arrays, from each of two states to the other."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np

from dalembert.analysis.stepping.step_map import LARGEST, StepMap
from dalembert.analysis.stepping.stepped_model import SteppedModel
from dalembert.symbolic.evaluation.fixed_call import FixedCall, FixedCalls


class StepArrays(NamedTuple):
    """Arrays of a step: a pair of states with inputs, which alternate, and the results.

    Attributes
    ----------
    z : two states ``[x; t]``
    u : inputs of the steps from each of them
    y : outputs
    share : validity, as of ``StepMap``
    """

    z: tuple[np.ndarray, np.ndarray]
    u: tuple[np.ndarray, np.ndarray]
    y: np.ndarray
    share: np.ndarray

    @classmethod
    def of(cls, size: int, inputs: int, outputs: int) -> StepArrays:
        """Zeros for states of a size and numbers of inputs and outputs."""
        states, values = ((np.zeros(n), np.zeros(n)) for n in (size + 1, inputs))
        return cls(states, values, np.zeros(outputs), np.zeros(1))

    def obstacle(self, side: int, solved: int, names: list[str]) -> str:
        """Reason of a failed step from the state ``side``.

        Parameters
        ----------
        solved : result of the call
        names : of the outputs
        """
        if not solved:
            return "its equations have no solution that Newton's method reaches"
        if not np.abs(self.z[1 - side]).sum() < LARGEST:
            return "the state would not be finite"
        for name, value in zip(names, self.y, strict=True):
            if not abs(value) < LARGEST:
                return f"the output {name} would be {value:.6g}"
        return f"its equations are ill-conditioned ({self.share[0]:.3g} times the limit)"


@dataclass(frozen=True, eq=False)
class BoundStep:
    """Calls of a step map on arrays.

    Attributes
    ----------
    map : StepMap
    values : ``r → q``, as of ``StepMap.split``
    q : its results
    calls : from each of two states to the other
    evaluator : name of the evaluator
    """

    map: StepMap
    values: ca.Function
    q: np.ndarray
    calls: tuple[FixedCall, ...]
    evaluator: str

    @classmethod
    def of(cls, step_map: StepMap, arrays: StepArrays, p: np.ndarray, compiled: bool) -> BoundStep:
        """Calls with the values of all parameters; ``compiled`` by machine code."""
        values, function = step_map.split
        q = values(p[step_map.others]).full().ravel()
        calls, results = FixedCalls(function, compiled), (arrays.y, arrays.share)
        pair = tuple(
            calls.on((arrays.z[side], arrays.u[side], q), (arrays.z[1 - side], *results))
            for side in (0, 1)
        )
        return cls(step_map, values, q, pair, calls.report)

    def renew(self, p: np.ndarray) -> None:
        """Use other values of the parameters."""
        self.q[:] = self.values(p[self.map.others]).full().ravel()


class BoundSteps:
    """Steps of a plant on common arrays, by mode and samples before substeps.

    Parameters
    ----------
    plant : SteppedModel

    Attributes
    ----------
    arrays : StepArrays
    """

    def __init__(self, plant: SteppedModel):
        self.plant = plant
        inputs, outputs = len(plant.input_names), plant.output_count
        self.arrays = StepArrays.of(plant.start[0].size, inputs, outputs)
        self._steps: dict[tuple[int, tuple[int, ...]], BoundStep] = {}

    def at(self, mode: int, due: tuple[int, ...], p: np.ndarray) -> BoundStep:
        """The step of a mode with samples before its substeps, for values of the parameters."""
        if (mode, due) not in self._steps:
            arguments = self.plant.map(mode, due), self.arrays, p, self.plant.compiled
            self._steps[mode, due] = BoundStep.of(*arguments)
        return self._steps[mode, due]

    def renew(self, p: np.ndarray) -> None:
        """Use other values of the parameters."""
        for step in self._steps.values():
            step.renew(p)
