"""Subdivision of steps so that products of their tangents stay bounded.

Under error control a run may stay at the stability limit of its method (see ``StepGrowth``). The
gradient is then computed for the same run with subdivided steps: the states agree within the
tolerance, and the products of the step tangents follow the motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.output_places import OutputPlaces
from dalembert.errors import AnalysisError, SingularityError
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.marching.step_growth import TOLERATED, StepGrowth
from dalembert.symbolic.once import once

MAX_PARTS = 1000
"""Upper limit of the number of parts of a step."""
REMEDY = "use Radau() or BDF(), whose steps dampen stiff modes"


@once
def growth_of(motion: Recording) -> StepGrowth | None:
    """Growth of the step tangents of a run under error control; None for other results."""
    kernel = getattr(motion.record, "kernel", None)
    if not isinstance(kernel, DynamicsKernel) or kernel.adaptive is None:
        return None
    return StepGrowth(kernel, motion.record.steps, motion.parameters)


@once
def with_stable_steps(motion: Result) -> Result:
    """The result, with subdivided steps if products of their tangents would diverge.

    Raises
    ------
    SingularityError
        No feasible subdivision suffices; names the growth, the time and other integrators.
    """
    growth = growth_of(motion) if isinstance(motion, Recording) else None
    if growth is None or growth.harmless:
        return motion
    parts = growth.parts
    if parts.max() > MAX_PARTS:
        raise SingularityError(f"no gradient: {describe(growth)}; {REMEDY}")
    assert isinstance(motion, Recording)
    try:
        return in_parts(motion, parts)
    except AnalysisError as error:
        raise SingularityError(f"no gradient: {describe(growth)}; {error}; {REMEDY}") from error


def in_halves(motion: Recording) -> Recording | None:
    """The run in steps half as long; None for multistep methods.

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
    """The run with each step divided into equal parts.

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
    places = divided_places(record.places, record.steps, parts)
    trajectory = kernel.trajectory(motion.time, steps, places, p)
    divided = replace(record, steps=steps, places=places)
    return replace(motion, trajectory=trajectory, record=divided)


def describe(growth: StepGrowth) -> str:
    """Description of the growth, with factor and time."""
    name, factor = growth.kernel.integrator.name, growth.factor
    grows = f"grows by {factor:.2g}" if factor > TOLERATED else "may grow"
    return (
        f"steps of {name} reach its limit of stability, from t = {growth.begin:.6g} s on; the "
        f"product of their tangents {grows}, which the motion does not explain"
    )


def divided_places(places: OutputPlaces, steps: Steps, parts: np.ndarray) -> OutputPlaces:
    """The same outputs in the divided steps."""
    k, first = places.index, np.concatenate([[0], np.cumsum(parts)])
    part = steps.h[k] / parts[k]
    ends = places.ends_of(steps)
    number = np.floor(np.divide(places.length, part, out=np.zeros(k.size), where=part > 0))
    number = np.where(ends, parts[k] - 1, np.minimum(number, parts[k] - 1)).astype(int)
    length = np.where(ends, part, np.maximum(places.length - number * part, 0.0))
    return OutputPlaces(first[k] + number, length, places.modes)
