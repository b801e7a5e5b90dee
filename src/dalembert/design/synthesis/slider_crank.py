"""Slider–cranks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.synthesis.linkage import Linkage, Numbers
from dalembert.elements import planar
from dalembert.model.system import System
from dalembert.symbolic.formulas.expression import t
from dalembert.symbolic.formulas.functions import cos, sin


@dataclass(frozen=True, kw_only=True)
class SliderCrank(Linkage):
    """``d e^{iθ} + c e^{iφ} = (s + i e) e^{iγ}``: crank d, rod c, offset e of the rail, whose
    direction is ``angle`` γ, and the place s of the slider. The branch is the sign of
    ``cos(φ − γ)``.

    Parameters
    ----------
    crank, coupler : lengths ``d``, ``c``; metres for ``system()``
    offset : ``e``
    x, y : pivot of the crank
    angle : ``γ`` [rad]
    u, v : coupler point, along the rod from the crank pin and square to it
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
    def closure(q: Numbers, theta: ca.SX, phi: ca.SX, output: ca.SX) -> list[ca.SX]:
        d, c, e, gamma = (q[n] for n in ("crank", "coupler", "offset", "angle"))
        along = d * ca.cos(theta - gamma) + c * ca.cos(phi - gamma) - output
        return [along, d * ca.sin(theta - gamma) + c * ca.sin(phi - gamma) - e]

    @staticmethod
    def transmission_sine(q: Numbers, phi: Any, output: Any) -> Any:
        return ca.cos(phi - q["angle"])

    @staticmethod
    def turns(q: Numbers, least: float) -> list[ca.SX]:
        edge = q["coupler"] * np.cos(least) - q["crank"]
        return [edge - q["offset"], edge + q["offset"]]

    @staticmethod
    def loop(q: Numbers, branch: Any, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        turned = theta - q["angle"]
        with np.errstate(invalid="ignore"):
            lean = np.arcsin((q["offset"] - q["crank"] * np.sin(turned)) / q["coupler"])
        lean = np.where(np.asarray(branch) > 0, lean, np.pi - lean)
        place = q["crank"] * np.cos(turned) + q["coupler"] * np.cos(lean)
        return lean + q["angle"], place

    @classmethod
    def drawn(cls, rng: np.random.Generator, count: int) -> dict[str, np.ndarray]:
        zero = np.zeros(count)
        crank = rng.uniform(0.1, 0.9, count)
        reach = rng.uniform(0.1, 1.5, count) * np.exp(1j * rng.uniform(-np.pi, np.pi, count))
        offset = rng.uniform(-0.9, 0.9, count) * (1 - crank)
        return {
            **{"crank": crank, "coupler": zero + 1, "offset": offset},
            **{"x": zero, "y": zero, "angle": zero, "u": 0.5 + reach.real, "v": reach.imag},
        }

    def system(self, name: str = "slider-crank", speed: float = 1.0) -> System:
        made = System(name)
        q = self.parameters(made)
        start = self.angle + 0.5
        phi, place = (float(a) for a in self.loop(self.numbers, self.branch, np.array(start)))
        crank = made.add(planar.Bar("crank", length=q["crank"], mass=1.0, angle=start))
        point = {"P": (q["u"] - q["coupler"] / 2, q["v"])}
        coupler = made.add(
            planar.Bar("coupler", length=q["coupler"], mass=1.0, angle=phi, points=point)
        )
        rail = (q["x"] - q["offset"] * sin(q["angle"]), q["y"] + q["offset"] * cos(q["angle"]))
        at = complex(self.x, self.y) + complex(place, self.offset) * np.exp(1j * self.angle)
        slider = made.add(
            planar.Body(
                "slider", mass=1.0, inertia=1.0, position=(at.real, at.imag), angle=self.angle
            )
        )
        ground = made.ground
        made.add(planar.Revolute("O", ground.point(q["x"], q["y"]), crank.start))
        made.add(planar.Revolute("A", crank.end, coupler.start))
        made.add(planar.Revolute("B", coupler.end, slider.center))
        direction = (cos(q["angle"]), sin(q["angle"]))
        made.add(
            planar.Translational(
                "rail", ground.point(*rail), slider.center, axis=direction, angle=q["angle"]
            )
        )
        made.add(planar.RotationalDriver("motor", ground, crank, start + speed * t))
        return made
