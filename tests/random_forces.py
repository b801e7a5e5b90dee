"""Forces of random mechanisms."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from random_beams import BeamTwin
from twins import length, turn

import dalembert as da
from dalembert import cos, planar


class Mechanism(BeamTwin):
    """Every force of the plane, with its energy or its load by hand."""

    def damped(self, along: Callable, damping: float) -> None:
        if damping:
            self.loads.append((along, lambda f, rate, t: -damping * rate))

    def distance(self, i: str, j: str) -> tuple[planar.Point, planar.Point, Callable]:
        """Two points, and how far they are apart."""
        (p, at_p), (q, at_q) = self.point(i, self.at(i)), self.point(j, self.at(j))
        return p, q, lambda f: length(at_q(f) - at_p(f))

    # between two bodies ----------------------------------------------------------------
    def spring(self, i: str, j: str) -> None:
        """With damping, and perhaps a law that hardens."""
        rng, (p, q, apart) = self.rng, self.distance(i, j)
        k, c, free, hard = rng.uniform((1, 0.1, 0, 1), (20, 1, 1, 30))
        c, hard = c * rng.integers(2), hard * (rng.random() < 0.3)
        more = {"law": lambda extension, rate: hard * extension**3} if hard else {}
        self.add(planar.Spring, p, q, stiffness=k, damping=c, free_length=free, **more)
        self.energies.append(lambda f: k / 2 * (apart(f) - free) ** 2)
        self.damped(apart, c)
        if hard:
            self.loads.append((apart, lambda f, rate, t: -hard * (apart(f) - free) ** 3))

    def rotational_spring(self, i: str, j: str) -> None:
        k, c, free = self.rng.uniform(0.5, 5, 3)
        more = {"stiffness": k, "damping": c, "free_angle": free}
        self.add(planar.TorsionSpring, self.bodies[i], self.bodies[j], **more)
        self.energies.append(lambda f: k / 2 * (f[j].phi - f[i].phi - free) ** 2)
        self.damped(lambda f: f[j].phi - f[i].phi, c)

    def bushing(self, i: str, j: str) -> None:
        place = self.place()
        (p, at_p), (q, at_q) = self.point(i, place), self.point(j, place)
        k, c = self.rng.uniform(5, 60, 3), self.rng.uniform(0, 2, 3) * self.rng.integers(2)
        k[2] *= 0.05  # the deflection of the angle is that of the bodies, which may be large
        self.add(
            planar.Bushing,
            p,
            q,
            stiffness=tuple(k[:2]),
            damping=tuple(c[:2]),
            rotational_stiffness=k[2],
            rotational_damping=c[2],
        )

        def deflections(f):
            local = turn(-f[i].phi, at_q(f) - at_p(f))
            return np.append(local, f[j].phi - f[i].phi)

        self.energies.append(lambda f: k @ deflections(f) ** 2 / 2)
        for n in range(3):
            self.damped(lambda f, n=n: deflections(f)[n], c[n])

    def actuator(self, i: str, j: str) -> None:
        """A force between two points by time and the speed of a body."""
        (p, q, apart), push = self.distance(i, j), self.rng.uniform(-5, 5)
        self.add(planar.Actuator, p, q, push * cos(4 * da.t))
        self.loads.append((apart, lambda f, rate, t: push * np.cos(4 * t)))

    def stop(self, i: str, j: str) -> None:
        """Reached soon: by the height of a body or an angle, from below or above."""
        rng, sense = self.rng, self._side()
        angular = self.turns(i) and self.turns(j) and rng.random() < 0.3
        if angular:
            measure = self.bodies[j].angle - (self.bodies[i].angle if i != "ground" else 0.0)
            along, now = lambda f: f[j].phi - f[i].phi, self.turned(i, j)
        else:
            measure, along, now = self.bodies[j].y, lambda f: f[j].r[1], self.poses[j][1]
        limit, k, c = now + sense * rng.uniform(-0.02, 0.05), *rng.uniform((20, 0), (200, 1))
        c, power = c * rng.integers(2), float(rng.choice([1.0, 1.5]))
        arguments = {"upper" if sense > 0 else "lower": limit}
        self.add(planar.Stop, measure, stiffness=k, damping=c, exponent=power, **arguments)

        def depth(f):
            return sense * (along(f) - limit)

        def stored(f):
            return k / (power + 1) * depth(f) ** (power + 1) if np.real(depth(f)) > 0 else 0.0

        def lost(f, rate, t):
            press = k * depth(f) ** power if depth(f) > 0 else 0.0
            return -sense * press * (max(0.0, 1 + c * sense * rate) - 1)

        self.energies.append(stored)
        self.loads.append((along, lost))

    # on one body -----------------------------------------------------------------------
    def force(self, j: str) -> None:
        """In fixed axes, or in those of the body."""
        place, vector = self.at(j), self.rng.uniform(-5, 5, 2)
        q, at_q = self.point(j, place)
        following = bool(self.turns(j) and self.rng.random() < 0.5)
        self.add(planar.Force, q, tuple(vector), following=following)

        def now(f):
            return f[j].vector(vector) if following else vector

        for k in (0, 1):
            self.loads.append((lambda f, k=k: at_q(f)[k], lambda f, rate, t, k=k: now(f)[k]))

    def moment(self, i: str, j: str) -> None:
        """By time and speed, and perhaps its opposite on another body."""
        size, fade = self.rng.uniform((-2, 0), 2)
        body, speed, more = self.bodies[j], self.bodies[j].angular_velocity, {}
        base = i if i != "ground" and self.turns(i) and self.rng.random() < 0.5 else "ground"
        if base != "ground":
            speed, more = speed - self.bodies[i].angular_velocity, {"reaction_on": self.bodies[i]}
        self.add(planar.Torque, body, size * cos(3 * da.t) - fade * speed, **more)
        self.loads.append(
            (
                lambda f: f[j].phi - f[base].phi,
                lambda f, rate, t: size * np.cos(3 * t) - fade * rate,
            )
        )

    # where things may touch, elastic alone ----------------------------------------------
    def pressed(self, depth: Callable, k: float, exponent: float) -> None:
        """``k δⁿ`` where ``δ > 0``."""
        n = exponent + 1
        self.energies.append(lambda f: k / n * np.maximum(depth(f), 0) ** n)

    def cable(self, i: str, j: str) -> None:
        """It pulls where two points are further apart than it is long."""
        p, q, apart = self.distance(i, j)
        k, free = self.rng.uniform((5, 0.3), (40, 2))
        self.add(planar.Cable, (p, q), length=free, stiffness=k)
        self.pressed(lambda f: apart(f) - free, k, 1.0)

    def contact(self, i: str, j: str) -> None:
        """Two discs, by Hertz."""
        p, q, apart = self.distance(i, j)
        k, a, b = self.rng.uniform((5, 0.1, 0.1), (40, 0.6, 0.6))
        discs = planar.contact.Circle(p, radius=a), planar.contact.Circle(q, radius=b)
        self.add(planar.Contact, *discs, law=planar.contact.Hertz(stiffness=k))
        self.pressed(lambda f: a + b - apart(f), k, 1.5)

    def clearance(self, i: str, j: str) -> None:
        """A journal in a bearing with much play."""
        p, q, apart = self.distance(i, j)
        k, play = self.rng.uniform((5, 0.2), (40, 1))
        law = planar.contact.Hertz(stiffness=k)
        self.add(planar.ClearanceRevolute, p, q, radius=0.1, clearance=play, law=law)
        self.pressed(lambda f: apart(f) - play, k, 1.5)

    def unilateral(self, j: str) -> None:
        """A body bounces off a level that it may reach soon, and loses nothing."""
        sense = self._side()
        limit = self.poses[j][1] + sense * self.rng.uniform(0.002, 0.05)
        distance = sense * (limit - self.bodies[j].y)
        self.add(planar.UnilateralConstraint, distance, restitution=1.0)
        self.gaps.append(lambda f: sense * (limit - f[j].r[1]))

    def any_touch(self, i: str, j: str) -> None:
        kinds = self.cable, self.contact, self.clearance
        kinds[self.rng.integers(len(kinds))](i, j)

    def any_force(self, i: str, j: str) -> None:
        """A random force on body j, from body i where it comes from a body."""
        turn_both = self.turns(i) and self.turns(j)
        kinds = [lambda: self.spring(i, j), lambda: self.actuator(i, j), lambda: self.force(j)]
        kinds.append(lambda: self.stop(i, j))
        if turn_both:
            kinds += [lambda: self.rotational_spring(i, j), lambda: self.bushing(i, j)]
        if self.turns(j):
            kinds.append(lambda: self.moment(i, j))
        kinds[self.rng.integers(len(kinds))]()
