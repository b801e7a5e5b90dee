"""Every element, law, curve, formulation, stabilisation and integrator, once.

A case builds a small model with one element in general position, in which *every* number is a
parameter, together with its NumPy twin: the same mechanics written out by hand. Laws are tested
over all cases.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from twins import CENTER, cross, cubic, direction, left, length, natural_cubic, turn

import dalembert as da
from dalembert import FormulaCurve, SplineCurve, cos, planar, sin, spatial, structures, t, u
from dalembert.elements.laws import (
    CycloidalRise,
    Formula,
    Harmonic,
    HarmonicRise,
    Polynomial,
    Polynomial345Rise,
    Polynomial4567Rise,
    Product,
    Sum,
    Table,
)

FORMULATIONS = {
    "Kkt": da.Kkt(),
    "RangeSpace": da.RangeSpace(),
    "Dae": da.Dae(),
    "AugmentedLagrangian": da.AugmentedLagrangian(),
    "NullSpace": da.NullSpace(),
    "NullSpace qr": da.NullSpace("qr"),
    "NullSpace gram-schmidt": da.NullSpace("gram-schmidt"),
    "NullSpace svd": da.NullSpace("svd"),
    "VelocityPartitioning": da.VelocityPartitioning(),
}
SOFT = {"Penalty": da.Penalty()}
"""Formulations that hold the constraints only nearly."""
STABILIZATIONS = {
    "none": da.Stabilization(),
    "Baumgarte": da.Baumgarte(),
    "Projection": da.Projection(),
    "EnergyProjection": da.EnergyProjection(),
}
INTEGRATORS = {
    "Euler": da.Euler(),
    "Heun": da.Heun(),
    "RK4": da.RK4(),
    "RKGill": da.RKGill(),
    "DormandPrince": da.DormandPrince(),
    "DormandPrince853": da.DormandPrince853(),
    "BackwardEuler": da.BackwardEuler(),
    "Trapezoidal": da.Trapezoidal(),
    "Newmark": da.Newmark(),
    "HHT": da.HHT(),
    "GeneralizedAlpha": da.GeneralizedAlpha(),
    "Radau": da.Radau(),
    "Bdf": da.Bdf(),
    "Cvodes": da.Cvodes(),
    "Ida": da.Ida(),
}


GRAVITY = (0.4, -9.81, 1.7)


@dataclass(frozen=True)
class Observer:
    """Turns, shifts and boosts the whole mechanism; nothing inside it may notice."""

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)
    boost: tuple[float, float] = (0.0, 0.0)


MOMENTS = (1.0, 1.2, 0.7, 0.1, -0.2, 0.15)
"""Moments and products of inertia of bodies in space, to scale."""
AXES = {"a": (0.3, -0.5, 1.0), "b": (1.0, 0.4, 0.2), "arm": (-0.2, 1.0, 0.3)}
"""About which they are turned at first."""


class Builder:
    """A system in which every number is a parameter."""

    def __init__(self, name: str, gravity: bool, observer: Observer, dimension: int = 2):
        self.observer, self.system = observer, da.System(name)
        if gravity:
            vector = self.numbers(
                **dict(zip(("gx", "gy", "gz")[:dimension], GRAVITY, strict=False))
            )
            self.system = da.System(name, gravity=vector)
            for parameter in vector:
                self.system.parameters[parameter.name] = parameter
        self.ground = self.system.ground

    def number(self, name: str, value: float):
        return self.system.parameter(name, value)

    def numbers(self, **values: float) -> tuple:
        return tuple(self.number(n, v) for n, v in values.items())

    def point(self, body, name: str, x: float, y: float):
        """Point of a body at parametric body coordinates ``<name>_x``, ``<name>_y``."""
        return body.point(*self.numbers(**{f"{name}_x": x, f"{name}_y": y}))

    def body(self, name: str, pose, speed, mass=1.3, inertia=0.21, kind=planar.Body, **more):
        place = turn(self.observer.angle, pose[:2]) + self.observer.shift
        speeds = turn(self.observer.angle, speed[:2]) + self.observer.boost
        given = {
            "mass": self.number(f"{name}_m", mass),
            "position": self.numbers(**{f"{name}_x0": place[0], f"{name}_y0": place[1]}),
            "velocity": self.numbers(**{f"{name}_vx0": speeds[0], f"{name}_vy0": speeds[1]}),
        }
        if not issubclass(kind, planar.Particle):
            angle = pose[2] + self.observer.angle
            given["angle"] = self.number(f"{name}_angle0", angle)
            given["angular_velocity"] = self.number(f"{name}_w0", speed[2])
            if inertia is not None:
                given["inertia"] = self.number(f"{name}_J", inertia)
        return self.add(kind(name, **given, **more))

    def pair(self, b=(1.1, 0.5, -0.6)):
        """Two free bodies in general position."""
        return (
            self.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7)),
            self.body("b", b, (-0.2, 0.4, -1.1), 0.8, 0.13),
        )

    def points(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.pair()
        return self.point(a, "P", 0.31, 0.12), self.point(b, "Q", -0.22, 0.17)

    def add(self, element):
        return self.system.add(element)

    # in space -----------------------------------------------------------------------------------
    def solid(self, name: str, place, turned, speed, spin, mass=1.3, size=0.2):
        """A free body whose mass centre is not its origin; ``turned`` about ``AXES[name]``."""
        angle, away = self.number(f"{name}_turn0", turned), self.number(f"{name}_c", 1.0)
        moment = self.number(f"{name}_J", size)
        return self.add(
            spatial.Body(
                name,
                mass=self.number(f"{name}_m", mass),
                inertia=[moment * share for share in MOMENTS],
                center_of_mass=[away * share for share in CENTER],
                position=self.numbers(**_components(f"{name}_{{}}0", place)),
                rotation=da.rotation.axis_angle(AXES[name], angle),
                velocity=self.numbers(**_components(f"{name}_v{{}}0", speed)),
                angular_velocity=self.numbers(**_components(f"{name}_w{{}}0", spin)),
            )
        )

    def solids(self, b=(0.9, 0.5, -0.4)):
        """Two free bodies in general position."""
        return (
            self.solid("a", (0.3, -0.2, 0.1), 0.4, (0.5, -0.3, 0.2), (0.7, 0.2, -0.4)),
            self.solid("b", b, -0.3, (-0.2, 0.4, 0.1), (-0.3, 0.5, 0.6), 0.8, 0.13),
        )

    def spot(self, body, name: str, place):
        """Point of a body at parametric coordinates ``<name>_x``, ``<name>_y``, ``<name>_z``."""
        return body.point(*self.numbers(**_components(f"{name}_{{}}", place)))

    def spots(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.solids()
        return self.spot(a, "P", (0.31, 0.12, -0.2)), self.spot(b, "Q", (-0.22, 0.17, 0.1))

    def hold(self, body, name: str, place, axis, x=None):
        """Frame of a body: parametric place, axis ``<name>_z…`` and x axis ``<name>_x…``."""
        given = {"axis": self.numbers(**_components(f"{name}_z{{}}", axis))}
        if x is not None:
            given["x"] = self.numbers(**_components(f"{name}_x{{}}", x))
        return body.frame(self.numbers(**_components(f"{name}_o{{}}", place)), **given)

    def holds(self, complete: bool = True, axis=(0.2, 0.4, 1.1), x=(0.9, 0.3, 0.1)):
        """A frame on each of two free bodies, ``P`` on a and ``Q`` on b, with x axes or without."""
        a, b = self.solids()
        return (
            self.hold(
                a, "P", (0.31, 0.12, -0.2), (0.3, -0.2, 1.2), (1.1, 0.2, 0.3) if complete else None
            ),
            self.hold(b, "Q", (-0.22, 0.17, 0.1), axis, x if complete else None),
        )


def _components(pattern: str, vector) -> dict[str, float]:
    return {pattern.format(letter): value for letter, value in zip("xyz", vector, strict=True)}


def P(c) -> np.ndarray:
    """Place of the point P of body a."""
    return c.a.at((c.p.P_x, c.p.P_y))


def Q(c) -> np.ndarray:
    """Place of the point Q of body b."""
    return c.b.at((c.p.Q_x, c.p.Q_y))


@dataclass(frozen=True)
class Case:
    """One small model and its twin.

    Attributes
    ----------
    covers : classes this case stands for
    build : adds the elements to a builder
    residual : twin of all constraint equations, in the order of the model
    loads : twin of all applied forces but gravity: list of (body, force, place, moment)
    place : joint → twin of the place where its reaction is reported
    objective : moving the whole mechanism changes nothing inside
    scleronomic : no driver works on it
    conservative : at rest, the forces are −∂V/∂y
    dimension : 3 of bodies in space
    """

    name: str
    covers: tuple
    build: Callable[[Builder], None]
    residual: Callable | None = None
    loads: Callable | None = None
    place: dict[str, Callable] = field(default_factory=dict)
    objective: bool = True
    scleronomic: bool = True
    conservative: bool = True
    dimension: int = 2

    def model(self, gravity: bool = True, observer: Observer | None = None) -> da.Model:
        name = self.name.replace(" ", "-")
        builder = Builder(name, gravity, observer or Observer(), self.dimension)
        self.build(builder)
        return builder.system.build()

    def __repr__(self) -> str:
        return self.name


CASES: dict[str, Case] = {}


def case(name: str, *covers, **more):
    """Register the decorated function as the builder of a case."""

    def register(build):
        CASES[name] = Case(name, covers, build, **more)
        return build

    return register


@functools.cache
def model_of(name: str) -> da.Model:
    """The model of a case, built once."""
    return CASES[name].model()


def definite(formulation, model: da.Model):
    """The formulation with what it chooses at the start of a run."""
    return formulation.choose(model.equations, 0.0, model.start.y, model.nominal)


# motion laws ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class LawCase:
    """A motion law, its twin, and where its pieces meet how smoothly.

    Attributes
    ----------
    make : builder → Law
    twin : (numbers, time) → value
    breaks : times at which pieces meet
    smooth : order of the highest continuous derivative there
    """

    kind: type
    make: Callable
    twin: Callable
    breaks: tuple[float, ...] = ()
    smooth: int = 2


def _rise_twin(profile: Callable, falls: bool):
    def clipped(x):
        return 0.0 if np.real(x) <= 0 else 1.0 if np.real(x) >= 1 else profile(x)

    def value(p, time):
        local = time - p.begin
        if not falls:
            return p.start + p.height * clipped(local / p.rise)
        local = local - p.period * np.floor(np.real(local) / np.real(p.period))
        up, down = clipped(local / p.rise), clipped((local - p.rise - p.dwell) / p.fall)
        return p.start + p.height * (up - down)

    return value


def _rise(kind: type, falls: bool):
    def make(q):
        values = {"height": 0.7, "start": -0.2, "begin": -0.05}
        given = {n: q.number(n, v) for n, v in values.items()}
        given["duration"] = q.number("rise", 0.5)
        if falls:
            given |= {
                n: q.number(n, v) for n, v in {"dwell": 0.1, "fall": 0.3, "period": 1.1}.items()
            }
        return kind(**given)

    return make


PROFILES = {
    HarmonicRise: (lambda x: np.sin(np.pi * x / 2) ** 2, 1),
    CycloidalRise: (lambda x: x - np.sin(2 * np.pi * x) / (2 * np.pi), 2),
    Polynomial345Rise: (lambda x: 10 * x**3 - 15 * x**4 + 6 * x**5, 2),
    Polynomial4567Rise: (lambda x: 35 * x**4 - 84 * x**5 + 70 * x**6 - 20 * x**7, 3),
}
TIMES = np.array([-0.5, 0.4, 0.9, 1.3, 2.0, 2.6])
VALUES = np.array([0.1, 0.7, -0.3, 0.2, 0.9, 0.1])

LAWS: dict[str, LawCase] = {
    "Polynomial": LawCase(
        Polynomial,
        lambda q: Polynomial(*q.numbers(phi0=0.3, omega=-1.2, alpha=2.5)),
        lambda p, s: p.phi0 + p.omega * s + p.alpha * s**2 / 2,
    ),
    "Harmonic": LawCase(
        Harmonic,
        lambda q: Harmonic(*q.numbers(amplitude=0.4, frequency=3.0, mean=0.2, phase=0.5)),
        lambda p, s: p.mean + p.amplitude * np.sin(p.frequency * s + p.phase),
    ),
    "Formula": LawCase(
        Formula,
        lambda q: Formula(q.number("k1", 0.3) * sin(q.number("k2", 2.0) * t) + 0.1 * t**3),
        lambda p, s: p.k1 * np.sin(p.k2 * s) + 0.1 * s**3,
    ),
    "Table": LawCase(
        Table,
        lambda q: Table(TIMES, VALUES),
        lambda p, s: cubic(s, TIMES, VALUES, "natural"),
        breaks=tuple(TIMES[1:-1]),
    ),
    "Sum": LawCase(
        Sum,
        lambda q: Table(TIMES, VALUES) + Harmonic(q.number("amp", 0.4), q.number("w", 3.0)) + t,
        lambda p, s: cubic(s, TIMES, VALUES, "natural") + p.amp * np.sin(p.w * s) + s,
        breaks=tuple(TIMES[1:-1]),
    ),
    "Product": LawCase(
        Product,
        lambda q: (
            Polynomial(q.number("s0", 0.3)) * Harmonic(q.number("amp", 1.0), q.number("w", 2.0))
        ),
        lambda p, s: p.s0 * p.amp * np.sin(p.w * s),
    ),
    "Table of formulas": LawCase(
        Table,
        lambda q: Table(
            [x * q.number(f"stretch{k}", 1.0) for k, x in enumerate(TIMES)],
            [y * q.number(f"lift{k}", 1.0) for k, y in enumerate(VALUES)],
        ),
        lambda p, s: natural_cubic(
            s,
            [x * getattr(p, f"stretch{k}") for k, x in enumerate(TIMES)],
            [y * getattr(p, f"lift{k}") for k, y in enumerate(VALUES)],
        ),
        breaks=tuple(TIMES[1:-1]),
    ),
    "Table periodic": LawCase(
        Table,
        lambda q: Table(TIMES, VALUES, periodic=True),
        lambda p, s: cubic(s, TIMES, VALUES, "periodic"),
        breaks=tuple(TIMES),
    ),
}
for _kind, (_profile, _smooth) in PROFILES.items():
    LAWS[_kind.__name__] = LawCase(
        _kind, _rise(_kind, False), _rise_twin(_profile, False), (-0.05, 0.45), _smooth
    )
    LAWS[f"{_kind.__name__} repeated"] = LawCase(
        _kind,
        _rise(_kind, True),
        _rise_twin(_profile, True),
        (-0.05, 0.45, 0.55, 0.85, 1.05, 1.55),
        _smooth,
    )


# bodies --------------------------------------------------------------------------------------


@case("free bodies", planar.Body, planar.Bar, planar.Particle)
def _(q):
    q.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7))
    q.body(
        "rod",
        (1.0, 0.3, -0.2),
        (0.1, 0.2, 0.3),
        inertia=None,
        kind=planar.Bar,
        length=q.number("rod_length", 0.7),
    )
    q.body("dot", (-1.0, 0.3), (0.1, 0.2), kind=planar.Particle)


# joints --------------------------------------------------------------------------------------


@case("revolute", planar.Revolute, residual=lambda c: Q(c) - P(c))
def _(q):
    q.add(planar.Revolute("J", *q.points()))


@case(
    "revolute on ground",
    planar.Revolute,
    planar.Ground,
    objective=False,
    residual=lambda c: c.a.at((c.p.A_x, c.p.A_y)) - np.array([c.p.O_x, c.p.O_y]),
)
def _(q):
    a = q.body("a", (0.3, -0.2, 0.4), (0.5, -0.3, 0.7))
    q.add(planar.Revolute("J", q.point(q.ground, "O", 0.1, 0.1), q.point(a, "A", -0.2, 0.3)))


def _axis(c):
    axis = np.array([c.p.axis_x, c.p.axis_y])
    return c.a.vector(axis / length(axis))


@case(
    "translational",
    planar.Translational,
    residual=lambda c: np.array([cross(_axis(c), Q(c) - P(c)), c.b.phi - c.a.phi - c.p.angle]),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    q.add(planar.Translational("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))


@case("pin in slot", planar.PinInSlot, residual=lambda c: cross(_axis(c), Q(c) - P(c)))
def _(q):
    q.add(planar.PinInSlot("J", *q.points(), axis=q.numbers(axis_x=1.2, axis_y=0.9)))


@case(
    "weld",
    planar.Weld,
    residual=lambda c: np.append(Q(c) - P(c), c.b.phi - c.a.phi - c.p.angle),
)
def _(q):
    q.add(planar.Weld("J", *q.points(), angle=q.number("angle", -0.8)))


@case("rigid link", planar.RigidLink, residual=lambda c: length(Q(c) - P(c)) - c.p.link)
def _(q):
    q.add(planar.RigidLink("J", *q.points(), length=q.number("link", 0.8)))


@case(
    "rigid link between particles",
    planar.RigidLink,
    planar.Particle,
    residual=lambda c: length(c.b.r - c.a.r) - c.p.link,
)
def _(q):
    a = q.body("a", (0.3, -0.2), (0.5, -0.3), kind=planar.Particle)
    b = q.body("b", (1.1, 0.5), (-0.2, 0.4), 0.8, kind=planar.Particle)
    q.add(planar.RigidLink("J", a.center, b.center, length=q.number("link", 1.05)))


@case(
    "user constraint",
    planar.UserConstraint,
    objective=False,
    scleronomic=False,
    residual=lambda c: c.p.k * c.a.r[0] * np.cos(c.b.phi) + c.b.r[1] ** 2 - c.p.h - c.p.s * c.t**2,
)
def _(q):
    a, b = q.pair()
    k, h, s = q.numbers(k=1.4, h=0.55, s=0.6)
    q.add(planar.UserConstraint("J", k * a.x * cos(b.angle) + b.y**2 - h - s * t**2))


# points on curves ----------------------------------------------------------------------------

CORNERS = np.array(
    [(0.5, 0.0), (0.35, 0.4), (-0.1, 0.5), (-0.45, 0.1), (-0.3, -0.4), (0.25, -0.45)]
)


def _spline(c, derivative: bool):
    table = np.array([[getattr(c.p, f"c{k}_{w}") for w in "xy"] for k in range(len(CORNERS))])
    table = np.vstack([table, table[:1]])
    knots = np.arange(len(table), dtype=float)
    return np.array([cubic(c.u, knots, table[:, k], "periodic", derivative) for k in (0, 1)])


def _ellipse(c, derivative: bool):
    if derivative:
        return np.array([-c.p.major * np.sin(c.u), c.p.minor * np.cos(c.u)])
    return np.array([c.p.major * np.cos(c.u), c.p.minor * np.sin(c.u)])


def _follows(curve, roller: bool):
    """Body a carries the curve; Q follows at the roller's radius on the right of it."""

    def residual(c):
        tangent = curve(c, True)
        off = (c.p.roller if roller else 0.0) * -left(tangent) / length(tangent)
        return turn(-c.a.phi, Q(c) - c.a.r) - curve(c, False) - off

    return residual


