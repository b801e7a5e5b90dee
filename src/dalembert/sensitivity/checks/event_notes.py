"""Notes on gradients of runs over switches, impacts and contacts.

Error control applies to states. The derivatives of its steps are less accurate if forces are stiff
or change suddenly: an error that is small relative to the state may vary quickly with parameters.
Fixed steps are cut at impacts. There the gradient follows the motion and not the cut step, which
differs by the error of the step.
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.transition import Transition
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.responses.base import Response
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.checks.nonsmooth_notes import nonsmooth_notes
from dalembert.sensitivity.checks.stencils import parameter_scales
from dalembert.sensitivity.marching.stable_steps import in_halves, with_stable_steps
from dalembert.sensitivity.methods import Automatic
from dalembert.symbolic.once import once

GRAZING_RATE = 1e-6
"""Threshold of the crossing speed of a switch, in natural units [-]."""


def switch_notes(motion: Result) -> list[str]:
    """Notes on the switches that a dynamic run went over."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    crossed = _inside_steps(motion) if kernel.adaptive is None else []
    return [*crossed, *_grazed_switches(motion, kernel)]


def _inside_steps(motion: Recording) -> list[str]:
    """Note on switches inside fixed steps, detected at the outputs."""
    function, s = _switching(motion.model), motion.trajectory
    if not function.numel_out(0) or s.t.size < 2:
        return []
    p = np.tile(motion.parameters[:, None], s.t.size)
    positive = function.map(s.t.size)(s.t, s.y, s.v, p).full() > 0
    changes = np.flatnonzero((positive[:, 1:] != positive[:, :-1]).any(axis=0))
    if not changes.size:
        return []
    return [
        f"fixed steps went over switches of forces or laws, {changes.size} between the outputs, "
        f"first after t = {s.t[changes[0]]:.6g} s: the derivative is that of the branches taken, "
        "without the terms of the moving instants; DormandPrince() and Radau() locate them"
    ]


@once
def _switching(model: Model) -> ca.Function:
    """``(t, y, v, p) → g``, all switching functions."""
    e = model.equations
    switches = e.with_frozen_branches().switches
    g = ca.substitute(switches.functions, switches.sides, switches.actual)
    return ca.Function("switching", [e.t, e.y, e.v, e.p], [ca.densify(g)])


def _grazed_switches(motion: Recording, kernel: DynamicsKernel) -> list[str]:
    """Notes on switches crossed too slowly for differentiable instants."""
    steps, notes = motion.record.steps, []
    for k, transition in kernel.crossings(steps):
        if not isinstance(transition, Transition):
            continue  # see contact_notes
        size = transition.step.state_size
        pace = float(transition.pace(steps.t[k], steps.x[:size, k], motion.parameters))
        if not abs(pace) > GRAZING_RATE:
            notes.append(
                f"a switch is only grazed at t = {steps.t[k]:.6g} s: its instant, and with it the "
                "motion after it, has no derivative there; move it, or smooth the force"
            )
    return notes


GRAZING_SPEED = 1e-4
"""Threshold of the closing speed of a gap for a differentiable instant, in natural units [-]."""


def contact_notes(motion: Result) -> list[str]:
    """Notes on impacts whose order or number changes with the parameters."""
    if isinstance(motion, NonsmoothMotion):
        return nonsmooth_notes(motion)
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    names = [gap.name for gap in kernel.equations.contacts]
    steps = motion.record.steps
    changes = [(k, c) for k, c in kernel.crossings(steps) if isinstance(c, ContactChange)]
    notes = [
        f"{names[gap]} is only grazed at t = {time:.6g} s: its instant, and with it the motion "
        "after it, has no derivative there; move it apart or closer"
        for gap, time in _grazed_gaps(motion, changes).items()
    ]
    for k, change in changes:
        time = steps.t[k]
        for gap in sorted(change.closes):
            notes.append(
                f"bounces of {names[gap]} accumulate at t = {time:.6g} s and end there: the "
                "derivative is that of the computed bounces, whose number changes with parameters"
            )
        if change.together and not change.closes:
            together = ", ".join(names[gap] for gap in change.together)
            notes.append(
                f"{together} close at one time, t = {time:.6g} s: parameters that separate "
                "them make successive impacts, so the derivative is that of a simultaneous impact"
            )
    return notes


def refuse_unlocated(motion: Result) -> None:
    """Refuse gradients over a change of the face of a contact whose instant has no derivative.

    Raises
    ------
    UnsupportedError
        A body comes to rest at a corner, or the distance jumps there.
    """
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return
    steps = motion.record.steps
    for k, change in kernel.crossings(steps):
        if not isinstance(change, ContactChange) or change.guard is not None:
            continue
        if steps.t[k] > steps.t[0] and (left := change.left_branches):
            names = ", ".join(kernel.equations.contacts[gap].name for gap in left)
            raise UnsupportedError(
                f"{names} reaches the end of a face at t = {steps.t[k]:.6g} s at rest, or the "
                "distance jumps there: this instant, and with it the motion after it, has no "
                "derivative; end the run before, or move the start"
            )


def _grazed_gaps(motion: Recording, changes: list[tuple[int, ContactChange]]) -> dict[int, float]:
    """Gap → first time of slow closing, except by the last of accumulating bounces."""
    steps, slow = motion.record.steps, dict[int, float]()
    for k, change in changes:
        gap, size = change.gap, change.step.state_size
        if change.struck and gap is not None:
            pace = float(change.pace(steps.t[k], steps.x[:size, k], motion.parameters))
            if not abs(pace) > GRAZING_SPEED:
                slow.setdefault(gap, float(steps.t[k]))
        for closed in change.closes:
            slow.pop(closed, None)
    return slow


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
