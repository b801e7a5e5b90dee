"""Forward dynamics: integrate the constrained equations of motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import field, replace
from typing import Any

import numpy as np

from dalembert.analysis.batch.adaptive_steps import AdaptiveSteps
from dalembert.analysis.batch.fixed_steps import FixedSteps
from dalembert.analysis.contact.gap_checks import refuse_overlap
from dalembert.analysis.dynamics.continuation import ContinuedRun, extended, refuse_ended
from dalembert.analysis.dynamics.dense_outputs import peak_quadrature
from dalembert.analysis.dynamics.event_search import end_by_event, ended_again, instant_of
from dalembert.analysis.dynamics.formulation_cost import cost_and_error
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.peaks import peaks
from dalembert.analysis.dynamics.record import DynamicsRecord
from dalembert.analysis.dynamics.residual_check import check_balance
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.events import Events, Occurrence
from dalembert.analysis.kinematics.branches import Branches, outputs_of, place_outputs
from dalembert.analysis.timeline import OverTime, checked_span
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.formulations.base import Formulation, Performance
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection, Stabilization
from dalembert.integrators.automatic import AutomaticIntegrator
from dalembert.integrators.base import Integrator
from dalembert.integrators.runge_kutta.explicit import RK4
from dalembert.model.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

DEFAULT_INTEGRATOR = AutomaticIntegrator()
"""Default integrator without a step; with a step the default is RK4."""
STRATEGIES = {
    "coordinates": (Coordinates, AbsoluteCoordinates),
    "formulation": (Formulation, RangeSpace),
    "stabilization": (Stabilization, Projection),
    "integrator": (Integrator, RK4),
}
"""Strategy of a run → its base class and default class."""
OUTPUT_QUADRATURE_ORDER = 4
"""Order of the quadrature through the ends of equal steps."""
BATCH_OUTPUTS = 201
"""Default number of outputs of each design of a batch under error control."""
INTERVALS = 1000
"""Minimum number of intervals of integrals where the integrator hides its own steps."""


@options
class Dynamics(OverTime[Motion]):
    """Forward dynamics as a strategy object that can be run, repeated and differentiated.

    Parameters
    ----------
    step : step length of fixed-step integrators, by default a thousandth of the run; first step
        of adaptive ones [s]
    coordinates : coordinates in which the equations are integrated; ``AutomaticCoordinates()``
        selects those that need fewer operations
    formulation : method for accelerations and multipliers; ``AutomaticFormulation()`` selects the
        accurate one with the fewest operations
    stabilization : control of constraint violations
    integrator : time integration method; by default ``AutomaticIntegrator()``, which controls the
        error and takes implicit steps where the problem is stiff, and ``RK4()`` with a ``step``
    events : name → Event, or a formula that is recorded when it crosses zero
    strict : refuse inconsistent initial speeds instead of projecting them
    backend : ``"auto"``, CasADi's virtual machine, and machine code when the run is long enough to
        benefit; ``"vm"``, the virtual machine; ``"jit"``, machine code by LLVM; ``"c"``, by the
        system's C compiler. Compiled code is cached on disk
    balance : upper limit of the error of the energy balance, relative to the energy of the motion
    memory : upper limit of the memory for states that gradients and later evaluations need [bytes];
        a longer run stores checkpoints and computes other states again when needed, which costs
        another run. Without ``outputs`` all states are stored

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 5.0, unit="m/s", bounds=(1, 10))
    >>> stone = system.add(planar.Particle("stone", mass=0.2, velocity=(speed, 10)))
    >>> throw = da.Dynamics(duration=2.0, step=0.1, integrator=da.Heun())
    >>> model = system.build()
    >>> [round(throw.run(model, {"speed": v})["stone.x"][-1].item(), 6) for v in (5, 8)]  # v t
    [10.0, 16.0]
    """

    display_name = "dynamics"
    integrates = True
    execution = DynamicsRun

    coordinates: Coordinates = field(default_factory=AbsoluteCoordinates)
    formulation: Formulation = field(default_factory=RangeSpace)
    stabilization: Stabilization = field(default_factory=Projection)
    integrator: Integrator = DEFAULT_INTEGRATOR
    events: Events | None = None
    strict: bool = False
    backend: str = "auto"
    balance: float = 0.25
    memory: float = 2.0**27

    def __post_init__(self) -> None:
        if self.integrator is DEFAULT_INTEGRATOR and self.step is not None:
            object.__setattr__(self, "integrator", RK4())
        for name, (kind, default) in STRATEGIES.items():
            strategy = getattr(self, name)
            if not isinstance(strategy, kind):
                text = f"{name} is {strategy!r}; give a strategy such as {default.__name__}()"
                raise AnalysisError(text)
        check_balance(self.balance)
        if self.backend not in BACKENDS:
            names = ", ".join(map(repr, BACKENDS))
            raise UnsupportedError(f"unknown backend {self.backend!r}; known: {names}")

    def kernel(self, model: Model) -> DynamicsKernel:
        """Compiled functions, built once per model and choice of strategies."""
        choices = (self.coordinates, self.formulation, self.stabilization, self.integrator)
        return _kernel(model, *choices, self.backend)

    @property
    def batched(self) -> type:  # type: ignore[override]
        """Class that runs a batch of designs."""
        return AdaptiveSteps if self.integrator.adaptive else FixedSteps

    def for_designs(self) -> Dynamics:
        """The same with outputs at common times: steps under error control differ by design."""
        if self.outputs is None and self.integrator.adaptive:
            return replace(self, outputs=BATCH_OUTPUTS)
        return self

    @property
    def gradient_error(self) -> float:
        return self.integrator.gradient_error

    def checks(self, model: Model) -> dict[str, Callable[[], object]]:
        """Checks of the strategies with each other and with the mechanism at its start."""

        def variant_at_start() -> Variant:
            return self.kernel(model).beginning[0]

        return {
            **super().checks(model),
            "stabilization": lambda: self.stabilization.check(self.formulation),
            "coordinates": lambda: self.coordinates.check(model, self.formulation.every_equation),
            "formulation": variant_at_start,
            "integrator": lambda: variant_at_start().integrator.check(variant_at_start().problem),
            "": lambda: refuse_overlap(model, checked_span(self.duration, self.t_span)[0]),
        }

    def continued(
        self, motion: Motion, duration: Any, options: Mapping[str, Any], progress: Any = False
    ) -> Motion:
        """The motion, continued by a duration.

        Parameters
        ----------
        options : step, outputs of the continuation and events, if they differ from the earlier run

        Raises
        ------
        AnalysisError
            The run failed, or its times follow parameters.
        """
        if "events" not in options:
            refuse_ended(motion, before=np.inf)
        analysis, step = extended(self, motion, duration, options)
        return ContinuedRun(motion, analysis, step).execute(progress)

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The motion at other times within the run.

        Raises
        ------
        AnalysisError
            A time outside the run.
        """
        return self._sampled(motion, times, place_outputs(motion.record.steps, times))

    def over_steps(self, motion: Motion) -> Motion:
        """The motion at the quadrature points of integrals over the run."""
        record: DynamicsRecord = motion.record
        kernel, steps, order = record.kernel, record.steps, self.integrator.order
        uneven = kernel.adaptive is not None or kernel.contacts is not None
        if steps.count and (uneven or order > OUTPUT_QUADRATURE_ORDER):
            long_steps = kernel.adaptive is not None  # steps are as long as the tolerance permits
            points = (
                StepQuadrature.fine(steps, order) if long_steps else StepQuadrature(steps, order)
            )
            sampled = self._sampled(motion, points.times, points.branches)
            return replace(sampled, record=replace(sampled.record, quadrature=points))
        if steps.count and kernel.fixed.at_once(int(steps.mode[0])):
            finer = steps.divided(-(-INTERVALS // steps.count))
            steps = kernel.fixed.repeat(finer, steps.x[:, 0], motion.parameters)
            motion = replace(motion, record=replace(record, steps=steps))
            return self._sampled(motion, *outputs_of(steps, None))
        if self.outputs is None:
            return motion
        return self._sampled(motion, *outputs_of(steps, None, end_by_event(motion) is not None))

    def peaks(self, motion: Motion, measure: str | Expression, sign: float) -> Motion:
        """The motion at the instant of the largest value, under error control."""
        return peaks(motion, measure, sign) if motion.record.kernel.adaptive else motion

    def over_peaks(
        self, motion: Motion, measure: str | Expression, sharpness: float, sign: float
    ) -> Motion:
        """The motion at points that resolve ``exp(± sharpness m)``, under error control."""
        points = peak_quadrature(motion, measure, sharpness, sign, self.integrator.order)
        if points is None:
            return motion
        sampled = self._sampled(motion, points.times, points.branches)
        return replace(sampled, record=replace(sampled.record, quadrature=points))

    def at_event(self, motion: Motion, occurrence: Occurrence) -> Motion:
        """The motion at the instant of an event.

        Raises
        ------
        AnalysisError
            Unknown event, or fewer occurrences.
        """
        instant = instant_of(motion, occurrence)
        time = motion.record.steps.t[instant.index] + instant.length
        return self._sampled(motion, np.array([time]), instant.branches)

    def _sampled(self, motion: Motion, times: np.ndarray, branches: Branches) -> Motion:
        kernel, steps = motion.record.kernel, motion.record.steps
        trajectory = kernel.trajectory(times, steps, branches, motion.parameters)
        return replace(
            motion,
            trajectory=trajectory,
            record=replace(motion.record, branches=branches, dense=False),
        )

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The same steps and outputs at other parameter values: the discrete map itself.

        A run that an event ended ends at the same event, with a last step of another length.

        Raises
        ------
        AnalysisError
            A step fails with these values.
        """
        record: DynamicsRecord = motion.record
        kernel, original = record.kernel, record.steps
        state = motion.model.assemble(p, float(original.t[0]))
        start = float(original.t[0])
        x0, mode = kernel.initial(state, start, p, original.x[:, 0])
        x0 = kernel.remembered(start, x0, p, int(original.mode[0]) if original.count else mode)
        steps = kernel.fixed.repeat(original, x0, p)
        if steps.interrupted:
            raise KeyboardInterrupt
        if steps.message:
            raise AnalysisError(
                f"the steps of the run cannot be repeated with these parameters: {steps.message} "
                f"after t = {steps.end:.9g} s"
            )
        times, branches = motion.time, record.branches
        if motion.status.outcome is Outcome.TERMINATED:
            steps = ended_again(motion, steps, p)
            if end_by_event(motion):
                times, branches = np.append(times[:-1], steps.end), branches.ended(steps)
        return replace(
            motion,
            parameters=p,
            trajectory=kernel.trajectory(times, steps, branches, p),
            record=DynamicsRecord(kernel, steps, branches, origin=motion, dense=record.dense),
        )


@once
def _kernel(
    model: Model,
    coordinates: Coordinates,
    formulation: Formulation,
    stabilization: Stabilization,
    integrator: Integrator,
    backend: str,
) -> DynamicsKernel:
    strategies = formulation, stabilization, integrator
    chosen = coordinates.chosen(
        lambda candidate: _kernel(model, candidate, *strategies, backend).operations
    )
    if chosen is not coordinates:
        return _kernel(model, chosen, *strategies, backend)

    def merits_with(candidate: Formulation) -> Performance:
        kernel = _kernel(model, coordinates, candidate, stabilization, integrator, backend)
        return cost_and_error(kernel)

    selected = formulation.select(merits_with, integrator.implicit)
    if selected is not formulation:
        return _kernel(model, coordinates, selected, stabilization, integrator, backend)
    return DynamicsKernel(model, chosen, *strategies, BACKENDS[backend]())