@case(
    "point on spline curve",
    planar.PointOnCurve,
    SplineCurve,
    residual=_follows(_spline, True),
    place={"J": lambda c: c.a.at(_spline(c, False))},
)
def _(q):
    a, b = q.pair((0.87, 0.0, -0.6))
    corners = [q.numbers(**{f"c{k}_x": x, f"c{k}_y": y}) for k, (x, y) in enumerate(CORNERS)]
    q.add(
        planar.PointOnCurve(
            "J",
            a,
            q.point(b, "Q", -0.22, 0.17),
            SplineCurve(corners),
            radius=q.number("roller", 0.15),
            parameter=q.number("u0", 0.4),
        )
    )


@case(
    "point on formula curve",
    planar.PointOnCurve,
    FormulaCurve,
    residual=_follows(_ellipse, False),
    place={"J": lambda c: c.a.at(_ellipse(c, False))},
)
def _(q):
    a, b = q.pair()
    major, minor = q.numbers(major=0.8, minor=0.45)
    curve = FormulaCurve(major * cos(u), minor * sin(u))
    point = q.point(b, "Q", -0.22, 0.17)
    q.add(planar.PointOnCurve("J", a, point, curve, parameter=q.number("u0", 0.3)))


# motion without slip -------------------------------------------------------------------------


