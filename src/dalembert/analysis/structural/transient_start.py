"""Where a transient begins: initial motion, static equilibrium, and accelerations to match."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.structural.nonlinear_statics import LoadPath, NonlinearStatics
from dalembert.analysis.structural.statics import factorised
from dalembert.analysis.structural.transient_equation import (
    EquationOfMotion,
    Motions,
    Slopes,
    factors,
)
from dalembert.errors import AnalysisError, ModelError
from dalembert.integrators.newmark_rule import Moving
from dalembert.sparse.solver import Factors

STARTS = ("rest", "statics")
MASSLESS = (
    "the mass matrix is singular: displacements without mass are coupled to others; give all "
    "elements a density, or take lumped=True"
)


class TransientStart:
    """The state at the beginning.

    Accelerations follow from the equations of motion; displacements without any mass have none.

    Parameters
    ----------
    equation : EquationOfMotion
    kind : ``"rest"``, the initial motion that the structure describes; ``"statics"``, equilibrium
        under the loads at that time, with the initial velocities
    case : name of the load case
    time : beginning of the run [s]

    Raises
    ------
    ModelError
        Initial displacements beside ``"statics"``.
    """

    def __init__(self, equation: EquationOfMotion, kind: str, case: str, time: float = 0.0):
        self.equation, self.static, self.case, self.time = equation, kind == "statics", case, time
        self.initial = equation.model.initial
        if self.static and self.initial.given:
            raise ModelError(
                "initial displacements are given, and start='statics' computes them; drop one",
                equation.model.name,
            )

    def mass_factor(self, slopes: Slopes) -> Factors | None:
        """Factors of the mass matrix where there is mass."""
        massive = self.equation.massive
        return factors(slopes.a[massive][:, massive], MASSLESS)

    def state(self) -> Moving:
        """Displacements, velocities and accelerations; the method remembers nothing yet.

        Raises
        ------
        SingularityError
            The mass matrix is singular; for ``"statics"``, the structure is a mechanism.
        AnalysisError
            There is no static equilibrium.
        """
        e, p = self.equation, self.equation.p
        held = e.support_motion(self.time)
        v, a = self.initial.velocities.values(p), np.zeros(e.assembly.size)
        v[e.held], a[e.held] = held.v, held.a
        u = self._equilibrium(held.u) if self.static else self.initial.displacements.values(p)
        u[e.held] = held.u
        begin = Motions(u, v, a)
        rest, factor = e.loads(self.time) - e.forces(begin), self.mass_factor(e.slopes(begin))
        if factor is not None:
            a[e.massive] = factor.solve(rest[e.massive])
        return Moving(u, v, a, np.zeros_like(a))

    def _equilibrium(self, held: np.ndarray) -> np.ndarray:
        e = self.equation
        u = np.zeros(e.assembly.size)
        if not e.linear:
            path = LoadPath(NonlinearStatics(), e.model, e.p, self.case)
            for _ in path.follow():
                u = path.u
            if path.reached < 1.0:
                raise AnalysisError(
                    f"there is no static equilibrium beyond {path.reached:.4g} of the load at the "
                    "start; use start='rest' or lower loads",
                    path.residual,
                )
        u[e.held] = held
        factor = self.static_factor(u)
        if factor is not None:  # in nonlinear statics this leaves round-off only
            u[e.free] += factor.solve((e.loads(self.time) - e.internal_forces(u))[e.free])
        return u

    def static_factor(self, u: np.ndarray) -> Factors | None:
        """Factors of the tangent stiffness in the free displacements."""
        e = self.equation
        return factorised(e.model, e.assembly.inner(e.tangent(u)))
