"""Sections: interfaces of a flexible body for joints, forces and drivers."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import rate_of
from dalembert.elements.flexible.shape_numbers import SectionSymbols
from dalembert.elements.flexible.shapes import SectionShapes
from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.symbolic.formulas.expression import t


class Section(BodyElement):
    """An interface as a body, whose pose depends on that of the flexible body.

    It is at ``r + R (x + Φ_S a)`` and rotated relative to the frame by ``Ψ_S a``.

    Parameters
    ----------
    owner : the flexible body, which has the coordinates
    label : name of the interface
    shapes : its motion in the frame
    """

    def __init__(self, owner: Any, label: str, shapes: SectionShapes):
        self._owner, self.label, self.shapes = owner, label, shapes
        self.name, self.dimension = owner.name, owner.dimension
        self.rotates = bool(shapes.turn.size)
        self.points, self.frames, self._measures = {}, {}, {}

    @property
    def owner(self) -> Any:
        return self._owner

    @property
    def graph(self) -> SectionSymbols:
        """Its shapes as they appear in equations."""
        return self.owner.graph.sections[self.label]

    @property
    def display_name(self) -> str:
        return f"{self.name}.{self.label}"

    @property
    def shift(self) -> ca.SX:
        """(d,) its displacement in the axes of the frame."""
        return ca.mtimes(self.graph.shift, self.owner.amplitudes)

    @property
    def turn(self) -> ca.SX:
        """Its small rotation relative to the frame; empty if it only translates."""
        return ca.mtimes(self.graph.turn, self.owner.amplitudes)

    @property
    def place(self) -> ca.SX:
        """(d,) its position, inertial axes."""
        return self.owner.locate(self.graph.place + self.shift)

    def undeformed(self, local: ca.SX) -> ca.SX:
        return self.graph.place[: local.numel()] + local

    def velocity_at(self, place: ca.SX) -> ca.SX:
        velocity = rate_of(self.place, [self], t.sx)
        origin = ca.vertcat(self.place, ca.SX.zeros(3 - self.dimension))
        velocity = ca.vertcat(velocity, ca.SX.zeros(3 - self.dimension))
        return velocity + ca.cross(self.turning, place - origin)

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        return self.owner.wrench(effort)

    def guesses(self) -> tuple[list, list]:
        return self.owner.guesses()

    def specified(self) -> list[bool]:
        return self.owner.specified()


def _of_owner(name: str) -> property:
    return property(lambda self: getattr(self.owner, name))


for _name in (
    *("pose", "pose_rate", "twist", "acceleration_symbols", "followers", "rest", "initial"),
    *("coordinate_names", "coordinate_units", "speed_names", "speed_units"),
):
    setattr(Section, _name, _of_owner(_name))


class SectionFrame(Frame):
    """Frame of a section, with its deflection among the measures."""

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        return super().measures() | deflections(self)


class SectionPoint(Point):
    """Point of a section, with its deflection among the measures."""

    def measures(self) -> dict[str, tuple[ca.SX, str]]:
        return super().measures() | deflections(self)


def deflections(point: Point) -> dict[str, tuple[ca.SX, str]]:
    """Displacement and rotation of its section relative to the frame, in the axes of the frame."""
    section = point.body
    measures = {"deflection": (section.shift, "m")}
    if section.rotates:
        measures["turn"] = (section.turn, "rad")
    return measures