def _start(c, name):
    """The given initial pose of a body, as a frame."""
    from twins import Frame

    return Frame(np.array([getattr(c.p, f"{name}_{w}") for w in ("x0", "y0", "angle0")]))


def _meshed(internal: bool, on_arm: bool):
    """Arc rolled off gear a equals the arc rolled off gear b, seen from the line of centres."""

    def rolled(a, b, p):
        line = direction(b.at((p.Q_x, p.Q_y)) - a.at((p.P_x, p.P_y)))
        inside = -1 if internal else 1
        return p.ra * (a.phi - line) + inside * p.rb * (b.phi - line)

    def residual(c):
        gear = np.atleast_1d(rolled(c.a, c.b, c.p) - rolled(_start(c, "a"), _start(c, "b"), c.p))
        if not on_arm:
            return gear
        pins = [P(c) - c.arm.at((c.p.A_x, c.p.A_y)), Q(c) - c.arm.at((c.p.B_x, c.p.B_y))]
        return np.concatenate([*pins, gear])

    return residual


def _gears(internal: bool):
    def build(q):
        i, j = q.points()
        ra, rb = q.numbers(ra=0.2, rb=0.5)
        q.add(planar.GearPair("J", i, j, radius_i=ra, radius_j=rb, internal=internal))

    return build


