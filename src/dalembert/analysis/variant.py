"""Compiled functions of one definite formulation; a run may change from one to another."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.formulations.base import Formulation, state_rate
from dalembert.formulations.consistency import with_consistent_speeds
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Attempt, Integrator, Problem
from dalembert.integrators.step import Step
from dalembert.model.coordinates import CoordinateView
from dalembert.symbolic.expression import Expression
from dalembert.symbolic.implicit import ImplicitFunction
from dalembert.symbolic.once import once


class Variant:
    """Functions of one definite formulation, e.g. with one partition of the speeds.

    Parameters
    ----------
    view : the model in the coordinates that are integrated
    formulation : as ``Formulation.choose`` made it
    stabilization, integrator : of the run
    """

    def __init__(
        self,
        view: CoordinateView,
        formulation: Formulation,
        stabilization: Stabilization,
        integrator: Integrator,
    ):
        self.view, self.equations = view, view.equations
        self.formulation, self.stabilization = formulation, stabilization
        self.integrator = integrator
        self.xi = stabilization.constraint_acceleration(self.equations)

    @cached_property
    def problem(self) -> Problem:
        """The equations as integrators take them."""
        e, formulation, stabilization = self.equations, self.formulation, self.stabilization
        rate = correction = tangential = None
        if formulation.gives_accelerations and not self.integrator.implicit:
            rate = formulation.acceleration(e, self.xi, [state_rate(e)], "state_rate")
        if (corrected := stabilization.correction(e, formulation)) is not None:
            correction = with_consistent_speeds(e, formulation, corrected)
        if self.integrator.adaptive:
            tangential = stabilization.tangential(e, formulation)
        return Problem(
            rate=rate,
            make_system=lambda: formulation.semi_explicit(e, self.xi),
            correction=correction,
            controlled=e.coordinate_count + e.speed_count,
            positions=e.coordinate_count,
            tangential=tangential,
            upkeep=with_consistent_speeds(e, formulation, None),
        )

    @cached_property
    def step(self) -> Step:
        return self.integrator.step(self.problem)

    @cached_property
    def attempt(self) -> Attempt | None:
        return self.integrator.attempt(self.problem, self.step)

    @once
    def measured(self, measure: Expression) -> ImplicitFunction:
        """``(t, x, p) → measure`` of the bodies, accelerations and multipliers included."""
        seen = [self.view.lift(measure.sx)]
        return self.formulation.acceleration(self.equations, self.xi, seen, "measured")

    @cached_property
    def bodies(self) -> ca.Function:
        """``(t, x, p) → y, v, v̇, λ`` of all bodies and equations."""
        found = self.formulation.acceleration(
            self.equations, self.xi, self.view.everything, "bodies"
        )
        return found.function

    @cached_property
    def conditioning(self) -> tuple[ca.Function, float] | None:
        """``(t, y, p) → value`` and the limit above which another variant is chosen."""
        e = self.equations
        found = self.formulation.conditioning(e)
        if found is None:
            return None
        return ca.Function("conditioning", [e.t, e.y, e.p], [found[0]]), found[1]
