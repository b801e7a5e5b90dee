"""Stepper: single steps of a model between its inputs and outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.stepping.jacobians import StepJacobians
from dalembert.analysis.stepping.lanes import Arrays, StepperLanes
from dalembert.analysis.stepping.step_map import LARGEST, StepMap
from dalembert.analysis.stepping.stepped_model import SteppedModel
from dalembert.analysis.stepping.stepper_state import StepperState
from dalembert.errors import SingularityError, SolverFailure
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.symbolic.evaluation.fixed_call import FixedCall, FixedCalls
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True, eq=False)
class _Way:
    """A step map with calls from each of two states to the other."""

    map: StepMap
    values: ca.Function
    calls: tuple[FixedCall, FixedCall]
    q: np.ndarray
    evaluator: str


class Stepper:
    """Steps of a model as a plant: inputs in, outputs out, the state inside.

    Inputs act constantly during a step; outputs are taken at its end. The steps are those of
    ``solve_dynamics`` with the length ``step/substeps``, as machine code in one call.

    Parameters
    ----------
    model : Model
    step : length of a step [s]
    substeps : number of integration steps in each
    inputs : names of parameters, by default ``model.inputs``
    outputs : measures by name or formula, by default ``model.outputs``
    parameters : new values
    **options : integrator, coordinates, formulation, stabilization, backend, as of ``Dynamics``;
        by default RK4 in the coordinates with the fewest operations, as machine code

    Raises
    ------
    UnsupportedError
        Rigid contacts, structures, or an integrator with error control.
    AnalysisError, ModelError
        Unknown names, or samples of blocks that are not at ends of substeps.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sled")
    >>> sled = system.add(planar.Particle("sled", mass=2.0))
    >>> thrust = system.input("thrust", unit="N")
    >>> drive = system.add(planar.Force("drive", sled.center, (thrust, 0)))
    >>> place, speed = system.output("place", sled.x), system.output("speed", sled.vx)
    >>> plant = da.Stepper(system.build(), step=0.1)
    >>> for _ in range(10):
    ...     y = plant.step(4.0)
    >>> y.round(9).tolist(), round(plant.time, 9)  # a t²/2, a t
    ([1.0, 2.0], 1.0)
    """

    @check_arguments
    def __init__(
        self,
        model: Model,
        step: float,
        *,
        substeps: int = 1,
        inputs: Sequence[str] | None = None,
        outputs: Sequence[Any] | None = None,
        parameters: Mapping[str, float] | None = None,
        **options: Any,
    ):
        self.plant = SteppedModel(
            model, step, substeps, inputs, outputs, dict(parameters or {}), options
        )
        self.model, self.length = model, self.plant.step
        self.input_names, self.output_names = self.plant.input_names, self.plant.output_names
        self._ways: dict[tuple[int, tuple[int, ...]], _Way] = {}
        self.reset()

    # starts ----------------------------------------------------------------------------
    @check_arguments
    def reset(
        self,
        parameters: Mapping[str, float] | None = None,
        *,
        initial: Mapping[str, float] | None = None,
        time: float = 0.0,
    ) -> np.ndarray:
        """Return to the start of the model; returns the outputs there.

        Parameters
        ----------
        parameters : new values, on which the start may depend; others are those of the stepper
        initial : values of entries of the state by ``state_names``, instead of those of the start
        time : of the start [s]

        Raises
        ------
        AnalysisError
            Unknown names, or entries that contradict the joints.
        AssemblyError
            The mechanism cannot be assembled with these parameters.
        """
        plant = self.plant
        p = plant.model.values({**plant.parameters, **(parameters or {})})
        usual = not parameters and not initial and time == 0.0
        x, mode = plant.start if usual else plant.begin(p, time, initial)
        self.restore(StepperState(0, time, x, p, mode))
        return self.outputs

    def save(self) -> StepperState:
        """The state, to be restored later."""
        self._p[self.plant.inputs] = self._u
        x = self._z[self._side][:-1]
        return StepperState(self._count, self._start, x.copy(), self._p.copy(), self._mode)

    def restore(self, state: StepperState) -> None:
        """Continue from a saved state; the following steps are identical to the last bit."""
        plant = self.plant
        self._count, self._start, self._mode = state.count, state.start, state.mode
        self._p = state.parameters.copy()
        if not hasattr(self, "_z") or self._z[0].size != state.x.size + 1:
            self._allocate(state.x.size)
        self._side = 0
        self._z[0][:-1], self._z[0][-1] = state.x, self.time
        self._u[:] = self._p[plant.inputs]
        for way in self._ways.values():
            way.q[:] = way.values(self._p[way.map.others]).full().ravel()
        self._way = self._way_of(self._mode, plant.due(self._count, self._start))

    def _allocate(self, size: int) -> None:
        self._ways.clear()
        self._z = np.zeros(size + 1), np.zeros(size + 1)
        self._u, self._y = np.zeros(len(self.plant.inputs)), np.zeros(self.plant.output_count)
        self._share = np.zeros(1)

    # steps -----------------------------------------------------------------------------
    def step(self, inputs: Any = None) -> np.ndarray:
        """Advance by one step; returns the outputs at its end.

        Parameters
        ----------
        inputs : values in the order of ``input_names``, [SI]; by default the last ones

        Raises
        ------
        SolverFailure
            The state is no longer finite, or equations have no solution; the state before the
            step remains.
        """
        if inputs is not None:
            self._u[:] = inputs
        if self.plant.phases is not None:
            self._way = self._way_of(self._mode, self.plant.due(self._count, self._start))
        side = self._side
        if not (self._way.calls[side]() and self._share[0] <= 1.0):
            self._repeat_by_other_variant()
        self._side = side = 1 - side
        self._count += 1
        self._z[side][-1] = self._start + self._count * self.length
        return self._y.copy()

    @property
    def time(self) -> float:
        """Time [s]."""
        return self._start + self._count * self.length  # type: ignore[no-any-return]

    @property
    def outputs(self) -> np.ndarray:
        """Outputs at the present state, with the last inputs."""
        self._p[self.plant.inputs] = self._u
        return self.plant.measure(self._mode, self.time, self.state, self._p)

    def snapshot(self) -> Motion:
        """The present state as a motion of one instant, for pictures and measures."""
        self._p[self.plant.inputs] = self._u
        return self.plant.snapshot(self._mode, self.time, self.state, self._p.copy())

    @property
    def state(self) -> np.ndarray:
        """State of the integrator, a copy: ``coordinates, speeds``, accumulated work, memory."""
        return self._z[self._side][:-1].copy()

    @property
    def state_names(self) -> list[str]:
        """Names of the coordinates and of their rates, the leading entries of ``state``."""
        return list(self.plant.entries_at(self.state.size).names)

    @property
    def backend(self) -> str:
        """Evaluator of the steps."""
        return self._way.evaluator

    def lanes(
        self, count: int, parameters: Arrays | None = None, workers: int | None = None
    ) -> StepperLanes:
        """Copies of this stepper that step side by side, from their own starts.

        Parameters
        ----------
        count : number of lanes
        parameters : new values, numbers or arrays of one for each lane
        workers : number of threads, by default one for each core
        """
        return StepperLanes(self.plant, count, parameters, workers)

    def jacobians(self, inputs: Any = None) -> StepJacobians:
        """Exact derivatives of the next step, without taking it.

        Parameters
        ----------
        inputs : values of the inputs; by default the last ones

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
        if inputs is not None:
            self._u[:] = inputs
        self._p[self.plant.inputs] = self._u
        way = self._way_of(self._mode, self.plant.due(self._count, self._start))
        return StepJacobians.at(way.map, self.plant, self.time, self.state, self._p)

    def _way_of(self, mode: int, due: tuple[int, ...]) -> _Way:
        """The step of a mode with samples before its substeps."""
        if (mode, due) not in self._ways:
            step_map = self.plant.map(mode, due)
            values, function = step_map.split
            q = values(self._p[step_map.others]).full().ravel()
            calls, (one, other) = FixedCalls(function, self.plant.compiled), self._z
            results = self._y, self._share
            pair = tuple(
                calls.on((a, self._u, q), (b, *results)) for a, b in ((one, other), (other, one))
            )
            self._ways[mode, due] = _Way(step_map, values, pair, q, calls.report)  # type: ignore[arg-type]
        return self._ways[mode, due]

    def _repeat_by_other_variant(self) -> None:
        """Repeat a refused step with the equations that suit the state, if there are others."""
        x, side = self.state, self._side
        self._p[self.plant.inputs] = self._u
        place = f"the step from t = {self.time:.6g} s"
        try:
            mode = self.plant.kernel.choose(self.time, x, self._p)
        except SingularityError as error:
            raise SolverFailure(f"{place} fails: {error}") from None
        if mode != self._mode:
            way = self._way_of(mode, self.plant.due(self._count, self._start))
            if way.calls[side]() and self._share[0] <= 1.0:
                self._mode, self._way = mode, way
                return
        residual, following = self._share[0], self._z[1 - side]
        raise SolverFailure(
            f"{place} fails: "
            + (
                "the state would not be finite; use a shorter step or more substeps"
                if not np.abs(following).sum() < LARGEST
                else f"its equations are ill-conditioned ({residual:.3g} times the limit)"
            )
        )
