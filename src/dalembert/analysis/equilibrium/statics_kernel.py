"""Compiled static equations of a mechanism."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.graph.assembly.position import position_stages
from dalembert.model.graph.displaced_states import changing_at_rest, with_displaced_states
from dalembert.model.graph.model import Model
from dalembert.model.graph.sampled_rates import determined, with_sampled_rates
from dalembert.results.recording import Trajectory
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner, once


class StaticsKernel(CacheOwner):
    """Compiled static equations of a model.

    Attributes
    ----------
    model : Model
    states : coordinates of first order that the equilibrium determines, sampled ones included
    equations : of the model at rest, in which these have displacements
    """

    def __init__(self, model: Model):
        model.closure.refuse_singular_start()
        self.model = model
        whole = with_sampled_rates(model)
        changing = changing_at_rest(whole, model.start.y, model.nominal)
        self.states = sorted({*changing, *determined(model, whole)})
        self.equations = e = with_displaced_states(whole, self.states)
        at_rest = ca.substitute(e.force - e.bias, e.v, ca.SX.zeros(e.speed_count))
        forces = at_rest - ca.mtimes(e.jacobian.T, e.multiplier)
        self.balance = forces
        self.static = ca.Function(
            "static",
            [e.t, e.y, e.multiplier, e.p],
            [
                at_rest,
                e.jacobian,
                -e.by_displacement(forces),
                e.constraints,
            ],
            {"cse": True},
        )

    @property
    def configuration(self) -> ImplicitFunction:
        """``(t, [y; λ] nearby, p) → y, λ`` with exact derivatives."""
        e = self.equations
        near = ca.SX.sym("near", e.coordinate_count + e.constraint_count)
        unknown = ca.vertcat(e.y, e.multiplier)
        displacement = e.manifold.displacement(near[: e.coordinate_count], e.y)
        constraints = e.constraints
        if e.slips:
            constraints = constraints + ca.mtimes(e.slip_jacobian, displacement)
        residual = ca.vertcat(self.balance, constraints)
        sizes = e.scales
        rows = np.concatenate([sizes.efforts, sizes.rows])
        stages = position_stages(
            e, near, residual, rows, beside=e.multiplier, beside_sizes=sizes.multipliers
        )
        return ImplicitFunction("equilibrium", [e.t, near, e.p], stages, [unknown])

    @once
    def measured(self, measure: Expression) -> ImplicitFunction:
        """A measure of the equilibrium; speeds and accelerations are zero."""
        e = self.equations
        rates = ca.vertcat(e.v, e.a)
        at_rest = ca.substitute(e.without_dropped(measure.sx), rates, ca.SX.zeros(rates.numel()))
        configuration = self.configuration
        return ImplicitFunction("measured", configuration.inputs, configuration.stages, [at_rest])

    def near(self, s: Trajectory) -> np.ndarray:
        """Positions and multipliers at which the configuration is differentiated."""
        return np.vstack([s.y, s.multiplier[self.model.closure.rows]])


statics_kernel = once(StaticsKernel)
"""Kernel of a model, compiled once."""
