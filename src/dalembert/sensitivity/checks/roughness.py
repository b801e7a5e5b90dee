"""Accuracy of gradients over switches, estimated by halved steps.

Error control applies to states. The derivatives of its steps are less accurate if forces are stiff
or change suddenly: an error that is small relative to the state may vary quickly with parameters.
Fixed steps are cut at impacts. There the gradient follows the motion and not the cut step, which
differs by the error of the step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.checks.scales import parameter_scales
from dalembert.sensitivity.marching.stable_steps import in_halves, with_stable_steps
from dalembert.sensitivity.methods import Automatic

TIGHT = 1e-7
"""Relative tolerance at which gradients of multistep methods were accurate to 3 % in tests [-]."""
ROUGH = 1e-2
"""Threshold of a reported difference of gradients, relative to the largest influence [-]."""


def step_accuracy_notes(
    motion: Result, responses: Sequence[Response], columns: Sequence[int], values: np.ndarray
) -> list[str]:
    """Notes if steps half as long change the gradient of a run over switches."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(kernel, DynamicsKernel) or not kernel.crossings(
        motion.record.steps  # type: ignore[attr-defined]
    ):
        return []
    stable = with_stable_steps(motion)
    assert isinstance(stable, Recording)
    try:
        halves = in_halves(stable)
        if halves is None:
            return _multistep_note(motion)
        strategy = Automatic().choose(len(responses), len(columns))
        finer = strategy.gradient(halves, responses, columns).reshape(values.shape)
    except AnalysisError:
        return []
    remedy = "shorter steps" if kernel.adaptive is None else "tighter tolerances"
    scales = parameter_scales(motion, columns)
    largest = np.abs(finer * scales).max(axis=1)
    change = np.abs((values - finer) * scales).max(axis=1)
    share = np.divide(change, largest, out=np.zeros_like(change), where=largest > 0)
    return [
        f"{response.label}: steps half as long change the gradient by up to {part:.1%} of its "
        f"largest influence; {remedy} make it more accurate"
        for response, part in zip(responses, share, strict=True)
        if part > ROUGH
    ]


def _multistep_note(motion: Result) -> list[str]:
    """Note on multistep methods, whose steps cannot be divided."""
    integrator = motion.analysis.integrator  # type: ignore[attr-defined]
    if not getattr(integrator, "rtol", 0.0) > TIGHT:
        return []
    return [
        f"gradients by {integrator.name} over switches are less accurate than the states, by an "
        f"unknown amount; use rtol={TIGHT:g} at most, or Radau()"
    ]
