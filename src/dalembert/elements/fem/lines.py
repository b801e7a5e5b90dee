"""Elements between two nodes: base class, axial spring (8.6), and bending of straight beams.

``φ = 12 E I/(G A_s L²)`` is the shear flexibility, zero for rigid shear. Stiffness and
interpolation of beams are exact for loads at the ends (Przemieniecki, Theory of Matrix Structural
Analysis; Friedman and Kosmatka, Computers & Structures 47, 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.look import Cells, Coils
from dalembert.errors import ModelError


@dataclass(eq=False)
class Line(StructuralElement):
    """An element between two nodes.

    Parameters
    ----------
    node_i, node_j : its ends
    """

    node_i: Nodal
    node_j: Nodal
    node_count = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        for field in ("node_i", "node_j"):
            if not isinstance(getattr(self, field), Nodal):
                raise ModelError(f"{field} must be a node; got {getattr(self, field)!r}", self.name)
        if self.node_i is self.node_j:
            raise ModelError(f"ties {self.node_i.name} to itself; use two nodes", self.name)

    def nodes(self) -> tuple[Nodal, ...]:
        return self.node_i, self.node_j

    @staticmethod
    def length(x: list[ca.SX]) -> ca.SX:
        """Distance of the two nodes."""
        return ca.norm_2(x[1] - x[0])

    @staticmethod
    def middle(u: list[ca.SX], x: list[ca.SX]) -> ca.SX:
        """Middle between the displaced nodes."""
        d = x[0].numel()
        return (x[0] + u[0][:d] + x[1] + u[1][:d]) / 2

    @classmethod
    def elongation(cls, u: list[ca.SX], x: list[ca.SX]) -> ca.SX:
        """Change ``(l² − L²)/(l + L)`` of the distance, without cancellation."""
        d = x[0].numel()
        relative = u[1][:d] - u[0][:d]
        if d == 1:
            return relative
        before = x[1] - x[0]
        return ca.dot(relative, 2 * before + relative) / (
            ca.norm_2(before) + ca.norm_2(before + relative)
        )

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        return [(cls.length(x), "has no length; its nodes must lie apart")]


@dataclass(eq=False)
class AxialSpring(Line):
    """Linear spring along the line of its nodes, ``s = k (u_j − u_i)`` (8.6).

    ``W = k e²/2`` with the elongation ``e``; in one dimension the node positions are irrelevant.

    Parameters
    ----------
    stiffness : [N/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> chain = da.Structure("chain")
    >>> a, b, c = (chain.node(name, x) for name, x in (("a", 0), ("b", 1), ("c", 2)))
    >>> soft = chain.add(structures.AxialSpring("soft", a, b, stiffness=100.0))
    >>> hard = chain.add(structures.AxialSpring("hard", b, c, stiffness=400.0))
    >>> chain.support(a)
    >>> chain.load(c, fx=20.0)
    >>> round(da.solve_statics(chain.build())["c.ux"], 9)  # sum of F/k
    0.25
    """

    stiffness: Scalar = quantity("N/m", "stiffness", above=0.0, keyword=True)

    @classmethod
    def look_of(cls, nodes: np.ndarray, elements: np.ndarray) -> list[Cells]:
        return [Coils(nodes, elements)]

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return cls.elongation(u, x)

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return q["stiffness"] * strains**2 / 2

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        elongation = cls.elongation(u, x)
        return {"elongation": (elongation, "m"), "force": (q["stiffness"] * elongation, "N")}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        return [] if x[0].numel() == 1 else super().checks(x, q)


STATIONS, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Bending:
    """A beam in one plane.

    Parameters
    ----------
    length : ``L`` [m]
    rigidity : ``E I`` [N m²]
    softness : ``φ`` [-]
    """

    length: ca.SX
    rigidity: ca.SX
    softness: ca.SX

    def energy(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Strain energy from the rotations of the ends relative to the chord."""
        moments = self.moments(first, second)
        return (first * moments[0] + second * moments[1]) / 2

    def moments(self, first: ca.SX, second: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Moments at the ends, ``E I/(L (1+φ)) ((4+φ) θ + (2−φ) θ')``."""
        bend = self.rigidity / (self.length * (1 + self.softness))
        direct, mixed = 4 + self.softness, 2 - self.softness
        return bend * (direct * first + mixed * second), bend * (mixed * first + direct * second)

    def mean_deflection(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Mean distance of the bent axis from the chord, for any shear flexibility."""
        return self.length / 12 * (first - second)

    def bow(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Length of the bent axis minus that of the chord, ``½ ∫ w'² dx`` to second order."""
        phi = self.softness
        direct = (8 + 10 * phi + 5 * phi**2) / 60
        mixed = -(1 + 5 * phi + 5 * phi**2 / 2) / 30
        square = direct * (first**2 + second**2) + 2 * mixed * first * second
        return self.length / 2 * square / (1 + phi) ** 2

    def kinetic(self, ends, mass: ca.SX, inertia: ca.SX) -> ca.SX:
        """Kinetic energy.

        Parameters
        ----------
        ends : transverse velocity and angular velocity of the first end, then of the second
        mass : mass per length [kg/m]
        inertia : rotary inertia of the cross-section per length [kg m]
        """
        total = ca.SX(0)
        for station, weight in zip((1 + STATIONS) / 2, WEIGHTS / 2, strict=True):
            deflections, rotations = self._shapes(float(station))
            speed = sum(n * v for n, v in zip(deflections, ends, strict=True))
            spin = sum(n * v for n, v in zip(rotations, ends, strict=True))
            total += weight * self.length * (mass * speed**2 + inertia * spin**2) / 2
        return total

    def _shapes(self, s: float) -> tuple[list[ca.SX], list[ca.SX]]:
        """Deflection and rotation at ``s L`` for unit motions of the ends."""
        phi, length = self.softness, self.length
        bow = (2 * s**3 - 3 * s**2 - phi * s) / (1 + phi)
        deflections = [
            1 + bow,
            length / (1 + phi) * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
            -bow,
            length / (1 + phi) * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
        ]
        tilt = 6 * (s**2 - s) / ((1 + phi) * length)
        rotations = [
            tilt,
            (3 * s**2 - (4 + phi) * s) / (1 + phi) + 1,
            -tilt,
            (3 * s**2 - (2 - phi) * s) / (1 + phi),
        ]
        return deflections, rotations


def linear_kinetic(first: ca.SX, second: ca.SX, mass: ca.SX) -> ca.SX:
    """Kinetic energy of a total ``mass`` with linear velocity between two ends."""
    return mass / 6 * (ca.sumsqr(first) + ca.dot(first, second) + ca.sumsqr(second))
