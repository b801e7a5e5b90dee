"""Impulses of contacts with friction, to round-off: Newton's method, and sweeps where it fails."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.friction_problem import FrictionProblem
from dalembert.integrators.contact.gauss_seidel import coloured, gauss_seidel
from dalembert.integrators.contact.semismooth_newton import semismooth_newton
from dalembert.options import options

FIRST = 20
"""Sweeps before Newton's method is tried again; each time twice as many."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """What a solver found.

    Attributes
    ----------
    impulses : (n, k)
    residual : largest speed by which the conditions are missed [m/s]
    converged : the residual is within the tolerance
    sweeps : of Gauss–Seidel
    """

    impulses: np.ndarray
    residual: float
    converged: bool
    sweeps: int


@options
class ContactSolver:
    """Semismooth Newton (Alart–Curnier) from the impulses before, projected Gauss–Seidel where it
    gets stuck, and Newton again.

    Parameters
    ----------
    tolerance : largest residual, relative to the largest speed of a contact
    sweeps : of Gauss–Seidel, at most
    """

    tolerance: float = 1e-12
    sweeps: int = 20000

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < 1:
            text = f"ContactSolver(tolerance={self.tolerance}): give a share such as 1e-12"
            raise UnsupportedError(text)
        if self.sweeps < 0:
            raise UnsupportedError(f"ContactSolver(sweeps={self.sweeps}): there are 0 or more")

    def solve(self, problem: FrictionProblem, start: np.ndarray | None = None) -> Impulses:
        """Impulses of a problem, from ``start`` if given."""
        allowed = self.tolerance * problem.scale
        found = np.zeros(problem.shape) if start is None else start
        found = semismooth_newton(problem, found, allowed)
        left, taken, ahead = problem.residual(found), 0, FIRST
        parts = coloured(problem) if left > allowed and self.sweeps else []
        while left > allowed and taken < self.sweeps:
            swept = gauss_seidel(problem, found, parts, ahead)
            taken, ahead = taken + ahead, 2 * ahead
            tried = semismooth_newton(problem, swept, allowed)
            found = min((swept, tried), key=problem.residual)
            left = problem.residual(found)
        return Impulses(found, left, bool(left <= allowed), taken)
