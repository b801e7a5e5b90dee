"""Sprockets of roller chains."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import casadi as ca

from dalembert.elements.base import Condition, Look, Scalar, option, quantity
from dalembert.elements.contact.hull import Boundary, Solid
from dalembert.elements.contact.shapes import NO_LENGTH, Ball, Pointed
from dalembert.elements.curves import Curve
from dalembert.elements.look import Path
from dalembert.errors import ModelError

SEAT, FLANK = 0.505, 0.12
"""Radii over the roller diameter: of the seats; of the flanks, divided by z + 2 (ISO 606)."""
DRAWN = 4
"""Number of chords per flank in pictures."""


@dataclass(eq=False)
class Sprocket(Pointed):
    """Sprocket of a roller chain, with the first seat on the x axis of its body.

    The ``z`` roller seats are concave arcs of radius ``0.505 d`` about points of the pitch circle,
    ``R = p/(2 sin(π/z))``, for rollers of diameter d. Arcs of radius ``0.12 d (z + 2)``, the flanks
    of the teeth, continue tangentially from a seat to the tip of a tooth (ISO 606, minimum form).
    Positions are rotated to the nearest seat, so that the cost does not depend on z.

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
    >>> round(motion["seat.gap"][0].item() / 0.00851, 6)  # seat clearance: 0.505 - 0.5
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
        clearance = self.pitch.sx - 2 * SEAT * self.roller.sx
        return [(clearance, "the rollers of a chain are smaller than its pitch; check both")]

    def boundary(self) -> Boundary:
        tips = tuple(self.tooth(ca.SX(k), ca.SX(0)) for k in range(self.teeth))
        return Boundary(TeethCurve(self), tips=tips)

    def solids(self) -> list[Solid]:
        return [Solid(self.carrier, tip) for tip in self.boundary().corners()]

    def tooth(self, number: ca.SX, fraction: ca.SX) -> ca.SX:
        """Position on a seat between its tips, from 0 to 1: a flank, the arc, the other flank."""
        from_middle = fraction - 0.5
        side, away = ca.if_else(from_middle < 0, -1, 1), 3 * ca.fabs(from_middle) - 0.5
        center, seat, direction, flank = self._arcs
        flank_center, tip = center + (seat + flank) * direction, self._tip
        begin, end = (
            ca.atan2(arm[1], arm[0]) for arm in (-direction, (tip - flank_center) / flank)
        )
        turn = ca.atan2(ca.sin(end - begin), ca.cos(end - begin))
        on_flank = begin + away * turn
        on_seat = 3 * from_middle * self.seating.sx
        x = ca.if_else(
            away > 0, flank_center[0] + flank * ca.cos(on_flank), center[0] - seat * ca.cos(on_seat)
        )
        y = ca.if_else(
            away > 0,
            side * (flank_center[1] + flank * ca.sin(on_flank)),
            seat * ca.sin(on_seat),
        )
        angle = 2 * ca.pi * number / self.teeth
        c, s = ca.cos(angle), ca.sin(angle)
        return self.point.local.sx + ca.vertcat(c * x - s * y, s * x + c * y)

    @property
    def pitch_radius(self) -> ca.SX:
        """``R``."""
        return self.pitch.sx / (2 * ca.sin(ca.pi / self.teeth))

    @property
    def _arcs(self) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
        """Centre and radius of a seat, direction of its end, radius of the flank."""
        end = self.seating.sx / 2
        center = ca.vertcat(self.pitch_radius, 0)
        direction = ca.vertcat(-ca.cos(end), ca.sin(end))
        return center, SEAT * self.roller.sx, direction, FLANK * self.roller.sx * (self.teeth + 2)

    def distance(self, place: ca.SX, sharp: bool) -> ca.SX:
        local = self.local(place) - self.point.local.sx
        seat_angle = self.teeth * ca.atan2(local[1], local[0])
        angle = ca.fabs(ca.atan2(ca.sin(seat_angle), ca.cos(seat_angle))) / self.teeth
        radius = ca.sqrt(ca.sumsqr(local) + NO_LENGTH**2)
        center, seat, direction, flank = self._arcs
        from_center = radius * ca.vertcat(ca.cos(angle), ca.sin(angle)) - center
        from_flank = from_center - (seat + flank) * direction
        on_seat = seat - ca.sqrt(ca.sumsqr(from_center) + NO_LENGTH**2)
        on_flank = ca.sqrt(ca.sumsqr(from_flank) + NO_LENGTH**2) - flank
        side = from_center[0] * direction[1] - from_center[1] * direction[0]
        return ca.if_else(side < 0, on_seat, on_flank)

    def look(self, near: ca.SX) -> list[Look]:
        corners = ca.horzcat(*self._outline())
        angles = [2 * ca.pi * k / self.teeth for k in range(self.teeth)]
        wheel = ca.horzcat(*(ca.mtimes(_rotation(angle), corners) for angle in angles))
        corners_at_point = wheel + self.point.local.sx
        count = corners_at_point.shape[1]

        def outline(u: ca.SX) -> ca.SX:
            weights = [ca.fmax(0, 1 - ca.fabs(u - k)) for k in range(count + 1)]
            return ca.mtimes(
                corners_at_point, ca.vertcat(weights[0] + weights[count], *weights[1:count])
            )

        return [Path(self.carrier, outline, (0.0, float(count)), True)]

    @property
    def _tip(self) -> ca.SX:
        """Tip of the tooth on the left of the first seat."""
        (center, seat, direction, flank), half = self._arcs, ca.pi / self.teeth
        flank_center = center + (seat + flank) * direction
        normal = ca.vertcat(-ca.sin(half), ca.cos(half))  # of the centre line of a tooth
        offset = ca.dot(flank_center, normal)
        height = ca.sqrt(flank**2 - offset**2)
        return flank_center - offset * normal + height * ca.vertcat(ca.cos(half), ca.sin(half))

    def _outline(self) -> list[ca.SX]:
        """Corners of half a tooth, a seat and half a tooth."""
        center, seat, direction, flank = self._arcs
        end, tip = self.seating.sx / 2, self._tip
        flank_center = center + (seat + flank) * direction
        begin = center + seat * direction
        flanks = []
        for k in range(DRAWN):
            chord = tip + (begin - tip) * k / DRAWN - flank_center
            flanks.append(flank_center + flank * chord / ca.sqrt(ca.sumsqr(chord)))
        arc = [end * (1 - k / DRAWN) for k in range(DRAWN + 1)]
        upper = [center + seat * ca.vertcat(-ca.cos(a), ca.sin(a)) for a in arc]
        half_seat = [*flanks, *upper]
        mirrored = [ca.vertcat(c[0], -c[1]) for c in half_seat]
        return [*mirrored[:-1], *half_seat[:0:-1]]


class TeethCurve(Curve):
    """The outline of a sprocket; seat ``k`` is at parameters from k to k + 1.

    Parameters
    ----------
    sprocket : Sprocket
    """

    closed = True

    def __init__(self, sprocket: Sprocket):
        self._sprocket = sprocket

    def position(self, parameter: ca.SX) -> ca.SX:
        number = ca.floor(parameter)
        return self._sprocket.tooth(number, parameter - number)

    def interval(self) -> tuple[float, float]:
        return 0.0, float(self._sprocket.teeth)


def _rotation(angle: float) -> ca.SX:
    c, s = ca.SX(cos(angle)), ca.SX(sin(angle))
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))
