"""Record of a dynamic run for gradients and later evaluations."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_accuracy import StepAccuracy
from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Recording

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
    branches : positions of the outputs among the steps
    origin : the run that this one repeats, None for an original run
    quadrature : weights of integrals over the outputs, if these are points inside steps
    accuracy : error estimate of the run, if its steps can be repeated in halves
    dense : outputs follow the motion between the ends of its steps
    """

    kernel: DynamicsKernel
    steps: Steps
    branches: Branches
    origin: Recording | None = None
    quadrature: StepQuadrature | None = None
    accuracy: StepAccuracy | None = None
    dense: bool = False


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
