"""Residuals of the model's own equations for a page, with which it judges its results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.model_residuals import (
    CHECKED,
    STILL,
    constraint_rows,
    energies,
    motion_rows,
    violation,
)
from dalembert.analysis.residual_check import EXACT, MOTION
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model


def residuals(model: Model, bodies: ca.Function) -> ca.Function:
    """``(t, x, p) → (violation; T; V; dissipated; input), (v̇; λ), rows, terms``.

    Rows are those of each level and of the equations of motion; terms are sums of the magnitudes
    of their parts.

    Parameters
    ----------
    bodies : ``(t, x, p) → y, v, v̇, λ, work`` of all bodies and equations
    """
    t, x, p = (ca.MX.sym(n, bodies.numel_in(k)) for k, n in enumerate("txp"))
    y, v, a, multiplier, work = bodies(t, x, p)
    missing = model.all_equations.transmitted.numel() - multiplier.numel()
    forces = ca.vertcat(multiplier, ca.MX.zeros(missing))
    sums = ca.vertcat(violation(model)(t, y, p), energies(model)(t, y, v, p), work)
    levels, level_terms = constraint_rows(model)(t, y, v, a, p)
    motion, motion_terms = motion_rows(model)(t, y, v, a, forces, p)
    outputs = [
        sums,
        ca.vertcat(a, multiplier),
        ca.vertcat(levels, motion),
        ca.vertcat(level_terms, motion_terms),
    ]
    return ca.Function("residuals", [t, x, p], [ca.densify(output) for output in outputs])


def check_data(
    model: Model,
    levels: Mapping[Level, tuple[float, bool]] | Iterable[Level],
    motion: float | None = MOTION,
    **more: Any,
) -> dict[str, Any]:
    """Limits, sizes and names for the check of residuals.

    Parameters
    ----------
    levels : limit of each checked level, and whether residuals are compared with the largest terms;
        by default the limit of enforced constraints
    motion : limit for the equations of motion, None where the result has no forces
    more : further limits
    """
    limits = levels if isinstance(levels, Mapping) else {n: (EXACT[n], False) for n in levels}
    scales, guesses = model.scales, model.guesses
    count = model.all_equations.constraint_count
    owners = [model.closure.owners[row] for row in range(count)]
    efforts = ["N" if unit == "m" else "N m" for unit in guesses.speed_units]
    return {
        "levels": [[int(n), limit, drifts] for n, (limit, drifts) in limits.items()],
        "rows": list(model.equation_names),
        "units": [constraint.units()[k] for constraint, k in owners],
        "sizes": np.asarray(scales.rows),
        "motion": motion,
        "speeds": list(guesses.speed_names),
        "speed_sizes": np.asarray(scales.speeds),
        "effort_units": efforts,
        "efforts": np.asarray(scales.efforts),
        "time": scales.time,
        "checked": CHECKED,
        "still": STILL,
        **more,
    }


def all_multipliers(model: Model, independent: ca.MX) -> ca.MX:
    """Multipliers of every equation, zero for redundant ones."""
    place = np.zeros((len(model.closure.owners), len(model.closure.rows)))
    place[list(model.closure.rows), np.arange(len(model.closure.rows))] = 1.0
    return ca.mtimes(ca.sparsify(ca.DM(place)), independent)
