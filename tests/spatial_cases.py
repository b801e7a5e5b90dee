"""Elements in space, each with its twin: part of the registry of tests."""

from __future__ import annotations

import functools

import numpy as np
import registry
from registry import AXES, LAWS
from spatial_twins import Hold, Solid, about, cross, norm, unit, wrapped
from twins import CENTER

from dalembert import FormulaCurve, cos, sin, spatial
from dalembert.elements.curves import u
from dalembert.elements.laws import Harmonic

case = functools.partial(registry.case, dimension=3)


# what twins see -------------------------------------------------------------------------------
def vector(p, pattern: str) -> np.ndarray:
    """Three parameters."""
    return np.array([getattr(p, pattern.format(letter)) for letter in "xyz"])


def spots(c) -> tuple[np.ndarray, np.ndarray]:
    """Places of the points P of a and Q of b."""
    return c.a.at(vector(c.p, "P_{}")), c.b.at(vector(c.p, "Q_{}"))


def frame(c, body, name: str) -> Hold:
    x = vector(c.p, f"{name}_x{{}}") if hasattr(c.p, f"{name}_xx") else None
    return Hold(body, vector(c.p, f"{name}_o{{}}"), vector(c.p, f"{name}_z{{}}"), x)


def frames(c, a=None, b=None) -> tuple[Hold, Hold]:
    return frame(c, a or c.a, "P"), frame(c, b or c.b, "Q")


def started(c, name: str) -> Solid:
    """A body at its given initial pose."""
    e = about(AXES[name], getattr(c.p, f"{name}_turn0"))
    body = Solid(np.concatenate([np.zeros(3, dtype=e.dtype), e]))
    body.center = getattr(c.p, f"{name}_c") * CENTER
    body.r = vector(c.p, f"{name}_{{}}0") + body.vector(body.center)
    return body


def at_start(c) -> tuple[Hold, Hold]:
    return frames(c, started(c, "a"), started(c, "b"))


def tilt(i: Hold, j: Hold) -> list:
    return [i.x @ j.z, i.y @ j.z]


def heading(i: Hold, j: Hold) -> complex:
    """Cosine and sine of the turn of the second x axis about the first z axis."""
    return np.array([i.x @ j.x, i.y @ j.x])


def after(turn, other) -> np.ndarray:
    """What is left of a turn after another one; both by cosine and sine."""
    c, s = unit(other)
    return np.array([c * turn[0] + s * turn[1], c * turn[1] - s * turn[0]])


def counted(c) -> np.ndarray:
    """The turn, from the initial poses unless all x axes are given."""
    now = heading(*frames(c))
    complete = hasattr(c.p, "P_xx") and hasattr(c.p, "Q_xx")
    return now if complete else after(now, heading(*at_start(c)))


def by(angle) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


def joined(*rows) -> np.ndarray:
    return np.concatenate([np.atleast_1d(row) for row in rows])


def wave(c):
    return LAWS["Harmonic"].twin(c.p, c.t)


def _wave(q, mean: float):
    return Harmonic(*q.numbers(amplitude=0.2, frequency=3.0, mean=mean, phase=0.5))


def held(c) -> np.ndarray:
    return frames(c)[1].o


# joints ---------------------------------------------------------------------------------------
@case(
    "spherical",
    spatial.Spherical,
    spatial.Body,
    residual=lambda c: spots(c)[1] - spots(c)[0],
    place={"J": lambda c: spots(c)[1]},
)
def _(q):
    q.add(spatial.Spherical("J", *q.spots()))


@case(
    "particle on a body",
    spatial.Particle,
    residual=lambda c: c.dot.r - c.a.at(vector(c.p, "P_{}")),
    place={"J": lambda c: c.dot.r},
)
def _(q):
    a = q.solid("a", (0.3, -0.2, 0.1), 0.4, (0.5, -0.3, 0.2), (0.7, 0.2, -0.4))
    dot = q.add(
        spatial.Particle(
            "dot",
            mass=q.number("dot_m", 0.7),
            position=q.numbers(dot_x0=0.6, dot_y0=0.1, dot_z0=-0.1),
            velocity=q.numbers(dot_vx0=0.1, dot_vy0=0.3, dot_vz0=-0.2),
        )
    )
    q.add(spatial.Spherical("J", q.spot(a, "P", (0.31, 0.12, -0.2)), dot))


