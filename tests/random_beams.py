"""Beams of random mechanisms: Reissner's, by hand."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from mechanism_twin import direction_of
from random_joints import JointTwin
from twins import turn

from dalembert import planar


def shapes(order: int, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Polynomials that are one at one of evenly spaced nodes in [0, 1], and their slopes."""
    powers = np.vander(np.linspace(0, 1, order + 1), increasing=True)
    polynomials = [np.polynomial.Polynomial(c) for c in np.linalg.inv(powers).T]
    values, slopes = ([p(at) for p in polynomials], [p.deriv()(at) for p in polynomials])
    return np.array(values).T, np.array(slopes).T


def points(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Places and weights of Gauss in [0, 1]."""
    at, weights = np.polynomial.legendre.leggauss(count)
    return (at + 1) / 2, weights / 2


class BeamTwin(JointTwin):
    """A beam clamped to one or two bodies, with nodes of its own."""

    def beam(self, i: str, j: str) -> None:
        rng = self.rng
        if not (self.turns(i) or i == "ground") or not self.turns(j):
            return
        order, elements = (int(rng.integers(1, 3)) for _ in range(2))
        a, along = self.place(), rng.uniform(0.6, 1.2) * direction_of(rng)
        b, length = a + along, float(np.hypot(*along) * rng.uniform(0.9, 1.1))
        angles = np.arctan2(along[1], along[0]) + rng.uniform(-0.3, 0.3, 2)
        count = elements * order + 1
        free = rng.random() < 0.3
        (p, start), (q, end) = self._clamp(i, a, angles[0]), self._clamp(j, b, angles[1])
        rigid, mass = rng.uniform((3, 3, 0.1), (10, 10, 0.4)), rng.uniform(0.5, 1.5)
        rotary, lead = rng.uniform(0.05, 0.1), 0.003 * float(rng.integers(2))
        curved = float(rng.choice([0.0, rng.uniform(-0.5, 0.5)]))
        element = self.add(
            planar.Beam,
            p,
            None if free else q,
            length=length,
            curvature=curved,
            axial_rigidity=rigid[0],
            shear_rigidity=rigid[1],
            bending_rigidity=rigid[2],
            mass_per_length=mass,
            rotary_inertia=rotary,
            damping=lead,
            elements=elements,
            order=order,
            angle_i=angles[0] - self.poses[i][2],
            angle_j=0.0 if free else angles[1] - self.poses[j][2],
        )
        own = [f"{element.name}.{k}" for k in range(1, count if free else count - 1)]
        self.own += [(name, 3) for name in own]

        def nodes(f) -> np.ndarray:
            """(count, 3) places and angles."""
            inner = [np.append(f[name].r, f[name].phi) for name in own]
            return np.array([start(f), *inner, *([] if free else [end(f)])])

        arc = np.array([natural(s, curved) for s in np.linspace(0, length, count)])
        self._deform(nodes, arc, length, order, elements, rigid, lead)
        self._weigh(nodes, length, order, elements, mass, rotary)

    def _clamp(self, name: str, place, angle: float) -> tuple[planar.Point, Callable]:
        """A point, and the pose of the cross-section there."""
        (point, at), local = self.point(name, place), angle - self.poses[name][2]
        return point, lambda f: np.append(at(f), f[name].phi + local)

    def _deform(self, nodes, arc, length, order, elements, rigid, lead) -> None:
        """``½ C ε²`` at points of Gauss, and ``τ C ε̇`` along every strain."""
        at, weights = points(order)
        values, slopes = shapes(order, at)
        for e in range(elements):
            mine = slice(e * order, (e + 1) * order + 1)
            for n, slope, weight in zip(values, slopes * elements / length, weights, strict=True):
                share = weight * length / elements

                def strain(poses, n=n, slope=slope, mine=mine):
                    own = poses[mine]
                    return np.append(turn(-(n @ own[:, 2]), slope @ own[:, :2]), slope @ own[:, 2])

                def strained(f, strain=strain):
                    return strain(nodes(f)) - strain(arc)

                self.energies.append(
                    lambda f, s=strained, share=share: share * rigid @ s(f) ** 2 / 2
                )
                for k in range(3 if lead else 0):
                    self.damped(lambda f, s=strained, k=k: s(f)[k], lead * share * rigid[k])

    def _weigh(self, nodes, length, order, elements, mass, rotary) -> None:
        """Mass and rotary inertia of the polynomials, and weight."""
        at, weights = points(order + 1)
        values, _ = shapes(order, at)
        part, count = values.T @ (weights[:, None] * values), elements * order + 1
        shared = np.zeros((count, count))
        for e in range(elements):
            mine = slice(e * order, (e + 1) * order + 1)
            shared[mine, mine] += part * length / elements
        matrix = np.kron(shared, np.diag([mass, mass, rotary]))
        self.spread.append((lambda f: nodes(f).ravel(), matrix))
        shares = mass * shared.sum(axis=1)
        self.energies.append(lambda f: -shares @ nodes(f)[:, :2] @ self.gravity)


def natural(s: float, curvature: float) -> np.ndarray:
    """Place and angle on an arc from the origin along x."""
    angle = curvature * s
    if curvature == 0:
        return np.array([s, 0.0, 0.0])
    return np.array([np.sin(angle) / curvature, (1 - np.cos(angle)) / curvature, angle])
