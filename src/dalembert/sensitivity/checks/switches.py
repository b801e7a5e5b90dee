"""Notes on gradients of runs over switches of forces and laws."""

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
"""Threshold of the crossing speed of a switch, in natural units [-]."""


def switch_notes(motion: Result) -> list[str]:
    """Notes on the switches that a dynamic run went over."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    crossed = _inside_steps(motion) if kernel.adaptive is None else []
    return [*crossed, *_grazed(motion, kernel)]


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
    switches = e.held().switches
    g = ca.substitute(switches.functions, switches.sides, switches.actual)
    return ca.Function("switching", [e.t, e.y, e.v, e.p], [ca.densify(g)])


def _grazed(motion: Recording, kernel: DynamicsKernel) -> list[str]:
    """Notes on switches crossed too slowly for differentiable instants."""
    steps, notes = motion.record.steps, []
    for k, transition in kernel.crossings(steps):
        if not isinstance(transition, Transition):
            continue  # see contact_notes
        size = transition.step.state_size
        pace = float(transition.pace(steps.t[k], steps.x[:size, k], motion.parameters))
        if not abs(pace) > GRAZING:
            notes.append(
                f"a switch is only grazed at t = {steps.t[k]:.6g} s: its instant, and with it the "
                "motion after it, has no derivative there; move it, or smooth the force"
            )
    return notes
