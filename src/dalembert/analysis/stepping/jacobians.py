"""Exact derivatives of one step in minimal coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
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
    Changes ``δp`` of parameters, before the step and during it, add ``E δp`` and ``F δp``; joints
    that depend on them move the other entries. Of steps one after the other, the derivatives by the
    parameters follow from ``S⁺ = A S + E`` with those of the start, ``Stepper.start_jacobian``.

    Attributes
    ----------
    state_names, input_names, output_names, parameter_names : of the rows and columns
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

    By the mass, ``∂(F h/m)/∂m = −F h/m²``; the initial speed is no function of it:

    >>> system = da.System("throw")
    >>> m, u = system.parameter("m", 2.0, "kg"), system.parameter("u", 1.0, "m/s")
    >>> ball = system.add(planar.Particle("ball", mass=m, velocity=(u, 0)))
    >>> push = system.add(planar.Force("push", ball.center, (3.0, 0)))
    >>> plant = da.Stepper(system.build(), step=0.1, outputs=["ball.vx"])
    >>> jacobians = plant.jacobians()
    >>> jacobians.parameter_names, jacobians.output_parameter.round(9).tolist()
    (['m', 'u'], [[-0.075, 0.0]])
    >>> dict(zip(jacobians.state_names, plant.start_jacobian().tolist()))["rate of ball.x"]
    [0.0, 1.0]
    """

    state_names: list[str]
    input_names: list[str]
    output_names: list[str]
    state: np.ndarray
    input: np.ndarray
    output_state: np.ndarray
    output_input: np.ndarray
    parameter_names: list[str]
    _step: tuple

    @classmethod
    def at(
        cls, step: StepMap, plant: SteppedModel, t: float, x: np.ndarray, p: np.ndarray
    ) -> StepJacobians:
        """Derivatives of a step from a state."""
        entries = plant.entries
        basis, free = entries.basis(t, x, p), entries.free
        names = list(plant.model.parameters)
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
            [names[k] for k in step.others],
            (step, arguments, basis, free, lambda: entries.shift(t, x, p)[:, step.others]),
        )

    @property
    def parameter(self) -> np.ndarray:
        """``E`` (n, np): independent entries after the step by the parameters."""
        return self._by_parameters[0]

    @property
    def output_parameter(self) -> np.ndarray:
        """``F`` (ny, np): outputs at the end of the step by the parameters."""
        return self._by_parameters[1]

    @cached_property
    def _by_parameters(self) -> tuple[np.ndarray, np.ndarray]:
        step, arguments, _, free, shift = self._step
        moved = shift()
        by_state, direct, output, output_direct = Kernel(step.by_parameters)(*arguments)
        state = (by_state[:, :-1] @ moved + direct)[free]
        return state, output[:, :-1] @ moved + output_direct

    @property
    def state_space(self) -> StateSpace:
        """``δx[k+1] = A δx[k] + B δu[k]``, ``δy[k] = C δx[k] + D δu[k]``.

        Outputs are taken at the beginning of the step, just before samples of blocks; those at its
        end are ``output_state`` and ``output_input``.
        """
        step, arguments, basis, *_ = self._step
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
        step, _, _, free, _ = self._step
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
        step, arguments, basis, *_ = self._step
        weights = self._weights(state_weight, output_weight)
        by_state, by_input = Kernel(step.adjoint)(*arguments, *weights)
        return basis.T @ by_state.ravel()[:-1], by_input.ravel()

    def parameter_adjoint(
        self, state_weight: np.ndarray, output_weight: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``Aᵀ w + Cᵀ v``, ``Bᵀ w + Dᵀ v`` and ``Eᵀ w + Fᵀ v`` by one reverse evaluation.

        Parameters
        ----------
        state_weight, output_weight : ``w`` (n,) and ``v`` (ny,), zero by default
        """
        step, arguments, basis, _, shift = self._step
        weights = self._weights(state_weight, output_weight)
        pulled = Kernel(step.parameter_adjoint)(*arguments, *weights)
        by_state, by_input, direct = (part.ravel() for part in pulled)
        by_state = by_state[:-1]
        return basis.T @ by_state, by_input, direct + shift().T @ by_state

    def _weights(
        self, state_weight: np.ndarray, output_weight: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Weights of ``z⁺`` and of the outputs."""
        _, arguments, _, free, _ = self._step
        weight = np.zeros(arguments[0].size)
        weight[free] = state_weight
        none = np.zeros(len(self.output_names))
        return weight, none if output_weight is None else output_weight