def _planetary(internal: bool):
    def build(q):
        arm = q.body("arm", (0.7, 0.2, 0.6), (0.1, 0.2, 0.9), 0.6, 0.1)
        i, j = q.points()
        q.add(planar.Revolute("A", q.point(arm, "A", -0.3, 0.05), i))
        q.add(planar.Revolute("B", q.point(arm, "B", 0.35, -0.02), j))
        ra, rb = q.numbers(ra=0.2, rb=0.5)
        q.add(planar.GearPair("J", i, j, radius_i=ra, radius_j=rb, internal=internal))

    return build


for _internal in (False, True):
    _kind_name = "internal" if _internal else "external"
    case(f"{_kind_name} gears", planar.GearPair, residual=_meshed(_internal, False))(
        _gears(_internal)
    )
    case(f"{_kind_name} gears on an arm", planar.GearPair, residual=_meshed(_internal, True))(
        _planetary(_internal)
    )


def _rack_slip(side: int):
    def travelled(a, b, p):
        axis = np.array([p.axis_x, p.axis_y])
        axis = a.vector(axis / length(axis))
        between = b.at((p.Q_x, p.Q_y)) - a.at((p.P_x, p.P_y))
        return axis @ between + side * p.radius * (b.phi - a.phi)

    return lambda c: travelled(c.a, c.b, c.p) - travelled(_start(c, "a"), _start(c, "b"), c.p)


def _pitch_point(side: int):
    return {"J": lambda c: Q(c) - side * c.p.radius * left(_axis(c))}


