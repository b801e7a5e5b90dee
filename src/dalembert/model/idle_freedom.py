"""Idle degrees of freedom: bodies that turn about a line without moving anything else.

A rod between two ball joints turns freely about the line through them, and so does a telescopic leg
of several bodies. The test is instantaneous: everything else is at rest, the bodies of the set turn
about the line, and no equation of a joint or driver changes, ``C δ = 0``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import combinations

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint
from dalembert.elements.body import BodyElement
from dalembert.elements.spatial.spherical import Spherical
from dalembert.model.absolute import at_ground
from dalembert.model.assembly.closure import Closure
from dalembert.model.description import Description
from dalembert.symbolic.formulas.expression import free_symbols

NOT_MOVING = 1e-9
"""Change of an equation, relative to its terms, that is rounding."""
MOST = 3_000_000
"""Operations of the search at most, beyond which sets of several bodies are left out."""


def idle_freedoms(d: Description, closure: Closure) -> tuple[str, ...]:
    """A sentence for each idle rotation of one or several bodies."""
    search = _IdleSearch(d, closure)
    return tuple(search.sentences()) if any(isinstance(c, Spherical) for c in d.constraints) else ()


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
        """For the smallest sets of bodies."""
        told: list[set[str]] = []
        for bodies, first, second in sorted(self._candidates(), key=lambda c: len(c[0])):
            if any(done <= bodies for done in told) or bodies & self.forced:
                continue
            if self._turns(bodies, first, second):
                told.append(bodies)
                ordered = [b.name for b in self.d.bodies if b.name in bodies]
                verb = "turns" if len(ordered) == 1 else "together turn"
                yield (
                    f"{' and '.join(ordered)} {verb} freely about the line through joints "
                    f"{first.name} and {second.name}: idle degree of freedom, which moves nothing "
                    "else"
                )

    def _candidates(self) -> Iterator[tuple[set[str], Constraint, Constraint]]:
        """Sets of bodies that two joints, one of them a ball joint, tie to two different bodies."""
        joints = [k for k, c in enumerate(self.constraints) if _place(c) is not None]
        balls = {k for k in joints if isinstance(self.constraints[k], Spherical)}
        if len(balls) * len(joints) * len(self.names) > MOST:
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
                if all(len(o) == 1 for o in outer) and outer[0] != outer[1]:
                    yield inside, self.constraints[i], self.constraints[k]

    def _around_single_bodies(self, joints: list[int]) -> Iterator[tuple[int, int]]:
        """Pairs of the joints of bodies that have two constraints."""
        of_body: dict[str, list[int]] = {}
        for k, names in enumerate(self.names):
            for name in names:
                of_body.setdefault(name, []).append(k)
        usable = set(joints)
        for name, held in of_body.items():
            ball = any(isinstance(self.constraints[k], Spherical) for k in held)
            if ball and name != "ground" and len(held) == 2 and usable.issuperset(held):
                yield held[0], held[1]

    def _turns(self, bodies: set[str], first: Constraint, second: Constraint) -> bool:
        """Whether the bodies turn about the line through two joints while all else is at rest."""
        spots = [place for c in (first, second) if (place := _place(c)) is not None]
        places = [self._number(spot).ravel() for spot in spots]
        line = places[1] - places[0]
        length = float(np.linalg.norm(line))
        if not length > NOT_MOVING * self.closure.scales.length:
            return False
        motion, at = np.zeros(self.closure.all_equations.speed_count), 0
        for group in self.d.coordinates:
            span = slice(at, at := at + group.twist.numel())
            if group.name in bodies:
                turned = self._turned(group, places[0], line / length)
                if turned is None:
                    return False
                motion[span] = turned
            elif getattr(group, "owner", group).name in bodies:
                return False
        natural = motion / self.closure.scales.displacements
        change, terms = self.closure.jacobian @ natural, abs(self.closure.jacobian) @ abs(natural)
        return bool(np.all(np.abs(change) <= NOT_MOVING * np.maximum(terms, length)))

    def _turned(self, group, origin: np.ndarray, axis: np.ndarray) -> np.ndarray | None:
        """Speeds of a rigid body that turns about a line; None where it is not a rigid body."""
        if not isinstance(group, BodyElement) or group.dimension != 3 or group.twist.numel() != 6:
            return None
        rates = ca.jacobian(ca.vertcat(group.twist[:3], group.turning), group.twist)
        matrix = self._number(rates)
        place = self._number(group.mass_center).ravel()
        wanted = np.concatenate([np.cross(axis, place - origin), axis])
        return np.linalg.solve(matrix, wanted)

    def _number(self, expression: ca.SX) -> np.ndarray:
        e, start = self.closure.all_equations, self.closure.start
        fixed = at_ground(self.d.ground, ca.densify(expression))
        function = ca.Function("number", [e.t, e.y, e.v, e.p], [fixed])
        return function(0.0, start.y, np.zeros(e.speed_count), self.closure.nominal).full()


class _Groups:
    """Bodies that constraints tie together; the ground is one of them."""

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
        """All bodies tied to one, itself among them."""
        root = self._root(body)
        return {body} | {name for name in self.parent if self._root(name) == root} | {root}


def _place(constraint: Constraint) -> ca.SX | None:
    """Where a joint of two bodies is; None where it has no single place."""
    if len(constraint.parts()) != 2 or constraint.spots is None:
        return None
    point = constraint.spots[0].position.sx
    return point if point.numel() == 3 else None
