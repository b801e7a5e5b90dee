"""Random trees of bodies in space that hang together by joints of every kind, from either end."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

import dalembert as da
from dalembert import spatial


def rotated(z: float) -> np.ndarray:
    return Rotation.from_euler("z", z).as_matrix()


def revolute(rng):
    return rotated(rng.uniform(-2, 2)), np.zeros(3)


def spherical(rng):
    return Rotation.random(random_state=rng).as_matrix(), np.zeros(3)


def prismatic(rng):
    return np.eye(3), np.array([0, 0, rng.uniform(-0.5, 0.5)])


def cylindrical(rng):
    return revolute(rng)[0], prismatic(rng)[1]


def screw(rng):
    turn = rng.uniform(-2, 2)
    return rotated(turn), np.array([0, 0, PITCH * (turn / (2 * np.pi) + 3)])


def universal(rng):
    exchange = np.fliplr(np.diag([1.0, -1.0, 1.0]))
    return rotated(rng.uniform(-2, 2)) @ exchange @ rotated(rng.uniform(-2, 2)), np.zeros(3)


def plane(rng):
    return revolute(rng)[0], np.array([*rng.uniform(-0.5, 0.5, 2), 0])


def weld(rng):
    return np.eye(3), np.zeros(3)


PITCH = 0.4
HALF_TURNS = [np.diag(signs) for signs in ((1, 1, 1), (1, -1, -1), (-1, -1, 1))]
BRANCHES = dict.fromkeys(("Revolute", "Screw", "Cylindrical", "Planar"), 2)
BRANCHES |= dict.fromkeys(("Prismatic", "Weld"), 3)
"""Of each kind, after how many of these half turns of the second frame the equations hold."""
KINDS = {
    "Revolute": revolute,
    "Spherical": spherical,
    "Prismatic": prismatic,
    "Cylindrical": cylindrical,
    "Screw": screw,
    "Universal": universal,
    "Planar": plane,
    "Weld": weld,
}
"""Of each kind of joint, how its second frame may stand in the first."""


class SpatialTree:
    """A system that grows body by body; every joint is closed where the bodies are put.

    Parameters
    ----------
    seed : of the random numbers
    parameters : names of masses ``m1``, places on bodies ``J0_1_x`` and stiffnesses ``k0``
    gravity : None where nothing acts from outside

    Attributes
    ----------
    places : body, position and axes of the ground and of all bodies
    solids : mass, mass centre and inertia of each body, for twins
    joined : kind, bodies, places and axes in them of each joint
    sprung : bodies, places in them, stiffness, damping and free length of each spring
    """

    def __init__(
        self,
        seed: int,
        parameters: tuple[str, ...] = (),
        gravity: tuple[float, ...] | None = (1.3, -2.1, -9.81),
    ):
        self.rng = np.random.default_rng(seed)
        self.parameters = parameters
        self.system = da.System("tree", gravity=gravity)
        self.gravity = np.zeros(3) if gravity is None else np.array(gravity)
        self.places = [(self.system.ground, np.zeros(3), np.eye(3))]
        self.solids: list[tuple] = []
        self.joined: list[tuple] = []
        self.sprung: list[tuple] = []

    def number(self, name: str, value: float):
        exists = name in self.parameters
        return self.system.parameter(name, float(value)) if exists else float(value)

    def body(self) -> int:
        """A body somewhere near, moving; its index."""
        rng, k = self.rng, len(self.places)
        axes = Rotation.random(random_state=rng).as_matrix()
        place = rng.uniform(-1, 1, 3)
        points = rng.uniform(-0.3, 0.3, (4, 3))
        spread = points.T @ points
        mass, centre = rng.uniform(0.5, 2.0), rng.uniform(-0.2, 0.2, 3)
        inertia = np.trace(spread) * np.eye(3) - spread
        self.solids.append((mass, centre, inertia))
        body = spatial.Body(
            f"b{k}",
            mass=self.number(f"m{k}", mass),
            inertia=inertia.tolist(),
            center_of_mass=tuple(centre),
            position=tuple(place),
            rotation=axes,
            velocity=tuple(rng.uniform(-1, 1, 3)),
            angular_velocity=tuple(rng.uniform(-2, 2, 3)),
        )
        self.places.append((self.system.add(body), place, axes))
        return k

    def joint(self, kind: str, i: int, j: int, name: str = "") -> None:
        """A joint that is closed as the bodies stand."""
        rng = self.rng
        turn, offset = KINDS[kind](rng)
        turn = turn @ HALF_TURNS[rng.integers(BRANCHES.get(kind, 1))]
        (first, at_i, axes_i), (second, at_j, axes_j) = self.places[i], self.places[j]
        world = Rotation.random(random_state=rng).as_matrix()
        place = (at_i + at_j) / 2 + rng.uniform(-0.2, 0.2, 3)
        local_i = axes_i.T @ (place - at_i)
        local_j = axes_j.T @ (place + world @ offset - at_j)
        name = name or f"J{i}_{j}"
        first_axes, second_axes = axes_i.T @ world, axes_j.T @ world @ turn
        self.joined.append((kind, i, j, local_i, first_axes, local_j, second_axes))
        numbers = {"pitch": PITCH} if kind == "Screw" else {}
        local_i = [self.number(f"{name}_{x}", v) for x, v in zip("xyz", local_i, strict=True)]
        if kind == "Spherical":
            ends = first.point(*local_i), second.point(*local_j)
        else:
            ends = (
                first.frame(local_i, axes=first_axes),
                second.frame(local_j, axes=second_axes),
            )
        self.system.add(getattr(spatial, kind)(name, *ends, **numbers))

    def grow(self, count: int, kinds: list[str], floating: bool = False) -> SpatialTree:
        """Bodies that hang on random ones before them, by random joints from random ends."""
        for k in range(count):
            child = self.body()
            if k == 0 and floating:
                continue
            parent = int(self.rng.integers(int(floating), child))
            ends = (parent, child) if self.rng.random() < 0.5 else (child, parent)
            self.joint(str(self.rng.choice(kinds)), *ends)
        return self

    def springs(self, count: int = 2) -> SpatialTree:
        for k in range(count):
            i, j = self.rng.choice(len(self.places), 2, replace=False)
            locals_ = [self.rng.uniform(-0.5, 0.5, 3) for _ in range(2)]
            ends = [self.places[n][0].point(*at) for n, at in zip((i, j), locals_, strict=True)]
            self.sprung.append((i, j, *locals_, 40.0 + 10 * k, 0.7, 0.4))
            stiffness = self.number(f"k{k}", 40.0 + 10 * k)
            numbers = {"stiffness": stiffness, "damping": 0.7, "free_length": 0.4}
            self.system.add(spatial.Spring(f"s{k}", *ends, **numbers))
        return self


def hanging_in_space(kind: str, ends: tuple[int, int]) -> da.Model:
    """Two bodies; the first hangs on the ground, the other on it, from one end or the other."""
    tree = SpatialTree(5)
    first, second = tree.body(), tree.body()
    for pair in ((0, first), (first, second)):
        tree.joint(kind, *(pair[k] for k in ends))
    return tree.system.build()