def _on_line(kind, side: int):
    def build(q):
        q.add(
            kind(
                "J",
                *q.points(),
                axis=q.numbers(axis_x=1.2, axis_y=0.9),
                radius=q.number("radius", 0.3),
                side=side,
            )
        )

    return build


def _rolling(side: int):
    slip = _rack_slip(side)
    return lambda c: np.array([cross(_axis(c), Q(c) - P(c)) - side * c.p.radius, slip(c)])


for _side, _where in ((1, "left"), (-1, "right")):
    case(
        f"rack and pinion {_where}",
        planar.RackAndPinion,
        residual=_rack_slip(_side),
        place=_pitch_point(_side),
    )(_on_line(planar.RackAndPinion, _side))
    case(
        f"rolling disc {_where}",
        planar.RollingDisc,
        residual=_rolling(_side),
        place=_pitch_point(_side),
    )(_on_line(planar.RollingDisc, _side))


def _coupled(carrier: bool):
    def ratio(a, b, base, p):
        return (b.phi - base) - p.ratio * (a.phi - base)

    def residual(c):
        now = ratio(c.a, c.b, c.arm.phi if carrier else 0.0, c.p)
        base = c.p.arm_angle0 if carrier else 0.0
        return now - ratio(_start(c, "a"), _start(c, "b"), base, c.p)

    return residual


@case("coupling", planar.Coupling, residual=_coupled(False))
def _(q):
    q.add(planar.Coupling("J", *q.pair(), ratio=q.number("ratio", -1.7)))


@case("coupling on carrier", planar.Coupling, residual=_coupled(True))
def _(q):
    arm = q.body("arm", (0.7, 0.2, 0.6), (0.1, 0.2, 0.9), 0.6, 0.1)
    q.add(planar.Coupling("J", *q.pair(), ratio=q.number("ratio", -1.7), carrier=arm))


# drivers -------------------------------------------------------------------------------------


def _driven_turn(law: LawCase):
    def build(q):
        q.add(planar.RotationalDriver("J", *q.pair(), law.make(q)))

    return build


for _name, _law in LAWS.items():
    case(
        f"rotational driver {_name}",
        planar.RotationalDriver,
        _law.kind,
        scleronomic=False,
        residual=lambda c, law=_law: c.b.phi - c.a.phi - law.twin(c.p, c.t),
    )(_driven_turn(_law))


def _wave(q, mean: float):
    return Harmonic(*q.numbers(amplitude=0.2, frequency=3.0, mean=mean, phase=0.5))


@case(
    "translational driver",
    planar.TranslationalDriver,
    scleronomic=False,
    residual=lambda c: _axis(c) @ (Q(c) - P(c)) - LAWS["Harmonic"].twin(c.p, c.t),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    q.add(planar.TranslationalDriver("J", *q.points(), axis=axis, law=_wave(q, 0.3)))


@case(
    "distance driver",
    planar.DistanceDriver,
    scleronomic=False,
    residual=lambda c: length(Q(c) - P(c)) - LAWS["Harmonic"].twin(c.p, c.t),
)
def _(q):
    q.add(planar.DistanceDriver("J", *q.points(), _wave(q, 0.8)))


@case(
    "coordinate driver",
    planar.CoordinateDriver,
    scleronomic=False,
    objective=False,
    residual=lambda c: (
        np.array([c.p.to_x, c.p.to_y])
        @ c.a.at((c.p.P_x, c.p.P_y))
        / np.sqrt(c.p.to_x**2 + c.p.to_y**2)
        - LAWS["Harmonic"].twin(c.p, c.t)
    ),
)
def _(q):
    a, _ = q.pair()
    point = q.point(a, "P", 0.31, 0.12)
    q.add(
        planar.CoordinateDriver("J", point, _wave(q, 0.3), direction=q.numbers(to_x=0.6, to_y=1.1))
    )


# forces --------------------------------------------------------------------------------------


def _opposite(c, force, place_i, place_j, moment=0.0):
    """A force and moment on b, and their opposites on a."""
    return [("b", force, place_j, moment), ("a", -force, place_i, -moment)]


def _approach(c):
    """Unit vector from P to Q and the rate of their distance."""
    between = Q(c) - P(c)
    along = between / length(between)
    return along, along @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)))


def _pull(tension):
    """Loads of an element that pulls P and Q together."""

    def loads(c):
        along, speed = _approach(c)
        return _opposite(c, -tension(c, length(Q(c) - P(c)), speed) * along, P(c), Q(c))

    return loads


def _force_at_p(c, force):
    return [("a", force, P(c), 0.0)]


@case(
    "force",
    planar.Force,
    objective=False,
    conservative=False,
    loads=lambda c: _force_at_p(c, np.array([c.p.fx * np.cos(3 * c.t), c.p.fy * c.b.r[0]])),
)
def _(q):
    a, b = q.pair()
    fx, fy = q.numbers(fx=3.0, fy=-2.0)
    q.add(planar.Force("F", q.point(a, "P", 0.31, 0.12), (fx * cos(3 * t), fy * b.x)))


@case(
    "following force",
    planar.Force,
    conservative=False,
    loads=lambda c: _force_at_p(c, c.a.vector(np.array([c.p.fx * np.cos(3 * c.t), c.p.fy]))),
)
def _(q):
    a, _ = q.pair()
    fx, fy = q.numbers(fx=3.0, fy=-2.0)
    q.add(planar.Force("F", q.point(a, "P", 0.31, 0.12), (fx * cos(3 * t), fy), following=True))


@case(
    "moment",
    planar.Moment,
    conservative=False,
    loads=lambda c: [("a", np.zeros(2), c.a.r, c.p.m0 * (1 - c.a.w / c.p.w0))],
)
def _(q):
    a, _ = q.pair()
    m0, w0 = q.numbers(m0=2.0, w0=5.0)
    q.add(planar.Moment("F", a, m0 * (1 - a.angular_velocity / w0)))


