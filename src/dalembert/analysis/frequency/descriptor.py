"""Compiled descriptor form of a mechanism, linear about an operating point.

    ẏ = A(y) v,      M v̇ + d = f − Cᵀ λ,      Φ(y, p) = 0, or Ψ(y, v, p) = 0

are linearised as they stand, without elimination of constraints: inputs in ``Φ`` and the velocities
and accelerations that follow from them are exact (Brüls and Golinval, ZAMM 86, 2006).
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.modes.rotation_axes import RotationAxes, rate_along_motion
from dalembert.formulations.base import dynamic_equations
from dalembert.formulations.kkt import KKT
from dalembert.model.graph.model import Model
from dalembert.model.graph.rigid_gaps import contact_forces
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner, once


class DescriptorKernel(CacheOwner):
    """Compiled first and second derivatives of the equations of a model.

    A change of the motion consists of those of displacements δ, states z of first order, speeds and
    multipliers, of the rates of all but the multipliers, and of the parameters.

    Attributes
    ----------
    model : Model
    axes : of the small rotations of spatial bodies
    parts : name → slice of a change
    sizes : (unknowns,) natural sizes of δ, z, v, λ
    """

    def __init__(self, model: Model, axes: RotationAxes = RotationAxes.REFERENCE):
        self.model, self.e, self.axes = model, model.equations, axes
        e = self.e
        self.states = list(e.states)
        counts = {
            "displacement": e.speed_count,
            "state": len(self.states),
            "speed": e.speed_count,
            "multiplier": e.constraint_count,
            "displacement_rate": e.speed_count,
            "state_rate": len(self.states),
            "acceleration": e.speed_count,
            "parameter": e.p.numel(),
        }
        ends = np.cumsum([0, *counts.values()])
        self.parts = {
            name: slice(int(a), int(b))
            for name, a, b in zip(counts, ends[:-1], ends[1:], strict=True)
        }
        self.change = ca.SX.sym("change", int(ends[-1]))
        self.point = [e.t, e.y, e.v, e.a, e.multiplier, e.p]
        self.rotates = bool(e.manifold.attitudes)

    @property
    def unknowns(self) -> slice:
        """Displacements, states, speeds and multipliers in a change."""
        return slice(0, self.parts["multiplier"].stop)

    @property
    def rates(self) -> slice:
        """Rates of displacements, states and speeds in a change."""
        return slice(self.parts["displacement_rate"].start, self.parts["acceleration"].stop)

    @cached_property
    def sizes(self) -> np.ndarray:
        s = self.e.scales
        return np.concatenate(
            [s.displacements, s.coordinates[self.states], s.speeds, s.multipliers]
        )

    @cached_property
    def rows(self) -> np.ndarray:
        """Natural sizes of the equations, for displacements in place of coordinates."""
        s = self.e.scales
        rates = np.concatenate([s.displacements, s.coordinates[self.states]]) / s.time
        return np.concatenate([rates, s.efforts, s.rows])

    @cached_property
    def turned(self) -> ca.SX:
        """(n, n) ``Q`` of ``δv = Q δ̇``."""
        return self.axes.speeds(self.e)

    @cached_property
    def tangent_basis(self) -> ca.SX:
        """(n_y, n + states) changes of the coordinates by displacements and states."""
        m, e = self.e.manifold, self.e
        still = ca.SX.zeros(e.speed_count)
        moved = ca.substitute(ca.jacobian(m.moved, m.delta), m.delta, still)
        moved = ca.mtimes(moved, self.turned) if self.rotates else moved
        unit = ca.SX(e.coordinate_count, len(self.states))
        for column, state in enumerate(self.states):
            unit[state, column] = 1
        return ca.horzcat(moved, unit)

    def _changed(self, column: ca.SX) -> ca.SX:
        """Change of expressions of the point along ``change``."""
        d, p, e = self.change, self.parts, self.e
        placed = slice(0, p["state"].stop)
        speeds, accelerations = d[p["speed"]], d[p["acceleration"]]
        if self.rotates:
            turning = ca.mtimes(rate_along_motion(self.e, self.turned), speeds)
            accelerations = ca.mtimes(self.turned, accelerations) + turning
            speeds = ca.mtimes(self.turned, speeds)
        along = ca.vertcat(
            ca.mtimes(self.tangent_basis, d[placed]),
            speeds,
            accelerations,
            d[p["multiplier"]],
            d[p["parameter"]],
        )
        by = ca.vertcat(e.y, e.v, e.a, e.multiplier, e.p)
        return ca.jtimes(ca.densify(column), by, along)

    @cached_property
    def equations_change(self) -> ca.SX:
        """(n + states + n + m,) change of the equations, those of ``ẏ`` by displacements."""
        e, p = self.e, self.parts
        rated = slice(p["displacement_rate"].start, p["state_rate"].stop)
        moving, reading = self._changed(e.pose_rate), e.manifold.reading
        if self.rotates:  # the basis turns with the motion
            placed = self.change[slice(0, p["state"].stop)]
            moving -= ca.mtimes(rate_along_motion(e, self.tangent_basis), placed)
            reading = ca.mtimes(self.turned.T, reading)
        rate = ca.vertcat(ca.mtimes(reading, moving), moving[self.states])
        rate -= self.change[rated]
        levels = ca.densify(e.constraints) + ca.densify(e.nonholonomic)
        return ca.vertcat(rate, self._changed(dynamic_equations(e)), self._changed(levels))

    @once
    def measure_change(self, measure: Expression) -> ca.SX:
        """Change of a measure."""
        forces = contact_forces(self.e.contacts)
        sx = ca.substitute(self.e.without_dropped(measure.sx), forces, 0 * forces)
        return self._changed(sx)

    @cached_property
    def jacobian(self) -> ca.Function:
        """point → (equations, change) derivatives of the equations."""
        matrix = ca.jacobian(self.equations_change, self.change)
        return ca.Function("descriptor", self.point, [matrix], {"cse": True})

    @cached_property
    def basis(self) -> ca.Function:
        """``y →`` tangent basis."""
        return ca.Function("tangent_basis", [self.e.y], [ca.densify(self.tangent_basis)])

    @once
    def measure_row(self, measure: Expression) -> ca.Function:
        """point → (1, change) derivatives of a measure."""
        row = ca.jacobian(self.measure_change(measure), self.change)
        return ca.Function("measure_row", self.point, [ca.densify(row)], {"cse": True})

    @once
    def pull(self, measure: Expression) -> ca.Function:
        """point, change, weights of measure and equations → weights of y, v, a, λ, p."""
        column = ca.vertcat(self.measure_change(measure), self.equations_change)
        weights = ca.SX.sym("weights", column.numel())
        scalar = ca.dot(weights, column)
        slopes = [ca.densify(ca.gradient(scalar, by)) for by in self.point[1:]]
        inputs = [*self.point, self.change, weights]
        return ca.Function("pull", inputs, slopes, {"cse": True})

    @once
    def push(self, measure: Expression) -> ca.Function:
        """point, its change, change of the motion → change of measure and equations."""
        column = ca.vertcat(self.measure_change(measure), self.equations_change)
        by = ca.vertcat(*self.point[1:])
        along = ca.SX.sym("along", by.numel())
        moved = ca.densify(ca.jtimes(column, by, along))
        return ca.Function("push", [*self.point, along, self.change], [moved], {"cse": True})

    @cached_property
    def accelerations(self) -> ImplicitFunction:
        """``(t, [y; v; …], p) → v̇, λ``."""
        return KKT().acceleration(self.e, self.e.constraint_acceleration)


descriptor_kernel = once(DescriptorKernel)
"""Kernel of a model and a choice of axes, compiled once."""
