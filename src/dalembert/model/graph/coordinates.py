"""Coordinates for the integration of a mechanism, and the motion of its bodies in them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.model.graph.rigid_gaps import contact_forces, headings
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import CacheOwner, once


class CoordinateView(CacheOwner):
    """Equations of a model in a choice of coordinates.

    Attributes
    ----------
    model : Model
    whole : Equations in these coordinates, including redundant ones
    with_free_branches : the same with free branches, if those of ``whole`` are frozen
    rows : constraint equations that are solved at the start
    names, speed_names : names of the coordinates, and of the speeds and displacements
    units, speed_units : units of the coordinates, and of the displacements
    """

    model: Model
    whole: Equations
    with_free_branches: Equations
    rows: tuple[int, ...]
    names: list[str]
    speed_names: list[str]
    units: list[str]
    speed_units: list[str]

    @property
    def equations(self) -> Equations:
        """Equations with the constraint rows of the start."""
        return self.with_rows(self.rows)

    @once
    def with_rows(self, rows: tuple[int, ...]) -> Equations:
        """Equations with these constraint rows."""
        return self.whole.with_rows(list(rows))

    def freeze_branches(self) -> None:
        """Freeze the branches of formulas, for integrators that locate switches."""
        self.with_free_branches, self.whole = self.whole, self.whole.with_frozen_branches()

    def lift(self, expression: ca.SX) -> ca.SX:
        """An expression of the bodies (of t, y, v, v̇, λ, p) in the symbols of ``whole``."""
        raise NotImplementedError

    def body_coordinates(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Coordinates of the bodies from those of this view."""
        e, lifted = self.equations, self.lift(self.model.all_equations.y)
        return ca.Function("bodies", [e.t, e.y, e.p], [lifted])(t, y, p).full().ravel()

    @property
    def reduce(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → coordinates and speeds of this view."""
        raise NotImplementedError

    @property
    def everything(self) -> list[ca.SX]:
        """``y, v, v̇`` of the bodies, ``λ`` of all equations, and forces of rigid contacts."""
        e = self.model.all_equations
        return [self.lift(column) for column in (e.y, e.v, e.a, e.transmitted)]


@dataclass(frozen=True)
class Coordinates:
    """Strategy object: choice of coordinates.

    Attributes
    ----------
    rigid_contacts : whether gaps of rigid contacts take part
    """

    rigid_contacts: ClassVar[bool] = True

    def chosen(self, cost: Callable[[Coordinates], int]) -> Coordinates:
        """The coordinates to use: itself, or the cheapest ones by ``cost``."""
        return self

    def check(self, model: Model, every_equation: bool) -> None:
        """Check that the coordinates support the model; raises the errors of ``view``."""
        self.view(model, every_equation)

    def view(self, model: Model, every_equation: bool = False) -> CoordinateView:
        """The model in these coordinates.

        Parameters
        ----------
        every_equation : whether to include redundant constraint equations
        """
        raise NotImplementedError


@dataclass(frozen=True)
class AbsoluteCoordinates(Coordinates):
    """Pose and twist of every body; all joints are constraint equations (Ch. 5).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.5, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> poses = da.AbsoluteCoordinates()
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1, coordinates=poses)
    >>> motion.data["coordinate"].values.tolist()
    ['bar.x', 'bar.y', 'bar.angle']
    """

    def view(self, model: Model, every_equation: bool = False) -> AbsoluteView:
        return AbsoluteView(model, every_equation)


@dataclass(frozen=True)
class DrivenCoordinates(AbsoluteCoordinates):
    """Absolute coordinates of a driven mechanism, whose motion no rigid contact changes."""

    rigid_contacts: ClassVar[bool] = False

    def view(self, model: Model, every_equation: bool = False) -> AbsoluteView:
        view = AbsoluteView(model, every_equation)
        gaps = view.whole.contacts
        dropped = ca.vertcat(view.whole.dropped, contact_forces(gaps), headings(gaps))
        view.whole = replace(view.whole, contacts=(), dropped=dropped)
        return view


class AbsoluteView(CoordinateView):
    """The equations of a model in absolute coordinates."""

    def __init__(self, model: Model, every_equation: bool):
        self.model = model
        self.whole, all_rows = model.all_equations, range(model.all_equations.constraint_count)
        self.rows = tuple(all_rows if every_equation else model.closure.rows)
        self.names = list(model.guesses.names)
        self.speed_names = list(model.guesses.speed_names)
        self.units, self.speed_units = model.guesses.units, model.guesses.speed_units

    def lift(self, expression: ca.SX) -> ca.SX:
        return expression

    @property
    def reduce(self) -> ImplicitFunction:
        e = self.equations
        return ImplicitFunction("reduce", [e.t, e.y, e.v, e.p], [], [e.y, e.v])