@case(
    "moment with reaction",
    planar.Moment,
    conservative=False,
    loads=lambda c: _opposite(c, np.zeros(2), c.a.r, c.b.r, c.p.m0 * np.cos(2 * c.t)),
)
def _(q):
    a, b = q.pair()
    q.add(planar.Moment("F", b, q.number("m0", 2.0) * cos(2 * t), reaction_on=a))


@case(
    "spring",
    planar.Spring,
    loads=_pull(lambda c, s, rate: c.p.k * (s - c.p.l0) + c.p.d * rate),
)
def _(q):
    k, d, l0 = q.numbers(k=30.0, d=1.5, l0=0.5)
    q.add(planar.Spring("F", *q.points(), stiffness=k, damping=d, free_length=l0))


@case(
    "spring with law",
    planar.Spring,
    conservative=False,
    loads=_pull(
        lambda c, s, rate: (
            c.p.k * (s - c.p.l0) + c.p.d * rate + c.p.k3 * (s - c.p.l0) ** 3 + c.p.d3 * rate**3
        )
    ),
)
def _(q):
    k, d, l0, k3, d3 = q.numbers(k=30.0, d=1.5, l0=0.5, k3=200.0, d3=0.7)
    q.add(
        planar.Spring(
            "F",
            *q.points(),
            stiffness=k,
            damping=d,
            free_length=l0,
            law=lambda extension, rate: k3 * extension**3 + d3 * rate**3,
        )
    )


@case(
    "rotational spring",
    planar.RotationalSpring,
    loads=lambda c: _opposite(
        c,
        np.zeros(2),
        c.a.r,
        c.b.r,
        -c.p.k * (c.b.phi - c.a.phi - c.p.a0) - c.p.d * (c.b.w - c.a.w),
    ),
)
def _(q):
    k, d, a0 = q.numbers(k=4.0, d=0.3, a0=-0.2)
    q.add(planar.RotationalSpring("F", *q.pair(), stiffness=k, damping=d, free_angle=a0))


@case(
    "rotational spring with law",
    planar.RotationalSpring,
    conservative=False,
    loads=lambda c: _opposite(
        c,
        np.zeros(2),
        c.a.r,
        c.b.r,
        -c.p.k * np.sin(c.b.phi - c.a.phi - c.p.a0) - c.p.d * (c.b.w - c.a.w) ** 3,
    ),
)
def _(q):
    k, d, a0 = q.numbers(k=4.0, d=0.3, a0=-0.2)
    q.add(
        planar.RotationalSpring(
            "F",
            *q.pair(),
            free_angle=a0,
            law=lambda extension, rate: k * sin(extension) + d * rate**3,
        )
    )


@case(
    "actuator",
    planar.Actuator,
    conservative=False,
    loads=_pull(lambda c, s, rate: -c.p.push * np.cos(4 * c.t) * (1 + c.a.w)),
)
def _(q):
    i, j = q.points()
    push = q.number("push", 6.0) * cos(4 * t) * (1 + i.body.angular_velocity)
    q.add(planar.Actuator("F", i, j, force=push))


def _bushing(c):
    # force on b at Q by the deflection in the axes of a; a feels the opposite at the same place
    between = Q(c) - P(c)
    opening = c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c))
    local, speed = turn(-c.a.phi, between), turn(-c.a.phi, opening)
    force = -np.array(
        [c.p.kx * local[0] + c.p.cx * speed[0], c.p.ky * local[1] + c.p.cy * speed[1]]
    )
    moment = -c.p.kr * (c.b.phi - c.a.phi) - c.p.cr * (c.b.w - c.a.w)
    return _opposite(c, c.a.vector(force), Q(c), Q(c), moment)


@case("bushing", planar.Bushing, loads=_bushing)
def _(q):
    kx, ky, cx, cy, kr, cr = q.numbers(kx=40.0, ky=25.0, cx=1.0, cy=0.6, kr=3.0, cr=0.2)
    q.add(
        planar.Bushing(
            "F",
            *q.points(),
            stiffness=(kx, ky),
            damping=(cx, cy),
            rotational_stiffness=kr,
            rotational_damping=cr,
        )
    )


def _beam(c):
    # one element of first order: strains in its middle, by the slopes of the straight line there
    along = (Q(c) - P(c)) / c.p.L
    first, second = c.a.phi + c.p.angle_i, c.b.phi + c.p.angle_j
    middle, bend = (first + second) / 2, (second - first) / c.p.L
    speed, spin = c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)), (c.a.w + c.b.w) / 2
    arc = c.p.bend * c.p.L  # of the natural shape
    natural = turn(-arc / 2, np.array([np.sin(arc), 1 - np.cos(arc)]) / arc)
    strain = turn(-middle, along) - natural
    rate = turn(-middle, speed / c.p.L - spin * left(along))
    rigid = np.array([c.p.EA, c.p.GA])
    force = turn(middle, rigid * (strain + c.p.lead * rate))
    moment = c.p.EI * (bend - c.p.bend + c.p.lead * (c.b.w - c.a.w) / c.p.L)
    shear = c.p.L / 2 * cross(along, force)
    return [("a", force, P(c), moment + shear), ("b", -force, Q(c), -moment + shear)]


@case("beam", planar.Beam, loads=_beam)
def _(q):
    numbers = q.numbers(L=0.9, bend=0.3, EA=40.0, GA=25.0, EI=3.0, lead=0.1)
    length, bend, axial, shear, bending, lead = numbers
    angles = q.numbers(angle_i=0.3, angle_j=-0.2)
    q.add(
        planar.Beam(
            "F",
            *q.points(),
            length=length,
            curvature=bend,
            axial_rigidity=axial,
            shear_rigidity=shear,
            bending_rigidity=bending,
            damping=lead,
            angle_i=angles[0],
            angle_j=angles[1],
            elements=1,
            order=1,
        )
    )


