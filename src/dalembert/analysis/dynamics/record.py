"""Record of a dynamic run for gradients and later evaluations."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.step_accuracy import StepAccuracy
from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.analysis.kinematics.branches import Branches
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Recording


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
