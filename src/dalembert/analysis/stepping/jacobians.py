"""Exact derivatives of one step in minimal coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dalembert.symbolic.evaluation.kernel import Kernel

if TYPE_CHECKING:
    from dalembert.analysis.stepping.step_map import StepMap
    from dalembert.analysis.stepping.stepped_model import SteppedModel


@dataclass(frozen=True, eq=False)
class StepJacobians:
    """``δx⁺ = A δx + B δu``, ``δy = C δx + D δu`` of one step; outputs are taken at its end.

    ``δx`` are changes of independent entries of the state; the others follow from the joints.

    Attributes
    ----------
    state_names, input_names, output_names : of the rows and columns
    state : ``A`` (n, n)
    input : ``B`` (n, nu)
    output_state : ``C`` (ny, n)
    output_input : ``D`` (ny, nu)
    """

    state_names: list[str]
    input_names: list[str]
    output_names: list[str]
    state: np.ndarray
    input: np.ndarray
    output_state: np.ndarray
    output_input: np.ndarray
    _step: tuple

    @classmethod
    def at(
        cls, step: StepMap, plant: SteppedModel, t: float, x: np.ndarray, p: np.ndarray
    ) -> StepJacobians:
        """Derivatives of a step from a state."""
        entries = plant.entries
        basis, free = entries.basis(t, x, p), entries.free
        arguments = np.append(x, t), p[step.inputs], p[step.others]
        by_state, by_input, output, direct = Kernel(step.jacobian)(*arguments)
        return cls(
            [entries.name(k) for k in free],
            plant.input_names,
            plant.output_names,
            by_state[free, :-1] @ basis,
            by_input[free],
            output[:, :-1] @ basis,
            direct,
            (step, arguments, basis, free),
        )

    def adjoint(
        self, state_weight: np.ndarray, output_weight: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """``Aᵀ w + Cᵀ v`` and ``Bᵀ w + Dᵀ v`` by one reverse evaluation, without the matrices.

        Parameters
        ----------
        state_weight, output_weight : ``w`` (n,) and ``v`` (ny,), zero by default
        """
        step, arguments, basis, free = self._step
        weight = np.zeros(arguments[0].size)
        weight[free] = state_weight
        outputs = np.zeros(len(self.output_names)) if output_weight is None else output_weight
        by_state, by_input = Kernel(step.adjoint)(*arguments, weight, outputs)
        return basis.T @ by_state.ravel()[:-1], by_input.ravel()
