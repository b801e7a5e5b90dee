"""Record of a dynamic run for gradients and later evaluations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event, ended_again
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_accuracy import StepAccuracy
from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.analysis.output_places import OutputPlaces, outputs_of
from dalembert.errors import AnalysisError
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Recording
from dalembert.results.status import Outcome

OUTPUT_QUADRATURE_ORDER = 4
"""Order of the quadrature through the ends of equal steps."""
INTERVALS = 1000
"""Minimum number of intervals of integrals where the integrator hides its own steps."""
MOST = 200
"""Upper limit of the number of states at which the time is measured."""
MACHINE = "VM"
"""Backend whose evaluation time is the same inside and outside of a step."""


@dataclass(frozen=True)
class DynamicsRecord:
    """Steps of a run and the positions of its outputs among them.

    Attributes
    ----------
    kernel : DynamicsKernel of the run
    steps : Steps taken
    places : places of the outputs among the steps
    origin : the run that this one repeats, None for an original run
    quadrature : weights of integrals over the outputs, if these are points inside steps
    accuracy : error estimate of the run, if its steps can be repeated in halves
    dense : outputs follow the motion between the ends of its steps
    """

    kernel: DynamicsKernel
    steps: Steps
    places: OutputPlaces
    origin: Recording | None = None
    quadrature: StepQuadrature | None = None
    accuracy: StepAccuracy | None = None
    dense: bool = False

    @property
    def adaptive(self) -> bool:
        """Whether the steps were controlled by an error estimate."""
        return self.kernel.adaptive is not None

    def sampled(self, motion: Any, times: np.ndarray, places: OutputPlaces) -> Any:
        """The motion of the run at other outputs."""
        return replace(
            motion,
            trajectory=self.kernel.trajectory(times, self.steps, places, motion.parameters),
            record=replace(self, places=places, dense=False),
        )

    def over_steps(self, motion: Any) -> Any:
        """The motion at the quadrature points of integrals over the run."""
        kernel, steps, order = self.kernel, self.steps, motion.analysis.integrator.order
        uneven = self.adaptive or kernel.contacts is not None
        if steps.count and (uneven or order > OUTPUT_QUADRATURE_ORDER):
            # under error control steps are as long as the tolerance permits
            rule = StepQuadrature.fine if self.adaptive else StepQuadrature
            points = rule(steps, order)
            sampled = self.sampled(motion, points.times, points.places)
            return replace(sampled, record=replace(sampled.record, quadrature=points))
        if steps.count and kernel.fixed.at_once(int(steps.mode[0])):
            finer = steps.divided(-(-INTERVALS // steps.count))
            steps = kernel.fixed.repeat(finer, steps.x[:, 0], motion.parameters)
            return replace(self, steps=steps).sampled(motion, *outputs_of(steps, None))
        if motion.analysis.outputs is None:
            return motion
        return self.sampled(motion, *outputs_of(steps, None, end_by_event(motion) is not None))

    def repeated(self, motion: Any, p: np.ndarray) -> Any:
        """The motion with the same steps and outputs at other parameter values.

        A run that an event ended ends at the same event, with a last step of another length.

        Raises
        ------
        AnalysisError
            A step fails with these values.
        """
        kernel, original = self.kernel, self.steps
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
        times, places = motion.time, self.places
        if motion.status.outcome is Outcome.TERMINATED:
            steps = ended_again(motion, steps, p)
            if end_by_event(motion):
                times, places = np.append(times[:-1], steps.end), places.ended(steps)
        return replace(
            motion,
            parameters=p,
            trajectory=kernel.trajectory(times, steps, places, p),
            record=DynamicsRecord(kernel, steps, places, origin=motion, dense=self.dense),
        )


def projection_time(motion: Any) -> float | None:
    """Computation time of the projections of a run [s]; None without projections or if compiled."""
    record, statistics = motion.record, motion.statistics
    count = statistics.get("projections", 0)
    if not isinstance(record, DynamicsRecord) or not count or statistics["backend"] != MACHINE:
        return None
    steps = record.steps
    last = int(steps.lasting[-1])
    correction = record.kernel.variants[int(steps.mode[last])].problem.correction
    if correction is None:
        return None
    columns = min(MOST, steps.count)
    states = np.asarray(steps.x[:, steps.count - columns : steps.count])
    times = steps.t[steps.count - columns : steps.count]
    parameters = np.tile(motion.parameters[:, None], columns)
    function = correction.function.map(columns)
    function(times, states, parameters)
    begin = perf_counter()
    function(times, states, parameters)
    return (perf_counter() - begin) * count / columns
