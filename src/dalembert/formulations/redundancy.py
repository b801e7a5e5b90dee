"""Redundant equations: which are solved, and how well the others follow from them.

``C`` has more rows than its rank. Some rows S are solved, and the others follow, ``C_R = W C_S``:
rounding of the ones returns in the others times ``W``. As the mechanism moves, so does ``W``, and
rows that were independent at the start need not stay so. The best rows are those with ``|W| ≤ 1``;
angles and lengths are compared by the mechanism's own size.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.errors import SingularityError
from dalembert.formulations.partition import largest_volume
from dalembert.model.equations import Equations
from dalembert.symbolic.equations.factor import LdlFactor

TRUSTED = 3.0
"""Largest entry of ``W`` before others are solved: far enough from 1/0 for a step to pass."""


def largest_share(whole: Equations, rows: tuple[int, ...]) -> ca.SX:
    """Largest entry of ``|W|`` for these rows, of t, y and p."""
    c = ca.mtimes(ca.diag(1 / ca.SX(whole.scales.rows)), whole.jacobian)
    left = [k for k in range(whole.constraint_count) if k not in rows]
    kept, others = c[list(rows), :], c[left, :]
    factor = LdlFactor(ca.mtimes(kept, kept.T))
    return ca.norm_inf(ca.vec(factor.solve(ca.mtimes(kept, others.T))))


def best_rows(
    whole: Equations, rows: tuple[int, ...], t: float, y: np.ndarray, p: np.ndarray
) -> tuple[int, ...]:
    """As many rows from which all others follow with ``|W| ≤ 1`` at a position, most of them kept.

    Raises
    ------
    SingularityError
        Equations without a value here.
    """
    evaluate = ca.Function("C", [whole.t, whole.y, whole.p], [ca.densify(whole.jacobian)])
    jacobian = evaluate(t, y, p).full() / whole.scales.rows[:, None]
    if not np.all(np.isfinite(jacobian)):
        raise SingularityError(f"the constraint equations have no value at t = {t:.9g} s")
    return largest_volume(np.linalg.svd(jacobian)[0][:, : len(rows)], rows)
