"""Projected Gauss–Seidel sweeps with Anderson acceleration, in machine code.

A sweep visits all contacts: ``P_N ← max(minimum, P_N − u_N/H_NN)``, then ``P_j ← P_j − ρ u_j`` of
each tangential group, shortened to ``μ_j P_N``; the speeds of the bodies follow at once (Jourdan,
Alart & Jean, Comput. Methods Appl. Mech. Eng. 155, 1998). With the changes ``f`` of the last
sweeps, the next one begins from ``P − Σ γ_i ΔP_i``, where ``γ`` minimises ``|f − Σ γ_i Δf_i|``
(Anderson 1965; Walker & Ni, SIAM J. Numer. Anal. 49, 2011).
"""

from __future__ import annotations

import numpy as np

from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.machine_code import (
    Loop,
    index_arrays,
    machine_code,
    problem_arrays,
)

DEPTH, GROWTH, REGULARIZATION = 10, 4.0, 1e-12
"""Stored sweeps; growth of the squared changes after which they are forgotten; regularisation of
the least-squares problem relative to its diagonal [-]."""
SWEEPS = 300
"""Upper limit of sweeps before Newton's method takes over."""


def swept(
    problem: FrictionProblem, impulses: np.ndarray, tolerance: float, limit: int = SWEEPS
) -> np.ndarray:
    """Impulses after sweeps; the same ones where no machine code is available.

    Parameters
    ----------
    problem : FrictionProblem
    impulses : (n, k) initial guess
    tolerance : change of the speed of a contact at which the sweeps end [m/s]
    limit : upper limit of sweeps
    """
    operator, code = problem.matrix, machine_code("sweep.c", "sweeps.c")
    if code is None or not isinstance(operator, Delassus) or not problem.shape[0]:
        return impulses
    result, rows, speeds = np.array(impulses), impulses.size, operator.directions.shape[1]
    settings = np.array([tolerance, GROWTH, REGULARIZATION])
    inputs = [*problem_arrays(problem, operator), settings, *index_arrays(problem, operator)]
    counts = [*problem.shape, len(problem.groups), limit, speeds, DEPTH]
    work = problem.shape[1] + (3 + 2 * DEPTH) * rows + (1 + DEPTH) * speeds
    work += DEPTH * (1 + 2 * DEPTH)
    outputs = [result, operator.response(result.ravel())]
    Loop(code, inputs, outputs, counts, work)()
    return result if np.isfinite(result).all() else impulses
