"""Random planar mechanisms, each with a twin of its mechanics in plain NumPy.

Poses come first, then joints that fit them, so that every mechanism can be assembled. Every
element added notes its twin: joints and drivers their residual, springs and stops their energy,
dampers the coordinate they work along, loads their power conjugate. A twin takes the frames of
the bodies and the time and may be complex, so all derivatives are taken by the complex step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from twins import Frame, complex_step, cross, left, length, turn

import dalembert as da
from dalembert import planar

GROUND = Frame(np.zeros(3))


@dataclass
class Mechanism:
    """A system under construction and its twin.

    Attributes
    ----------
    poses : name → (x, y, φ) of every body
    names : bodies in the order of their coordinates; the twin of all that is noted below takes a
        dictionary of their frames and the time
    residuals : per equation set, in the order of the model
    energies : potential energies
    losses : (coordinate, damping) of linear dampers
    works : (coordinate, force) of applied forces, force of (frames, t)
    """

    rng: np.random.Generator
    system: da.System
    gravity: np.ndarray
    poses: dict[str, np.ndarray] = field(default_factory=dict)
    bodies: dict[str, planar.Body] = field(default_factory=dict)
    masses: list[float] = field(default_factory=list)
    residuals: list[Callable] = field(default_factory=list)
    energies: list[Callable] = field(default_factory=list)
    losses: list[tuple[Callable, float]] = field(default_factory=list)
    works: list[tuple[Callable, Callable]] = field(default_factory=list)
    kinds: list[str] = field(default_factory=list)
    steady: bool = True

    def __post_init__(self) -> None:
        self.poses["ground"] = np.zeros(3)
        self.bodies["ground"] = self.system.ground
        self.count = 0

    # bodies ----------------------------------------------------------------------------
    def body(self, pose=None, massless: bool = False, fast: float = 1.0) -> str:
        rng, name = self.rng, f"b{len(self.bodies) - 1}"
        pose = np.append(rng.uniform(-1, 1, 2), rng.uniform(-3, 3)) if pose is None else pose
        mass, inertia = (0.0, 0.0) if massless else (rng.uniform(0.5, 2), rng.uniform(0.05, 0.5))
        speeds = {} if massless else {"angular_velocity": fast * rng.uniform(-1, 1)}
        if not massless:
            speeds["velocity"] = tuple(fast * rng.uniform(-1, 1, 2))
        made = planar.Body(
            name, mass=mass, inertia=inertia, position=tuple(pose[:2]), angle=pose[2], **speeds
        )
        self._grow(name, made, np.asarray(pose), [mass, mass, inertia])
        return name

    def particle(self) -> str:
        rng, name = self.rng, f"b{len(self.bodies) - 1}"
        pose, mass = rng.uniform(-1, 1, 2), rng.uniform(0.5, 2)
        made = planar.Particle(
            name, mass=mass, position=tuple(pose), velocity=tuple(rng.uniform(-1, 1, 2))
        )
        self._grow(name, made, np.append(pose, 0.0), [mass, mass])
        return name

    def _grow(self, name: str, made: planar.Body, pose: np.ndarray, masses: list[float]) -> None:
        self.bodies[name] = self.system.add(made)
        self.poses[name] = pose
        self.masses += masses

    # places ----------------------------------------------------------------------------
    def local(self, name: str, place) -> np.ndarray:
        pose = self.poses[name]
        return turn(-pose[2], np.asarray(place) - pose[:2])

    def point(self, name: str, place) -> tuple[planar.Point, Callable]:
        """Point of a body at a place, and its twin."""
        body, local = self.bodies[name], self.local(name, place)
        if isinstance(body, planar.Particle):
            return body.center, lambda f: f[name].r
        return body.point(*local), lambda f: f[name].at(local)

    def place(self) -> np.ndarray:
        return self.rng.uniform(-1, 1, 2)

    def at(self, name: str) -> np.ndarray:
        """Some place of a body; the only one of a particle."""
        particle = isinstance(self.bodies[name], planar.Particle)
        return self.poses[name][:2] if particle else self.place()

    def turns(self, name: str) -> bool:
        return not isinstance(self.bodies[name], planar.Particle)

    def name(self, kind: str) -> str:
        self.count += 1
        self.kinds.append(kind)
        return f"{kind}{self.count}"

    # joints ----------------------------------------------------------------------------
    def join(self, kind: type, i: str, j: str, residual: Callable, a, b, **more) -> None:
        """A joint of two points at places ``a`` and ``b``."""
        (p, at_p), (q, at_q) = self.point(i, a), self.point(j, b)
        self.system.add(kind(self.name(kind.__name__), p, q, **more))
        self.residuals.append(lambda f, t: residual(f, at_p(f), at_q(f)))

    def revolute(self, i: str, j: str, place) -> None:
        self.join(planar.Revolute, i, j, lambda f, p, q: q - p, place, place)

    def weld(self, i: str, j: str, place) -> None:
        angle = self.poses[j][2] - self.poses[i][2]
        self.join(
            planar.Weld,
            i,
            j,
            lambda f, p, q: np.append(q - p, f[j].phi - f[i].phi - angle),
            place,
            place,
            angle=angle,
        )

    def slider(self, i: str, j: str, a, b) -> None:
        """Point at b of body j on the line from a to b of body i, without turning."""
        axis, angle = self._axis(i, a, b), self.poses[j][2] - self.poses[i][2]

        def residual(f, p, q):
            offset = left(f[i].vector(axis)) @ (q - p)
            return np.array([offset, f[j].phi - f[i].phi - angle])

        self.join(planar.Translational, i, j, residual, a, b, axis=tuple(axis), angle=angle)

    def slot(self, i: str, j: str, a, b) -> None:
        axis = self._axis(i, a, b)
        self.join(
            planar.PinInSlot,
            i,
            j,
            lambda f, p, q: np.array([left(f[i].vector(axis)) @ (q - p)]),
            a,
            b,
            axis=tuple(axis),
        )

    def _axis(self, i: str, a, b) -> np.ndarray:
        along = turn(-self.poses[i][2], np.subtract(b, a))
        return along / np.linalg.norm(along)

    def link(self, i: str, j: str, a, b) -> None:
        reach = float(np.linalg.norm(np.subtract(b, a)))
        self.join(
            planar.RigidLink,
            i,
            j,
            lambda f, p, q: np.array([length(q - p) - reach]),
            a,
            b,
            length=reach,
        )

    def coupling(self, i: str, j: str, ratio: float) -> None:
        constant = self.poses[j][2] - ratio * self.poses[i][2]
        self.system.add(
            planar.Coupling(self.name("Coupling"), self.bodies[i], self.bodies[j], ratio=ratio)
        )
        self.residuals.append(lambda f, t: np.array([f[j].phi - ratio * f[i].phi - constant]))

    def rolling(self, j: str, radius: float, side: int) -> None:
        """Body j with its centre at the radius above a line of the ground through its place."""
        pose = self.poses[j]
        self.join(
            planar.RollingDisc,
            "ground",
            j,
            lambda f, p, q: np.array(
                [(q - p)[1] - side * radius, (q - p)[0] + side * radius * (f[j].phi - pose[2])]
            ),
            pose[:2] - (0, side * radius),
            pose[:2],
            radius=radius,
            side=side,
        )

    def any_joint(self, i: str, j: str) -> int:
        """A random joint between two bodies that turn; how many equations it has."""
        a, b = self.place(), self.place()
        pick = self.rng.integers(6)
        if not (self.turns(i) and self.turns(j)):
            if pick < 3 and self.turns(i):
                self.revolute(i, j, self.at(j))
                return 2
            self.link(i, j, self.at(i), self.at(j))
            return 1
        if pick <= 1:
            self.revolute(i, j, a)
            return 2
        if pick == 2:
            self.slider(i, j, a, b)
            return 2
        if pick == 3:
            self.slot(i, j, a, b)
            return 1
        if pick == 4:
            self.link(i, j, a, b)
            return 1
        self.weld(i, j, a)
        return 3

    # drivers ---------------------------------------------------------------------------
    def driver(self, i: str, j: str) -> None:
        """A coordinate of body j relative to i, prescribed from where it is."""
        rate, bend = self.rng.uniform(-1, 1, 2)
        self.steady = False

        def moved(start, t):
            return start + rate * t + bend * t**2

        law, pick = (lambda start: moved(start, da.t)), self.rng.integers(3)
        if pick == 0 and self.turns(i) and self.turns(j):
            start = self.poses[j][2] - self.poses[i][2]
            made = planar.RotationalDriver(
                self.name("RotationalDriver"), self.bodies[i], self.bodies[j], law(start)
            )
            twin = lambda f, t: np.array([f[j].phi - f[i].phi - moved(start, t)])  # noqa: E731
        elif pick == 1:
            b = self.at(j)
            (p, at_p), (q, at_q) = self.point(i, a := self.at(i)), self.point(j, b)
            reach = np.linalg.norm(b - a)
            made = planar.DistanceDriver(self.name("DistanceDriver"), p, q, law(reach))
            twin = lambda f, t: np.array([length(at_q(f) - at_p(f)) - moved(reach, t)])  # noqa: E731
        else:
            q, at_q = self.point(j, b := self.at(j))
            along = direction_of(self.rng)
            made = planar.CoordinateDriver(
                self.name("CoordinateDriver"), q, law(along @ b), direction=tuple(along)
            )
            twin = lambda f, t: np.array([along @ at_q(f) - moved(along @ b, t)])  # noqa: E731
        self.system.add(made)
        self.residuals.append(twin)

    # forces ----------------------------------------------------------------------------
    def spring(self, i: str, j: str) -> None:
        rng = self.rng
        a, b = self.at(i), self.at(j)
        (p, at_p), (q, at_q) = self.point(i, a), self.point(j, b)
        k, c, free = rng.uniform(1, 20), rng.choice([0.0, rng.uniform(0.1, 1)]), rng.uniform(0, 1)
        self.system.add(
            planar.Spring(
                self.name("Spring"), p, q, stiffness=k, damping=float(c), free_length=free
            )
        )
        self.energies.append(lambda f: k / 2 * (length(at_q(f) - at_p(f)) - free) ** 2)
        self.losses.append((lambda f: length(at_q(f) - at_p(f)), float(c)))

    def rotational_spring(self, i: str, j: str) -> None:
        k, c, free = self.rng.uniform(0.5, 5, 3)
        self.system.add(
            planar.RotationalSpring(
                self.name("RotationalSpring"),
                self.bodies[i],
                self.bodies[j],
                stiffness=k,
                damping=c,
                free_angle=free,
            )
        )
        self.energies.append(lambda f: k / 2 * (f[j].phi - f[i].phi - free) ** 2)
        self.losses.append((lambda f: f[j].phi - f[i].phi, c))

    def force(self, j: str) -> None:
        q, at_q = self.point(j, self.at(j))
        vector = self.rng.uniform(-5, 5, 2)
        self.system.add(planar.Force(self.name("Force"), q, tuple(vector)))
        for k in (0, 1):
            self.works.append((lambda f, k=k: at_q(f)[k], lambda f, t, k=k: vector[k]))

    def moment(self, j: str) -> None:
        size = self.rng.uniform(-2, 2)
        self.system.add(planar.Moment(self.name("Moment"), self.bodies[j], size * da.cos(3 * da.t)))
        self.works.append((lambda f: f[j].phi, lambda f, t: size * np.cos(3 * t)))

    def stop(self, j: str) -> None:
        """A soft floor close below a body."""
        level, k = self.poses[j][1] - self.rng.uniform(-0.02, 0.05), self.rng.uniform(20, 200)
        body = self.bodies[j]
        self.system.add(planar.Stop(self.name("Stop"), body.y, lower=level, stiffness=k))

        def stored(f):
            depth = level - f[j].r[1]
            return k / 2 * depth**2 if np.real(depth) > 0 else 0.0

        self.energies.append(stored)

    # twin ------------------------------------------------------------------------------
    def frames(self, y: np.ndarray, v: np.ndarray | None = None) -> dict[str, Frame]:
        found, k = {"ground": GROUND}, 0
        for name in self.bodies:
            if name == "ground":
                continue
            n = 3 if self.turns(name) else 2
            found[name] = Frame(y[k : k + n], None if v is None else v[k : k + n])
            k += n
        return found

    def constraints(self, y: np.ndarray, t) -> np.ndarray:
        f = self.frames(y)
        return np.concatenate([np.atleast_1d(r(f, t)) for r in self.residuals] or [np.zeros(0)])

    def potential(self, y: np.ndarray):
        f, k, weight = self.frames(y), 0, 0.0
        for name in self.bodies:
            if name != "ground":
                weight = weight - self.masses[k] * (self.gravity @ f[name].r)
                k += 3 if self.turns(name) else 2
        return weight + sum(energy(f) for energy in self.energies)

    def kinetic(self, v: np.ndarray) -> float:
        return float(np.array(self.masses) @ v**2 / 2)

    def forces(self, y: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """All but constraint forces: −∂V/∂y, dampers, applied loads."""
        total = -complex_step(lambda x: np.atleast_1d(self.potential(x)), y)[0]
        for along, c in self.losses:
            if c:
                slope = complex_step(lambda x, along=along: along(self.frames(x)), y)[0]
                total -= c * slope * (slope @ v)
        for along, load in self.works:
            slope = complex_step(lambda x, along=along: along(self.frames(x)), y)[0]
            total += load(self.frames(y), t) * slope
        return total


def direction_of(rng: np.random.Generator) -> np.ndarray:
    angle = rng.uniform(-np.pi, np.pi)
    return np.array([np.cos(angle), np.sin(angle)])


# kinds of mechanisms -------------------------------------------------------------------------


def empty(rng: np.random.Generator) -> Mechanism:
    weight = rng.choice([0.0, 9.81]) * direction_of(rng)
    gravity = tuple(weight) if weight.any() else None
    return Mechanism(rng, da.System("random", gravity=gravity), weight)


def chain(m: Mechanism, count: int) -> int:
    """Bodies joined to earlier ones or the ground at random; the freedoms left."""
    freedom = 0
    for k in range(count):
        particle = m.rng.random() < 0.1
        name = m.particle() if particle else m.body()
        freedom += 2 if particle else 3
        earlier = ["ground", *[n for n in m.bodies if n not in ("ground", name)]]
        if k or m.rng.random() < 0.8:
            freedom -= m.any_joint(str(m.rng.choice(earlier)), name)
    return freedom


def opened(m: Mechanism) -> None:
    chain(m, int(m.rng.integers(1, 4)))


def closed(m: Mechanism) -> None:
    """Further joints as long as something stays free, or nothing."""
    freedom = chain(m, int(m.rng.integers(2, 4)))
    names = list(m.bodies)
    least = int(m.rng.choice([0, 1, 1, 1]))
    for _ in range(4):
        i, j = m.rng.choice(names, 2, replace=False)
        if m.bodies[i] is m.system.ground or m.turns(i):
            if freedom >= 2 + least and m.turns(j) and m.rng.random() < 0.7:
                m.revolute(i, j, m.place()) if m.rng.random() < 0.6 else m.slider(
                    i, j, m.place(), m.place()
                )
                freedom -= 2
            elif freedom >= 1 + least:
                m.link(i, j, m.at(i), m.at(j))
                freedom -= 1


def trammel(m: Mechanism) -> None:
    """A bar with two pins in crossing slots, and links from its circle's centre: redundant."""
    rng = m.rng
    tilt, half, phi = rng.uniform(-3, 3), rng.uniform(0.3, 0.7), rng.uniform(-3, 3)
    centre, u = m.place() / 2, np.array([np.cos(tilt), np.sin(tilt)])
    w = left(u)
    bar = m.body(np.append(centre + half * turn(tilt, direction_at(phi)), rng.uniform(-3, 3)))
    ends = centre + 2 * half * np.cos(phi) * u, centre + 2 * half * np.sin(phi) * w
    middle = (ends[0] + ends[1]) / 2

    def guide(axis, end):
        pick = rng.integers(3)
        if pick == 0:
            m.slot("ground", bar, centre - axis, end) if abs(
                cross(end - centre + axis, axis)
            ) < 1e-9 else None
        else:
            shoe = m.body(np.append(end, 0.3))
            m.slider("ground", shoe, centre - axis, end)
            m.revolute(shoe, bar, end)

    parts = [lambda: guide(u, ends[0]), lambda: guide(w, ends[1]), lambda: crank()]

    def crank():
        if rng.random() < 0.5:
            m.link("ground", bar, centre, middle)
        else:
            arm = m.body(np.append((centre + middle) / 2, 0.1))
            m.revolute("ground", arm, centre)
            m.revolute(arm, bar, middle)

    for k in rng.permutation(3):
        parts[k]()


