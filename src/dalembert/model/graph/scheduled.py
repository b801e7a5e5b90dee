"""Models with functions of time in place of parameters, such as optimal controls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.model.graph.assembly.guesses import AssembledState
from dalembert.model.graph.model import Model
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import stack, t


class ScheduledModel(Model):
    """The model with formulas of time in place of some parameters of its forces.

    Parameters
    ----------
    model : Model
    schedules : parameter → formula of time
    p : SX symbols of the parameters of the equations, by default its own
    """

    def __init__(self, model: Model, schedules: Mapping[str, ca.SX], p: ca.SX | None = None):
        check_controls(model, list(schedules))
        self._replaced = stack(model.parameters[name].sx for name in schedules)
        self._schedules = stack(schedules.values())
        e = model.all_equations
        force, powers = self._scheduled(e.force), self._scheduled(e.powers)
        rate, p = self._scheduled(e.pose_rate), e.p if p is None else p
        e = replace(e, force=force, powers=powers, pose_rate=rate, p=p)
        super().__init__(model.parts, e, model.closure, model.diagnosis, model.build_time)
        self._fixed_start: AssembledState | None = None

    def begun_at(self, y: np.ndarray, v: np.ndarray, p: np.ndarray) -> ScheduledModel:
        """The mechanism with this state as the start of its runs."""
        model = copy(self)
        model._fixed_start = replace(self.closure.state(y, p, 0.0), v=v)
        return model

    def assemble(self, p: np.ndarray, time: float = 0.0) -> AssembledState:
        return super().assemble(p, time) if self._fixed_start is None else self._fixed_start

    @property
    def initial_state(self) -> ImplicitFunction:
        if self._fixed_start is not None:
            raise UnsupportedError(
                "the run starts in a state of the optimal trajectory, which does not follow the "
                "parameters; optimise from the start of the model for gradients"
            )
        return super().initial_state

    def _scheduled(self, expression: ca.SX) -> ca.SX:
        return ca.substitute(expression, self._replaced, self._schedules)

    def at_ground(self, expression: ca.SX) -> ca.SX:
        return self._scheduled(super().at_ground(expression))


class SteeredModel(ScheduledModel):
    """The model with parabolas of time in place of some parameters.

    Additional parameters follow its own: start and duration of a parabola, and for each control its
    values at the start, in the middle and at the end.

    Parameters
    ----------
    model : Model
    controls : names of parameters of its forces
    """

    def __init__(self, model: Model, controls: Sequence[str]):
        self.steering = ca.SX.sym("steering", 2 + 3 * len(controls))
        begin, length = self.steering[0], self.steering[1]
        fraction = (t.sx - begin) / length
        schedules = {}
        for k, name in enumerate(controls):
            first, middle, last = ca.vertsplit(self.steering[2 + 3 * k : 5 + 3 * k])
            slope, curvature = 4 * middle - 3 * first - last, 2 * (first - 2 * middle + last)
            schedules[name] = first + fraction * (slope + fraction * curvature)
        super().__init__(model, schedules, ca.vertcat(model.all_equations.p, self.steering))


def check_controls(model: Model, names: list[str]) -> None:
    """Check that controls affect forces only, not masses, lengths or drivers.

    Raises
    ------
    UnsupportedError
        Names the parameter and what else depends on it.
    """
    e = model.all_equations
    formulas = {
        "masses": ca.veccat(e.mass, e.bias),
        "joints or drivers": ca.vertcat(e.constraints, e.nonholonomic),
        "energy that springs store": e.potential,
        "the start": model.guesses.place,
    }
    for name in names:
        for affected, formula in formulas.items():
            if ca.depends_on(formula, model.parameters[name].sx):
                raise UnsupportedError(
                    f"the control {name!r} would change {affected}; a control is a parameter of "
                    "forces and moments alone, such as planar.Torque(..., value) or a JointActuator"
                )
