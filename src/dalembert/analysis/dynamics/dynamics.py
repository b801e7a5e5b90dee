"""Forward dynamics: time integration of the equations of motion."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import refuse_overlap
from dalembert.analysis.dynamics.continuation import ContinuedRun, extended, refuse_ended
from dalembert.analysis.dynamics.dense_outputs import peak_quadrature
from dalembert.analysis.dynamics.event_search import instant_of
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.kernel_choice import dynamics_kernel
from dalembert.analysis.dynamics.peaks import peaks
from dalembert.analysis.dynamics.residual_check import check_balance
from dalembert.analysis.dynamics.run import DynamicsRun
from dalembert.analysis.dynamics.variant import Variant
from dalembert.analysis.events import Events, Occurrence
from dalembert.analysis.output_places import place_outputs
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.analysis.timeline import OverTime, checked_span
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.formulations.base import Formulation
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection, Stabilization
from dalembert.integrators.automatic import AutomaticIntegrator
from dalembert.integrators.base import Integrator
from dalembert.integrators.contact.schemes import ContactScheme
from dalembert.integrators.newmark.family import Newmark
from dalembert.integrators.runge_kutta.explicit import RK4
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.coordinates import AbsoluteCoordinates, Coordinates
from dalembert.model.graph.model import Model
from dalembert.options import only_for, options
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.sources import Row
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.formulas.expression import Expression

DEFAULT_INTEGRATOR = AutomaticIntegrator()
"""Default integrator of mechanisms without a step."""
DEFAULT_WITH_STEP = RK4()
"""Default integrator of mechanisms with a step."""
UNDAMPED = Rayleigh()
STRATEGIES: dict[str, tuple[type, type]] = {
    "coordinates": (Coordinates, AbsoluteCoordinates),
    "formulation": (Formulation, RangeSpace),
    "stabilization": (Stabilization, Projection),
    "integrator": (Integrator, RK4),
}
"""Strategy of a run → its base class and default class."""
BATCH_OUTPUTS = 201
"""Default number of outputs of each design of a batch under error control."""


STARTS = ("rest", "statics")
"""Initial states of a structure."""


def _transient_run(analysis: Any, model: StructuralModel, parameters: Any) -> Any:
    """Executor for a structure, whose modules mechanisms do not need."""
    from dalembert.analysis.transient.run import TransientRun

    return TransientRun(analysis, model, parameters)


@options
class Dynamics(OverTime[Any]):
    """Forward dynamics as a strategy object that can be run, repeated and differentiated.

    The options from ``coordinates`` to ``memory`` apply to mechanisms, those from ``nonlinear`` on
    to structures.

    Parameters
    ----------
    step : step length of fixed-step integrators, by default a thousandth of the run; first step
        of adaptive ones [s]
    integrator : time integration method. By default, of a mechanism ``AutomaticIntegrator()``,
        which controls the error and takes implicit steps where the problem is stiff, or ``RK4()``
        with a ``step``; of a structure ``Newmark()``, or ``HHT()``, ``GeneralizedAlpha()``
    coordinates : coordinates in which the equations are integrated; ``AutomaticCoordinates()``
        selects those that need fewer operations
    formulation : method for accelerations and multipliers; ``AutomaticFormulation()`` selects the
        accurate one with the fewest operations
    stabilization : control of constraint violations
    events : name → Event, or a formula that is recorded when it crosses zero
    strict : refuse inconsistent initial speeds instead of projecting them
    backend : ``"auto"``, CasADi's virtual machine, and machine code when the run is long enough to
        benefit; ``"vm"``, the virtual machine; ``"jit"``, machine code by LLVM; ``"c"``, by the
        system's C compiler. Compiled code is cached on disk
    balance : upper limit of the error of the energy balance, relative to the energy of the motion
    memory : upper limit of the memory for states that gradients and later evaluations need [bytes];
        a longer run stores checkpoints and computes other states again when needed, which costs
        another run. Without ``outputs`` all states are stored
    nonlinear : displacements of any size
    lumped : diagonal mass matrix instead of the consistent one
    damping : Rayleigh
    case : name of the load case; optional if there is only one
    start : ``"rest"``, from the initial motion of ``structure.initial``; ``"statics"``, from
        equilibrium under the loads at the start

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
    executions = {"mechanism": DynamicsRun, "structure": _transient_run}

    integrator: Integrator = DEFAULT_INTEGRATOR
    coordinates: Coordinates = only_for("mechanism", default=AbsoluteCoordinates())
    formulation: Formulation = only_for("mechanism", default=RangeSpace())
    stabilization: Stabilization = only_for("mechanism", default=Projection())
    events: Events | None = only_for("mechanism", default=None)
    strict: bool = only_for("mechanism", default=False)
    backend: str = only_for("mechanism", default="auto")
    balance: float = only_for("mechanism", default=0.25)
    memory: float = only_for("mechanism", default=2.0**27)
    nonlinear: bool = only_for("structure", default=False)
    lumped: bool = only_for("structure", default=False)
    damping: Rayleigh = only_for("structure", default=UNDAMPED)
    case: str = only_for("structure", default="")
    start: str = only_for("structure", default="rest")

    def __post_init__(self) -> None:
        if self.integrator is DEFAULT_INTEGRATOR and self.step is not None:
            object.__setattr__(self, "integrator", DEFAULT_WITH_STEP)
        for name, (kind, default) in STRATEGIES.items():
            strategy = getattr(self, name)
            if not isinstance(strategy, kind):
                text = f"{name} is {strategy!r}; give a strategy such as {default.__name__}()"
                if isinstance(strategy, ContactScheme):
                    text += ", or use solve_nonsmooth, to which contact schemes belong"
                raise AnalysisError(text)
        if not isinstance(self.damping, Rayleigh):
            raise AnalysisError(f"damping is {self.damping!r}; give Rayleigh(mass=, stiffness=)")
        check_balance(self.balance)
        if self.backend not in BACKENDS:
            names = ", ".join(map(repr, BACKENDS))
            raise UnsupportedError(f"unknown backend {self.backend!r}; known: {names}")
        if self.start not in STARTS:
            accepted = " or ".join(map(repr, STARTS))
            raise AnalysisError(f"start is {self.start!r}; it must be {accepted}")

    def for_model(self, model: Model | StructuralModel) -> Dynamics:
        super().for_model(model)
        default = self.integrator is DEFAULT_WITH_STEP or self.integrator == DEFAULT_INTEGRATOR
        if default and model.kind == "structure":
            return replace(self, integrator=Newmark())
        return self

    def case_of(self, model: StructuralModel) -> str:
        """Name of the load case that acts.

        Raises
        ------
        AnalysisError
            No load case of this name.
        """
        if self.case in model.loads:
            return self.case
        if not self.case and len(model.loads) == 1:
            return next(iter(model.loads))
        cases = ", ".join(map(repr, model.loads))
        raise AnalysisError(f"no load case {self.case!r}; give case= one of {cases}")

    def kernel(self, model: Model) -> DynamicsKernel:
        """Compiled functions, built once per model and choice of strategies."""
        choices = (self.coordinates, self.formulation, self.stabilization, self.integrator)
        return dynamics_kernel(model, *choices, self.backend)

    @property
    def batched(self) -> type:  # type: ignore[override]
        """Class that runs a batch of designs."""
        from dalembert.analysis.batch.marches import AdaptiveSteps, FixedSteps

        return AdaptiveSteps if self.integrator.adaptive else FixedSteps

    def for_designs(self) -> Dynamics:
        """The same with outputs at common times: steps under error control differ by design."""
        if self.outputs is None and self.integrator.adaptive:
            return replace(self, outputs=BATCH_OUTPUTS)
        return self

    @property
    def gradient_error(self) -> float:
        return self.integrator.gradient_error

    def checks(self, model: Model | StructuralModel) -> dict[str, Callable[[], object]]:
        """Checks of the strategies with each other and with the mechanism at its start."""
        if isinstance(model, StructuralModel):
            from dalembert.analysis.transient.run import check_rule

            rule = self.for_model(model).integrator
            return {**super().checks(model), "integrator": lambda: check_rule(rule)}

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

    def live_obstacle(self, result: Any) -> str:
        from dalembert.analysis.live.dynamics_module import obstacle

        return obstacle(result) if isinstance(result, Motion) else super().live_obstacle(result)

    def live_functions(self, result: Any, rows: Sequence[Row], times: np.ndarray) -> LiveFunctions:
        from dalembert.analysis.live.dynamics_module import dynamics_functions

        return dynamics_functions(result, rows, times)

    def resample(self, motion: Any, times: np.ndarray) -> Any:
        """The motion at other times within the run.

        Between the ends of two steps it is computed by a shorter step from the first one.

        Raises
        ------
        AnalysisError
            A time outside the run.
        """
        return motion.record.sampled(motion, times, place_outputs(motion.record.steps, times))

    def over_steps(self, motion: Motion) -> Motion:
        """The motion at the quadrature points of integrals over the run."""
        return motion.record.over_steps(motion)  # type: ignore[no-any-return]

    def peaks(self, motion: Motion, measure: str | Expression, sign: float) -> Motion:
        """The motion at the instant of the largest value, under error control."""
        return peaks(motion, measure, sign) if self._adaptive(motion) else motion

    def over_peaks(
        self, motion: Motion, measure: str | Expression, sharpness: float, sign: float
    ) -> Motion:
        """The motion at points that resolve ``exp(± sharpness m)``, under error control."""
        if not self._adaptive(motion):
            return motion
        points = peak_quadrature(motion, measure, sharpness, sign, self.integrator.order)
        if points is None:
            return motion
        sampled = motion.record.sampled(motion, points.times, points.places)
        return replace(sampled, record=replace(sampled.record, quadrature=points))

    def at_event(self, motion: Motion, occurrence: Occurrence) -> Motion:
        """The motion at the instant of an event.

        Raises
        ------
        AnalysisError
            Unknown event, or fewer occurrences.
        """
        if motion.model.kind == "structure":
            raise UnsupportedError("the motion of a structure has no events; use at(time, …)")
        instant = instant_of(motion, occurrence)
        time = motion.record.steps.t[instant.index] + instant.length
        return motion.record.sampled(motion, np.array([time]), instant.places)  # type: ignore[no-any-return]

    @staticmethod
    def _adaptive(motion: Any) -> bool:
        """Whether the steps of the run were controlled by an error estimate."""
        return motion.record is not None and motion.record.adaptive

    def replay(self, motion: Any, p: np.ndarray) -> Any:
        """The same steps and outputs at other parameter values: the discrete map itself.

        Raises
        ------
        AnalysisError
            A step fails with these values.
        """
        return motion.record.repeated(motion, p)
