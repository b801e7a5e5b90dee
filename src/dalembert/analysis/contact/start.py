"""Gaps at the start of a run: none may be negative."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError
from dalembert.model.model import Model
from dalembert.model.rigid_gaps import RigidGap

TOUCHING = 1e-9
"""Gap, in natural lengths, that counts as none."""


def refuse_overlap(model: Model, start: float) -> None:
    """With the parameters as they were when the model was built.

    Raises
    ------
    AnalysisError
        As ``refuse_negative``.
    """
    e = model.all_equations
    if not e.contacts:
        return
    distances = ca.vertcat(*(gap.distance for gap in e.contacts))
    function = ca.Function("gaps", [e.t, e.y, e.p], [ca.densify(distances)])
    y = model.start.y if start == 0 else model.assemble(model.nominal, start).y
    found = function(start, y, model.nominal).full().ravel()
    refuse_negative(e.contacts, found, TOUCHING * e.scales.length)


def refuse_negative(gaps: Sequence[RigidGap], distances: np.ndarray, near: float) -> None:
    """Bodies must not overlap where a run starts.

    Raises
    ------
    AnalysisError
        Names the first that do.
    """
    for k in map(int, np.flatnonzero(distances < -near)):
        raise AnalysisError(
            f"{gaps[k].name}: its gap is {distances[k]:.6g} at the start; it must not be negative, "
            "so move the bodies apart"
        )
