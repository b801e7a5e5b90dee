"""Contact of beams along their length."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.budget import check_budget, numeral
from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.contact.hull import Solid
from dalembert.elements.contact.shapes import Ball, Spot
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.flexible.beam import NODE, Beam
from dalembert.elements.flexible.nodes import CrossSection, gauss
from dalembert.elements.point import Point
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import t


def need_beam(value: Any, owner: str) -> None:
    """Check that an argument is a beam."""
    if not isinstance(value, Beam):
        raise ModelError(
            f"beam must be a beam, e.g. system.add(planar.Beam(...)); got {value!r}", owner
        )


class Station:
    """A cross-section between nodes of a beam, which points are fixed in.

    Its position and velocity are those of the polynomials of the beam, ``r = Σ N_k r_k``; its
    angular velocity is ``Σ N_k ω_k``. Forces at it act on the nodes in these proportions. Its frame
    is at the centre and has inertial axes.

    Parameters
    ----------
    beam : Beam
    sections : cross-sections at the nodes
    values : values of their polynomials at the station
    """

    def __init__(self, beam: Beam, sections: list[CrossSection], values: Iterable[ca.SX | float]):
        self.name, self.dimension = beam.name, beam.dimension
        self.sections, self.values = sections, list(values)

    def parts(self) -> list[Coordinates]:
        """The bodies that carry the nodes."""
        return list(dict.fromkeys(section.body for section in self.sections))

    def _between(self, quantities: list[ca.SX]) -> ca.SX:
        """Value at the station of a quantity at the nodes."""
        return sum(
            (n * q for n, q in zip(self.values, quantities, strict=True)),
            ca.SX.zeros(quantities[0].shape),
        )

    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point in its frame."""
        return self.place + local

    def turned(self, local: ca.SX) -> ca.SX:
        """Inertial components of a vector in its frame."""
        return local

    @cached_property
    def place(self) -> ca.SX:
        """Inertial position of its centre."""
        return self._between([section.place for section in self.sections])

    def velocity_at(self, place: ca.SX) -> ca.SX:
        """(3,) velocity of the material of the cross-section at an inertial position."""
        beyond = ca.SX.zeros(3 - self.dimension)
        velocity = self._between([rate_of(s.place, [s.body], t.sx) for s in self.sections])
        spin = self._between([section.body.turning for section in self.sections])
        arm = place - ca.vertcat(self.place, beyond)
        return ca.vertcat(velocity, beyond) + ca.cross(spin, arm)


@dataclass(eq=False)
class BeamLine(Ball):
    """A beam along its length: all points within a distance of its centre line.

    It touches other shapes at stations, the Gauss points of its elements. The contact law is that
    of the whole beam: a station that represents the fraction ``w`` of its length has the force
    ``w N(δ, δ̇)``, so that all together have ``∫ N ds/L``, independently of their number. A contact
    stiffness ``k'`` per length is a stiffness ``k' L``. In ``Collisions`` it is a chain of capsules
    between the nodes of the beam, which needs a radius; distant parts touch each other.

    Parameters
    ----------
    beam : a beam
    radius : half of its height, or radius of its cross-section [m]
    stations : number of stations per element; the order of the beam by default

    Raises
    ------
    ModelError
        Not a beam; a number of stations that is not whole or below 1.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("strip on the floor", gravity=(0, -10))
    >>> strip = system.add(planar.Beam("strip", length=2.0, axial_rigidity=1e6, shear_rigidity=4e5,
    ...     bending_rigidity=10.0, mass_per_length=3.0, position=(0, 0.0099), angle=0, elements=2))
    >>> line, law = contact.BeamLine(strip, radius=0.01), contact.KelvinVoigt(stiffness=1e6)
    >>> floor = contact.HalfPlane(system.ground.center)
    >>> touch = system.add(planar.Contact("touch", floor, line, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["touch.force"].item(), 6)  # its weight
    60.0
    >>> round(rest["touch.penetration"].item() * 1e6, 6)  # weight over k [µm]
    60.0
    """

    beam: Beam = option("the beam")
    radius: Scalar = quantity("m", "half height, or radius", default=0.0, minimum=0.0)
    stations: int | None = option("number of stations per element", default=None)

    def __post_init__(self) -> None:
        need_beam(self.beam, type(self).__name__)
        if self.stations is None:
            self.stations = self.beam.order
        if type(self.stations) is not int or self.stations < 1:
            raise ModelError(
                f"stations is {self.stations!r}; give a whole number from 1 on", "BeamLine"
            )
        count = self.beam.elements * self.stations
        subject = f"{numeral(count)} stations on {self.beam.name}"
        check_budget(subject, memory=NODE * count, cure="give fewer stations")
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.beam

    @property
    def bodies(self) -> list[Coordinates]:
        return self.beam.parts()

    def solids(self) -> list[Solid]:
        from dalembert.elements.contact.beam_parts import beam_solids

        return beam_solids(self.beam, self.radius.sx, "BeamLine")

    def spots(self) -> list[Spot]:
        beam, (points, weights) = self.beam, gauss(int(self.stations or 1))
        values, order = beam.shapes.values(points), beam.order
        spots = []
        for e in range(beam.elements):
            sections = beam.sections[e * order : (e + 1) * order + 1]
            for shares, weight in zip(values, weights, strict=True):
                center = Point(Station(beam, sections, shares), (0.0,) * beam.dimension)
                spots.append(Spot(center, self.radius.sx, float(weight) / beam.elements))
        return spots
