"""Accelerations and measures as functions of independent coordinates and speeds.

    Φ(y, t) = 0,  y_i = x_i;      Ψ(y, v, t) = 0,  v_i = u_i;      ⎡M Cᵀ; C 0⎤ ⎡v̇; λ⎤ = ⎡f − d; ξ⎤

are three stages of one implicit function, so that tangents and adjoints are exact, through the
closed loops as well. The position is solved outside, by repeated calls of ``closing``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.variant import sliding
from dalembert.fmu.independent_coordinates import independent_coordinates
from dalembert.fmu.stepping_functions import constraint_names
from dalembert.formulations.base import Formulation, state_sizes
from dalembert.formulations.null_space import NullSpaceSolver
from dalembert.model.graph.assembly.position import newton_step, position_stages
from dalembert.model.graph.coordinates import Coordinates
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.factor import PartitionBasis, QrFactor
from dalembert.symbolic.equations.implicit import ImplicitFunction, Stage
from dalembert.symbolic.formulas.expression import stack

BEYOND = 1e-9
"""Distance beyond a switch at which an event occurs, in natural sizes of time and motion [-]."""


class MotionFunctions:
    """Functions of ``(t, held, x, p)`` for model exchange.

    ``x`` are the states; ``held = [y; σ]``, the position near which ``Φ = 0`` is solved and the
    frozen branches of formulas, are constant to differentiation.

    Parameters
    ----------
    model : Model
    coordinates : in which it is closed
    outputs : SX expressions of the bodies
    names : names of the independent coordinates; None for an automatic choice
    """

    def __init__(
        self,
        model: Model,
        coordinates: Coordinates,
        outputs: Sequence[ca.SX],
        names: Sequence[str] | None = None,
    ):
        self.model, self.outputs = model, [ca.SX(output) for output in outputs]
        self.view = coordinates.view(model)
        self.view.freeze_branches()
        self.e = e = self.view.equations
        start, p = model.start, model.nominal
        y, _ = (x.full().ravel() for x in self.view.reduce.function(0.0, start.y, start.v, p))
        free = self.view.with_free_branches.with_rows(list(self.view.rows))
        self.states = independent_coordinates(self.view, free, y, p, 0.0, names)
        s = self.states
        self.x = ca.SX.sym("x", s.count)
        self.near_y = ca.SX.sym("near", e.coordinate_count)
        self.held = ca.vertcat(self.near_y, e.switches.sides)
        ends = np.cumsum([0, len(s.positions), len(s.speeds), len(s.first_order)])
        self._positions, self._speeds, self._first_order = (
            self.x[int(a) : int(b), :] for a, b in pairwise(ends)
        )

    # names ------------------------------------------------------------------------------
    @property
    def names(self) -> list[tuple[str, str]]:
        """Name and unit of each state."""
        s, view = self.states, self.view
        positions = [(view.names[k], view.units[k]) for k in s.positions]
        speeds = [(f"rate of {view.speed_names[k]}", f"{view.speed_units[k]}/s") for k in s.speeds]
        return [*positions, *speeds, *((view.names[k], view.units[k]) for k in s.first_order)]

    @property
    def rows(self) -> list[str]:
        """Names of the constraint equations of positions, then of the states that pin them."""
        names = constraint_names(self.model, self.e.multiplier)
        equations = [names[k] for k in self.e.holds]
        return [*equations, *(self.view.speed_names[k] for k in self.states.pinned)]

    # stages -----------------------------------------------------------------------------
    @property
    def closed(self) -> bool:
        """Whether constraint equations determine some of the coordinates."""
        return bool(self.e.holds)

    @cached_property
    def _near(self) -> ca.SX:
        """The nearby position with the states in their entries."""
        near = ca.SX(self.near_y)
        for symbols, entries in (
            (self._positions, self.states.positions),
            (self._first_order, self.states.first_order),
        ):
            if entries:
                near[list(entries)] = symbols
        return near

    @cached_property
    def _position_equations(self) -> tuple[ca.SX, np.ndarray]:
        """Residual of the position, with its natural sizes."""
        e, pinned = self.e, list(self.states.pinned)
        holds = list(e.holds)
        away = e.manifold.displacement(self._near, e.y)[pinned, :]
        sizes = np.concatenate([e.scales.rows[holds], e.scales.displacements[pinned]])
        return ca.vertcat(e.constraints[holds, :], away), sizes

    @cached_property
    def closing(self) -> ca.Function:
        """``(t, held, x, p) → (y⁺, r)``: a step of Newton's method and the residual before it."""
        residual, sizes = self._position_equations
        stages = position_stages(self.e, self._near, residual, sizes, self.near_y)
        inputs = [self.e.t, self.held, self.x, self.e.p]
        return newton_step("closing", inputs, stages, sizes)

    @property
    def _position_stages(self) -> list[Stage]:
        e = self.e
        if self.closed:
            return position_stages(e, self._near, *self._position_equations, self.near_y)
        return [_explicit(e.y, e.manifold.settled(self._near))]

    @property
    def _speed_stage(self) -> Stage:
        e, speeds = self.e, list(self.states.speeds)
        if not e.constraint_count:
            return _explicit(e.v, self._speeds)
        residual = ca.vertcat(e.velocity_constraints, e.v[speeds, :] - self._speeds)
        rows = np.concatenate([e.scales.rows / e.scales.time, e.scales.speeds[speeds]])
        factor = QrFactor(ca.jacobian(residual, e.v), rows, e.scales.speeds)
        at_zero = ca.substitute(residual, e.v, ca.SX.zeros(e.speed_count))
        return Stage(e.v, residual, factor.solve(-at_zero), factor.solve, factor.solve_transposed)

    def _function(self, name: str, outputs: list[ca.SX], accelerations: bool) -> ImplicitFunction:
        e = self.e
        stages = [*self._position_stages, self._speed_stage]
        outputs = [e.without_dropped(ca.densify(output)) for output in outputs]
        if accelerations:
            basis = PartitionBasis(e.jacobian, self.states.speeds)
            saddle = sliding(NullSpaceSolver(e.inertia, basis), e)
            solved = Formulation().acceleration(e, e.constraint_acceleration, outputs, name, saddle)
            stages, outputs = stages + solved.stages, solved.outputs
        return ImplicitFunction(name, [e.t, self.held, self.x, e.p], stages, outputs)

    # functions --------------------------------------------------------------------------
    @cached_property
    def _rates(self) -> ca.SX:
        e, s = self.e, self.states
        parts = [e.pose_rate[list(s.positions), :], e.a[list(s.speeds), :]]
        return ca.vertcat(*parts, e.pose_rate[list(s.first_order), :])

    @cached_property
    def _measured(self) -> ca.SX:
        return stack(self.view.lift(output) for output in self.outputs)

    @cached_property
    def rates(self) -> ImplicitFunction:
        """``(t, held, x, p) → ẋ``."""
        return self._function("rates", [self._rates], True)

    @cached_property
    def measured(self) -> ImplicitFunction:
        """``(t, held, x, p) → outputs``."""
        return self._function("outputs", [self._measured], True)

    @cached_property
    def everything(self) -> ImplicitFunction:
        """``(t, held, x, p) → [ẋ; outputs]``, whose derivatives are those of the unit."""
        return self._function("motion", [ca.vertcat(self._rates, self._measured)], True)

    @cached_property
    def conditioning(self) -> ca.Function | None:
        """``(t, held, x, p)`` → largest dependent speed per independent one, in natural sizes."""
        e = self.e
        if not self.states.speeds or not e.constraint_count:
            return None
        basis, sizes = PartitionBasis(e.jacobian, self.states.speeds), e.scales.displacements
        rows, columns = sizes[list(basis.dependent)], sizes[list(basis.independent)]
        ratios = ca.mtimes([ca.diag(ca.SX(1 / rows)), basis.ratio, ca.diag(ca.SX(columns))])
        largest = ca.norm_inf(ca.vec(ca.densify(ratios)))
        return self._function("conditioning", [largest], False).function

    @cached_property
    def indicators(self) -> ca.Function | None:
        """``(t, held, x, p) → z``, positive on the side 1 of a switch; None without switches.

        ``z = g ± δ`` crosses zero when the motion is beyond the switch by ``δ``, so that its sign
        is certain at the event.
        """
        e, g = self.e, self.e.switches.functions
        if not e.switches.count:
            return None
        moving, sizes = ca.vertcat(e.t, e.y, e.v), ca.DM([e.scales.time, *state_sizes(e)])
        slopes = ca.fabs(ca.jacobian(g, moving))
        width = BEYOND * ca.mtimes(slopes, sizes[: moving.numel()])
        z = ca.densify(g + (2 * e.switches.sides - 1) * width)
        return self._function("indicators", [z], False).function

    @cached_property
    def start(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → ``x``, ``held``."""
        reduce, s = self.view.reduce, self.states
        q, u = reduce.outputs
        first, speeds, last = list(s.positions), list(s.speeds), list(s.first_order)
        x = ca.vertcat(q[first, :], u[speeds, :], q[last, :])
        e = self.e
        actual = ca.densify(e.switches.actual)
        sides = ca.substitute(actual, ca.vertcat(e.t, e.y, e.v), ca.vertcat(reduce.inputs[0], q, u))
        return ImplicitFunction("start", reduce.inputs, [], [x, ca.vertcat(q, sides)])


def _explicit(unknown: ca.SX, value: ca.SX) -> Stage:
    """Stage of an unknown that is given by an expression."""
    return Stage(unknown, unknown - value, value, lambda rhs: rhs, lambda rhs: rhs)
