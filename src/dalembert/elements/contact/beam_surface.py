"""Contact at the nearest point of a beam."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.contact.beam_line import Station, need_beam
from dalembert.elements.contact.contact_point import ContactPoint
from dalembert.elements.contact.hull import Solid
from dalembert.elements.contact.shapes import NO_LENGTH, Ball, Shape, Spot
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.flexible.beam import Beam

ITERATIONS = 3
"""Newton iterations to the nearest point of an element, from that of its chord."""
STRAIGHT = 0.2
"""Lower limit of the slope of the equation, over that of a straight element."""


@dataclass(eq=False)
class BeamSurface(Shape):
    """The surface of a beam, touched at the point of its centre line nearest to a ball.

    ``g = min |r_P − r(s)| − R − radius``; the force acts on the nodes of the nearest element. It is
    for rollers, pins and rings that are small beside the elements, and for a ``BeamLine`` of
    another beam. A large drum touches along a length: use a ``BeamLine``. In ``Collisions`` both
    are the same.

    Parameters
    ----------
    beam : a beam
    radius : half of its height, or radius of its cross-section [m]

    Raises
    ------
    ModelError
        Not a beam.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("stone on a cantilever", gravity=(0, -10))
    >>> arm = system.add(planar.Beam("arm", system.ground.center, length=1.0, axial_rigidity=1e6,
    ...     shear_rigidity=1e6, bending_rigidity=1e3, elements=4))
    >>> stone = system.add(planar.Particle("stone", mass=0.3, position=(0.5, 0.019)))
    >>> rail = planar.PinInSlot("rail", system.ground.point(0.5, 0), stone.center, axis=(0, 1))
    >>> guide, law = system.add(rail), contact.KelvinVoigt(stiffness=1e5)
    >>> shapes = contact.BeamSurface(arm), contact.Circle(stone.center, 0.02)
    >>> touch = system.add(planar.Contact("touch", *shapes, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> sag = 0.02 - rest["stone.y"].item() - 3 / 1e5
    >>> round(sag / (3 * (0.5**3 / 3e3 + 0.5 / 1e6)), 3)  # over m g (a³/(3 E I) + a/(G A))
    1.0
    """

    beam: Beam = option("the beam")
    radius: Scalar = quantity("m", "half height, or radius", default=0.0, minimum=0.0)
    feels = (Ball,)

    def __post_init__(self) -> None:
        need_beam(self.beam, type(self).__name__)
        super().__post_init__()

    @property
    def carrier(self) -> Any:
        return self.beam

    @property
    def bodies(self) -> list[Coordinates]:
        return self.beam.parts()

    def solids(self) -> list[Solid]:
        from dalembert.elements.contact.beam_parts import beam_solids

        return beam_solids(self.beam, self.radius.sx, "BeamSurface")

    def _contact_point(self, spot: Spot) -> ContactPoint:
        place = spot.point.position.sx
        station = Station(self.beam, self.beam.sections, self._shares(place))
        between = place - station.place
        distance = ca.sqrt(ca.sumsqr(between) + NO_LENGTH**2)
        gap, normal = distance - self.radius.sx - spot.radius, between / distance
        middle = place - normal * (spot.radius + gap / 2)
        bodies = station, spot.point.body
        return ContactPoint(gap, normal, middle, bodies=bodies, weight=spot.weight)

    def _shares(self, place: ca.SX) -> list[ca.SX]:
        """(count,) values of the polynomials of all nodes at the point nearest to a position."""
        order, nodes = self.beam.order, [section.place for section in self.beam.sections]
        shares, nearest = [ca.SX(0)] * len(nodes), None
        for e in range(self.beam.elements):
            first = e * order
            corners = ca.horzcat(*nodes[first : first + order + 1])
            values, squared = ca.vertsplit(
                self._projection(place, corners), [0, order + 1, order + 2]
            )
            closer = ca.SX(1) if nearest is None else squared < nearest
            nearest = squared if nearest is None else ca.fmin(squared, nearest)
            others = [ca.if_else(closer, 0, share) for share in shares]
            for k, value in enumerate(ca.vertsplit(values)):
                others[first + k] += ca.if_else(closer, value, 0)
            shares = others
        return shares

    @cached_property
    def _projection(self) -> ca.Function:
        """``(position, (d, p + 1) nodes) → (values, squared distance)`` of an element."""
        shapes, d = self.beam.shapes.shapes, self.beam.dimension
        place, corners = ca.SX.sym("place", d), ca.SX.sym("nodes", d, len(shapes))

        def at(xi: ca.SX, order: int) -> ca.SX:
            """Values of the polynomials, or of a derivative."""
            return ca.vertcat(*(_value(shape.deriv(order), xi) for shape in shapes))

        chord = corners[:, -1] - corners[:, 0]
        xi = ca.dot(place - corners[:, 0], chord) / (ca.sumsqr(chord) + NO_LENGTH**2)
        for _ in range(ITERATIONS):
            away, along, bend = (ca.mtimes(corners, at(xi, order)) for order in range(3))
            away, square = away - place, ca.sumsqr(along) + NO_LENGTH**2
            slope = ca.fmax(square + ca.dot(away, bend), STRAIGHT * square)
            xi = xi - ca.dot(away, along) / slope
        values = at(ca.fmin(1, ca.fmax(0, xi)), 0)
        squared = ca.sumsqr(ca.mtimes(corners, values) - place)
        return ca.Function("nearest", [place, corners], [ca.vertcat(values, squared)])


def _value(polynomial: Any, xi: ca.SX) -> ca.SX:
    """Value of a polynomial by Horner's rule."""
    total = ca.SX(0)
    for coefficient in reversed(polynomial.coef):
        total = total * xi + float(coefficient)
    return total
