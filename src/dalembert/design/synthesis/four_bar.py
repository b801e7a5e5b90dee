"""Four-bar linkages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.linkage import EDGE, Direction, Linkage, Numbers, least_squares
from dalembert.elements import planar
from dalembert.errors import AnalysisError
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import t
from dalembert.symbolic.formulas.functions import cos, sin


@dataclass(frozen=True, kw_only=True)
class FourBar(Linkage):
    """``d e^{iθ} + c e^{iφ} = g e^{iγ} + f e^{iψ}``: crank d, coupler c, ground g at ``angle`` γ,
    follower f at the output ψ. The branch is the sign of ``sin(ψ − φ)``.

    Parameters
    ----------
    crank, coupler, follower, ground : lengths ``d``, ``c``, ``f``, ``g``; metres for ``system()``
    x, y : pivot of the crank
    angle : ``γ`` [rad]
    u, v : coupler point, from the crank pin along the coupler and normal to it
    branch : +1 or −1

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.2, coupler=0.7, follower=0.6, ground=0.8)
    >>> bar.kind, bar.crank_turns
    ('crank-rocker', True)
    >>> model = bar.system().build()
    >>> model.diagnosis.degrees_of_freedom
    1
    """

    follower: float
    ground: float

    lengths = ("crank", "coupler", "follower", "ground")

    @staticmethod
    def closed(q: Numbers, branch: ca.SX, theta: ca.SX) -> tuple[Direction, Direction | ca.SX]:
        x, y = _line(q, theta)
        c, f = q["coupler"], q["follower"]
        distance = ca.sqrt(x**2 + y**2)
        cosine = (c**2 + distance**2 - f**2) / (2 * c * distance)
        cos_in = ca.fmin(ca.fmax(cosine, -EDGE), EDGE)
        sin_in = branch * ca.sqrt(1 - cos_in**2)
        parallel, normal = (
            (x * cos_in - y * sin_in) / distance,
            (y * cos_in + x * sin_in) / distance,
        )
        return (parallel, normal), ((c * parallel - x) / f, (c * normal - y) / f)

    @staticmethod
    def closure_conditions(q: Numbers, theta: ca.SX, least: float) -> list[ca.SX]:
        x, y = _line(q, theta)
        c, f = q["coupler"], q["follower"]
        product, squared_distance = 2 * c * f * np.cos(least), x**2 + y**2
        return [
            squared_distance - (c**2 + f**2 - product),
            c**2 + f**2 + product - squared_distance,
        ]

    @staticmethod
    def transmission_sine(q: Numbers, phi: Any, output: Any) -> Any:
        return ca.sin(output - phi)

    @staticmethod
    def rotation_conditions(q: Numbers, least: float) -> list[ca.SX]:
        """``c² + f² − 2cf cos μ`` is the squared distance of crank pin and follower pivot, which
        ranges from ``|g − d|`` to ``g + d``: Grashof's condition if ``least`` is 0."""
        d, c, f, g = (q[n] for n in ("crank", "coupler", "follower", "ground"))
        product = 2 * c * f * np.cos(least)
        return [(g - d) ** 2 - (c**2 + f**2 - product), c**2 + f**2 + product - (g + d) ** 2]

    @staticmethod
    def loop(
        q: Numbers, branch: float | np.ndarray, theta: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        ground = q["ground"] * np.exp(1j * q["angle"])
        pin = q["crank"] * np.exp(1j * theta)
        line = ground - pin
        distance = np.abs(line)
        with np.errstate(invalid="ignore", divide="ignore"):
            inner_angle = np.arccos(
                (q["coupler"] ** 2 + distance**2 - q["follower"] ** 2)
                / (2 * q["coupler"] * distance)
            )
        phi = np.angle(line) + branch * inner_angle
        return phi, np.angle(pin + q["coupler"] * np.exp(1j * phi) - ground)

    @classmethod
    def fitted_dimensions(cls, theta: np.ndarray, output: np.ndarray) -> dict[str, np.ndarray]:
        """``K₁ cos ψ − K₂ cos θ + K₃ = cos(θ − ψ)`` (Freudenstein 1955), ``K₁ = g/d``,
        ``K₂ = g/f``, ``K₃ = (d² − c² + f² + g²)/(2 d f)``."""
        rows = np.stack([np.cos(output), -np.cos(theta), np.ones_like(theta)], axis=-1)
        k1, k2, k3 = least_squares(rows, np.cos(theta - output))
        with np.errstate(all="ignore"):
            d, f = (np.where(k > 0, 1 / k, np.nan) for k in (k1, k2))
            c = np.sqrt(d**2 + f**2 + 1 - 2 * d * f * k3)
        zero = np.zeros_like(d)
        return {
            **{"crank": d, "coupler": c, "follower": f, "ground": zero + 1},
            **{"x": zero, "y": zero, "angle": zero, "u": zero, "v": zero},
        }

    @classmethod
    def random_dimensions(cls, rng: np.random.Generator, count: int) -> dict[str, np.ndarray]:
        zero = np.zeros(count)
        crank, coupler = rng.uniform(0.1, 0.9, count), rng.uniform(0.4, 2.5, count)
        # range of the follower by Grashof: from |c − f| ≤ 1 − d and c + f ≥ 1 + d
        low = np.maximum(coupler - (1 - crank), 1 + crank - coupler)
        high = coupler + 1 - crank
        follower = low + rng.uniform(0.05, 0.95, count) * (high - low)
        reach = rng.uniform(0.1, 1.5, count) * np.exp(1j * rng.uniform(-np.pi, np.pi, count))
        point = coupler * (0.5 + reach)
        return {
            **{"crank": crank, "coupler": coupler, "follower": follower, "ground": zero + 1},
            **{"x": zero, "y": zero, "angle": zero, "u": point.real, "v": point.imag},
        }

    @staticmethod
    def circuits(q: Numbers, theta: np.ndarray, phi: np.ndarray, output: np.ndarray) -> np.ndarray:
        """By Grashof's condition, joints that are not on the shortest link never straighten."""
        lengths = {name: float(q[name]) for name in FourBar.lengths}
        shortest = min(lengths, key=lambda name: lengths[name])
        if 2 * (lengths[shortest] + max(lengths.values())) >= sum(lengths.values()):
            return np.zeros(np.shape(theta))
        angle = {"coupler": theta - q["angle"], "follower": phi - theta}.get(shortest, output - phi)
        return np.asarray(np.sign(np.sin(angle)))

    def joints(self, theta: float) -> np.ndarray:
        """Crank pivot and pin, follower pivot and pin, coupler point."""
        phi = self.coupler_angle(theta)
        pivot = complex(self.x, self.y)
        pin = pivot + self.crank * np.exp(1j * theta)
        far_pivot, end = (
            pivot + self.ground * np.exp(1j * self.angle),
            pin + self.coupler * np.exp(1j * phi),
        )
        return np.array(
            [pivot, pin, far_pivot, end, pin + complex(self.u, self.v) * np.exp(1j * phi)]
        )

    @property
    def kind(self) -> str:
        """Type by Grashof's condition and the shortest link."""
        lengths = {n: getattr(self, n) for n in self.lengths}
        minimum, maximum = min(lengths.values()), max(lengths.values())
        gap = 2 * (minimum + maximum) - sum(lengths.values())
        if abs(gap) < 1e-12 * maximum:
            return "change point"
        if gap > 0:
            return "triple rocker"
        shortest = min(lengths, key=lambda name: lengths[name])
        kinds = {"crank": "crank-rocker", "follower": "rocker-crank", "ground": "double crank"}
        return kinds.get(shortest, "double rocker")

    def cognates(self) -> tuple[FourBar, FourBar]:
        """The two cognate four-bars with the same coupler curve (Roberts–Chebyshev theorem).

        With ``k = (P − A)/(B − A)`` the third pivot is ``O + k g``. The first cognate has the
        pivots ``O`` and the third; its crank is parallel to the coupler of this linkage, so its
        branch changes where crank and follower of this linkage are parallel. The second one, with a
        crank that rotates like this one, has the third pivot and that of the follower.
        Source: R. S. Hartenberg, J. Denavit, *Kinematic Synthesis of Linkages* (1964), ch. 6.
        """
        k = complex(self.u, self.v) / self.coupler
        origin, ground = complex(self.x, self.y), self.ground * np.exp(1j * self.angle)
        if abs(k) < 1e-12 or abs(1 - k) < 1e-12:
            raise AnalysisError("the coupler point is on a joint; its curve is an arc")

        def cognate(
            at: complex, frame: complex, sizes: tuple[float, ...], ratio: complex, branch: int
        ) -> FourBar:
            crank, coupler, follower = sizes
            point = ratio * coupler
            return FourBar(
                **{"crank": crank, "coupler": coupler, "follower": follower},
                **{"ground": abs(frame), "angle": float(np.angle(frame))},
                **{"x": at.real, "y": at.imag, "u": point.real, "v": point.imag},
                branch=branch,
            )

        left, right = abs(k), abs(1 - k)
        third = origin + k * ground
        return (
            cognate(
                origin,
                k * ground,
                (left * self.coupler, left * self.crank, left * self.follower),
                1 / k,
                self.branch,
            ),
            cognate(
                third,
                (1 - k) * ground,
                (right * self.crank, right * self.follower, right * self.coupler),
                k / (k - 1),
                -self.branch,
            ),
        )

    def system(self, name: str = "four-bar", speed: float = 1.0) -> System:
        system = System(name)
        q = self.parameters(system)
        start = self.angle + 0.5
        phi, psi = (float(a) for a in self.loop(self.numbers, self.branch, np.array(start)))
        crank = system.add(planar.Bar("crank", length=q["crank"], mass=1.0, angle=start))
        point = {"P": (q["u"] - q["coupler"] / 2, q["v"])}
        coupler = system.add(
            planar.Bar("coupler", length=q["coupler"], mass=1.0, angle=phi, points=point)
        )
        follower = system.add(planar.Bar("follower", length=q["follower"], mass=1.0, angle=psi))
        ground = system.ground
        far_pivot = ground.point(
            q["x"] + q["ground"] * cos(q["angle"]), q["y"] + q["ground"] * sin(q["angle"])
        )
        system.add(planar.Revolute("O1", ground.point(q["x"], q["y"]), crank.start))
        system.add(planar.Revolute("A", crank.end, coupler.start))
        system.add(planar.Revolute("B", coupler.end, follower.end))
        system.add(planar.Revolute("O2", far_pivot, follower.start))
        system.add(planar.RotationalDriver("motor", ground, crank, start + speed * t))
        return system


def _line(q: Numbers, theta: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Vector from the crank pin to the follower pivot."""
    d, g, gamma = q["crank"], q["ground"], q["angle"]
    return g * ca.cos(gamma) - d * ca.cos(theta), g * ca.sin(gamma) - d * ca.sin(theta)