def _revolute(c):
    i, j = frames(c)
    return joined(j.o - i.o, tilt(i, j))


def _cylindrical(c):
    i, j = frames(c)
    d = j.o - i.o
    return joined(i.x @ d, i.y @ d, tilt(i, j))


def _angle(c) -> np.ndarray:
    return by(c.p.angle if hasattr(c.p, "angle") else 0.0)


def _prismatic(c):
    return joined(_cylindrical(c), after(counted(c), _angle(c))[1])


def _weld(c):
    return joined(_revolute(c), after(counted(c), _angle(c))[1])


def _planar(c):
    i, j = frames(c)
    return joined(i.z @ (j.o - i.o), tilt(i, j))


def _screw(c):
    i, j = frames(c)
    along, lead = i.z @ (j.o - i.o), c.p.pitch / (2 * np.pi)
    if not hasattr(c.p, "P_xx"):
        first, second = at_start(c)
        along = along - first.z @ (second.o - first.o)
    return joined(_cylindrical(c), lead * wrapped(*after(by(along / lead), counted(c))))


TWINS = {
    spatial.Revolute: _revolute,
    spatial.Cylindrical: _cylindrical,
    spatial.Planar: _planar,
    spatial.Prismatic: _prismatic,
    spatial.Weld: _weld,
    spatial.Screw: _screw,
}
"""Joints of two frames, by textbook equations."""


def _between(kind: type, complete: bool, **numbers):
    def build(q):
        arguments = {name: q.number(name, value) for name, value in numbers.items()}
        return q.add(kind("J", *q.holds(complete), **arguments))

    return build


for _kind, _twin in TWINS.items():
    for _complete in (True, False):
        if _kind in (spatial.Revolute, spatial.Cylindrical, spatial.Planar) and not _complete:
            continue
        _numbers = {"pitch": 1.9} if _kind is spatial.Screw else {}
        if _complete and _kind in (spatial.Prismatic, spatial.Weld):
            _numbers = {"angle": 0.3}
        case(
            f"spatial {_kind.__name__.lower()}{'' if _complete else ' from the start'}",
            _kind,
            spatial.Frame,
            residual=_twin,
            place={"J": held},
        )(_between(_kind, _complete, **_numbers))


def _universal(c):
    i, j = frames(c)
    return joined(j.o - i.o, i.z @ j.z)


@case("universal", spatial.Universal, residual=_universal, place={"J": held})
def _(q):
    q.add(spatial.Universal("J", *q.holds(True, (1.2, 0.1, 0.2), (0.1, 0.3, 1.0))))


def _constant_velocity(complete: bool):
    def twist(i, j):
        return np.array([i.x @ j.x + i.y @ j.y, i.y @ j.x - i.x @ j.y])

    def residual(c):
        i, j = frames(c)
        turned = twist(i, j) if complete else after(twist(i, j), twist(*at_start(c)))
        return joined(j.o - i.o, wrapped(*turned))

    return residual


for _complete in (True, False):
    case(
        f"constant velocity{'' if _complete else ' from the start'}",
        spatial.ConstantVelocity,
        residual=_constant_velocity(_complete),
        place={"J": held},
    )(_between(spatial.ConstantVelocity, _complete))


# points and links -------------------------------------------------------------------------------
def _spot_on(kind: type, **numbers):
    def build(q):
        a, b = q.solids()
        hold = q.hold(a, "P", (0.31, 0.12, -0.2), (0.3, -0.2, 1.2), (1.1, 0.2, 0.3))
        arguments = {name: q.number(name, value) for name, value in numbers.items()}
        q.add(kind("J", hold, q.spot(b, "Q", (-0.22, 0.17, 0.1)), **arguments))

    return build


def _to_spot(rows):
    def residual(c):
        i = frame(c, c.a, "P")
        return joined(*rows(c, i, c.b.at(vector(c.p, "Q_{}")) - i.o))

    return residual


ON_SPOTS = {
    "point on line": (spatial.PointOnLine, {}, lambda c, i, d: [i.x @ d, i.y @ d]),
    "point on plane": (spatial.PointOnPlane, {}, lambda c, i, d: [i.z @ d]),
    "hinged link": (
        *(spatial.RevoluteSphericalLink, {"length": 0.8}),
        lambda c, i, d: [norm(d) - c.p.length, i.z @ d],
    ),
}
for _name, (_kind, _numbers, _rows) in ON_SPOTS.items():
    case(
        _name,
        _kind,
        residual=_to_spot(_rows),
        place={"J": lambda c: c.b.at(vector(c.p, "Q_{}"))},
    )(_spot_on(_kind, **_numbers))


