"""Compiled functions of a driven mechanism: configuration at a time, and chunks of steps."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.assembly.position import position_stages
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.results.recording import Recording, Trajectory
from dalembert.symbolic.equations.factor import QrFactor
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.evaluation.kernel import SELDOM, Kernel, condensed
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner, once

ITERATIONS = 5
"""Newton iterations of a position."""


class KinematicsKernel(CacheOwner):
    """Compiled functions of one fully driven model."""

    def __init__(self, model: Model):
        self.model = model
        self.e: Equations = model.equations
        model.closure.refuse_singular_start()
        free = model.diagnosis.free
        if free:
            n = "degree" if free == 1 else "degrees"
            raise AnalysisError(
                f"the drivers leave {free} {n} of freedom undetermined; add {free} driver(s), "
                "or use solve_dynamics"
            )

        if self.e.slips:
            rolling = [model.closure.owners[model.closure.rows[k]][0].name for k in self.e.slips]
            raise UnsupportedError(
                f"{', '.join(dict.fromkeys(rolling))}: positions depend on the path, so they "
                "cannot be computed instant by instant; use solve_dynamics"
            )

    @cached_property
    def configuration(self) -> ImplicitFunction:
        """``(t, y_near, p) → (y, v, v̇, λ)`` with the exact derivative of every stage."""
        e = self.e
        near = ca.SX.sym("y_near", e.coordinate_count)
        c = e.jacobian
        factor = QrFactor(c, e.scales.rows, e.scales.displacements)
        value, step = near, factor.solve(e.constraints)
        for _ in range(ITERATIONS):
            value = e.manifold.retract(value, -ca.substitute(step, e.y, value))
        psi0 = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        stages = [
            *position_stages(e, near, e.constraints, e.scales.rows, value),
            Stage(
                e.v,
                e.velocity_constraints,
                factor.solve(-psi0),
                factor.solve,
                factor.solve_transposed,
            ),
            Stage(
                e.a,
                ca.mtimes(c, e.a) - e.constraint_acceleration,
                factor.solve(e.constraint_acceleration),
                factor.solve,
                factor.solve_transposed,
            ),
            Stage(
                e.multiplier,
                e.inertia.times(e.a) + e.bias - e.force + ca.mtimes(c.T, e.multiplier),
                factor.solve_transposed(e.force - e.bias - e.inertia.times(e.a)),
                factor.solve_transposed,
                factor.solve,
            ),
        ]
        return ImplicitFunction(
            "configuration", [e.t, near, e.p], stages, [e.y, e.v, e.a, e.multiplier]
        )

    @once
    def measured(self, measure: Expression) -> ImplicitFunction:
        """A measure of the configuration."""
        configuration = self.configuration
        expression = self.e.without_dropped(measure.sx)
        return ImplicitFunction(
            "measured", configuration.inputs, configuration.stages, [expression]
        )

    def near(self, s: Trajectory) -> np.ndarray:
        """Positions at which the configuration is differentiated."""
        return s.y

    @cached_property
    def single(self) -> ca.Function:
        """``([y; v; v̇; …], t, h, p) → next; regularity, residual, prediction error``.

        The last three have no units: pivots, rows and coordinates are relative to natural sizes.
        """
        e, sizes = self.e, self.e.scales
        n, k, m = e.coordinate_count, e.speed_count, e.constraint_count
        last, h = ca.SX.sym("last", n + 2 * k + m + 3), ca.SX.sym("h")
        y, v, a = last[:n], last[n : n + k], last[n + k : n + 2 * k]
        predicted = e.manifold.retract(y, h * v + h**2 / 2 * a)
        new = self.configuration.function(e.t, predicted, e.p)
        violation = ca.Function("r", [e.t, e.y, e.p], [e.constraints])(e.t, new[0], e.p)
        residual = ca.norm_inf(violation / sizes.rows)
        change = ca.norm_inf(e.manifold.displacement(predicted, new[0]) / sizes.displacements)
        pivots = ca.fabs(QrFactor(e.jacobian, sizes.rows, sizes.displacements).pivots)
        regular = ca.mmin(pivots) / ca.mmax(pivots)
        regular = ca.Function("s", [e.t, e.y, e.p], [regular])(e.t, new[0], e.p)
        outputs = [ca.vertcat(*new, regular, residual, change)]
        return condensed("kinematic_step", [last, e.t, h, e.p], outputs, SELDOM)

    @once
    def chunk(self, count: int) -> Kernel:
        """``count`` steps in one call."""
        last = ca.MX.sym("last", self.single.size1_in(0))
        t, h = ca.MX.sym("t", 1, count), ca.MX.sym("h", 1, count)
        p = ca.MX.sym("p", self.e.p.numel())
        out = self.single.mapaccum(count)(last, t, h, ca.repmat(p, 1, count))
        return Kernel(ca.Function("kinematic_chunk", [last, t, h, p], [out]))

    @cached_property
    def powers(self) -> ca.Function:
        """``(t, y, v, v̇, λ, p) →`` dissipated and input power."""
        e = self.e
        return ca.Function("powers", [e.t, e.y, e.v, e.a, e.multiplier, e.p], [e.powers])

    @cached_property
    def jacobian(self) -> ca.Function:
        """``(t, y, p) → Φ, C, ∂Φ/∂t``."""
        e = self.e
        outputs = [e.constraints, e.jacobian, ca.jacobian(e.constraints, e.t)]
        return ca.Function("driven", [e.t, e.y, e.p], outputs)


kinematics_kernel = once(KinematicsKernel)
"""Kernel of a model, compiled once."""


@dataclass(frozen=True)
class KinematicsRecord:
    """Record of a kinematic run for gradients.

    Attributes
    ----------
    kernel : KinematicsKernel
    path : Trajectory of all positions of the run
    origin : the run that this one repeats, None for an original run
    """

    kernel: KinematicsKernel
    path: Trajectory
    origin: Recording | None = None