def _chord(c):
    """Between two nodes: natural length, length, direction and turn."""
    before = np.array([c.p.b_x0 - c.p.a_x0, c.p.b_y0 - c.p.a_y0])
    now = c.b.r - c.a.r
    turned = direction(turn(-direction(before), now))
    return length(before), length(now), now / length(now), turned


def _truss(c):
    natural, stretched, along, _ = _chord(c)
    strain = stretched / natural - 1 - c.p.alpha * c.p.heat
    force = c.p.E * c.p.A * strain * along
    return [("a", force, c.a.r, 0.0), ("b", -force, c.b.r, 0.0)]


def _nodes(q, kind):
    return (
        q.body("a", (0.3, -0.2, 0.1), (0.5, -0.3, 0.7), kind=kind),
        q.body("b", (1.1, 0.5, -0.2), (-0.2, 0.4, -1.1), 0.8, 0.13, kind=kind),
    )


@case("truss", planar.PointNode, structures.Truss, loads=_truss)
def _(q):
    area, modulus, expansion, heat = q.numbers(A=0.02, E=8000.0, alpha=0.01, heat=2.0)
    numbers = {"area": area, "modulus": modulus, "expansion": expansion, "temperature": heat}
    q.add(structures.Truss("F", *_nodes(q, planar.PointNode), **numbers))


def _frame(c):
    natural, stretched, along, turned = _chord(c)
    first, second = c.a.phi - c.p.a_angle0 - turned, c.b.phi - c.p.b_angle0 - turned
    longer = natural * (2 * first**2 - first * second + 2 * second**2) / 30
    axial = c.p.E * c.p.A * (stretched - natural + longer) / natural
    bend = 2 * c.p.E * c.p.I / natural
    moment_a = bend * (2 * first + second) + axial * natural * (4 * first - second) / 30
    moment_b = bend * (first + 2 * second) + axial * natural * (4 * second - first) / 30
    force = axial * along - (moment_a + moment_b) / stretched * left(along)
    return [("a", force, c.a.r, -moment_a), ("b", -force, c.b.r, -moment_b)]


@case("plane frame", planar.Node, structures.Frame, loads=_frame)
def _(q):
    area, bending, modulus = q.numbers(A=0.02, I=2e-3, E=3000.0)
    numbers = {"area": area, "second_moment": bending, "modulus": modulus}
    q.add(structures.Frame("F", *_nodes(q, planar.Node), **numbers))


def _friction(c, speed):
    return -(c.p.coulomb * np.tanh(speed / c.p.transition) + c.p.viscous * speed)


@case(
    "friction in revolute",
    planar.JointFriction,
    residual=lambda c: Q(c) - P(c),
    loads=lambda c: _opposite(c, np.zeros(2), c.a.r, c.b.r, _friction(c, c.b.w - c.a.w)),
)
def _(q):
    joint = q.add(planar.Revolute("J", *q.points()))
    f, v, w = q.numbers(coulomb=0.4, viscous=0.1, transition=0.8)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))


def _sliding_friction(c):
    sliding = _axis(c) @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c)))
    return _opposite(c, _friction(c, sliding) * _axis(c), Q(c), Q(c))


@case(
    "friction in slider",
    planar.JointFriction,
    residual=CASES["translational"].residual,
    loads=_sliding_friction,
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.Translational("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))
    f, v, w = q.numbers(coulomb=2.0, viscous=0.5, transition=0.8)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))


@case(
    "friction in slot",
    planar.JointFriction,
    residual=CASES["pin in slot"].residual,
    loads=lambda c: (
        _sliding_friction(c) + _opposite(c, np.zeros(2), c.a.r, c.b.r, -c.p.spin * (c.b.w - c.a.w))
    ),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.PinInSlot("J", *q.points(), axis=axis))
    f, v, w, spin = q.numbers(coulomb=2.0, viscous=0.5, transition=0.8, spin=0.3)
    q.add(planar.JointFriction("F", joint, coulomb=f, viscous=v, transition=w))
    q.add(planar.JointFriction("G", joint, viscous=spin, motion="angle"))


@case(
    "actuator in slider",
    planar.JointActuator,
    residual=CASES["translational"].residual,
    conservative=False,
    loads=lambda c: _opposite(c, c.p.push * np.cos(4 * c.t) * _axis(c), Q(c), Q(c)),
)
def _(q):
    axis = q.numbers(axis_x=1.2, axis_y=0.9)
    joint = q.add(planar.Translational("J", *q.points(), axis=axis, angle=q.number("angle", -0.8)))
    q.add(planar.JointActuator("F", joint, q.number("push", 6.0) * cos(4 * t)))


@case(
    "motor in slot",
    planar.JointActuator,
    residual=CASES["pin in slot"].residual,
    conservative=False,
    loads=lambda c: _opposite(c, np.zeros(2), c.a.r, c.b.r, c.p.m0 * (1 - c.b.w / c.p.w0)),
)
def _(q):
    joint = q.add(planar.PinInSlot("J", *q.points(), axis=q.numbers(axis_x=1.2, axis_y=0.9)))
    m0, w0 = q.numbers(m0=2.0, w0=5.0)
    value = m0 * (1 - joint.point_j.body.angular_velocity / w0)
    q.add(planar.JointActuator("F", joint, value, motion="angle"))


def _stop(upper: bool):
    def loads(c):
        along, speed = _approach(c)
        depth = length(Q(c) - P(c)) - c.p.limit if upper else c.p.limit - length(Q(c) - P(c))
        sense = 1 if upper else -1
        if np.real(depth) <= 0:
            return []
        press = c.p.k * depth**c.p.power * max(0.0, 1 + c.p.d * sense * speed)
        return _opposite(c, -sense * press * along, P(c), Q(c))

    return loads


