"""Toothed wheels of roller chains."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import casadi as ca

from dalembert.elements.base import Condition, Look, Scalar, option, quantity
from dalembert.elements.contact.shapes import NO_LENGTH, Ball, Pointed
from dalembert.elements.look import Path
from dalembert.errors import ModelError

SEAT, FLANK = 0.505, 0.12
"""Radius of the seats by the diameter of rollers; of the flanks, times (z + 2) (ISO 606)."""
DRAWN = 4
"""Chords of a tooth's flank in pictures."""


@dataclass(eq=False)
class Sprocket(Pointed):
    """Wheel with teeth for a roller chain, the first seat along the x axis of its body.

    Rollers of the diameter d sit in ``z`` hollow arcs of radius ``0.505 d`` about points of the
    pitch circle, ``R = p/(2 sin(π/z))``. Arcs of ``0.12 d (z + 2)``, which are the flanks of the
    teeth, go on tangentially where a seat ends, up to where two of them meet (ISO 606, minimum
    form). A place is turned back to the seat nearest to it, so that all teeth cost as much as one.

    Parameters
    ----------
    point : its centre, point of a body
    teeth : z
    pitch : p, of the chain [m]
    roller : diameter d of its rollers [m]
    seating : angle of the arc of a seat [rad]

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("chain on a wheel")
    >>> wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.01))
    >>> radius = 0.0127 / (2 * math.sin(math.pi / 18))
    >>> pin = system.add(planar.Particle("pin", mass=0.01, position=(radius, 0)))
    >>> teeth = contact.Sprocket(wheel.center, teeth=18, pitch=0.0127, roller=0.00851)
    >>> roller = contact.Circle(pin.center, 0.00851 / 2)
    >>> seat = planar.Contact("seat", teeth, roller, law=contact.KelvinVoigt(stiffness=1e6))
    >>> contact = system.add(seat)
    >>> motion = da.solve_dynamics(system.build(), 1e-4, step=1e-4)
    >>> round(motion["seat.gap"][0].item() / 0.00851, 6)  # play of a seat: 0.505 - 0.5
    0.005
    """

    teeth: int = option("number of teeth", default=0)
    pitch: Scalar = quantity("m", "pitch of the chain", default=None, above=0.0)
    roller: Scalar = quantity("m", "diameter of the rollers", default=None, above=0.0)
    seating: Scalar = quantity("rad", "angle of the arc of a seat", default=2.3, above=0.0)
    feels = (Ball,)
    space = 2

    def __post_init__(self) -> None:
        if isinstance(self.teeth, bool) or not isinstance(self.teeth, int) or self.teeth < 5:
            raise ModelError(f"teeth is {self.teeth!r}; give a whole number from 5 on", "Sprocket")
        if self.pitch is None or self.roller is None:
            raise ModelError("give pitch= of the chain and roller=, the diameter", "Sprocket")
        super().__post_init__()

    def conditions(self) -> list[Condition]:
        room = self.pitch.sx - 2 * SEAT * self.roller.sx
        return [(room, "the rollers of a chain are smaller than its pitch; check both")]

    @property
    def pitch_radius(self) -> ca.SX:
        """``R``."""
        return self.pitch.sx / (2 * ca.sin(ca.pi / self.teeth))

    @property
    def _arcs(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """Seat: its middle, radius; where it ends, from there; radius of the flank."""
        end = self.seating.sx / 2
        middle = ca.vertcat(self.pitch_radius, 0)
        toward = ca.vertcat(-ca.cos(end), ca.sin(end))
        return middle, SEAT * self.roller.sx, toward, FLANK * self.roller.sx * (self.teeth + 2)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        local = self.local(place) - self.point.local.sx
        turned = self.teeth * ca.atan2(local[1], local[0])
        angle = ca.fabs(ca.atan2(ca.sin(turned), ca.cos(turned))) / self.teeth
        radius = ca.sqrt(ca.sumsqr(local) + NO_LENGTH**2)
        middle, seat, toward, flank = self._arcs
        off = radius * ca.vertcat(ca.cos(angle), ca.sin(angle)) - middle
        beyond = off - (seat + flank) * toward
        on_seat = seat - ca.sqrt(ca.sumsqr(off) + NO_LENGTH**2)
        on_flank = ca.sqrt(ca.sumsqr(beyond) + NO_LENGTH**2) - flank
        side = off[0] * toward[1] - off[1] * toward[0]
        return ca.if_else(side < 0, on_seat, on_flank)

    def look(self, near: ca.SX) -> list[Look]:
        corners = ca.horzcat(*self._outline())
        turns = [2 * ca.pi * k / self.teeth for k in range(self.teeth)]
        wheel = ca.horzcat(*(ca.mtimes(_turn(angle), corners) for angle in turns))
        placed = wheel + self.point.local.sx
        count = placed.shape[1]

        def along(u: ca.SX) -> ca.SX:
            share = [ca.fmax(0, 1 - ca.fabs(u - k)) for k in range(count + 1)]
            return ca.mtimes(placed, ca.vertcat(share[0] + share[count], *share[1:count]))

        return [Path(self.carrier, along, (0.0, float(count)), True)]

    def _outline(self) -> list[ca.SX]:
        """Corners of half a tooth, a seat, half a tooth."""
        middle, seat, toward, flank = self._arcs
        end, half = self.seating.sx / 2, ca.pi / self.teeth
        centre = middle + (seat + flank) * toward
        line = ca.vertcat(-ca.sin(half), ca.cos(half))  # across the middle of the tooth
        across = ca.dot(centre, line)
        height = ca.sqrt(flank**2 - across**2)
        tip = centre - across * line + height * ca.vertcat(ca.cos(half), ca.sin(half))
        begin = middle + seat * toward
        flanks = []
        for k in range(DRAWN):
            chord = tip + (begin - tip) * k / DRAWN - centre
            flanks.append(centre + flank * chord / ca.sqrt(ca.sumsqr(chord)))
        arc = [end * (1 - k / DRAWN) for k in range(DRAWN + 1)]
        upper = [middle + seat * ca.vertcat(-ca.cos(a), ca.sin(a)) for a in arc]
        half_seat = [*flanks, *upper]
        mirrored = [ca.vertcat(c[0], -c[1]) for c in half_seat]
        return [*mirrored[:-1], *half_seat[:0:-1]]


def _turn(angle: float) -> ca.SX:
    c, s = ca.SX(cos(angle)), ca.SX(sin(angle))
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))
