"""Slider–crank linkages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.linkage import EDGE, Direction, Linkage, Numbers, least_squares
from dalembert.elements import planar
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import t
from dalembert.symbolic.formulas.functions import cos, sin


@dataclass(frozen=True, kw_only=True)
class SliderCrank(Linkage):
    """``d e^{iθ} + c e^{iφ} = (s + i e) e^{iγ}``: crank d, rod c, offset e of the rail, whose
    direction is ``angle`` γ, and the position s of the slider. The branch is the sign of
    ``cos(φ − γ)``.

    Parameters
    ----------
    crank, coupler : lengths ``d``, ``c``; metres for ``system()``
    offset : ``e``
    x, y : pivot of the crank
    angle : ``γ`` [rad]
    u, v : coupler point, from the crank pin along the rod and normal to it
    branch : +1 or −1

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> engine = da.SliderCrank(crank=0.1, coupler=0.3)
    >>> [round(float(engine.output(angle)), 6) for angle in (0.0, math.pi)]  # l + r, l - r
    [0.4, 0.2]
    """

    offset: float = 0.0

    lengths = ("crank", "coupler")
    output_is_angle = False

    @staticmethod
    def closed(q: Numbers, branch: ca.SX, theta: ca.SX) -> tuple[Direction, Direction | ca.SX]:
        d, c, e, gamma = (q[n] for n in ("crank", "coupler", "offset", "angle"))
        sin_in = ca.fmin(ca.fmax((e - d * ca.sin(theta - gamma)) / c, -EDGE), EDGE)
        cos_in = branch * ca.sqrt(1 - sin_in**2)
        cos_g, sin_g = ca.cos(gamma), ca.sin(gamma)
        coupler = cos_in * cos_g - sin_in * sin_g, sin_in * cos_g + cos_in * sin_g
        return coupler, d * ca.cos(theta - gamma) + c * cos_in

    @staticmethod
    def closure_conditions(q: Numbers, theta: ca.SX, least: float) -> list[ca.SX]:
        height = q["offset"] - q["crank"] * ca.sin(theta - q["angle"])
        projection = q["coupler"] * np.cos(least)
        return [projection - height, projection + height]

    @staticmethod
    def transmission_sine(q: Numbers, phi: Any, output: Any) -> Any:
        return ca.cos(phi - q["angle"])

    @staticmethod
    def rotation_conditions(q: Numbers, least: float) -> list[ca.SX]:
        margin = q["coupler"] * np.cos(least) - q["crank"]
        return [margin - q["offset"], margin + q["offset"]]

    @staticmethod
    def loop(
        q: Numbers, branch: float | np.ndarray, theta: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        relative_angle = theta - q["angle"]
        with np.errstate(invalid="ignore"):
            rod_angle = np.arcsin(
                (q["offset"] - q["crank"] * np.sin(relative_angle)) / q["coupler"]
            )
        rod_angle = np.where(np.asarray(branch) > 0, rod_angle, np.pi - rod_angle)
        position = q["crank"] * np.cos(relative_angle) + q["coupler"] * np.cos(rod_angle)
        return rod_angle + q["angle"], position

    @classmethod
    def fitted_dimensions(cls, theta: np.ndarray, output: np.ndarray) -> dict[str, np.ndarray]:
        """``s² = K₁ s cos θ + K₂ sin θ + K₃``, ``K₁ = 2 d``, ``K₂ = 2 d e``,
        ``K₃ = c² − d² − e²``."""
        rows = np.stack([output * np.cos(theta), np.sin(theta), np.ones_like(theta)], axis=-1)
        k1, k2, k3 = least_squares(rows, output**2)
        with np.errstate(all="ignore"):
            d = np.where(k1 > 0, k1 / 2, np.nan)
            e = k2 / k1
            c = np.sqrt(k3 + d**2 + e**2)
        zero = np.zeros_like(d)
        return {
            **{"crank": d, "coupler": c, "offset": e},
            **{"x": zero, "y": zero, "angle": zero, "u": zero, "v": zero},
        }

    @classmethod
    def random_dimensions(cls, rng: np.random.Generator, count: int) -> dict[str, np.ndarray]:
        zero = np.zeros(count)
        crank = rng.uniform(0.1, 0.9, count)
        reach = rng.uniform(0.1, 1.5, count) * np.exp(1j * rng.uniform(-np.pi, np.pi, count))
        offset = rng.uniform(-0.9, 0.9, count) * (1 - crank)
        return {
            **{"crank": crank, "coupler": zero + 1, "offset": offset},
            **{"x": zero, "y": zero, "angle": zero, "u": 0.5 + reach.real, "v": reach.imag},
        }

    @staticmethod
    def circuits(q: Numbers, theta: np.ndarray, phi: np.ndarray, output: np.ndarray) -> np.ndarray:
        """If crank or rod rotates fully, the other link is never perpendicular to the rail."""
        gap, offset = float(q["coupler"]) - float(q["crank"]), abs(float(q["offset"]))
        if abs(gap) <= offset:
            return np.zeros(np.shape(theta))
        return np.asarray(np.sign(np.cos((phi if gap > 0 else theta) - q["angle"])))

    def joints(self, theta: float) -> np.ndarray:
        """Crank pivot and pin, slider pin, coupler point, and the foot of the rail."""
        phi = self.coupler_angle(theta)
        pivot = complex(self.x, self.y)
        pin = pivot + self.crank * np.exp(1j * theta)
        point = pin + complex(self.u, self.v) * np.exp(1j * phi)
        foot = pivot + 1j * self.offset * np.exp(1j * self.angle)
        return np.array([pivot, pin, pin + self.coupler * np.exp(1j * phi), point, foot])

    def system(self, name: str = "slider-crank", speed: float = 1.0) -> System:
        system = System(name)
        q = self.parameters(system)
        start = self.angle + 0.5
        phi, position = (float(a) for a in self.loop(self.numbers, self.branch, np.array(start)))
        crank = system.add(planar.Bar("crank", length=q["crank"], mass=1.0, angle=start))
        point = {"P": (q["u"] - q["coupler"] / 2, q["v"])}
        coupler = system.add(
            planar.Bar("coupler", length=q["coupler"], mass=1.0, angle=phi, points=point)
        )
        rail = (q["x"] - q["offset"] * sin(q["angle"]), q["y"] + q["offset"] * cos(q["angle"]))
        slider_position = complex(self.x, self.y) + complex(position, self.offset) * np.exp(
            1j * self.angle
        )
        slider = system.add(
            planar.Body(
                "slider",
                mass=1.0,
                inertia=1.0,
                position=(slider_position.real, slider_position.imag),
                angle=self.angle,
            )
        )
        ground = system.ground
        system.add(planar.Revolute("O", ground.point(q["x"], q["y"]), crank.start))
        system.add(planar.Revolute("A", crank.end, coupler.start))
        system.add(planar.Revolute("B", coupler.end, slider.center))
        direction = (cos(q["angle"]), sin(q["angle"]))
        system.add(
            planar.Prismatic(
                "rail", ground.point(*rail), slider.center, axis=direction, angle=q["angle"]
            )
        )
        system.add(planar.RotationalDriver("motor", ground, crank, start + speed * t))
        return system