def _stopped(upper: bool):
    def build(q):
        i, j = q.points()
        gap = ((j.x - i.x) ** 2 + (j.y - i.y) ** 2) ** 0.5
        limit, k, d, power = q.numbers(limit=0.4 if upper else 1.4, k=80.0, d=0.5, power=1.5)
        q.add(
            planar.Stop(
                "F",
                gap,
                stiffness=k,
                damping=d,
                exponent=power,
                **{"upper" if upper else "lower": limit},
            )
        )

    return build


case("upper stop", planar.Stop, loads=_stop(True))(_stopped(True))
case("lower stop", planar.Stop, loads=_stop(False))(_stopped(False))


def _touch(c):
    """Discs about P and Q that press and rub, with creeping Coulomb friction."""
    along, _ = _approach(c)
    depth = c.p.radius_i + c.p.radius_j - length(Q(c) - P(c))
    if np.real(depth) <= 0:
        return []
    place = P(c) + along * (c.p.radius_i - depth / 2)
    moved = c.b.velocity_at(place) - c.a.velocity_at(place)
    speed, slip = -along @ _approach_velocity(c), moved @ -left(along)
    factor = 1 + c.p.d * speed
    press = c.p.k * depth**c.p.power * (factor if np.real(factor) > 0 else 0.0)
    x = np.sqrt((slip / c.p.transition) ** 2 + 1e-12)
    bump = (c.p.static - c.p.dynamic) * x / (x**2 / 4 + 0.75) ** 2
    rub = press * (c.p.dynamic * np.tanh(4 * x) + bump) * slip / c.p.transition / x
    return _opposite(c, press * along + rub * left(along), place, place)


def _approach_velocity(c):
    return c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c))


@case("contact", planar.Contact, loads=_touch)
def _(q):
    i, j = q.points()
    k, d, power = q.numbers(k=80.0, d=0.3, power=1.5)
    dynamic, static, transition = q.numbers(dynamic=0.3, static=0.5, transition=0.9)
    kit = planar.contact
    q.add(
        planar.Contact(
            "F",
            kit.Circle(i, q.number("radius_i", 0.7)),
            kit.Circle(j, q.number("radius_j", 0.5)),
            law=kit.HuntCrossley(stiffness=k, damping=d, exponent=power),
            friction=kit.Coulomb(dynamic, static, transition),
        )
    )


def _play(c):
    """A journal about Q in a bearing about P, with friction that falls."""
    along, rate = _approach(c)
    depth = length(Q(c) - P(c)) - c.p.clearance
    if np.real(depth) <= 0:
        return []
    place = Q(c) + along * (c.p.radius - depth / 2)
    slip = (c.b.velocity_at(place) - c.a.velocity_at(place)) @ left(along)
    press = c.p.k * depth + c.p.d * rate
    press = press if np.real(press) > 0 else 0.0
    x = np.sqrt((slip / c.p.transition) ** 2 + 1e-12)
    falling = (c.p.static - c.p.dynamic) * np.exp(-((x * c.p.transition / c.p.fallen) ** 2))
    size = (c.p.dynamic + falling) * np.tanh(4 * x) + c.p.viscous * x * c.p.transition
    rub = press * size * slip / c.p.transition / x
    return _opposite(c, -press * along - rub * left(along), place, place)


@case("clearance", planar.ClearanceRevolute, loads=_play)
def _(q):
    k, d = q.numbers(k=8.0, d=0.3)
    dynamic, static, transition = q.numbers(dynamic=0.3, static=0.5, transition=0.9)
    fallen, viscous = q.numbers(fallen=0.8, viscous=0.1)
    q.add(
        planar.ClearanceRevolute(
            "F",
            *q.points(),
            radius=q.number("radius", 0.5),
            clearance=q.number("clearance", 0.1),
            law=planar.contact.KelvinVoigt(stiffness=k, damping=d),
            friction=planar.contact.Stribeck(dynamic, static, transition, fallen, viscous),
        )
    )


def _hoist(c):
    """A cable from P over a point of the ground to Q."""
    via = np.array([c.p.V_x, c.p.V_y])
    parts = [(P(c) - via) / length(P(c) - via), (Q(c) - via) / length(Q(c) - via)]
    rate = parts[0] @ c.a.velocity_at(P(c)) + parts[1] @ c.b.velocity_at(Q(c))
    stretch = length(P(c) - via) + length(Q(c) - via) - c.p.rope
    pull = c.p.k * stretch + c.p.d * rate
    if np.real(stretch) <= 0 or np.real(pull) <= 0:
        return []
    return [("a", -pull * parts[0], P(c), 0.0), ("b", -pull * parts[1], Q(c), 0.0)]


@case("cable", planar.Cable, loads=_hoist, objective=False)
def _(q):
    i, j = q.points()
    via = q.point(q.ground, "V", 0.4, 0.9)
    rope, k, d = q.numbers(rope=0.6, k=80.0, d=0.3)
    q.add(planar.Cable("F", (i, via, j), length=rope, stiffness=k, damping=d))


import spatial_cases  # noqa: E402, F401  (registers them)

PLANAR = [n for n, c in CASES.items() if c.dimension == 2]
CONSTRAINED = [n for n, c in CASES.items() if c.residual]
LOADED = [n for n, c in CASES.items() if c.loads]
SPATIAL = [n for n in CASES if n not in PLANAR]
RELATED = [n for n in CONSTRAINED if n.removeprefix("rotational driver ") not in list(LAWS)[1:]]
"""All that are constrained, but a driver with one law: others change its right side only."""
EACH = [n for n in PLANAR if n in RELATED]
IN_TURN = [f for f in FORMULATIONS if f not in ("Kkt", "NullSpace svd")]  # svd: for few speeds only
COMBINED = [(n, f) for n in EACH for f in FORMULATIONS] + [
    (n, IN_TURN[k % len(IN_TURN)]) for k, n in enumerate(n for n in CASES if n not in EACH)
]
"""Cases with formulations: constraints in the plane each with each; all formulations in turn in
space, for other laws of one driver, and where nothing is constrained, so that all do the same."""
