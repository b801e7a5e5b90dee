"""The run in steps whose tangents stay bounded, of which gradients are taken.

Under error control a run may stay at the limit of stability of its method (see ``StepGrowth``).
Its gradient is then taken of the same run with the steps divided: the states are the same within
the tolerance, and the products of the step tangents follow the motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.kinematics.branches import Branches
from dalembert.errors import AnalysisError, SingularityError
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.marching.step_growth import TOLERATED, StepGrowth
from dalembert.symbolic.once import once

MOST = 1000
"""Parts of a step at most."""
STIFF = "use Radau() or Bdf(), whose steps dampen stiff modes"


@once
def growth_of(motion: Recording) -> StepGrowth | None:
    """Growth of the step tangents of a run under error control; None of other results."""
    kernel = getattr(motion.record, "kernel", None)
    if not isinstance(kernel, DynamicsKernel) or kernel.adaptive is None:
        return None
    return StepGrowth(kernel, motion.record.steps, motion.parameters)


@once
def with_stable_steps(motion: Result) -> Result:
    """The result itself, or the run in parts of its steps where their tangents would explode.

    Raises
    ------
    SingularityError
        No reasonable division helps; names the growth, the time and other integrators.
    """
    growth = growth_of(motion) if isinstance(motion, Recording) else None
    if growth is None or growth.harmless:
        return motion
    parts = growth.parts
    if parts.max() > MOST:
        raise SingularityError(f"no gradient: {described(growth)}; {STIFF}")
    assert isinstance(motion, Recording)
    try:
        return in_parts(motion, parts)
    except AnalysisError as error:
        raise SingularityError(f"no gradient: {described(growth)}; {error}; {STIFF}") from error


def in_halves(motion: Recording) -> Recording | None:
    """The run in steps half as long; None where the steps of its method remember earlier ones.

    Raises
    ------
    AnalysisError
        A shorter step fails.
    """
    steps, variants = motion.record.steps, motion.record.kernel.variants
    if any(variants[mode].step.begin is not None for mode in np.unique(steps.mode)):
        return None
    return in_parts(motion, np.where(steps.h > 0, 2, 1))


def in_parts(motion: Recording, parts: np.ndarray) -> Recording:
    """The run with each of its steps in so many equal parts.

    Raises
    ------
    AnalysisError
        A shorter step fails.
    """
    record, p = motion.record, motion.parameters
    kernel = record.kernel
    steps = kernel.fixed.repeat(record.steps.divided(parts), record.steps.x[:, 0], p)
    if steps.interrupted:
        raise KeyboardInterrupt
    if steps.message:
        raise AnalysisError(
            f"the run in shorter steps ends with {steps.message!r} at t = {steps.end:.6g} s"
        )
    branches = moved_branches(record.branches, record.steps, parts)
    trajectory = kernel.trajectory(motion.time, steps, branches, p)
    made = replace(record, steps=steps, branches=branches)
    return replace(motion, trajectory=trajectory, record=made)


def described(growth: StepGrowth) -> str:
    """What happens, with the factor and the time."""
    name, factor = growth.kernel.integrator.name, growth.factor
    grows = f"grows by {factor:.2g}" if factor > TOLERATED else "may grow"
    return (
        f"steps of {name} reach its limit of stability, from t = {growth.begin:.6g} s on; the "
        f"product of their tangents {grows}, which the motion does not explain"
    )


def moved_branches(branches: Branches, steps: Steps, parts: np.ndarray) -> Branches:
    """The same places among divided steps."""
    k, first = branches.index, np.concatenate([[0], np.cumsum(parts)])
    part = steps.h[k] / parts[k]
    ends = branches.ends_of(steps)
    number = np.floor(np.divide(branches.length, part, out=np.zeros(k.size), where=part > 0))
    number = np.where(ends, parts[k] - 1, np.minimum(number, parts[k] - 1)).astype(int)
    length = np.where(ends, part, np.maximum(branches.length - number * part, 0.0))
    return Branches(first[k] + number, length, branches.modes)
