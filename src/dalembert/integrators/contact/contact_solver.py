"""Options of the solver for frictional contact impulses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.options import options

if TYPE_CHECKING:
    from dalembert.integrators.contact.contacts import FrictionProblem
    from dalembert.integrators.contact.impulses import Impulses


@options
class ContactSolver:
    """Semismooth Newton method (Alart & Curnier 1991), started from the previous impulses.

    Accelerated Gauss–Seidel sweeps precede it and alternate with it, for many contacts of free
    bodies only where it and a few proximal problems fail. If these stagnate, too, the proximal
    point method follows: it solves a sequence of problems with ``H + α D`` and ``b − α D P``, ``D``
    the diagonal of ``H``, whose solution is the next ``P``. These problems are definite, so that
    Newton's method converges, and their limit solves the original problem (Acary, Brémond & Huber
    2018).

    In machine code, proximal problems follow Newton's method at once, which suits boxes with more
    contacts than unknown speeds; interior points of the friction cones follow the first one that
    Newton's method does not solve, unless the residual is small by then (Acary, Armand, Nguyen &
    Shpakovych 2024). Where pairs of bodies press at several points, as boxes do, interior
    points rarely converge, and follow after several failures of Newton's method.

    Parameters
    ----------
    tolerance : upper limit of the residual, relative to the largest speed of a contact [-];
        Newton's method aims at a tenth of it
    acceptable : residual, relative to the same speed, with which a run continues, and warns, where
        the tolerance is out of reach [-]
    max_iterations : upper limit of iterations of the proximal method

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("landing", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> contact = planar.contact
    >>> shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    >>> hits = system.add(planar.Collisions("hits", shapes))
    >>> scheme, solver = da.MoreauJean(), da.ContactSolver(tolerance=1e-12)
    >>> options = {"integrator": scheme, "solver": solver}
    >>> motion = da.solve_nonsmooth(system.build(), 0.5, step=0.01, **options)
    >>> round(float(motion.impulse("hits").sum()), 6)  # m g t, the impulse of gravity
    5.0
    """

    tolerance: float = 1e-8
    acceptable: float = 1e-6
    max_iterations: int = 500

    def __post_init__(self) -> None:
        for name in ("tolerance", "acceptable"):
            if not 0 < getattr(self, name) < 1:
                text = f"ContactSolver({name}={getattr(self, name)}): give a share such as 1e-9"
                raise UnsupportedError(text)
        if self.max_iterations < 0:
            text = f"ContactSolver(max_iterations={self.max_iterations}): give 0 or more"
            raise UnsupportedError(text)

    @property
    def newton_tolerance(self) -> float:
        """Residual at which Newton's method ends, and accuracy of what follows from it [-]."""
        from dalembert.integrators.contact.solution_settings import NEWTON_SHARE

        return NEWTON_SHARE * self.tolerance

    def solve(self, problem: FrictionProblem, start: np.ndarray | None = None) -> Impulses:
        """Impulses of a problem, from an initial guess ``start``, zero by default.

        They are in their cones: those beyond by less than the tolerance are shortened.
        """
        from dalembert.integrators.contact.impulses import Impulses, solved_impulses

        guess = np.zeros(problem.shape) if start is None else start
        limits = self.tolerance, max(self.tolerance, self.acceptable), self.max_iterations
        solution = solved_impulses(problem, guess, *limits)
        if not solution.accepted:
            return solution
        inside = problem.project(solution.impulses, np.zeros(problem.shape))
        return Impulses(inside, solution.residual, solution.converged, solution.rounds)