@case(
    "spatial rigid link",
    spatial.RigidLink,
    residual=lambda c: norm(spots(c)[1] - spots(c)[0]) - c.p.length,
    place={"J": lambda c: spots(c)[1]},
)
def _(q):
    q.add(spatial.RigidLink("J", *q.spots(), length=q.number("length", 0.9)))


def _two_hinges(c):
    i, j = frames(c)
    d = j.o - i.o
    rows = [norm(d) - c.p.length, i.z @ d]
    if not hasattr(c.p, "twist"):
        return joined(rows, tilt(i, j))
    between = wrapped(i.z @ j.z, norm(cross(i.z, j.z)))
    return joined(rows, j.z @ d, between - c.p.twist)


for _numbers in ({"length": 0.7}, {"length": 0.7, "twist": 0.9}):
    case(
        f"link of two hinges{' askew' if 'twist' in _numbers else ''}",
        spatial.RevoluteRevoluteLink,
        residual=_two_hinges,
        place={"J": held},
    )(_between(spatial.RevoluteRevoluteLink, True, **_numbers))


def _helix(c):
    helix = [c.p.wide * np.cos(c.u), c.p.wide * np.sin(c.u), c.p.rise * c.u]
    return joined(c.a.R.T @ (c.b.at(vector(c.p, "Q_{}")) - c.a.at(np.zeros(3))) - helix)


@case(
    "point on helix",
    spatial.PointOnCurve,
    FormulaCurve,
    residual=_helix,
    place={"J": lambda c: c.a.at([c.p.wide * np.cos(c.u), c.p.wide * np.sin(c.u), c.p.rise * c.u])},
)
def _(q):
    a, b = q.solids()
    wide, rise = q.numbers(wide=0.7, rise=0.2)
    curve = FormulaCurve(wide * cos(u), wide * sin(u), z=rise * u, closed=False)
    spot = q.spot(b, "Q", (-0.22, 0.17, 0.1))
    q.add(spatial.PointOnCurve("J", a, spot, curve, parameter=q.number("u0", 0.9)))


# couplings --------------------------------------------------------------------------------------
def _on_ground(first: type, second: type, kind: type, **numbers):
    """Bodies a and b, each on a joint of the ground, and what couples both."""

    def build(q):
        a, b = q.solids()
        i = q.hold(q.ground, "G", (0.2, -0.1, 0.0), (0.4, -0.3, 1.1), (1.1, 0.2, 0.3))
        j = q.hold(q.ground, "H", (0.9, 0.4, -0.3), (-0.2, 0.3, 1.0), (0.9, 0.1, 0.2))
        on_a = q.hold(a, "P", (0.1, 0.12, -0.1), (0.3, -0.2, 1.2), (1.1, 0.2, 0.3))
        on_b = q.hold(b, "Q", (-0.12, 0.1, 0.1), (0.2, 0.4, 1.1), (0.9, 0.3, 0.1))
        joints = q.add(first("A", i, on_a)), q.add(second("B", j, on_b))
        arguments = {n: q.number(n, v) if isinstance(v, float) else v for n, v in numbers.items()}
        q.add(kind("J", *joints, **arguments))

    return build


class Grounded:
    """Both frames of a joint of the ground, for the twins of joints."""

    def __init__(self, c, i: str, body: Solid, j: str):
        self.i, self.j = frame(c, c.ground, i), frame(c, body, j)

    def rows(self, slides: bool):
        d = self.j.o - self.i.o
        if slides:
            return joined(self.i.x @ d, self.i.y @ d, tilt(self.i, self.j))
        return joined(d, tilt(self.i, self.j))

    @property
    def travel(self):
        return self.i.z @ (self.j.o - self.i.o)

    @property
    def turn(self) -> np.ndarray:
        return heading(self.i, self.j)


