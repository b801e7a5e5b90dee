"""Gaps at the start of a run: none is negative beyond a tolerance; those within it are closed."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, DalembertError
from dalembert.model.model import Model
from dalembert.model.rigid_gaps import RigidGap
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

TOUCHING = 1e-9
"""Gap, in natural lengths, that counts as none."""
ROUNDED = 1e-4
"""Overlap, in natural lengths, that a start of rounded numbers may have."""


def refuse_overlap(model: Model, start: float) -> None:
    """With the parameters as they were when the model was built.

    Raises
    ------
    AnalysisError
        As ``refuse_negative``.
    """
    touching_model(model, model.nominal, start)


def touching_model(model: Model, p: np.ndarray, start: float) -> tuple[Model, str]:
    """The model whose start closes gaps that overlap within the tolerance, and which these are.

    The positions that it starts from satisfy ``g = 0`` of these gaps exactly, so that they, and
    gradients, are those of bodies that touch.

    Raises
    ------
    AnalysisError
        Bodies overlap by more, or the start cannot be moved.
    """
    e = model.all_equations
    if not e.contacts:
        return model, ""
    plain = start == 0 and p is model.nominal
    y = model.start.y if plain else model.assemble(p, start).y
    found = _distances(model)(start, y, p).full().ravel()
    refuse_negative(e.contacts, found, ROUNDED * e.scales.length)
    closed = tuple(map(int, np.flatnonzero(found < -TOUCHING * e.scales.length)))
    if not closed:
        return model, ""
    try:
        made = _closed(model, closed)
        made.assemble(p, start)
    except DalembertError:  # the start is prescribed
        refuse_negative(e.contacts, found, TOUCHING * e.scales.length)
        raise
    told = [f"{e.contacts[k].name} by {-found[k]:.3g} m" for k in closed]
    return made, f"{', '.join(told)} (at most {ROUNDED * e.scales.length:.3g} m)"


@once
def _distances(model: Model) -> ca.Function:
    e = model.all_equations
    distances = ca.vertcat(*(gap.distance for gap in e.contacts))
    return ca.Function("gaps", [e.t, e.y, e.p], [ca.densify(distances)])


@once
def _closed(model: Model, gaps: tuple[int, ...]) -> Model:
    """The model that starts with some gaps closed."""
    parts = model.parts.copy()
    for k in gaps:
        distance = Expression(model.all_equations.contacts[k].distance)
        parts.initial_conditions.append((distance, Expression(0.0)))
    return Model(parts)


def refuse_negative(gaps: Sequence[RigidGap], distances: np.ndarray, near: float) -> None:
    """Bodies must not overlap where a run starts.

    Raises
    ------
    AnalysisError
        Names the first that do.
    """
    for k in map(int, np.flatnonzero(distances < -near)):
        raise AnalysisError(
            f"{gaps[k].name}: its gap is {distances[k]:.6g} m at the start, and at most {near:.3g} "
            "m of overlap are taken for rounding; it must not be negative, so move the bodies apart"
        )
