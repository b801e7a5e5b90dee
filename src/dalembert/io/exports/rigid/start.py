"""Numbers of a mechanism at its assembled start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.body import BodyElement
from dalembert.elements.spatial.body import Body as SpatialBody
from dalembert.elements.spatial.inertia_tensor import tensor
from dalembert.model.graph.model import Model


@dataclass(frozen=True)
class RigidBody:
    """A rigid body at the start, in inertial axes unless stated otherwise.

    Attributes
    ----------
    position, axes : (3,), (3, 3) of the body frame
    velocity, spin : (3,) of its origin, and angular velocity
    mass : [kg]
    center : (3,) mass centre in the body frame [m]
    inertia : (3, 3) about the mass centre in body axes [kg m²]
    rotates : False for particles
    planar : whether it moves in the x-y plane only
    """

    position: np.ndarray
    axes: np.ndarray
    velocity: np.ndarray
    spin: np.ndarray
    mass: float
    center: np.ndarray
    inertia: np.ndarray
    rotates: bool
    planar: bool

    def local(self, place: np.ndarray) -> np.ndarray:
        """Coordinates of an inertial position in the body frame."""
        return self.axes.T @ (place - self.position)


class Start:
    """The assembled start at parameter values; evaluates formulas there.

    Parameters
    ----------
    model : Model
    parameters : values other than those of the model
    """

    def __init__(self, model: Model, parameters: Mapping[str, float] | None = None):
        self.model, self.p = model, model.values(parameters)
        state = model.start if not parameters else model.assemble(self.p)
        self.y, self.v = state.y, state.v

    def values(self, *formulas: ca.SX) -> list[np.ndarray]:
        """Values of formulas of positions, speeds, time and parameters."""
        e = self.model.all_equations
        columns = [self.model.at_ground(ca.vec(ca.densify(f))) for f in formulas]
        function = ca.Function("start", [e.t, e.y, e.v, e.p], [ca.vertcat(*columns)])
        table = function(0.0, self.y, self.v, self.p).full().ravel()
        return np.split(table, np.cumsum([c.numel() for c in columns])[:-1])

    def by_parameters(self, formula: ca.SX) -> ca.SX:
        """The formula with numbers for the parameters, and the ground at rest."""
        formula = self.model.at_ground(ca.densify(formula))
        return ca.substitute(formula, self.model.all_equations.p, ca.DM(self.p))

    def constant(self, formula: ca.SX) -> np.ndarray | None:
        """Components of a formula of parameters; None if it varies with time or state."""
        column = ca.vec(self.by_parameters(formula))
        if ca.symvar(column):
            return None
        return np.array(ca.evalf(column)).ravel()

    @cached_property
    def bodies(self) -> dict[str, RigidBody]:
        """Rigid bodies by name, with the ground."""
        moving = self.model.bodies
        formulas = [part for body in moving for part in _formulas(body)]
        values = iter(self.values(*formulas) if formulas else [])
        bodies = {"ground": _at_rest(self.model.ground.dimension == 2)}
        for body in moving:
            bodies[body.name] = _rigid_body(body, *(next(values) for _ in range(7)))
        return bodies


def _formulas(body: Any) -> list[ca.SX]:
    """Position, axes, velocity, spin, mass, mass centre and inertia."""
    inertia: ca.SX = ca.SX.zeros(3, 3)
    center: ca.SX = ca.SX.zeros(3)
    if isinstance(body, SpatialBody):
        center = body.center_of_mass.sx
        inertia = tensor(body.inertia.sx) if body.rotates else inertia
    elif body.rotates:
        inertia = body.inertia.sx * ca.SX.eye(3)
    place = body.locate(ca.SX.zeros(3))
    axes = ca.horzcat(*(body.turned(ca.SX.eye(3)[:, k]) for k in range(3)))
    return [place, axes, body.velocity_at(place), body.turning, body.mass.sx, center, inertia]


def _rigid_body(
    body: BodyElement,
    position: np.ndarray,
    axes: np.ndarray,
    velocity: np.ndarray,
    spin: np.ndarray,
    mass: np.ndarray,
    center: np.ndarray,
    inertia: np.ndarray,
) -> RigidBody:
    matrix, moments = axes.reshape(3, 3).T, inertia.reshape(3, 3)
    kind = (body.rotates, body.dimension == 2)
    return RigidBody(position, matrix, velocity, spin, float(mass[0]), center, moments, *kind)


def _at_rest(planar: bool) -> RigidBody:
    zero = np.zeros(3)
    return RigidBody(zero, np.eye(3), zero, zero, 0.0, zero, np.zeros((3, 3)), True, planar)
