"""In which coordinates a mechanism is integrated, and how its bodies follow from them."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.model.equations import Equations
from dalembert.model.model import Model
from dalembert.symbolic.implicit import ImplicitFunction


class CoordinateView:
    """One model seen in one choice of coordinates.

    Attributes
    ----------
    model : Model
    equations : Equations in these coordinates
    names : names of the coordinates
    """

    model: Model
    equations: Equations
    names: list[str]

    def lift(self, expression: ca.SX) -> ca.SX:
        """A measure of the bodies (of t, y, v, v̇, λ, p) in the symbols of ``equations``."""
        raise NotImplementedError

    @property
    def reduce(self) -> ImplicitFunction:
        """``(t, y, v, p)`` of the bodies → coordinates and speeds of this view."""
        raise NotImplementedError

    @property
    def everything(self) -> list[ca.SX]:
        """``y, v, v̇`` of the bodies and ``λ`` of all equations."""
        e = self.model.all_equations
        return [self.lift(column) for column in (e.y, e.v, e.a, e.multiplier)]


@dataclass(frozen=True)
class Coordinates:
    """Strategy object: the choice of coordinates."""

    def view(self, model: Model, every_equation: bool = False) -> CoordinateView:
        """The model in these coordinates.

        Parameters
        ----------
        every_equation : with redundant constraint equations too
        """
        raise NotImplementedError


@dataclass(frozen=True)
class AbsoluteCoordinates(Coordinates):
    """Pose and twist of every body; all joints are constraint equations (Ch. 5)."""

    def view(self, model: Model, every_equation: bool = False) -> AbsoluteView:
        return AbsoluteView(model, every_equation)


class AbsoluteView(CoordinateView):
    """The equations of a model as they are."""

    def __init__(self, model: Model, every_equation: bool):
        self.model = model
        self.equations = model.all_equations if every_equation else model.equations
        self.names = list(model.guesses.names)

    def lift(self, expression: ca.SX) -> ca.SX:
        return self.equations.without_dropped(expression)

    @property
    def reduce(self) -> ImplicitFunction:
        e = self.equations
        return ImplicitFunction("reduce", [e.t, e.y, e.v, e.p], [], [e.y, e.v])
