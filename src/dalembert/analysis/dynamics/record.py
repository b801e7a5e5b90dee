"""Record of a dynamic run: what gradients and later questions need of it."""

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
    """What a gradient needs of a run: the steps taken and the branches to the outputs.

    ``origin`` is the run that this one repeats, if it does; ``quadrature`` holds the weights that
    make integrals of the outputs, where these are points inside steps. ``accuracy`` estimates the
    error of the run, where its steps can be repeated in halves. ``dense`` outputs show the motion
    between the ends of its steps.
    """

    kernel: DynamicsKernel
    steps: Steps
    branches: Branches
    origin: Recording | None = None
    quadrature: StepQuadrature | None = None
    accuracy: StepAccuracy | None = None
    dense: bool = False
