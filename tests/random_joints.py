"""Joints and drivers of random mechanisms, made to fit the poses there are."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mechanism_twin import MechanismTwin, direction_of
from twins import direction, left, length, turn

import dalembert as da
from dalembert import FormulaCurve, cos, planar, sin
from dalembert.elements.base import Constraint
from dalembert.elements.curves import u


class JointTwin(MechanismTwin):
    """Every joint and driver of the plane, with its residual by hand."""

    def join(self, kind: type, i: str, j: str, residual: Callable, a, b, **more) -> Constraint:
        """A joint of two points at places ``a`` and ``b``."""
        (p, at_p), (q, at_q) = self.point(i, a), self.point(j, b)
        self.residuals.append(lambda f, t: residual(f, at_p(f), at_q(f)))
        return self.add(kind, p, q, **more)

    def revolute(self, i: str, j: str, place) -> None:
        joint = self.join(planar.Revolute, i, j, lambda f, p, q: q - p, place, place)
        if self.turns(i) and self.turns(j):
            self.work_in(joint, {"angle": lambda f: f[j].phi - f[i].phi})

    def weld(self, i: str, j: str, place) -> None:
        angle = self.turned(i, j)

        def residual(f, p, q):
            return np.append(q - p, f[j].phi - f[i].phi - angle)

        self.join(planar.Weld, i, j, residual, place, place, angle=angle)

    def slider(self, i: str, j: str, a, b) -> None:
        """Point at b of body j on the line from a to b of body i, without turning."""
        axis, angle = self.axis(i, a, b), self.turned(i, j)

        def residual(f, p, q):
            offset = left(f[i].vector(axis)) @ (q - p)
            return np.array([offset, f[j].phi - f[i].phi - angle])

        joint = self.join(planar.Prismatic, i, j, residual, a, b, axis=tuple(axis), angle=angle)
        self.work_in(joint, {"displacement": self._travel(i, j, a, b, axis)})

    def slot(self, i: str, j: str, a, b) -> None:
        axis = self.axis(i, a, b)

        def residual(f, p, q):
            return np.array([left(f[i].vector(axis)) @ (q - p)])

        joint = self.join(planar.PinInSlot, i, j, residual, a, b, axis=tuple(axis))
        free = {"displacement": self._travel(i, j, a, b, axis)}
        self.work_in(joint, free | {"angle": lambda f: f[j].phi - f[i].phi})

    def _travel(self, i: str, j: str, a, b, axis) -> Callable:
        (_, at_p), (_, at_q) = self.point(i, a), self.point(j, b)
        return lambda f: f[i].vector(axis) @ (at_q(f) - at_p(f))

    def work_in(self, joint: Constraint, free: dict[str, Callable]) -> None:
        """Friction or an actuator in a free motion of a joint, of some of them."""
        chance = self.rng.random()
        if chance < 0.78:
            return
        motion = str(self.rng.choice(list(free)))
        if chance < 0.85:
            push = self.rng.uniform(-2, 2)
            self.add(planar.JointActuator, joint, push * cos(5 * da.t), motion=motion)
            self.loads.append((free[motion], lambda f, rate, t: push * np.cos(5 * t)))
            return
        dry, viscous, at = self.rng.uniform((0.1, 0.0, 0.2), (1.0, 0.3, 1.0))
        values = {"coulomb": dry, "viscous": viscous, "transition": at}
        self.add(planar.JointFriction, joint, motion=motion, **values)
        self.loads.append(
            (free[motion], lambda f, rate, t: -dry * np.tanh(rate / at) - viscous * rate)
        )

    def link(self, i: str, j: str, a, b) -> None:
        reach = float(np.linalg.norm(np.subtract(b, a)))

        def residual(f, p, q):
            return np.array([length(q - p) - reach])

        self.join(planar.RigidLink, i, j, residual, a, b, length=reach)

    def curve(self, i: str, j: str, place) -> None:
        """A point of body j on an ellipse of body i, or a roller beside it."""
        rng, at = self.rng, self.rng.uniform(-3, 3)
        major, minor = rng.uniform(0.3, 0.9, 2)
        roller = float(rng.choice([0.0, rng.uniform(0.05, 0.2)]))

        def round_(u):
            tangent = np.array([-major * np.sin(u), minor * np.cos(u)])
            ellipse = np.array([major * np.cos(u), minor * np.sin(u)])
            return ellipse - roller * left(tangent) / length(tangent)

        x, y = self.local(i, place) - round_(at)
        curve, (q, at_q) = (
            FormulaCurve(x + major * cos(u), y + minor * sin(u)),
            self.point(j, place),
        )
        element = self.add(
            planar.PointOnCurve, self.bodies[i], q, curve, radius=roller, parameter=at
        )
        self.own.append((element.name, 1))
        self.residuals.append(
            lambda f, t: turn(-f[i].phi, at_q(f) - f[i].r) - (x, y) - round_(f[element.name])
        )

    # without slip ----------------------------------------------------------------------
    def coupling(self, i: str, j: str, ratio: float, carrier: str | None = None) -> None:
        base = carrier or "ground"
        constant = self.turned(base, j) - ratio * self.turned(base, i)
        more = {"carrier": self.bodies[carrier]} if carrier else {}
        self.add(planar.Coupling, self.bodies[i], self.bodies[j], ratio=ratio, **more)

        def residual(f, t):
            turned = f[j].phi - f[base].phi - ratio * (f[i].phi - f[base].phi)
            return np.array([turned - constant])

        self.residuals.append(residual)

    def gears(self, i: str, j: str, a, b) -> None:
        """Toothed wheels about two places, which something else holds apart."""
        first, second = self.rng.uniform(0.1, 0.6, 2)
        internal = bool(self.rng.random() < 0.5)
        way, line = -1 if internal else 1, np.subtract(b, a)
        start, angles = np.arctan2(line[1], line[0]), (self.poses[i][2], self.poses[j][2])

        def residual(f, p, q):
            along = direction(turn(-start, q - p))
            own, other = f[i].phi - angles[0] - along, f[j].phi - angles[1] - along
            return np.array([first * own + way * second * other])

        radii = {"radius_i": first, "radius_j": second}
        self.join(planar.GearPair, i, j, residual, a, b, internal=internal, **radii)

    def rack(self, i: str, j: str, a, b) -> None:
        """A pinion about b of body j on a rack of body i along the line from a to b."""
        axis, radius, side = self.axis(i, a, b), self.rng.uniform(0.1, 0.5), self._side()
        angle, start = self.turned(i, j), np.linalg.norm(np.subtract(b, a))

        def residual(f, p, q):
            along = f[i].vector(axis) @ (q - p) - start
            return np.array([along + side * radius * (f[j].phi - f[i].phi - angle)])

        more = {"axis": tuple(axis), "radius": radius, "side": side}
        self.join(planar.RackAndPinion, i, j, residual, a, b, **more)

    def rolling(self, j: str) -> None:
        """Body j with its centre beside a line of the ground through its place."""
        pose, radius, side = self.poses[j], self.rng.uniform(0.2, 0.5), self._side()

        def residual(f, p, q):
            along = (q - p)[0] + side * radius * (f[j].phi - pose[2])
            return np.array([(q - p)[1] - side * radius, along])

        a, b = pose[:2] - (0, side * radius), pose[:2]
        self.join(planar.RollingDisc, "ground", j, residual, a, b, radius=radius, side=side)

    def _side(self) -> int:
        return int(self.rng.choice([-1, 1]))

    # formulas --------------------------------------------------------------------------
    def user(self, j: str) -> None:
        """A formula of the pose of a body, that may move with time."""
        rng, (x, y, angle) = self.rng, self.poses[j]
        k, h, bend, rate = rng.uniform(-1, 1, 4)
        rate = float(rng.choice([0.0, rate]))
        body, wide = self.bodies[j], 0.3 if self.turns(j) else 0.0

        def formula(x, y, angle, t, sin):
            return k * x + y + h * x * y + bend * wide * sin(angle) - rate * t

        start = formula(x, y, angle, 0.0, np.sin)
        at = body.angle if wide else 0.0
        self.add(planar.UserConstraint, formula(body.x, body.y, at, da.t, sin) - start)
        self.residuals.append(
            lambda f, t: np.array([formula(*f[j].r, f[j].phi, t, np.sin) - start])
        )

    def driver(self, i: str, j: str) -> None:
        """A coordinate of body j relative to i, prescribed from where it is."""
        rate, bend = self.rng.uniform(-1, 1, 2)

        def moved(start, t):
            return start + rate * t + bend * t**2

        a, b, pick = self.at(i), self.at(j), self.rng.integers(4)
        (p, at_p), (q, at_q) = self.point(i, a), self.point(j, b)
        if pick == 0 and self.turns(i) and self.turns(j):
            start = self.turned(i, j)
            arguments = planar.RotationalDriver, self.bodies[i], self.bodies[j], moved(start, da.t)
            more, coordinate = {}, lambda f: f[j].phi - f[i].phi
        elif pick == 1 and self.turns(i):
            axis, start = self.axis(i, a, b), np.linalg.norm(b - a)
            arguments, more = (planar.TranslationalDriver, p, q), {"axis": tuple(axis)}
            more["law"] = moved(start, da.t)
            coordinate = self._travel(i, j, a, b, axis)
        elif pick == 2:
            start = np.linalg.norm(b - a)
            arguments, more = (planar.DistanceDriver, p, q, moved(start, da.t)), {}
            coordinate = lambda f: length(at_q(f) - at_p(f))  # noqa: E731
        else:
            along = direction_of(self.rng)
            start = along @ b
            arguments, more = (planar.CoordinateDriver, q, moved(start, da.t)), {}
            more["direction"] = tuple(along)
            coordinate = lambda f: along @ at_q(f)  # noqa: E731
        self.add(*arguments, **more)
        self.residuals.append(lambda f, t: np.array([coordinate(f) - moved(start, t)]))

    # any -------------------------------------------------------------------------------
    def any_joint(self, i: str, j: str) -> int:
        """A random joint between two bodies; how many freedoms it takes."""
        rng, a, b = self.rng, self.at(i), self.at(j)
        if not (self.turns(i) and self.turns(j)):
            return self._joint_of_points(i, j, a, b)
        kinds = {
            2: (
                lambda: self.revolute(i, j, a),
                lambda: self.revolute(i, j, a),
                lambda: self.slider(i, j, a, b),
            ),
            1: (
                lambda: self.slot(i, j, a, b),
                lambda: self.link(i, j, a, b),
                lambda: self.curve(i, j, a),
                lambda: self.rack(i, j, a, b),
                lambda: self.gears(i, j, a, b),
                lambda: self.coupling(i, j, rng.uniform(-2, 2)),
                lambda: self.user(j),
            ),
            3: (lambda: self.weld(i, j, a),),
        }
        taken = int(rng.choice([1, 2, 3], p=[0.45, 0.45, 0.1]))
        kinds[taken][rng.integers(len(kinds[taken]))]()
        return taken

    def _joint_of_points(self, i: str, j: str, a, b) -> int:
        """Where one or both are particles."""
        pick = self.rng.integers(4)
        if pick == 0 and self.turns(i):
            self.revolute(i, j, b)
            return 2
        if pick == 1 and self.turns(i):
            self.curve(i, j, b)
        elif pick == 2:
            self.user(j)
        else:
            self.link(i, j, a, b)
        return 1
