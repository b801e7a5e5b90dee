"""Every element in space, once: small models whose numbers are all parameters, and NumPy twins.

As ``registry`` for the plane: a case builds free bodies in general position with one element, and
its twin writes the same mechanics out by hand, as wrenches on the bodies.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np
import registry
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import cos, spatial, t


class Builder:
    """A system in which every number is a parameter."""

    def __init__(self, name: str, gravity: bool = True):
        self.system = da.System(name)
        if gravity:
            vector = self.vector("g", (0.4, -0.7, -9.6))
            self.system = da.System(name, gravity=vector)
            for parameter in vector:
                self.system.parameters[parameter.name] = parameter

    def number(self, name: str, value: float):
        return self.system.parameter(name, value)

    def vector(self, name: str, values) -> tuple:
        return tuple(self.number(f"{name}_{k}", x) for k, x in zip("xyzuvw", values, strict=False))

    def solid(self, name, place, turn, velocity, spin, kind=spatial.Body, **more):
        given = {
            "position": self.vector(f"{name}_r0", place),
            "velocity": self.vector(f"{name}_v0", velocity),
        }
        if kind is not spatial.Particle:
            size = float(np.linalg.norm(turn))
            axis = self.vector(f"{name}_n0", np.array(turn) / size)
            angle = self.number(f"{name}_angle0", size)
            given["rotation"] = da.rotation.axis_angle(axis, angle)
            given["angular_velocity"] = self.vector(f"{name}_w0", spin)
        return self.system.add(kind(name, **given, **more))

    def body(self, name, place, turn, velocity, spin, mass=1.3):
        moments = np.array([0.21, 0.17, 0.13, 0.02, -0.01, 0.03]) * mass
        return self.solid(
            name,
            place,
            turn,
            velocity,
            spin,
            mass=self.number(f"{name}_m", mass),
            inertia=self.vector(f"{name}_J", moments),
            center_of_mass=self.vector(f"{name}_c", (0.03, -0.02, 0.04)),
        )

    def pair(self):
        """Two free bodies in general position."""
        return (
            self.body("a", (0.3, -0.2, 0.1), (0.4, -0.3, 0.6), (0.5, -0.3, 0.2), (0.7, -0.4, 0.3)),
            self.body(
                "b", (1.1, 0.5, -0.3), (-0.3, 0.5, 0.2), (-0.2, 0.4, 0.1), (-1.1, 0.3, 0.5), 0.8
            ),
        )

    def points(self):
        """A point on each of two free bodies: ``P`` on a, ``Q`` on b."""
        a, b = self.pair()
        return a.point(*self.vector("P", (0.31, 0.12, -0.2))), b.point(
            *self.vector("Q", (-0.22, 0.17, 0.05))
        )

    def frames(self):
        """A frame on each of two free bodies."""
        a, b = self.pair()
        return (
            a.frame(
                self.vector("P", (0.31, 0.12, -0.2)),
                axis=self.vector("axis_i", (0.2, 0.3, 1.1)),
                x=self.vector("x_i", (1.0, 0.1, 0.2)),
            ),
            b.frame(
                self.vector("Q", (-0.22, 0.17, 0.05)),
                rotation=da.rotation.bryant(*self.vector("turn_j", (0.3, 0.2, -0.1))),
            ),
        )

    def hinge(self):
        """Two bodies on a hinge."""
        return self.system.add(spatial.Revolute("J", *self.frames()))

    def add(self, element):
        return self.system.add(element)


# twins ---------------------------------------------------------------------------------------


class Solid:
    """A moving body: mass centre ``r``, matrix ``R``, velocity ``v``, angular velocity ``w``."""

    def __init__(self, pose, twist, center):
        self.r, self.center = pose[:3], center
        turns = pose.size > 3
        self.R = Rotation.from_quat(np.roll(pose[3:], -1)).as_matrix() if turns else np.eye(3)
        self.v, self.w = twist[:3], self.R @ twist[3:] if turns else np.zeros(3)

    def at(self, local):
        return self.r + self.R @ (np.asarray(local) - self.center)

    def velocity_at(self, place):
        return self.v + np.cross(self.w, place - self.r)


class Numbers:
    """Parameter values; vectors by their name."""

    def __init__(self, model, p):
        self._values = dict(zip(model.parameters, np.asarray(p, float), strict=True))

    def __getattr__(self, name):
        values = self.__dict__["_values"]
        if name in values:
            return values[name]
        return np.array([values[f"{name}_{k}"] for k in "xyzuvw" if f"{name}_{k}" in values])


def context(model, time, y, v, p) -> SimpleNamespace:
    c = SimpleNamespace(t=time, p=Numbers(model, p), body={})
    i = j = 0
    for body in model.bodies:
        m, n = body.pose.numel(), body.twist.numel()
        center = c.p.__getattr__(f"{body.name}_c")
        center = center if center.size else np.zeros(3)
        c.body[body.name] = Solid(y[i : i + m], v[j : j + n], center)
        i, j = i + m, j + n
    vars(c).update(c.body)
    return c


def P(c):
    return c.a.at(c.p.P)


def Q(c):
    return c.b.at(c.p.Q)


def frame_i(c):
    """Axes of the first frame as columns."""
    z, x = c.p.axis_i / np.linalg.norm(c.p.axis_i), c.p.x_i
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    return c.a.R @ np.column_stack([x, np.cross(z, x), z])


def frame_j(c):
    return c.b.R @ Rotation.from_euler("XYZ", c.p.turn_j).as_matrix()


def opposite(force, place, moment=(0.0, 0.0, 0.0)):
    """The wrench on b, and its reaction on a."""
    moment = np.asarray(moment)
    return [("b", force, place, moment), ("a", -force, place, -moment)]


def approach(c):
    """Direction from P to Q and the rate of their distance."""
    between = Q(c) - P(c)
    along = between / np.linalg.norm(between)
    return along, along @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)))


@dataclass(frozen=True)
class Case:
    """One small model and its twin.

    Attributes
    ----------
    covers : classes this case stands for
    build : adds the elements to a builder
    loads : twin of all applied forces but gravity: list of (body, force, place, moment)
    conservative : at rest, the forces are those of the potential
    """

    name: str
    covers: tuple
    build: Callable[[Builder], None]
    loads: Callable = field(default=lambda c: [])
    conservative: bool = True

    def model(self, gravity: bool = True) -> da.Model:
        builder = Builder(self.name.replace(" ", "-"), gravity)
        self.build(builder)
        return builder.system.build()


SPATIAL_CASES: dict[str, Case] = {}
"""Names begin with ``spatial``."""


def case(name: str, *covers, **more):
    """Register the decorated function as the builder of a case."""

    def register(build):
        SPATIAL_CASES[f"spatial {name}"] = Case(name, covers, build, **more)
        return build

    return register


@functools.cache
def spatial_model_of(name: str) -> da.Model:
    """The model of a case, built once."""
    return SPATIAL_CASES[name].model()


def any_model_of(name: str) -> da.Model:
    """The model of a case in the plane or in space."""
    return spatial_model_of(name) if name in SPATIAL_CASES else registry.model_of(name)


@case(
    "bodies",
    *(spatial.Body, spatial.Particle, spatial.Box, spatial.Cylinder, spatial.Sphere),
    *(spatial.Capsule, spatial.Bar),
)
def _(q):
    q.body("a", (0.3, -0.2, 0.1), (0.4, -0.3, 0.6), (0.5, -0.3, 0.2), (0.7, -0.4, 0.3))
    place, turn, speed, spin = (1.0, 0.3, 0.1), (0.1, 0.7, -0.2), (0.1, 0.2, 0.3), (0.3, 1.0, 0.2)
    free = functools.partial(q.solid, place=place, turn=turn, velocity=speed, spin=spin)
    rho = q.number("density", 1.4)
    free("box", kind=spatial.Box, size=q.vector("box", (0.5, 0.8, 0.7)), density=rho)
    sizes = {"radius": q.number("drum_radius", 0.4), "length": q.number("drum_length", 0.6)}
    bore = q.number("bore", 0.1)
    free("drum", kind=spatial.Cylinder, inner_radius=bore, density=rho, **sizes)
    free("ball", kind=spatial.Sphere, radius=q.number("ball_radius", 0.5), density=rho)
    sizes = {"radius": q.number("pill_radius", 0.4), "length": q.number("pill_length", 0.6)}
    free("pill", kind=spatial.Capsule, mass=q.number("pill_m", 0.9), **sizes)
    sizes = {"radius": q.number("rod_radius", 0.2), "length": q.number("rod_length", 1.1)}
    free("rod", kind=spatial.Bar, mass=q.number("rod_m", 0.9), **sizes)
    free("dot", kind=spatial.Particle, mass=q.number("dot_m", 0.7))


@case(
    "force",
    spatial.Force,
    conservative=False,
    loads=lambda c: [("a", c.p.F * [np.cos(3 * c.t), c.b.at((0, 0, 0))[0], 1], P(c), np.zeros(3))],
)
def _(q):
    i, j = q.points()
    x, y, z = q.vector("F", (3.0, -2.0, 1.0))
    q.add(spatial.Force("F", i, (x * cos(3 * t), y * j.body.x, z)))


@case(
    "following force",
    spatial.Force,
    conservative=False,
    loads=lambda c: [("a", c.b.R @ c.p.F, P(c), np.zeros(3))],
)
def _(q):
    i, j = q.points()
    q.add(spatial.Force("F", i, q.vector("F", (3.0, -2.0, 1.0)), follows=j.body))


@case(
    "torque",
    spatial.Torque,
    conservative=False,
    loads=lambda c: [("a", np.zeros(3), c.a.r, c.p.M * np.cos(2 * c.t) - c.p.drag * c.a.w)],
)
def _(q):
    a, _ = q.pair()
    drag, whole = q.number("drag", 0.3), q.vector("M", (0.7, -0.5, 0.9))
    spin = a.angular_velocity
    components = [m * cos(2 * t) - drag * spin[k] for k, m in enumerate(whole)]
    q.add(spatial.Torque("F", a, components))


@case(
    "torque with reaction",
    spatial.Torque,
    conservative=False,
    loads=lambda c: opposite(np.zeros(3), c.b.r, c.a.R @ c.p.M),
)
def _(q):
    a, b = q.pair()
    q.add(spatial.Torque("F", b, q.vector("M", (0.7, -0.5, 0.9)), reaction_on=a, follows=a))


def _tension(c):
    along, speed = approach(c)
    pull = c.p.k * (np.linalg.norm(Q(c) - P(c)) - c.p.l0) + c.p.d * speed
    return opposite(-pull * along, Q(c))


@case("spring", spatial.Spring, loads=_tension)
def _(q):
    k, d, l0 = q.number("k", 30.0), q.number("d", 1.5), q.number("l0", 0.5)
    q.add(spatial.Spring("F", *q.points(), stiffness=k, damping=d, free_length=l0))


@case(
    "actuator",
    spatial.Actuator,
    conservative=False,
    loads=lambda c: opposite(c.p.push * np.cos(4 * c.t) * approach(c)[0], Q(c)),
)
def _(q):
    q.add(spatial.Actuator("F", *q.points(), force=q.number("push", 6.0) * cos(4 * t)))


def angle_of(c):
    """The angle of x_j about z_i, its rate, and its gradient by the angular velocity of b."""
    (x, y, _), turned = frame_i(c).T, frame_j(c)[:, 0]
    a, b = x @ turned, y @ turned
    slope = np.cross(turned, a * y - b * x) / (a**2 + b**2)
    return np.arctan2(b, a), slope @ (c.b.w - c.a.w), slope


def _torsion(law):
    def loads(c):
        angle, rate, slope = angle_of(c)
        moment = c.p.k * (angle - c.p.a0) + c.p.d * rate + law(c, angle - c.p.a0)
        return opposite(np.zeros(3), c.b.r, -moment * slope)

    return loads


@case("torsion spring", spatial.TorsionSpring, loads=_torsion(lambda c, e: 0))
def _(q):
    k, d, a0 = q.number("k", 4.0), q.number("d", 0.3), q.number("a0", -0.2)
    q.add(spatial.TorsionSpring("F", *q.frames(), stiffness=k, damping=d, free_angle=a0))


@case(
    "torsion spring with law",
    spatial.TorsionSpring,
    conservative=False,
    loads=_torsion(lambda c, e: c.p.k3 * e**3),
)
def _(q):
    k, d, a0, k3 = (q.number(n, x) for n, x in {"k": 4, "d": 0.3, "a0": -0.2, "k3": 2}.items())
    given = {"stiffness": k, "damping": d, "free_angle": a0}
    q.add(spatial.TorsionSpring("F", *q.frames(), **given, law=lambda e, rate: k3 * e**3))


def _bushing(c):
    axes = frame_i(c)
    d = axes.T @ (Q(c) - P(c))
    rate = axes.T @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(Q(c)))
    x, y, z, w = Rotation.from_matrix(axes.T @ frame_j(c)).as_quat(canonical=True)
    by_spin = w * np.eye(3) - np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    turning = by_spin @ axes.T @ (c.b.w - c.a.w)
    force = -(c.p.k * d + c.p.c * rate)
    moment = -by_spin.T @ (c.p.kr * 2 * np.array([x, y, z]) + c.p.cr * turning)
    return opposite(axes @ force, Q(c), axes @ moment)


@case("bushing", spatial.Bushing, loads=_bushing)
def _(q):
    q.add(
        spatial.Bushing(
            "F",
            *q.frames(),
            stiffness=q.vector("k", (40.0, 25.0, 30.0)),
            damping=q.vector("c", (1.0, 0.6, 0.8)),
            rotational_stiffness=q.vector("kr", (3.0, 2.0, 4.0)),
            rotational_damping=q.vector("cr", (0.2, 0.1, 0.3)),
        )
    )


def _friction(c):
    _, rate, slope = angle_of(c)
    moment = -(c.p.coulomb * np.tanh(rate / c.p.transition) + c.p.viscous * rate)
    return opposite(np.zeros(3), c.b.r, moment * slope)


@case("friction in hinge", spatial.JointFriction, loads=_friction)
def _(q):
    values = {"coulomb": 0.4, "viscous": 0.1, "transition": 0.8}
    given = {name: q.number(name, value) for name, value in values.items()}
    q.add(spatial.JointFriction("F", q.hinge(), **given))


@case(
    "motor in hinge",
    spatial.JointActuator,
    conservative=False,
    loads=lambda c: opposite(np.zeros(3), c.b.r, c.p.m0 * np.cos(2 * c.t) * angle_of(c)[2]),
)
def _(q):
    q.add(spatial.JointActuator("F", q.hinge(), q.number("m0", 2.0) * cos(2 * t)))


@case(
    "ram in slider",
    spatial.JointActuator,
    conservative=False,
    loads=lambda c: opposite(c.p.push * frame_i(c)[:, 2], Q(c)),
)
def _(q):
    joint = q.add(spatial.Cylindrical("J", *q.frames()))
    q.add(spatial.JointActuator("F", joint, q.number("push", 6.0), motion="displacement"))


def _stop(c):
    along, speed = approach(c)
    depth = np.linalg.norm(Q(c) - P(c)) - c.p.limit
    if depth <= 0:
        return []
    press = c.p.k * depth**c.p.power * max(0.0, 1 + c.p.d * speed)
    return opposite(-press * along, Q(c))


@case("stop", spatial.Stop, loads=_stop)
def _(q):
    i, j = q.points()
    gap = sum((getattr(j, s) - getattr(i, s)) ** 2 for s in "xyz") ** 0.5
    k, d, power = q.number("k", 80.0), q.number("d", 0.5), q.number("power", 1.5)
    limit = q.number("limit", 0.3)
    q.add(spatial.Stop("F", gap, upper=limit, stiffness=k, damping=d, exponent=power))


def _end(c):
    angle, rate, slope = angle_of(c)
    depth = angle - c.p.limit
    press = c.p.k * depth * max(0.0, 1 + c.p.d * rate) if depth > 0 else 0.0
    return opposite(np.zeros(3), c.b.r, -press * slope)


@case("stop in hinge", spatial.Stop, loads=_end)
def _(q):
    q.hinge()
    k, d, limit = q.number("k", 80.0), q.number("d", 0.5), q.number("limit", -0.4)
    q.add(spatial.Stop("F", q.system.formula("J.angle"), upper=limit, stiffness=k, damping=d))


def _touch(c):
    """Balls about P and Q that press and rub, with creeping Coulomb friction."""
    along, rate = approach(c)
    depth = c.p.radius_i + c.p.radius_j - np.linalg.norm(Q(c) - P(c))
    if depth <= 0:
        return []
    place = P(c) + along * (c.p.radius_i - depth / 2)
    moved = c.b.velocity_at(place) - c.a.velocity_at(place)
    slip = moved - (moved @ along) * along
    press = c.p.k * depth**c.p.power * max(0.0, 1 - c.p.d * rate)
    x = np.sqrt(slip @ slip / c.p.transition**2 + 1e-12)
    rub = press * c.p.dynamic * np.tanh(4 * x) * slip / c.p.transition / x
    return opposite(press * along - rub, place)


@case("contact", spatial.Contact, loads=_touch)
def _(q):
    (i, j), kit = q.points(), spatial.contact
    k, d, power = q.number("k", 80.0), q.number("d", 0.3), q.number("power", 1.5)
    law = kit.HuntCrossley(stiffness=k, damping=d, exponent=power)
    friction = kit.Coulomb(q.number("dynamic", 0.3), slip_speed=q.number("transition", 0.9))
    balls = (kit.Sphere(i, q.number("radius_i", 0.5)), kit.Sphere(j, q.number("radius_j", 0.4)))
    q.add(spatial.Contact("F", *balls, law=law, friction=friction))


def _play(c):
    """A ball about Q in a socket about P."""
    along, rate = approach(c)
    depth = np.linalg.norm(Q(c) - P(c)) - c.p.clearance
    press = max(0.0, c.p.k * depth + c.p.d * rate) if depth > 0 else 0.0
    return opposite(-press * along, Q(c))


@case("clearance", spatial.ClearanceSpherical, loads=_play)
def _(q):
    law = spatial.contact.KelvinVoigt(stiffness=q.number("k", 20.0), damping=q.number("d", 0.8))
    sizes = {"radius": q.number("radius", 0.5), "clearance": q.number("clearance", 0.1)}
    q.add(spatial.ClearanceSpherical("F", *q.points(), law=law, **sizes))


def _hoist(c):
    """A cable from P over a point of the ground to Q."""
    away = [P(c) - c.p.V, Q(c) - c.p.V]
    sizes = [np.linalg.norm(part) for part in away]
    parts = [part / size for part, size in zip(away, sizes, strict=True)]
    rate = parts[0] @ c.a.velocity_at(P(c)) + parts[1] @ c.b.velocity_at(Q(c))
    stretch = sum(sizes) - c.p.rope
    pull = max(0.0, c.p.k * stretch + c.p.d * rate) if stretch > 0 else 0.0
    nothing = np.zeros(3)
    return [("a", -pull * parts[0], P(c), nothing), ("b", -pull * parts[1], Q(c), nothing)]


@case("cable", spatial.Cable, loads=_hoist)
def _(q):
    (i, j), via = q.points(), q.system.ground.point(*q.vector("V", (0.4, 0.9, 0.2)))
    rope, k, d = q.number("rope", 0.6), q.number("k", 80.0), q.number("d", 0.3)
    q.add(spatial.Cable("F", (i, via, j), length=rope, stiffness=k, damping=d))
