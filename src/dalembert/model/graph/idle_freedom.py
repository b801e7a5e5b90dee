"""Idle degrees of freedom: bodies that rotate about a line without moving anything else.

A rod between two ball joints rotates freely about the line through them, and so does a telescopic
leg of several bodies. In an open chain such a rotation is an ordinary degree of freedom; in a loop
it is idle, as it does not affect the motion of the loop. The test is instantaneous: everything else
is at rest, the bodies rotate about the line, and no joint or driver equation changes, ``C δ = 0``.

A motion without mass, ``C δ = M δ = 0``, makes dynamics singular.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property
from itertools import combinations

import casadi as ca
import numpy as np
import scipy

from dalembert.elements.base import Constraint
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.spatial.spherical import Spherical
from dalembert.model.graph.absolute import at_ground
from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.independence import columns_of, least_fill
from dalembert.model.graph.description import Description
from dalembert.model.graph.natural_units import body_sizes
from dalembert.symbolic.formulas.expression import free_symbols

UNCHANGED = 1e-9
"""Threshold for the change of an equation, relative to its terms."""
MAX_OPERATIONS = 100_000
"""Upper limit of operations of the search, above which only single bodies are tested."""
LISTED = 6
"""Upper limit of idle rotations that are named; the rest is counted."""
MASSLESS = 1e-12
"""Threshold for zero mass, relative to the largest one of the same body."""
MOVING = 1e-6
"""Threshold for a body that takes part in a motion, relative to the largest component."""


def massless_bodies(
    d: Description, closure: Closure, mass: scipy.sparse.csc_array
) -> tuple[str, ...]:
    """Bodies that take part in a free motion without kinetic energy, ``C δ = M δ = 0``.

    Masses of different bodies are not compared, as a small ball may move beside a heavy machine.
    An inertia is compared with the mass of its body times the square of the body's reach: the
    characteristic length of the mechanism if the body has a joint, or the size of its shapes.
    """
    if not mass.shape[0]:  # blocks alone
        return ()
    scale = scipy.sparse.diags_array(closure.scales.displacements)
    scaled_mass = scipy.sparse.csr_array(scale @ mass @ scale)
    largest = abs(scaled_mass).max(axis=1).toarray().ravel()
    heavy = np.flatnonzero(largest > MASSLESS * _references(d, closure, largest))
    equations = scipy.sparse.vstack([closure.jacobian[closure.rows], scaled_mass[heavy]])
    motions = columns_of(equations, least_fill(equations))
    if not motions.free:
        return ()
    motion = np.abs(motions.any_kernel(np.random.default_rng(0)))
    moving = motion > MOVING * motion.max()
    return tuple(dict.fromkeys(o for o, m in zip(closure.guesses.owners, moving, strict=True) if m))


def _references(d: Description, closure: Closure, scaled: np.ndarray) -> np.ndarray:
    """(n,) what the mass of each coordinate is compared with, in the same natural units."""
    length = closure.scales.length
    reach = body_sizes(d, closure.all_equations, closure.nominal)
    reach |= {body.name: length for joint in d.constraints for body in joint.parts()}
    kinds = list(zip(closure.guesses.owners, closure.guesses.speed_units, strict=True))
    largest = dict[tuple[str, str], float]()
    for kind, value in zip(kinds, scaled.tolist(), strict=True):
        largest[kind] = max(value, largest.get(kind, 0.0))
    references = [largest[kind] for kind in kinds]
    for k, (owner, unit) in enumerate(kinds):
        if unit == "rad":
            translating = largest.get((owner, "m"), 0.0)
            rotating = translating * (reach.get(owner, 0.0) / length) ** 2
            references[k] = max(references[k], rotating)
    return np.array(references)


def idle_freedoms(d: Description, closure: Closure) -> tuple[str, ...]:
    """Message for each idle rotation in a loop, of one or several bodies."""
    if not any(isinstance(c, Spherical) for c in d.constraints):
        return ()
    sentences = list(_IdleSearch(d, closure).sentences())
    if len(sentences) > LISTED:
        sentences[LISTED:] = [
            f"{len(sentences) - LISTED} more idle degrees of freedom of this kind"
        ]
    return tuple(sentences)


class _IdleSearch:
    def __init__(self, d: Description, closure: Closure):
        self.d, self.closure = d, closure
        self.constraints = [c for c in d.constraints if len(c.parts()) > 1]
        self.names = [[part.owner.name for part in c.parts()] for c in self.constraints]
        self.forced = self._forced()

    def _forced(self) -> set[str]:
        """Bodies that forces other than gravity act on."""
        forces = [f for f in self.d.forces if f.name != "gravity" and not f.internal]
        acting = {part.owner.name for f in forces for part in f.parts()}
        formulas = [q.sx for f in forces if not f.parts() for _, q, _ in f.checked_quantities()]
        if formulas:  # of any positions
            used = free_symbols(ca.vertcat(*formulas))
            for body in self.d.bodies:
                own = {symbol.name() for symbol in ca.symvar(ca.vertcat(body.pose, body.twist))}
                if own & used:
                    acting.add(body.name)
        return acting

    def sentences(self) -> Iterator[str]:
        """Messages for the smallest sets of bodies."""
        reported: list[set[str]] = []
        for bodies, first, second in sorted(self._candidates(), key=lambda c: len(c[0])):
            if any(smaller <= bodies for smaller in reported) or bodies & self.forced:
                continue
            if self._rotates(bodies, first, second):
                reported.append(bodies)
                ordered = [b.name for b in self.d.bodies if b.name in bodies]
                verb = "turns" if len(ordered) == 1 else "together turn"
                yield (
                    f"{' and '.join(ordered)} {verb} freely about the line through joints "
                    f"{first.name} and {second.name}: idle degree of freedom, which moves nothing "
                    "else"
                )

    def _candidates(self) -> Iterator[tuple[set[str], Constraint, Constraint]]:
        """Sets of bodies connected to two other bodies by two joints, one of them a ball joint."""
        joints = [k for k, c in enumerate(self.constraints) if _location(c) is not None]
        balls = {k for k in joints if isinstance(self.constraints[k], Spherical)}
        if len(balls) * len(joints) * len(self.names) > MAX_OPERATIONS:
            pairs = self._around_single_bodies(joints)
        else:
            pairs = ((i, k) for i, k in combinations(joints, 2) if i in balls or k in balls)
        for i, k in pairs:
            rest = (names for n, names in enumerate(self.names) if n not in (i, k))
            groups = _Groups(rest)
            for body in self.names[i]:
                inside = groups.of(body)
                if "ground" in inside or not set(self.names[k]) & inside:
                    continue
                outer = [[n for n in self.names[j] if n not in inside] for j in (i, k)]
                if any(len(o) != 1 for o in outer) or outer[0] == outer[1]:
                    continue
                if outer[1][0] in groups.of(outer[0][0]):  # they are part of a loop
                    yield inside, self.constraints[i], self.constraints[k]

    def _around_single_bodies(self, joints: list[int]) -> Iterator[tuple[int, int]]:
        """Pairs of joints of bodies with two constraints."""
        of_body: dict[str, list[int]] = {}
        for k, names in enumerate(self.names):
            for name in names:
                of_body.setdefault(name, []).append(k)
        usable = set(joints)
        for name, own in of_body.items():
            ball = any(isinstance(self.constraints[k], Spherical) for k in own)
            if ball and name != "ground" and len(own) == 2 and usable.issuperset(own):
                yield own[0], own[1]

    def _rotates(self, bodies: set[str], first: Constraint, second: Constraint) -> bool:
        """Whether the bodies can rotate about the line through two joints, all else at rest."""
        places = [self._places[c.name] for c in (first, second)]
        line = places[1] - places[0]
        length = float(np.linalg.norm(line))
        if not length > UNCHANGED * self.closure.scales.length:
            return False
        motion, at = np.zeros(self.closure.all_equations.speed_count), 0
        for group in self.d.coordinates:
            span = slice(at, at := at + group.twist.numel())
            if group.name in bodies:
                speeds = self._rotation(group, places[0], line / length)
                if speeds is None:
                    return False
                motion[span] = speeds
            elif getattr(group, "owner", group).name in bodies:
                return False
        natural = motion / self.closure.scales.displacements
        change, terms = self.closure.jacobian @ natural, abs(self.closure.jacobian) @ abs(natural)
        return bool(np.all(np.abs(change) <= UNCHANGED * np.maximum(terms, length)))

    def _rotation(
        self, group: Coordinates, origin: np.ndarray, axis: np.ndarray
    ) -> np.ndarray | None:
        """Speeds of a rigid body that rotates about a line; None for other bodies."""
        if group.name not in self._rates:
            return None
        matrix, center = self._rates[group.name]
        twist = np.concatenate([np.cross(axis, center - origin), axis])
        return np.linalg.solve(matrix, twist)

    @cached_property
    def _places(self) -> dict[str, np.ndarray]:
        """Joint → (3,) its location."""
        spots = {c.name: spot for c in self.constraints if (spot := _location(c)) is not None}
        values = self._numbers(ca.horzcat(ca.SX(3, 0), *spots.values()))
        return {name: values[:, k] for k, name in enumerate(spots)}

    @cached_property
    def _rates(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Rigid body → (6, 6) velocity and angular velocity by speeds, (3,) mass centre."""
        rigid = [b for b in self.d.bodies if b.dimension == 3 and b.twist.numel() == 6]
        matrices = [ca.jacobian(ca.vertcat(b.twist[:3], b.turning), b.twist) for b in rigid]
        columns = [
            ca.vertcat(m, ca.repmat(b.mass_center.T, 1, 2))
            for m, b in zip(matrices, rigid, strict=True)
        ]
        values = self._numbers(ca.horzcat(ca.SX(7, 0), *columns))
        return {
            b.name: (values[:6, 6 * k : 6 * k + 6], values[6, 6 * k : 6 * k + 3])
            for k, b in enumerate(rigid)
        }

    def _numbers(self, expression: ca.SX) -> np.ndarray:
        e, start = self.closure.all_equations, self.closure.start
        fixed = at_ground(self.d.ground, ca.densify(expression))
        function = ca.Function("numbers", [e.t, e.y, e.v, e.p], [fixed])
        return function(0.0, start.y, np.zeros(e.speed_count), self.closure.nominal).full()


class _Groups:
    """Groups of bodies connected by constraints, the ground included (union–find)."""

    def __init__(self, ties: Iterable[list[str]]):
        self.parent: dict[str, str] = {}
        for names in ties:
            for name in names[1:]:
                self.parent[self._root(name)] = self._root(names[0])

    def _root(self, name: str) -> str:
        while (above := self.parent.get(name, name)) != name:
            name = above
        return name

    def of(self, body: str) -> set[str]:
        """All bodies connected to a body, and the body itself."""
        root = self._root(body)
        return {body} | {name for name in self.parent if self._root(name) == root} | {root}


def _location(constraint: Constraint) -> ca.SX | None:
    """Location of a joint of two bodies; None without a single one."""
    if len(constraint.parts()) != 2 or constraint.end_points is None:
        return None
    point = constraint.end_points[0].position.sx
    return point if point.numel() == 3 else None