def direction_at(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


def parallelogram(m: Mechanism) -> None:
    """A platform on three or four parallel cranks or links of one length."""
    rng = m.rng
    arm = rng.uniform(0.3, 0.8) * direction_of(rng)
    platform = m.body()
    for _ in range(int(rng.integers(3, 5))):
        foot = m.place()
        if rng.random() < 0.5:
            m.link("ground", platform, foot, foot + arm)
        else:
            crank = m.body(np.append(foot + arm / 2, rng.uniform(-3, 3)))
            m.revolute("ground", crank, foot)
            m.revolute(crank, platform, foot + arm)


def doubled(m: Mechanism) -> None:
    """A chain, some of whose joints are held twice."""
    rng, carrier = m.rng, "ground"
    for _ in range(int(rng.integers(1, 4))):
        body, a = m.body(), m.place()
        b, pick = m.place(), rng.integers(5)
        far = a + rng.uniform(0.3, 1) * direction_of(rng)
        if pick == 0:  # a pin, and a link or a slot that says the same
            m.revolute(carrier, body, a)
            if rng.random() < 0.5:
                m.link(carrier, body, far, a)
            else:
                m.slot(body, carrier, far, a)
        elif pick == 1:
            m.revolute(carrier, body, a)
            m.revolute(carrier, body, a)
        elif pick == 2:
            m.slider(carrier, body, a, b)
            m.slot(carrier, body, far, far + (b - a))
        elif pick == 3:
            m.weld(carrier, body, a)
            m.link(carrier, body, b, far)
        else:
            m.slider(carrier, body, a, b)
            m.slider(carrier, body, far, far + 2 * (b - a))
        carrier = body


def held(m: Mechanism) -> None:
    """Massless members between others: welded on, or a coupler with two pins."""
    rng = m.rng
    first = m.body()
    m.revolute("ground", first, m.place())
    if rng.random() < 0.5:
        tool = m.body(massless=True)
        m.weld(first, tool, m.place())
        return
    second, coupler = m.body(), m.body(massless=True)
    m.revolute("ground", second, m.place())
    m.revolute(first, coupler, m.place())
    m.revolute(coupler, second, m.place())


def geared(m: Mechanism) -> None:
    rng = m.rng
    one = m.body()
    m.rolling(one, rng.uniform(0.2, 0.5), int(rng.choice([-1, 1])))
    other = m.body()
    m.any_joint(one, other)
    if rng.random() < 0.5:
        third = m.body()
        m.revolute("ground", third, m.place())
        m.coupling(one, third, float(rng.choice([-2.0, 0.5])))


KINDS = {
    make.__name__: make for make in (opened, closed, trammel, parallelogram, doubled, held, geared)
}


def random_mechanism(seed: int) -> tuple[str, Mechanism]:
    """A mechanism of a random kind, with drivers and loads; the same for the same seed."""
    rng = np.random.default_rng(seed)
    kind = str(rng.choice(list(KINDS)))
    m = empty(rng)
    KINDS[kind](m)
    names = list(m.bodies)
    for _ in range(int(rng.integers(0, 3))):
        i, j = rng.choice(names, 2, replace=False)
        j = j if j != "ground" else names[-1]
        i = i if i != j else "ground"
        pick = rng.integers(5)
        if pick == 0:
            m.force(j)
        elif pick == 1 and m.turns(j):
            m.moment(j)
        elif pick == 2 and m.turns(i) and m.turns(j):
            m.rotational_spring(i, j)
        elif pick == 3:
            m.stop(j)
        else:
            m.spring(i, j)
    if rng.random() < 0.2:
        i, j = rng.choice(names, 2, replace=False)
        m.driver(i, j if j != "ground" else names[-1]) if i != names[-1] else None
    return kind, m
