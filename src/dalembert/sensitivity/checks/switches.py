"""What gradients do not tell by themselves of runs that went over switches of forces and laws."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.dynamics.transition import Transition
from dalembert.model.model import Model
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.extremes import SmoothExtreme
from dalembert.responses.integrals import OverRun
from dalembert.results.recording import Recording
from dalembert.results.result import Result
from dalembert.symbolic.once import once

BESIDE = 1e-6
"""Share of a step by which a measure is looked at beside a switch."""
JUMP = 1e-3
"""Change of a measure at a switch, relative to its largest value, that is a jump."""
GRAZING = 1e-6
"""Speed at which a switch is crossed, in natural units, that is none."""


def over_switches(motion: Result, responses: Sequence[Response]) -> list[str]:
    """Sentences about the switches that a dynamic run went over."""
    kernel = getattr(getattr(motion, "record", None), "kernel", None)
    if not isinstance(motion, Recording) or not isinstance(kernel, DynamicsKernel):
        return []
    stepped = _stepped_over(motion) if kernel.adaptive is None else []
    jumping = [note for r in responses for note in _jumping(motion, r, kernel)]
    return [*stepped, *_grazed(motion, kernel), *jumping]


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
    found = e.held().switches
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


def _jumping(motion: Recording, response: Response, kernel: DynamicsKernel) -> list[str]:
    """An integral over a measure that jumps lacks what the moved instants add to it."""
    crossings = [k for k, _ in kernel.crossings(motion.record.steps)]
    over_run = isinstance(response, OverRun) or isinstance(response.over(motion), SmoothExtreme)
    if not crossings or not over_run:
        return []
    steps = motion.record.steps
    t, h = steps.t[crossings], BESIDE * steps.h[steps.lasting].min()
    measure = scalar_measure(motion, response)
    beside = [motion.at(np.clip(t + s * h, *motion.time[[0, -1]])).values(measure) for s in (-1, 1)]
    size = np.max(np.abs(motion.values(measure)), initial=0.0)
    jumps = np.flatnonzero(np.abs(beside[1] - beside[0]) > JUMP * size)
    if not jumps.size:
        return []
    return [
        f"{response.label}: its measure jumps at {jumps.size} switch(es), first at "
        f"t = {t[jumps[0]]:.6g} s; the derivative lacks what the moving instants add to it"
    ]
