"""Where a transient begins: initial motion, static equilibrium, and accelerations to match."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.structural.instant import Instant, Unknown
from dalembert.analysis.structural.nonlinear_statics import LoadPath, NonlinearStatics
from dalembert.analysis.structural.static_equations import StaticEquations, factorised
from dalembert.analysis.structural.transient_equation import EquationOfMotion, Motions, factors
from dalembert.errors import AnalysisError, ModelError
from dalembert.integrators.newmark.rule import Moving

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
        begin = self._accelerations(Instant(e, Motions(u, v, a), self.time))
        a[e.massive] = begin.correction(begin.value)
        return Moving(u, v, a, np.zeros_like(a))

    def push(self, begin: Instant) -> Moving:
        """Change of the state with the parameters."""
        e, changes = self.equation, begin.parameters
        held = changes.supports(self.time)
        u = np.zeros_like(begin.own) if self.static else changes.each(self.initial.displacements)
        v, a = changes.each(self.initial.velocities), np.zeros_like(u)
        u[e.held], v[e.held], a[e.held] = held
        if self.static:
            u[e.free] = self._displacements(begin.at_rest()).tangent(Motions(u, 0 * v, 0 * a))
        a[e.massive] = self._accelerations(begin).tangent(Motions(u, v, a))
        return Moving(u, v, a, np.zeros_like(a))

    def pull(self, begin: Instant, weights: Moving) -> None:
        """Take weights of the state to the parameters."""
        e, parameters = self.equation, begin.parameters
        by_motion = self._accelerations(begin).adjoint(weights.a[e.massive])
        left = begin.freed(weights, by_motion)
        parameters.pull(self.initial.velocities, left.v)
        if not self.static:
            parameters.pull(self.initial.displacements, left.u)
            return
        still = self._displacements(begin.at_rest())
        by_place = still.adjoint(left.u[e.free])
        nothing = np.zeros_like(by_place.u)
        still.at.freed(Moving(*(nothing,) * 4), Motions(by_place.u, nothing, nothing))

    def _accelerations(self, at: Instant) -> Unknown:
        """Those where there is mass."""
        where = self.equation.massive
        return Unknown(at, where, lambda: factors(at.slopes.a[where][:, where], MASSLESS))

    def _displacements(self, at: Instant) -> Unknown:
        """The free ones, at rest."""
        e = self.equation
        inner = e.assembly.inner
        return Unknown(at, e.free, lambda: factorised(e.model, inner(at.stiffness)))

    def _equilibrium(self, held: np.ndarray) -> np.ndarray:
        e = self.equation
        u = np.zeros(e.assembly.size)
        if not e.linear:
            path = LoadPath(NonlinearStatics(), StaticEquations(e.model, e.p, self.case))
            for _ in path.follow():
                u = path.u
            if path.lost:
                text = f"at the start, {path.lost} or take start='rest'"
                raise AnalysisError(text, path.residual)
        u[e.held] = held
        still = self._displacements(Instant(e, Motions(u, 0 * u, 0 * u), self.time))
        u[e.free] += still.correction(still.value)  # in nonlinear statics round-off is left only
        return u
