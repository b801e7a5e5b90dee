"""Controls that alternate from node to node: how often, and a penalty that prevents it.

Where a control enters linearly and nothing decides it (a singular arc), an optimiser lets it
alternate at every node. Polynomials through alternating nodes meet the equations of motion where
they are collocated and nowhere else, so that such a plan is better than any motion.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.transcription import Transcription

LARGE = 0.05
"""Step of a control, relative to its range, that counts."""
CLOSE = 3
"""Nodes between two reversals that belong to one chattering."""
MANY = 5
"""Close reversals beyond which a control chatters."""
WEIGHT = 1e-3
"""Penalty on the roughness of controls, relative to the objective."""


def reversals(control: Control) -> int:
    """Number of changes between rising and falling that follow one another closely."""
    steps = np.diff(control.values)
    large = np.flatnonzero(np.abs(steps) > LARGE * float(np.ptp(control.values)))
    if large.size < 2:
        return 0
    turns = large[1:][np.sign(steps[large[1:]]) != np.sign(steps[large[:-1]])]
    return int(np.count_nonzero(np.diff(turns) <= CLOSE))


def chattering(controls: dict[str, Control]) -> dict[str, int]:
    """Name → reversals of the controls that chatter."""
    found = {name: reversals(control) for name, control in controls.items()}
    return {name: count for name, count in found.items() if count > MANY}


def roughness(transcription: Transcription) -> ca.MX:
    """``Σ (Δ²u)²`` over the nodes, in units of the largest controls."""
    ends, middles = (transcription.blocks[name].symbol for name in ("u", "u_middle"))
    inner = ends[:, :-1] - 2 * middles + ends[:, 1:]
    outer = middles[:, :-1] - 2 * ends[:, 1:-1] + middles[:, 1:]
    return ca.sumsqr(inner) + ca.sumsqr(outer)
