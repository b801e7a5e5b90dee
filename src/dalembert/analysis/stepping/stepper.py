"""Stepper: single steps of a model between its inputs and outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.analysis.stepping.bound_step import BoundStep, BoundSteps
from dalembert.analysis.stepping.input_values import input_values, refuse_infinite, wrong_inputs
from dalembert.analysis.stepping.jacobians import StepJacobians
from dalembert.analysis.stepping.lanes import Arrays, StepperLanes
from dalembert.analysis.stepping.stepped_model import SteppedModel
from dalembert.analysis.stepping.stepper_state import StepperState
from dalembert.errors import SingularityError, StepFailure, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.state_space import StateSpace
from dalembert.text.arguments import check_arguments

SHORTER = "use a shorter step, more substeps or another integrator"
"""Remedy of a failed step."""


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
        self._several = len(self.input_names) != 1
        self._steps = BoundSteps(self.plant)
        self._arrays = self._steps.arrays
        self.reset()

    # starts ----------------------------------------------------------------------------
    @check_arguments
    def reset(
        self,
        parameters: Mapping[str, float] | None = None,
        *,
        initial: Mapping[str, float] | None = None,
        time: float = 0.0,
        motion: Motion | None = None,
    ) -> np.ndarray:
        """Return to the start of the model; returns the outputs there.

        Parameters
        ----------
        parameters : new values, on which the start may depend; others are those of the stepper
        initial : values of entries of the state by ``state_names``, instead of those of the start
        time : of the start [s]
        motion : of the model, at whose last instant the stepper starts, with its parameters; for
            example an equilibrium

        Raises
        ------
        AnalysisError
            Unknown names, a motion of another model, or a time at which no step can begin.
        AssemblyError
            The mechanism cannot be assembled with these parameters, or entries contradict the
            joints.
        """
        plant = self.plant
        plant.check_time(time)
        x, p, mode = plant.begin_at(motion, parameters or {}, time, initial or {})
        self.restore(StepperState(0, time, x, p, mode))
        return self.outputs

    def save(self) -> StepperState:
        """The state, to be restored later."""
        x = self._arrays.z[self._side][:-1]
        return StepperState(self._count, self._start, x.copy(), self._parameters(), self._mode)

    def restore(self, state: StepperState) -> None:
        """Continue from a saved state; the following steps are identical to the last bit.

        Raises
        ------
        AnalysisError
            No ``StepperState``, or one of another model or integrator.
        """
        plant = self.plant
        self._mode = plant.mode_of(state)
        self._count, self._start = state.count, state.start
        self._side, self._p = 0, state.parameters.copy()
        self._arrays.z[0][:] = [*state.x, self.time]
        for u in self._arrays.u:
            u[:] = self._p[plant.inputs]
        self._steps.renew(self._p)
        self._step = self._bound_step(self._mode)

    # steps -----------------------------------------------------------------------------
    def step(self, inputs: Any = None) -> np.ndarray:
        """Advance by one step; returns the outputs at its end.

        Parameters
        ----------
        inputs : values in the order of ``input_names``, [SI]; by default the last ones

        Raises
        ------
        AnalysisError
            Inputs of another number, or not finite.
        SolverFailure
            The state is no longer finite, or equations have no solution; the state and the inputs
            before the step remain.
        """
        side, arrays = self._side, self._arrays
        u = arrays.u[side]
        if inputs is None:
            u[:] = arrays.u[1 - side]
        else:
            try:
                u[:] = inputs
                if self._several and len(inputs) != u.size:  # NumPy would repeat a single number
                    raise wrong_inputs(self.input_names, inputs)
            except (TypeError, ValueError):
                raise wrong_inputs(self.input_names, inputs) from None
        if self.plant.phases is not None:
            self._step = self._bound_step(self._mode)
        if not (self._step.calls[side]() and arrays.share[0] <= 1.0):
            self._repeat_by_other_variant()
        self._side = side = 1 - side
        self._count += 1
        arrays.z[side][-1] = self._start + self._count * self.length
        return arrays.y.copy()

    @property
    def time(self) -> float:
        """Time [s]."""
        return self._start + self._count * self.length  # type: ignore[no-any-return]

    @property
    def outputs(self) -> np.ndarray:
        """Outputs at the present state, with the last inputs."""
        return self.plant.measure(self._mode, self.time, self.state, self._parameters())

    def snapshot(self) -> Motion:
        """The present state as a motion of one instant, for pictures and measures."""
        return self.plant.snapshot(self._mode, self.time, self.state, self._parameters())

    def _parameters(self, inputs: Any = None) -> np.ndarray:
        """Values of all parameters, with the last inputs or others, which are checked."""
        p = self._p.copy()
        last = self._arrays.u[1 - self._side]
        p[self.plant.inputs] = last if inputs is None else input_values(self.input_names, inputs)
        return p

    def __copy__(self) -> Stepper:
        """A stepper of the same plant with a state of its own."""
        other = object.__new__(type(self))
        other.__dict__ |= {k: v for k, v in vars(self).items() if not k.startswith("_")}
        other._several = self._several
        other._steps = BoundSteps(self.plant)
        other._arrays = other._steps.arrays
        other.restore(self.save())
        return other

    def __deepcopy__(self, memo: dict[int, Any]) -> Stepper:
        return self.__copy__()

    def __reduce__(self) -> Any:
        raise UnsupportedError(
            "a Stepper is machine code, which is not written to files or sent to processes; send "
            "its save(), and restore it in a stepper that is made there"
        )

    @property
    def state(self) -> np.ndarray:
        """State of the integrator, a copy: ``coordinates, speeds``, accumulated work, memory."""
        return self._arrays.z[self._side][:-1].copy()

    @property
    def state_names(self) -> list[str]:
        """Names of the coordinates and of their rates, the leading entries of ``state``."""
        return list(self.plant.entries_at(self.state.size).names)

    @property
    def backend(self) -> str:
        """Evaluator of the steps."""
        return self._step.evaluator

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
        """Exact derivatives of the next step by the last inputs or others, without taking it."""
        step_map = self.plant.map(self._mode, self.plant.due(self._count, self._start))
        p = self._parameters(inputs)
        return StepJacobians.at(step_map, self.plant, self.time, self.state, p)

    def start_jacobian(self) -> np.ndarray:
        """(n, np) exact derivatives of the start of the model by the parameters.

        Rows and columns are those of ``jacobians().parameter``; at the parameters and the time of
        the last reset. A start by ``initial`` or ``motion`` has other ones.
        """
        return self.plant.start_slopes(self._p, self._start)

    def state_space(self, inputs: Any = None) -> StateSpace:
        """Linear system ``x[k+1] = A x[k] + B u[k]``, ``y[k] = C x[k] + D u[k]`` of a step.

        The exact derivatives of a step at the present state, samples of blocks included, in
        independent entries of the state. About a fixed point, such as ``reset(motion=...)`` with an
        equilibrium, it is the sampled plant with held inputs, and its poles are those of the
        sampled loop.

        Parameters
        ----------
        inputs : values of the inputs; by default the last ones

        Raises
        ------
        AnalysisError
            Samples of blocks differ between steps.

        Examples
        --------
        >>> import dalembert as da
        >>> from dalembert import planar
        >>> system = da.System("sled")
        >>> sled = system.add(planar.Particle("sled", mass=2.0))
        >>> rail = planar.PinInSlot("rail", system.ground.center, sled.center)
        >>> joint, thrust = system.add(rail), system.input("thrust", unit="N")
        >>> drive = system.add(planar.Force("drive", sled.center, (thrust, 0)))
        >>> space = da.Stepper(system.build(), step=0.1, outputs=["sled.x"]).state_space()
        >>> space.dt, space.A.round(9).tolist(), space.B.round(9).tolist()
        (0.1, [[1.0, 0.1], [0.0, 1.0]], [[0.0025], [0.05]])
        """
        if self.plant.phases is not None:
            self.plant.phases.check_repeated(self._count, self._start)
        return self.jacobians(inputs).state_space

    def _bound_step(self, mode: int) -> BoundStep:
        """The next step in a mode."""
        due = self.plant.due(self._count, self._start)
        return self._steps.at(mode, due, self._p)

    def _repeat_by_other_variant(self) -> None:
        """Repeat a refused step with the equations that suit the state, if there are others."""
        side, p, arrays = self._side, self._p.copy(), self._arrays
        refuse_infinite(self.input_names, arrays.u[side])
        p[self.plant.inputs] = arrays.u[side]
        try:
            mode = self.plant.kernel.choose(self.time, self.state, p)
        except SingularityError as error:
            raise StepFailure(self.time, str(error), SHORTER) from None
        step = self._bound_step(mode)
        for results in (arrays.z[1 - side], arrays.y, arrays.share):
            results[:] = 0.0  # a call that fails may leave them as they are
        solved = step.calls[side]()
        if not (solved and arrays.share[0] <= 1.0):
            raise StepFailure(self.time, arrays.obstacle(side, solved, self.output_names), SHORTER)
        self._mode, self._step = mode, step
