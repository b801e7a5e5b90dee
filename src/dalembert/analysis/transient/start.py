"""Initial state of a transient: initial motion or static equilibrium, consistent accelerations."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.equilibrium.load_steps import LoadSteps, StepControl
from dalembert.analysis.equilibrium.static_equations import StaticEquations, free_factors
from dalembert.analysis.transient.equation import EquationOfMotion, Motions, factors
from dalembert.analysis.transient.instant import Instant, Unknown
from dalembert.errors import AnalysisError, ModelError
from dalembert.integrators.newmark.rule import Moving

MASSLESS = (
    "the mass matrix is singular: displacements without mass are coupled to others; give all "
    "elements a density, or use lumped=True"
)


class TransientStart:
    """The initial state.

    Accelerations follow from the equations of motion; massless displacements have none.

    Parameters
    ----------
    equation : EquationOfMotion
    kind : ``"rest"``, the initial motion of the structure; ``"statics"``, equilibrium under the
        loads at that time, with the initial velocities
    case : name of the load case
    time : start of the run [s]

    Raises
    ------
    ModelError
        Initial displacements together with ``"statics"``.
    """

    def __init__(self, equation: EquationOfMotion, kind: str, case: str, time: float = 0.0):
        self.equation, self.static, self.case, self.time = equation, kind == "statics", case, time
        self.initial = equation.model.initial
        if self.static and self.initial.displaced:
            raise ModelError(
                "initial displacements are given, and start='statics' computes them; drop one",
                equation.model.name,
            )

    def state(self) -> Moving:
        """Displacements, velocities and accelerations; the memory of the method is zero.

        Raises
        ------
        SingularityError
            The mass matrix is singular; for ``"statics"``, the structure is a mechanism.
        AnalysisError
            No static equilibrium was found.
        """
        e, p = self.equation, self.equation.p
        held = e.support_motion(self.time)
        v, a = self.initial.velocities.values(p), np.zeros(e.assembly.size)
        v[e.held], a[e.held] = held.v, held.a
        u = self._equilibrium(held.u) if self.static else self.initial.displacements.values(p)
        u[e.held] = held.u
        unknown = self._accelerations(Instant(e, Motions(u, v, a), self.time))
        a[e.massive] = unknown.correction(unknown.value)
        return Moving(u, v, a, np.zeros_like(a))

    def push(self, instant: Instant) -> Moving:
        """Change of the state with the parameters."""
        e, changes = self.equation, instant.parameters
        held = changes.supports(self.time)
        u = (
            np.zeros_like(instant.parameter_change)
            if self.static
            else changes.each(self.initial.displacements)
        )
        v, a = changes.each(self.initial.velocities), np.zeros_like(u)
        u[e.held], v[e.held], a[e.held] = held
        if self.static:
            u[e.free] = self._displacements(instant.at_rest()).tangent(Motions(u, 0 * v, 0 * a))
        a[e.massive] = self._accelerations(instant).tangent(Motions(u, v, a))
        return Moving(u, v, a, np.zeros_like(a))

    def pull(self, instant: Instant, weights: Moving) -> None:
        """Pass weights of the state to the parameters."""
        e, parameters = self.equation, instant.parameters
        by_motion = self._accelerations(instant).adjoint(weights.a[e.massive])
        total = instant.free_weights(weights, by_motion)
        parameters.pull(self.initial.velocities, total.v)
        if not self.static:
            parameters.pull(self.initial.displacements, total.u)
            return
        still = self._displacements(instant.at_rest())
        by_displacement = still.adjoint(total.u[e.free])
        zeros = np.zeros_like(by_displacement.u)
        still.at.free_weights(Moving(*(zeros,) * 4), Motions(by_displacement.u, zeros, zeros))

    def _accelerations(self, at: Instant) -> Unknown:
        """Accelerations of the displacements with mass."""
        rows = self.equation.massive
        return Unknown(at, rows, lambda: factors(at.slopes.a[rows][:, rows], MASSLESS))

    def _displacements(self, at: Instant) -> Unknown:
        """Free displacements at rest."""
        e = self.equation
        inner = e.assembly.inner
        return Unknown(at, e.free, lambda: free_factors(e.model, inner(at.stiffness)))

    def _equilibrium(self, held: np.ndarray) -> np.ndarray:
        e = self.equation
        u = np.zeros(e.assembly.size)
        if not e.linear:
            path = LoadSteps(StepControl(), StaticEquations(e.model, e.p, self.case, self.time))
            for _ in path.follow():
                u = path.u
            if path.failure:
                text = f"at the start, {path.failure} or use start='rest'"
                raise AnalysisError(text, path.residual)
        u[e.held] = held
        unknown = self._displacements(Instant(e, Motions(u, 0 * u, 0 * u), self.time))
        u[e.free] += unknown.correction(unknown.value)  # only round-off after nonlinear statics
        return u
