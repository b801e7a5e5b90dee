"""A planar mechanism under construction, and its mechanics in plain NumPy.

Every element added notes its twin: joints and drivers their residual, springs and stops their
energy, everything else the coordinate it works along and its force. A twin takes the frames of the
bodies and the time and may be complex, so all derivatives are taken by the complex step.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from twins import Frame, complex_step, rate, second_rate, turn

import dalembert as da
from dalembert import planar

GROUND = Frame(np.zeros(3))


def direction_of(rng: np.random.Generator) -> np.ndarray:
    return direction_at(rng.uniform(-np.pi, np.pi))


def direction_at(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


@dataclass
class MechanismTwin:
    """A system, the poses of its bodies, and what its elements are by hand.

    Attributes
    ----------
    poses : name → (x, y, φ) of every body
    bodies : in the order of their coordinates; the twin of all that is noted below takes a
        dictionary of their frames and the time
    own : (name, how many) of coordinates that elements bring along, behind those of the bodies:
        parameters of curves, poses of nodes of beams
    masses : per coordinate of the bodies
    spread : (places and angles, their mass matrix) of masses between bodies
    gaps : what must not be negative
    residuals : per equation set, in the order of the model
    energies : potential energies
    loads : (coordinate, force along it), the force of (frames, rate of the coordinate, t)
    """

    rng: np.random.Generator
    system: da.System
    gravity: np.ndarray
    poses: dict[str, np.ndarray] = field(default_factory=dict)
    bodies: dict[str, planar.Body] = field(default_factory=dict)
    own: list[tuple[str, int]] = field(default_factory=list)
    masses: list[float] = field(default_factory=list)
    spread: list[tuple[Callable, np.ndarray]] = field(default_factory=list)
    gaps: list[Callable] = field(default_factory=list)
    residuals: list[Callable] = field(default_factory=list)
    energies: list[Callable] = field(default_factory=list)
    loads: list[tuple[Callable, Callable]] = field(default_factory=list)
    kinds: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.poses["ground"] = np.zeros(3)
        self.bodies["ground"] = self.system.ground

    # bodies ----------------------------------------------------------------------------
    def body(self, pose=None, massless: bool = False) -> str:
        rng, name = self.rng, f"b{len(self.bodies) - 1}"
        pose = np.append(rng.uniform(-1, 1, 2), rng.uniform(-3, 3)) if pose is None else pose
        mass, inertia = (0.0, 0.0) if massless else (rng.uniform(0.5, 2), rng.uniform(0.05, 0.5))
        speeds = {} if massless else {"angular_velocity": rng.uniform(-1, 1)}
        if not massless:
            speeds["velocity"] = tuple(rng.uniform(-1, 1, 2))
        body = planar.Body(
            name, mass=mass, inertia=inertia, position=tuple(pose[:2]), angle=pose[2], **speeds
        )
        self._grow(name, body, np.asarray(pose), [mass, mass, inertia])
        return name

    def particle(self) -> str:
        rng, name = self.rng, f"b{len(self.bodies) - 1}"
        pose, mass = rng.uniform(-1, 1, 2), rng.uniform(0.5, 2)
        particle = planar.Particle(
            name, mass=mass, position=tuple(pose), velocity=tuple(rng.uniform(-1, 1, 2))
        )
        self._grow(name, particle, np.append(pose, 0.0), [mass, mass])
        return name

    def _grow(self, name: str, body: planar.Body, pose: np.ndarray, masses: list[float]) -> None:
        self.bodies[name] = self.system.add(body)
        self.poses[name] = pose
        self.masses += masses

    def turns(self, name: str) -> bool:
        return not isinstance(self.bodies[name], planar.Particle)

    # places ----------------------------------------------------------------------------
    def local(self, name: str, place) -> np.ndarray:
        pose = self.poses[name]
        return turn(-pose[2], np.asarray(place) - pose[:2])

    def point(self, name: str, place) -> tuple[planar.Point, Callable]:
        """Point of a body at a place, and its twin."""
        body, local = self.bodies[name], self.local(name, place)
        if not self.turns(name):
            return body.center, lambda f: f[name].r
        return body.point(*local), lambda f: f[name].at(local)

    def place(self) -> np.ndarray:
        return self.rng.uniform(-1, 1, 2)

    def at(self, name: str) -> np.ndarray:
        """Some place of a body; the only one of a particle."""
        return self.place() if self.turns(name) else self.poses[name][:2]

    def axis(self, i: str, a, b) -> np.ndarray:
        """The direction from a to b, in the frame of a body."""
        along = turn(-self.poses[i][2], np.subtract(b, a))
        return along / np.linalg.norm(along)

    def turned(self, i: str, j: str) -> float:
        """Angle of body j relative to i."""
        return self.poses[j][2] - self.poses[i][2]

    def add(self, kind: type, *arguments, **more):
        """An element of a kind, with a name of its own."""
        self.kinds.append(kind.__name__)
        return self.system.add(kind(f"{kind.__name__}{len(self.kinds)}", *arguments, **more))

    # twin ------------------------------------------------------------------------------
    def frames(self, y: np.ndarray) -> dict[str, Frame]:
        """Of all bodies and nodes; and the parameters of curves."""
        results, k = {"ground": GROUND}, 0
        for name in self.bodies:
            if name != "ground":
                n = 3 if self.turns(name) else 2
                results[name] = Frame(y[k : k + n])
                k += n
        for name, n in sorted(self.own, key=lambda one: -one[1]):  # nodes before curves
            results[name] = Frame(y[k : k + n]) if n > 1 else y[k]
            k += n
        assert k == y.size
        return results

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

    @property
    def inertia(self) -> np.ndarray:
        """Of bodies, per coordinate."""
        return np.array(self.masses + [0.0] * sum(n for _, n in self.own))

    def kinetic(self, y: np.ndarray, v: np.ndarray) -> float:
        total = self.inertia @ v**2 / 2
        for moved, mass in self.spread:
            speed = rate(lambda s, moved=moved: moved(self.frames(y + s * v)))
            total += speed @ mass @ speed / 2
        return float(total)

    def taken(self, y: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Forces that accelerate: ``m a``, and ``Jᵀ M (J a + J̇ v)`` of what lies between bodies."""
        total, way = self.inertia * a, 2e-3 / (1 + np.abs(v).max(initial=0.0))
        for moved, mass in self.spread:
            slope = complex_step(lambda x, moved=moved: moved(self.frames(x)), y)
            drift = second_rate(lambda s, moved=moved: moved(self.frames(y + s * v)), way)
            total = total + slope.T @ mass @ (slope @ a + drift)
        return total

    def forces(self, y: np.ndarray, v: np.ndarray, t: float) -> np.ndarray:
        """All but constraint forces: −∂V/∂y, and loads along their coordinates."""
        total = -complex_step(lambda x: np.atleast_1d(self.potential(x)), y)[0]
        for along, load in self.loads:
            slope = complex_step(lambda x, along=along: along(self.frames(x)), y)[0]
            total += load(self.frames(y), slope @ v, t) * slope
        return total
