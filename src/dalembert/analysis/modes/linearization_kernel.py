"""Compiled functions of the linearisation of a mechanism about a state."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.equilibrium.statics_kernel import statics_kernel
from dalembert.analysis.modes.rotation_axes import RotationAxes
from dalembert.formulations.base import state_rate
from dalembert.formulations.kkt import KKT
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.oscillation import oscillation, parts
from dalembert.symbolic.once import CacheOwner, once


class LinearizationKernel(CacheOwner):
    """Compiled functions of one model, in a choice of coordinates.

    Raises
    ------
    SingularityError
        A motion has no mass.
    """

    def __init__(self, model: Model, coordinates: Coordinates):
        model.diagnosis.refuse_massless("no modes")
        model.closure.refuse_singular_start()
        self.model, self.view = model, coordinates.view(model)
        self.e = self.view.equations

    @cached_property
    def sizes(self) -> tuple[np.ndarray, np.ndarray]:
        """Natural sizes of the state (N,) and of the equations (m,)."""
        e, s = self.e, self.e.scales
        bounds = np.ones(e.manifold.bounds.numel())
        by_level = np.concatenate([s.rows[list(e.holds)], bounds, s.rows / s.time])
        return np.concatenate([s.coordinates, s.speeds]), by_level

    @cached_property
    def system(self) -> ImplicitFunction:
        """``(t, x, p) → F, (Φ, Ψ)`` with ``x = [y; v]``."""
        e = self.e
        rate = state_rate(e)[: e.coordinate_count + e.speed_count]
        level = ca.vertcat(self._position_level, e.velocity_constraints)
        accelerations = KKT().acceleration(e, e.constraint_acceleration, [rate, level])
        inputs, stages = [e.t, ca.vertcat(e.y, e.v), e.p], accelerations.stages
        return ImplicitFunction("linearized", inputs, stages, accelerations.outputs)

    @once
    def small_motions(self, axes: RotationAxes | None) -> ImplicitFunction:
        """``(t, x, p, q) → (J − Ω) q, G q``, with the turning ``Ω`` of axes unless they rest."""
        e, inputs = self.e, self.system.inputs
        q = ca.SX.sym("q", inputs[1].numel())
        along = [ca.SX.zeros(inputs[0].numel()), q, ca.SX.zeros(inputs[2].numel())]
        changes = self.system.along(along, [q])
        rate, level = changes.outputs
        if axes is not None:
            rate = rate - ca.mtimes(axes.turning(e), q)
        return ImplicitFunction("small_motions", changes.inputs, changes.stages, [rate, level])

    @once
    def turned(self, axes: RotationAxes) -> ca.Function:
        """``x → S``; see ``RotationAxes``."""
        e = self.e
        return ca.Function("turned", [ca.vertcat(e.y, e.v)], [ca.densify(axes.state(e))])

    @cached_property
    def resting(self) -> ImplicitFunction:
        """``(t, [y; λ] nearby, p) → x`` of the equilibrium."""
        equilibrium = statics_kernel(self.model).configuration
        e = self.model.equations
        still = ca.substitute(self._state_of_bodies, e.v, ca.SX.zeros(e.speed_count))
        return ImplicitFunction("resting", equilibrium.inputs, equilibrium.stages, [still])

    @cached_property
    def assembled(self) -> ImplicitFunction:
        """``(t, y nearby, p) → x`` of the assembled state."""
        start, e = self.model.initial_state, self.model.equations
        x = ca.substitute(self._state_of_bodies, ca.vertcat(e.y, e.v), ca.vertcat(*start.outputs))
        return ImplicitFunction("assembled", start.inputs, start.stages, [x])

    @property
    def _state_of_bodies(self) -> ca.SX:
        """``x`` in these coordinates as expression in t, y, v and p of the bodies."""
        return ca.vertcat(*self.view.reduce.outputs)

    def state(self, t: float, y: np.ndarray, v: np.ndarray, p: np.ndarray) -> np.ndarray:
        """``x`` from positions and speeds of the bodies."""
        return np.concatenate(
            [part.full().ravel() for part in self.view.reduce.function(t, y, v, p)]
        )

    @cached_property
    def placing(self) -> ca.Function:
        """``(t, y, p, r, i, R, M, I)`` → coordinates of all bodies and their oscillation."""
        e, vectors = self.e, parts(self.e.coordinate_count)
        bodies = self.view.lift(self.model.all_equations.y)
        return ca.Function("placing", [e.t, e.y, e.p, *vectors], oscillation(bodies, e.y, vectors))

    @cached_property
    def curvature(self) -> ca.Function:
        """``(t, y, p, a, b) → aᵀ Φ″ b/2`` of the rows at position level."""
        e, (a, b, *_) = self.e, parts(self.e.coordinate_count)
        along = ca.jtimes(ca.jtimes(self._position_level, e.y, a), e.y, b) / 2
        return ca.Function("curvature", [e.t, e.y, e.p, a, b], [ca.densify(along)])

    @property
    def _position_level(self) -> ca.SX:
        """Φ with the equations of the manifold."""
        e = self.e
        return ca.vertcat(e.constraints[list(e.holds), :], e.manifold.bounds)

    def bodies(self, t: float, x: np.ndarray, p: np.ndarray) -> np.ndarray:
        """``y`` of all bodies from a state."""
        return self.view.body_coordinates(t, x[: self.e.coordinate_count], p)

    def matrices(
        self, axes: RotationAxes | None, t: float, x: np.ndarray, p: np.ndarray
    ) -> list[np.ndarray]:
        """``J − Ω`` and ``G``."""
        columns = self.small_motions(axes).function.map(x.size)(t, x, p, np.eye(x.size))
        return [matrix.full() for matrix in columns]


linearization_kernel = once(LinearizationKernel)
"""Kernel of a model and a choice of coordinates, compiled once."""
