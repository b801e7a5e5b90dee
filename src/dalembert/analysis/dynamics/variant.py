"""Compiled functions of one definite formulation; a run may change between variants."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.contact.guards import Guards, guards_of
from dalembert.formulations.base import (
    Formulation,
    SaddleSolver,
    state_rate,
    state_sizes,
    state_symbols,
)
from dalembert.formulations.kkt import SlidingSolver
from dalembert.formulations.partition import (
    LARGEST_COEFFICIENT,
    largest_coefficient,
    with_consistent_speeds,
)
from dalembert.formulations.stabilization import Stabilization
from dalembert.integrators.base import Attempt, Integrator, Problem
from dalembert.integrators.step import Step
from dalembert.model.graph.contacts import Phases, touching
from dalembert.model.graph.coordinates import CoordinateView
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.once import CacheOwner, once


class Variant(CacheOwner):
    """Functions of one definite formulation, e.g. with one partition of the speeds.

    Parameters
    ----------
    view : the model in the integrated coordinates
    rows : constraint equations that are solved
    formulation : result of ``Formulation.choose``
    stabilization, integrator : of the run
    phases : of rigid gaps
    bare : result of ``Formulation.choose`` for the equations with all gaps open, for impacts;
        ``formulation`` by default
    """

    def __init__(
        self,
        view: CoordinateView,
        rows: tuple[int, ...],
        formulation: Formulation,
        stabilization: Stabilization,
        integrator: Integrator,
        phases: Phases = (),
        bare: Formulation | None = None,
    ):
        self.bare = bare or formulation
        self.view, self.rows, self.phases = view, rows, phases
        self.equations = touching(view.with_rows(rows), phases)
        self.formulation, self.stabilization = formulation, stabilization
        self.integrator = integrator
        self.xi = stabilization.constraint_acceleration(self.equations)

    @cached_property
    def problem(self) -> Problem:
        """The equations in the form of integrators."""
        e, formulation, stabilization = self.equations, self.formulation, self.stabilization
        rate = correction = tangential = None
        if formulation.gives_accelerations and not self.integrator.implicit:
            rate = self.rate
        if (corrected := stabilization.correction(e, formulation)) is not None:
            correction = with_consistent_speeds(e, formulation, corrected)
        upkeep = with_consistent_speeds(e, formulation, None)
        if self.integrator.adaptive:
            tangential = stabilization.tangential(e, formulation)
        return Problem(
            rate=rate,
            make_system=lambda: formulation.semi_explicit(e, self.xi, self._saddle(e)),
            correction=correction and correction.frequent,
            controlled=e.coordinate_count + e.speed_count,
            positions=e.coordinate_count,
            tangential=tangential,
            upkeep=upkeep and upkeep.frequent,
            translates=stabilization.translates,
            sizes=state_sizes(e),
            time=e.scales.time,
            spare=self._open_rows * formulation.variables_per_row,
        )

    @property
    def _open_rows(self) -> int:
        """Number of equations that rigid gaps would add if all of them stuck."""
        e = self.equations
        most = sum(gap.forces().numel() for gap in e.contacts) + len(self.rows)
        return most - e.constraint_count

    @cached_property
    def rate(self) -> ImplicitFunction:
        """``(t, x, p) → ẋ``."""
        rates = [state_rate(self.equations)]
        return self._accelerated(self.equations, rates, "state_rate").frequent

    @cached_property
    def step(self) -> Step:
        self.integrator.check(self.problem)
        return self.integrator.step(self.problem)

    @cached_property
    def attempt(self) -> Attempt | None:
        return self.integrator.attempt(self.problem, self.step)

    @once
    def measured(self, measure: Expression) -> ImplicitFunction:
        """``(t, x, p) → measure`` of the bodies, accelerations and multipliers included."""
        return self._of_view(self.equations, [self.view.lift(measure.sx)], "measured")

    @cached_property
    def bodies(self) -> ca.Function:
        """``(t, x, p) → y, v, v̇, λ`` of all bodies and equations, with actual signs of switches."""
        e = self.equations
        if not e.switches.count:
            return self.held_bodies
        choosing = touching(self.view.with_free_branches.with_rows(list(self.rows)), self.phases)
        function = self._of_view(choosing, self.view.everything, "bodies").function
        x, count = state_symbols(e), function.numel_in(1)
        return ca.Function("bodies", [e.t, x, e.p], function.call([e.t, x[:count], e.p]))

    @cached_property
    def held_bodies(self) -> ca.Function:
        """The same with the signs of switching functions stored in the state."""
        return self._of_view(self.equations, self.view.everything, "bodies").function

    def _of_view(self, e: Equations, expressions: list[ca.SX], name: str) -> ImplicitFunction:
        """Expressions of the view; multipliers of dropped equations are zero."""
        outputs = [e.without_dropped(expression) for expression in expressions]
        return self._accelerated(e, outputs, name)

    def _accelerated(self, e: Equations, outputs: list[ca.SX], name: str) -> ImplicitFunction:
        """Outputs of accelerations and multipliers, including sliding friction."""
        xi = self.stabilization.constraint_acceleration(e)
        return self.formulation.acceleration(e, xi, outputs, name, self._saddle(e))

    def _saddle(self, e: Equations) -> SaddleSolver:
        return sliding(self.formulation.saddle(e), e)

    @cached_property
    def guards(self) -> Guards | None:
        """Guards of the phases of rigid gaps; None without gaps."""
        e = self.equations
        if not e.contacts:
            return None
        switches = [gap.switches for gap in self.view.whole.contacts]
        watched = guards_of(e, self.phases, switches)
        values = self._of_view(e, [stack(g.value for g in watched)], "guards").function
        return Guards(e, watched, values, self.rate.function)

    def is_conditioned(self, t: float, x: np.ndarray, p: np.ndarray) -> bool:
        """Whether equations and formulation are well conditioned at a state."""
        if self.conditioning is None:
            return True
        shares = self.conditioning(t, x[: self.equations.coordinate_count], p)
        return all(float(share) <= 1 for share in shares)

    @cached_property
    def conditioning(self) -> ca.Function | None:
        """``(t, y, p) → (share, value)`` of the dropped equations and of the formulation.

        Both are relative to the limit above which another variant is chosen; None if never.
        """
        e, zero = self.equations, ca.SX(0)
        condition = self.formulation.conditioning(e)
        redundant = len(self.rows) < self.view.whole.constraint_count
        if condition is None and not redundant:
            return None
        share = (
            largest_coefficient(self.view.whole, self.rows) / LARGEST_COEFFICIENT
            if redundant
            else zero
        )
        value = zero if condition is None else condition[0] / condition[1]
        return ca.Function("conditioning", [e.t, e.y, e.p], [share, value])


def sliding(frictionless: SaddleSolver, e: Equations) -> SaddleSolver:
    """The solver with sliding friction, if there is any."""
    return SlidingSolver(frictionless, e) if e.rubbing.nnz() else frictionless
