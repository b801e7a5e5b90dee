"""What gradients do not tell by themselves of runs that went over switches of forces and laws."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.transition import Transition
from dalembert.model.model import Model
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.symbolic.once import once

GRAZING = 1e-6
"""Speed at which a switch is crossed, in natural units, that is none."""


def over_switches(motion: Result) -> list[str]:
    """Sentences about the switches that a dynamic run went over."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    stepped = _stepped_over(motion) if kernel.adaptive is None else []
    return [*stepped, *_grazed(motion, kernel)]


def _stepped_over(motion: Recording) -> list[str]:
    """Switches that steps of given lengths do not see, by the outputs."""
    function, s = _switching(motion.model), motion.trajectory
    if not function.numel_out(0) or s.t.size < 2:
        return []
    p = np.tile(motion.parameters[:, None], s.t.size)
    sides = function.map(s.t.size)(s.t, s.y, s.v, p).full() > 0
    changes = np.flatnonzero((sides[:, 1:] != sides[:, :-1]).any(axis=0))
    if not changes.size:
        return []
    return [
        f"steps of given length went over switches of forces or laws, {changes.size} between the "
        f"outputs, first after t = {s.t[changes[0]]:.6g} s: the derivative is that of the branches "
        "taken, without what the moving instants add; DormandPrince() and Radau() locate them"
    ]


@once
def _switching(model: Model) -> ca.Function:
    """``(t, y, v, p) → g`` of all switches."""
    e = model.equations
    found = e.with_frozen_branches().switches
    g = ca.substitute(found.functions, found.sides, found.actual)
    return ca.Function("switching", [e.t, e.y, e.v, e.p], [ca.densify(g)])


def _grazed(motion: Recording, kernel: DynamicsKernel) -> list[str]:
    """Switches that were crossed so slowly that their instants have no derivative."""
    steps, notes = motion.record.steps, []
    for k, transition in kernel.crossings(steps):
        if not isinstance(transition, Transition):
            continue  # contacts are told apart
        size = transition.step.state_size
        pace = float(transition.pace(steps.t[k], steps.x[:size, k], motion.parameters))
        if not abs(pace) > GRAZING:
            notes.append(
                f"a switch is only grazed at t = {steps.t[k]:.6g} s: its instant, and with it the "
                "motion after it, has no derivative there; move it, or smooth the force"
            )
    return notes
