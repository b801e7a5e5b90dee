"""Beams in collisions: balls at their nodes and the sides of the chords between these."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.elements.contact.hull import Hull, Solid
from dalembert.elements.coordinates import rate_of
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.flexible.nodes import CrossSection
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import t


class BeamPart:
    """A part of a beam, which moves with its nodes.

    Parameters
    ----------
    beam : Beam
    first, last : numbers of its nodes
    """

    def __init__(self, beam: Beam, first: int, last: int):
        self.beam = self.owner = beam
        self.name, self.dimension = beam.name, beam.dimension
        self.first, self.last = first, last

    def in_space(self, vector: ca.SX) -> ca.SX:
        """(3,) components."""
        return ca.vertcat(vector, ca.SX.zeros(3 - self.dimension))

    def velocity_of(self, section: CrossSection) -> ca.SX:
        """(3,) velocity of the centre of a cross-section."""
        return self.in_space(rate_of(section.place, [section.body], t.sx))

    def turned(self, local: ca.SX) -> ca.SX:
        """Inertial components of a vector in inertial axes."""
        return local


class Knot(BeamPart):
    """A cross-section at a node; points are in inertial axes."""

    @property
    def _section(self) -> CrossSection:
        return self.beam.sections[self.first]

    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point relative to the centre."""
        return self._section.place + local

    @property
    def turning(self) -> ca.SX:
        """(3,) angular velocity."""
        spin: ca.SX = self._section.body.turning
        return spin

    def velocity_at(self, place: ca.SX) -> ca.SX:
        """(3,) velocity at an inertial position."""
        arm = place - self.in_space(self._section.place)
        return self.velocity_of(self._section) + ca.cross(self.turning, arm)


class Chord(BeamPart):
    """The straight line between two successive nodes.

    Points are located by their fraction of its length, from -1/2 to 1/2. Its velocity is that of
    the middle and of its rotation, without its stretch, which does not change the distance of
    points beside it; its ends are knots.
    """

    @property
    def _ends(self) -> list[CrossSection]:
        return self.beam.sections[self.first : self.last + 1]

    @property
    def _along(self) -> ca.SX:
        first, second = self._ends
        return second.place - first.place

    def locate(self, local: ca.SX) -> ca.SX:
        """Inertial position of a point of the line."""
        first, second = self._ends
        return (first.place + second.place) / 2 + local[0] * self._along

    @cached_property
    def turning(self) -> ca.SX:
        """(3,) angular velocity; about the line, the mean of the cross-sections."""
        along = self.in_space(self._along)
        first, second = (self.velocity_of(section) for section in self._ends)
        square = ca.sumsqr(along)
        turning = ca.cross(along, second - first) / square
        if self.dimension == 2:
            return turning
        spins = [section.body.turning for section in self._ends]
        return turning + ca.dot(along, spins[0] + spins[1]) / (2 * square) * along

    def velocity_at(self, place: ca.SX) -> ca.SX:
        """(3,) velocity at an inertial position."""
        middle = self.in_space(self.locate(ca.SX(1, 1)))
        first, second = (self.velocity_of(section) for section in self._ends)
        return (first + second) / 2 + ca.cross(self.turning, place - middle)


def beam_solids(beam: Beam, radius: ca.SX, shape: str) -> list[Solid]:
    """Balls at the nodes of a beam, and capsules along its chords, whose ends do not touch.

    Raises
    ------
    ModelError
        The radius is zero.
    """
    if radius.is_zero():
        text = "has no radius, which collisions need; give half of its height"
        raise ModelError(text, f"{shape} of {beam.name}")
    rest = ca.SX.zeros(beam.dimension - 1)
    ends = [ca.vertcat(fraction, rest) for fraction in (-0.5, 0.5)]
    hull = Hull(tuple(ends), radius, ((0, 1),))
    if beam.dimension == 2:
        hull = Hull.planar(ends, radius)
    ball, count = Hull((ca.SX.zeros(beam.dimension),), radius), beam.count
    knots = [Solid(Knot(beam, k, k), ball) for k in range(count)]
    return [*knots, *(Solid(Chord(beam, k, k + 1), hull) for k in range(count - 1))]