def _coupled(slides: bool, own):
    def residual(c):
        a, b = Grounded(c, "G", c.a, "P"), Grounded(c, "H", c.b, "Q")
        first = Grounded(c, "G", started(c, "a"), "P")
        second = Grounded(c, "H", started(c, "b"), "Q")
        turned = wrapped(*after(a.turn, first.turn)), wrapped(*after(b.turn, second.turn))
        return joined(a.rows(False), b.rows(slides), own(c, turned, b.travel - second.travel))

    return residual


COUPLED = {
    "bevel gears": (
        *(spatial.Revolute, spatial.GearPair, {"radius_i": 0.3, "radius_j": 0.4}),
        lambda c, turned, travel: [
            c.p.radius_i * turned[0] - c.u,
            c.p.radius_j * turned[1] + c.u,
        ],
    ),
    "spatial rack": (
        *(spatial.Cylindrical, spatial.RackAndPinion, {"radius": 0.3, "side": -1}),
        lambda c, turned, travel: [c.p.radius * turned[0] - c.u, travel + c.u],
    ),
    "spatial coupling": (
        *(spatial.Revolute, spatial.Coupling, {"ratio": 1.7}),
        lambda c, turned, travel: [turned[0] - c.u, turned[1] - c.p.ratio * c.u],
    ),
}
for _name, (_second, _kind, _numbers, _rows) in COUPLED.items():
    case(
        _name,
        _kind,
        residual=_coupled(_second is spatial.Cylindrical, _rows),
        place={"A": lambda c: frame(c, c.a, "P").o, "B": lambda c: frame(c, c.b, "Q").o},
    )(_on_ground(spatial.Revolute, _second, _kind, **_numbers))


# drivers --------------------------------------------------------------------------------------
def _ahead(c, turn):
    return wrapped(*after(turn, by(wave(c))))


def _driven(joint: type, driver: type, motion, twin, mean: float, axes=()):
    def build(q):
        element = q.add(joint("J", *q.holds(True, *axes)))
        q.add(driver("D", element, _wave(q, mean), motion=motion))

    return build


def _along(axis: str):
    def missed(c):
        i, j = frames(c)
        return getattr(i, axis) @ (j.o - i.o) - wave(c)

    return missed


def _cross_turns(c, motion: str):
    i, j = frames(c)
    if motion == "angle_i":
        return np.array([i.x @ j.z, i.y @ j.z])
    return np.array([j.x @ i.z, -(j.y @ i.z)])


_ARMS = ((1.2, 0.1, 0.2), (0.1, 0.3, 1.0))
DRIVEN = {
    "hinge driver": (
        *(spatial.Revolute, spatial.RotationalDriver, None, 0.2, ()),
        lambda c: joined(_revolute(c), _ahead(c, counted(c))),
    ),
    "sleeve driver": (
        *(spatial.Cylindrical, spatial.TranslationalDriver, "displacement", 0.2, ()),
        lambda c: joined(_cylindrical(c), _along("z")(c)),
    ),
    "plate driver": (
        *(spatial.Planar, spatial.TranslationalDriver, "displacement_y", 0.2, ()),
        lambda c: joined(_planar(c), _along("y")(c)),
    ),
    "cross driver": (
        *(spatial.Universal, spatial.RotationalDriver, "angle_j", 0.2, _ARMS),
        lambda c: joined(_universal(c), _ahead(c, _cross_turns(c, "angle_j"))),
    ),
}
for _name, (_joint, _driver, _motion, _mean, _axes, _rows) in DRIVEN.items():
    case(
        _name,
        _driver,
        residual=_rows,
        scleronomic=False,
        place={"J": held, "D": held},
    )(_driven(_joint, _driver, _motion, _rows, _mean, _axes))


@case(
    "spatial distance driver",
    spatial.DistanceDriver,
    residual=lambda c: norm(spots(c)[1] - spots(c)[0]) - wave(c),
    scleronomic=False,
    place={"J": lambda c: spots(c)[1]},
)
def _(q):
    q.add(spatial.DistanceDriver("J", *q.spots(), _wave(q, 0.8)))


@case(
    "spatial coordinate driver",
    spatial.CoordinateDriver,
    residual=lambda c: unit(vector(c.p, "to_{}")) @ spots(c)[0] - wave(c),
    scleronomic=False,
    objective=False,
)
def _(q):
    point, _ = q.spots()
    to = q.numbers(to_x=0.6, to_y=1.1, to_z=-0.4)
    q.add(spatial.CoordinateDriver("J", point, _wave(q, 0.3), direction=to))
