"""Model of a stepper: kernel, inputs, outputs and sample instants of its steps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.batch.starts import Starts, first_states
from dalembert.analysis.contact.gap_checks import refuse_collisions
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.stepping.input_values import positive_count
from dalembert.analysis.stepping.output_names import names_of
from dalembert.analysis.stepping.sample_phases import SamplePhases
from dalembert.analysis.stepping.step_map import StepMap
from dalembert.analysis.stepping.stepper_state import StepperState
from dalembert.analysis.stepping.tangents import IndependentEntries
from dalembert.errors import AnalysisError, AssemblyError, UnsupportedError
from dalembert.formulations.base import WORK
from dalembert.model.graph.model import Model
from dalembert.model.graph.registry import AutomaticCoordinates
from dalembert.options import is_number
from dalembert.results.batch.designs import Designs, are_designs
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.text.wording import unknown

OPTIONS = "integrator", "coordinates", "formulation", "stabilization", "backend"
"""Options of ``Dynamics`` that a stepper has."""
FEW = 4
"""Number of starts below which they are assembled one by one."""
HOLDS = 1e-9
"""Change of prescribed entries of a start by the joints, relative to their sizes, that is zero."""


class SteppedModel:
    """Everything that the steps of a model have in common.

    Parameters
    ----------
    model : Model
    step, substeps : length of a step [s], and number of its integration steps
    inputs, outputs : names, or None for those of the model
    parameters : values other than the nominal ones
    options : of the run

    Raises
    ------
    UnsupportedError, AnalysisError
        As of ``Stepper``.
    """

    def __init__(
        self,
        model: Model,
        step: float,
        substeps: int,
        inputs: Sequence[str] | None,
        outputs: Sequence[Any] | None,
        parameters: Mapping[str, float],
        options: Mapping[str, Any],
    ):
        if model.kind != "mechanism":
            raise UnsupportedError("a stepper needs a mechanism; the model is a structure")
        if not is_number(step) or not step > 0:
            raise AnalysisError(f"step is {step!r}; give a positive number of seconds")
        substeps = positive_count("substeps", substeps)
        for name in options:
            if name not in OPTIONS:
                raise AnalysisError(unknown("option", name, OPTIONS))
        self.model, self.step, self.substeps = model, float(step), substeps
        self.compiled = options.get("backend", "jit") != "vm"
        choices = {"coordinates": AutomaticCoordinates(), **options, "backend": "vm"}
        self.analysis = analysis = Dynamics(duration=step, step=step / substeps, **choices)
        if analysis.integrator.adaptive:
            raise UnsupportedError(
                f"{analysis.integrator.name} chooses its own steps; use one with fixed steps, such "
                "as RK4() or Radau(fixed=True)"
            )
        model.diagnosis.refuse_massless()
        refuse_collisions(model)
        self.kernel: DynamicsKernel = analysis.kernel(model)
        if self.kernel.contacts is not None:
            raise UnsupportedError(
                f"{self.kernel.equations.contacts[0].name} is a rigid contact, whose impacts end "
                "steps; use a compliant law such as HuntCrossley, or solve_dynamics"
            )
        if isinstance(inputs, str):
            raise AnalysisError(f"inputs is {inputs!r}; give a list of names, [{inputs!r}]")
        self.input_names = list(model.inputs if inputs is None else inputs)
        if len(set(self.input_names)) < len(self.input_names):
            raise AnalysisError(f"inputs is {self.input_names!r:.80}; give each name once")
        names = list(model.parameters)
        for name in self.input_names:
            if name not in names:
                raise AnalysisError(unknown("input", name, names))
        self.inputs = [names.index(name) for name in self.input_names]
        chosen = list(model.outputs.values()) if outputs is None else list(outputs)
        self.measures = [model.expression(measure) for measure in chosen]
        self.output_names = names_of(self.measures)
        self.output_count = len(self.output_names)
        self.parameters = parameters
        sampling = self.kernel.sampling
        self.phases = None if sampling is None else SamplePhases(sampling, self.h, self.substeps)
        self._none = (-1,) * self.substeps
        self._maps: dict[tuple[int, tuple[int, ...]], StepMap] = {}

    @property
    def h(self) -> float:
        """Length of a substep [s]."""
        return self.step / self.substeps

    # starts ----------------------------------------------------------------------------
    @cached_property
    def start(self) -> tuple[np.ndarray, int]:
        """State and mode at the usual start."""
        return self.begin(self.model.values(self.parameters), 0.0, None)

    def begin(
        self, p: np.ndarray, time: float, initial: Mapping[str, float] | None
    ) -> tuple[np.ndarray, int]:
        """State and mode at a start."""
        state = self.model.assemble(p, time)
        x, mode = self.kernel.initial(state, time, p)
        if initial:
            x, mode = self._prescribed(x, mode, p, time, initial)
        return x, mode

    def start_slopes(self, p: np.ndarray, time: float) -> np.ndarray:
        """(f, np) derivatives of the independent entries of a start by all but the inputs."""
        model, kernel, unit = self.model, self.kernel, np.eye(p.size)
        state = model.assemble(p, time)
        x, mode = kernel.initial(state, time, p)
        still = np.zeros((state.y.size, p.size))
        begun = model.initial_state.tangent.map(p.size)(time, state.y, p, 0, still, unit)
        start = kernel.start.tangent.map(p.size)
        slopes = start(time, state.y, state.v, p, 0, *begun, unit).full()
        step = kernel.variants[mode].step
        if step.begin is not None:
            memory = step.begin.tangent.map(p.size)
            moved = memory(time, x[: step.state_size], p, 0, slopes, unit).full()
            slopes = np.vstack([slopes, moved])
        others = [k for k in range(p.size) if k not in set(self.inputs)]
        return slopes[np.ix_(self.entries.free, others)]

    def begin_at(
        self,
        motion: Motion | None,
        parameters: Mapping[str, float],
        time: float,
        initial: Mapping[str, float],
    ) -> tuple[np.ndarray, np.ndarray, int]:
        """State, parameters and mode of a reset; arguments as of ``Stepper.reset``."""
        if motion is None:
            p = self.model.values({**self.parameters, **parameters})
            usual = not parameters and not initial and time == 0.0
            x, mode = self.start if usual else self.begin(p, time, initial)
            return x, p, mode
        if not isinstance(motion, Motion) or motion.model is not self.model:
            raise AnalysisError(f"motion is {motion!r:.60}; give a motion of the same model")
        if parameters or initial:
            raise AnalysisError("motion determines the start; give no parameters and no initial")
        if not motion.status.success:
            raise AnalysisError(f"motion was not completed: {motion.status.message}")
        p, instants = motion.parameters, motion.trajectory
        x = self.kernel.start.function(time, instants.y[:, -1], instants.v[:, -1], p).full().ravel()
        mode = self.kernel.choose(time, x, p)
        return self.kernel.remembered(time, x, p, mode), p.copy(), mode

    def check_time(self, time: float) -> None:
        """Raise if steps cannot begin at a time.

        Raises
        ------
        AnalysisError
            It is not finite, or samples of blocks would be within substeps.
        """
        if not np.isfinite(time):
            raise AnalysisError(f"time is {time!r}; give a finite number of seconds")
        if self.phases is not None:
            self.phases.check_time(time)

    def due(self, count: int, start: float) -> tuple[int, ...]:
        """Samples before the substeps of a step."""
        return self._none if self.phases is None else self.phases.due(count, start)

    def mode_of(self, state: StepperState) -> int:
        """The mode of a saved state in this kernel.

        Modes are numbered in the order of their first use, so that a state of another stepper of
        the model may name one that is missing here.

        Raises
        ------
        AnalysisError
            The state does not belong to this model and integrator.
        """
        if not isinstance(state, StepperState):
            raise AnalysisError(f"restore takes a StepperState of save(); got {state!r:.60}")
        variants = self.kernel.variants
        sizes = variants[self.start[1]].step.size, len(self.model.parameters)
        own = np.size(state.x), np.size(state.parameters)
        if own != sizes:
            raise AnalysisError(
                f"the state has {own[0]} entries and {own[1]} parameters, but this stepper has "
                f"{sizes[0]} and {sizes[1]}; restore states of the same model and integrator"
            )
        if state.mode < len(variants) and type(variants[state.mode]) is Variant:
            return state.mode
        time = state.start + state.count * self.step
        return self.kernel.choose(time, state.x, state.parameters)

    def begin_many(
        self, parameters: Mapping[str, Any], count: int, mode: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """(count, n) states and (count, np) parameters of starts in one mode.

        Raises
        ------
        AssemblyError
            A start is impossible; the message states the first one.
        """
        model, kernel = self.model, self.kernel
        designs = Designs.of(model, parameters) if are_designs(parameters) else None
        if designs is None or len(designs) < FEW or model.closure.lost:
            values = [
                {n: np.ravel(v)[k % np.size(v)] for n, v in parameters.items()}
                for k in range(1 if designs is None else count)
            ]
            p = np.array([model.values({n: float(v) for n, v in one.items()}) for one in values])
            x = np.array([self.begin(row, 0.0, None)[0] for row in p])
            return (np.tile(x, (count, 1)), np.tile(p, (count, 1))) if designs is None else (x, p)
        first = first_states(kernel, mode)
        needs = kernel.formulation.needs_mass
        starts = Starts(model, designs, kernel.backend, 1, (0.0, self.step), needs, first)
        if starts.started.size < count:
            missing = np.setdiff1d(np.arange(count), starts.started)[0]
            status = starts.statuses.get(int(missing))
            reason = status.message if status else "its parameters are not valid"
            raise AssemblyError(f"the start of lane {missing} is impossible: {reason}")
        return starts.x0, starts.p

    def _prescribed(
        self, x: np.ndarray, mode: int, p: np.ndarray, time: float, initial: Mapping[str, float]
    ) -> tuple[np.ndarray, int]:
        """The start with values of some of its entries; joints must permit them."""
        names = self.entries_at(x.size).names
        for name in initial:
            if name not in names:
                raise AnalysisError(unknown("entry of the state", name, names))
            if not np.isfinite(initial[name]):
                raise AnalysisError(f"{name} is {initial[name]!r}; give a finite number")
        values = {names.index(name): float(value) for name, value in initial.items()}
        x, variant = x.copy(), self.kernel.variants[mode]
        size = variant.step.state_size
        x[list(values)] = list(values.values())
        correction = variant.problem.correction or variant.problem.upkeep
        if correction is not None:
            x[:size] = correction.function(time, x[:size], p).full().ravel()
        for k, value in values.items():
            if not abs(x[k] - value) <= HOLDS * max(1.0, abs(value)):
                raise AssemblyError(
                    f"{names[k]} = {value:.6g} contradicts the joints, which give {x[k]:.6g}; let "
                    "the start depend on parameters, reset(parameters=...), or give all entries"
                )
        mode = self.kernel.choose(time, x, p)
        return self.kernel.remembered(time, x[:size], p, mode), mode

    # steps -----------------------------------------------------------------------------
    def map(self, mode: int, due: tuple[int, ...]) -> StepMap:
        """The step of a mode with samples before its substeps."""
        if (mode, due) not in self._maps:
            arguments = self.kernel, mode, self.h, due, self.inputs, self.measures
            self._maps[mode, due] = StepMap(*arguments)
        return self._maps[mode, due]

    def measure(self, mode: int, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Outputs at a state."""
        variant, values = self.kernel.variants[mode], []
        for measure in self.measures:
            function = variant.measured(measure).function
            values.append(function(t, x[: variant.step.state_size], p).full().ravel())
        return np.concatenate(values) if values else np.zeros(0)

    def snapshot(self, mode: int, t: float, x: np.ndarray, p: np.ndarray) -> Motion:
        """A state as a motion of one instant."""
        variant = self.kernel.variants[mode]
        columns = variant.bodies(t, x[: variant.step.state_size], p)
        y, v, a, multiplier = (column.full() for column in columns)
        instant = Trajectory(np.array([t]), y, v, a, multiplier, np.zeros((2, 1)))
        status = Status(Outcome.COMPLETED, f"state of a stepper at t = {t:.6g} s", t)
        return Motion(self.model, self.analysis, p, instant, status)

    @cached_property
    def entries(self) -> IndependentEntries:
        """Independent entries of the state at the usual start."""
        p, (x, _) = self.model.values(self.parameters), self.start
        entries = self.entries_at(x.size)
        entries.choose(0.0, x, p)
        return entries

    def entries_at(self, size: int) -> IndependentEntries:
        """Entries of a state of this size, without a choice."""
        e = self.kernel.equations
        begin = e.coordinate_count + e.speed_count
        return IndependentEntries(self.kernel.view, size, range(begin, begin + WORK.numel()))
