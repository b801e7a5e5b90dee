"""Notes on gradients of runs with rigid contacts."""

from __future__ import annotations

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.sensitivity.nonsmooth.pattern_changes import nonsmooth_notes

GRAZING = 1e-4
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
        for gap, time in _grazed(motion, changes).items()
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


def _grazed(motion: Recording, changes: list[tuple[int, ContactChange]]) -> dict[int, float]:
    """Gap → first time of slow closing, except by the last of accumulating bounces."""
    steps, slow = motion.record.steps, dict[int, float]()
    for k, change in changes:
        gap, size = change.gap, change.step.state_size
        if change.struck and gap is not None:
            pace = float(change.pace(steps.t[k], steps.x[:size, k], motion.parameters))
            if not abs(pace) > GRAZING:
                slow.setdefault(gap, float(steps.t[k]))
        for closed in change.closes:
            slow.pop(closed, None)
    return slow
