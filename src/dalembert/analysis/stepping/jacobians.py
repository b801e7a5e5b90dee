"""Exact derivatives of one step in minimal coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dalembert.analysis.stepping.output_names import names_of
from dalembert.results.state_space import StateSpace
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

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sled")
    >>> sled = system.add(planar.Particle("sled", mass=2.0))
    >>> rail = planar.PinInSlot("rail", system.ground.center, sled.center)
    >>> joint, thrust = system.add(rail), system.input("thrust", unit="N")
    >>> drive = system.add(planar.Force("drive", sled.center, (thrust, 0)))
    >>> jacobians = da.Stepper(system.build(), step=0.1, outputs=["sled.x"]).jacobians()
    >>> jacobians.state.round(9).tolist()
    [[1.0, 0.1], [0.0, 1.0]]
    >>> jacobians.input.round(9).ravel().tolist(), jacobians.output_input.round(9).item()
    ([0.0025, 0.05], 0.0025)
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

    @property
    def state_space(self) -> StateSpace:
        """``δx[k+1] = A δx[k] + B δu[k]``, ``δy[k] = C δx[k] + D δu[k]``.

        Outputs are taken at the beginning of the step, just before samples of blocks; those at its
        end are ``output_state`` and ``output_input``.
        """
        step, arguments, basis, _ = self._step
        by_state, by_input = Kernel(step.reading)(*arguments)
        model, names = step.kernel.model, self.input_names
        units = {name: model.parameters[name].unit for name in names}
        for measure in step.outputs:
            units |= dict.fromkeys(names_of([measure]), measure.unit)
        signals = self.state_names, names, self.output_names
        matrices = self.state, self.input, by_state[:, :-1] @ basis, by_input
        length = step.h * len(step.due)
        return StateSpace(*matrices, *signals, units, self._sizes, model.name, length)

    @property
    def _sizes(self) -> np.ndarray:
        """Natural sizes of the independent entries; one for the memory of integrators."""
        step, _, _, free = self._step
        scales = step.kernel.equations.scales
        sizes = np.concatenate([scales.coordinates, scales.speeds])
        return np.array([sizes[k] if k < sizes.size else 1.0 for k in free])

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
