"""Base class of single-loop linkages: crank, coupler with a point, and an output.

Positions are complex numbers. ``θ`` is the angle of the crank, ``φ`` of the coupler; the output is
the angle of a follower or the position of a slider. All angles are relative to the x axis.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, ClassVar, Self

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import AnalysisError
from dalembert.model.system import System
from dalembert.symbolic.formulas.parameter import Parameter

Numbers = Mapping[str, Any]
"""Dimension → number, array or graph."""
Direction = tuple[Any, Any]
"""Cosine and sine of an angle."""
EDGE = 1 - 1e-7
"""Upper limit of cosines and sines of angles in the loop, for finite derivatives."""


@dataclass(frozen=True, kw_only=True)
class Linkage(ABC):
    """Single-loop linkage.

    ``u, v`` is the coupler point, from the crank pin along and normal to the coupler, ``x, y`` the
    pivot of the crank, ``angle`` the direction of the frame, and ``branch`` ±1.
    """

    crank: float
    coupler: float
    x: float = 0.0
    y: float = 0.0
    angle: float = 0.0
    u: float = 0.0
    v: float = 0.0
    branch: int = 1

    lengths: ClassVar[tuple[str, ...]] = ()
    """Dimensions that are positive."""
    output_is_angle: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for name in self.names():
            if not np.isfinite(getattr(self, name)):
                raise AnalysisError(f"{type(self).__name__}.{name} is {getattr(self, name)}")
        for name in self.lengths:
            if getattr(self, name) <= 0:
                raise AnalysisError(f"{name} must be positive, got {getattr(self, name):g}")
        if self.branch not in (1, -1):
            raise AnalysisError(f"branch is 1 or -1, got {self.branch!r}")

    @classmethod
    def names(cls) -> tuple[str, ...]:
        """Dimensions, without the branch."""
        return tuple(f.name for f in fields(cls) if f.name != "branch")

    @property
    def numbers(self) -> dict[str, float]:
        """Dimension → value."""
        return {name: float(getattr(self, name)) for name in self.names()}

    # interface of linkages --------------------------------------------------------------
    @staticmethod
    @abstractmethod
    def closed(q: Numbers, branch: ca.SX, theta: ca.SX) -> tuple[Direction, Direction | ca.SX]:
        """Direction of the coupler, and direction of the follower or position of the slider.

        If the loop is open, those of the nearest closed loop.
        """

    @staticmethod
    @abstractmethod
    def closure_conditions(q: Numbers, theta: ca.SX, least: float) -> list[ca.SX]:
        """Nonnegative if the loop closes with a transmission angle of at least ``least`` [rad]."""

    @staticmethod
    @abstractmethod
    def transmission_sine(q: Numbers, phi: Any, output: Any) -> Any:
        """Sine of the transmission angle, with the sign of the branch."""

    @staticmethod
    @abstractmethod
    def rotation_conditions(q: Numbers, least: float) -> list[ca.SX]:
        """Nonnegative if the crank rotates fully with a transmission angle of at least ``least``
        [rad]."""

    @staticmethod
    @abstractmethod
    def loop(
        q: Numbers, branch: float | np.ndarray, theta: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Angle of the coupler and output at crank angles; NaN if the loop is open."""

    @classmethod
    @abstractmethod
    def fitted_dimensions(cls, theta: np.ndarray, output: np.ndarray) -> dict[str, np.ndarray]:
        """Dimensions (k,) for unit frame from outputs (k, n) at crank angles (k, n).

        Least squares of the loop equation with the coupler angle eliminated, which is linear in
        three coefficients: exact for three entries. Lengths that are not real are NaN.
        """

    @classmethod
    @abstractmethod
    def random_dimensions(cls, rng: np.random.Generator, count: int) -> dict[str, np.ndarray]:
        """Random linkages of unit size with fully rotating cranks."""

    @staticmethod
    @abstractmethod
    def circuits(q: Numbers, theta: np.ndarray, phi: np.ndarray, output: np.ndarray) -> np.ndarray:
        """Circuit of each position, ±1; 0 if all positions are on one circuit."""

    @abstractmethod
    def joints(self, theta: float) -> np.ndarray:
        """Complex positions of pivots, pins and coupler point, starting with the crank."""

    @abstractmethod
    def system(self, name: str = "linkage", speed: float = 1.0) -> System:
        """The mechanism with its crank driven at constant speed [rad/s]; parameters are the
        dimensions, ``coupler.P`` is the coupler point."""

    def parameters(self, system: System) -> dict[str, Parameter]:
        """The dimensions as parameters of a system."""
        names = {"x": "pivot_x", "y": "pivot_y", "u": "point_u", "v": "point_v"}
        parameters = {}
        for name, value in self.numbers.items():
            full_name = names.get(name) or ("frame_angle" if name == "angle" else f"{name}_length")
            parameters[name] = system.parameter(full_name, value, "rad" if name == "angle" else "m")
        return parameters

    # derived quantities --------------------------------------------------------------------
    @classmethod
    def points(cls, q: Numbers, branch: float | np.ndarray, theta: np.ndarray) -> np.ndarray:
        """Coupler points as complex numbers."""
        phi, _ = cls.loop(q, branch, theta)
        pin = q["x"] + 1j * q["y"] + q["crank"] * np.exp(1j * theta)
        return pin + (q["u"] + 1j * q["v"]) * np.exp(1j * phi)

    def path(self, theta: ArrayLike) -> np.ndarray:
        """(n, 2) positions of the coupler point at crank angles."""
        z = self.points(self.numbers, self.branch, np.asarray(theta, dtype=float))
        return np.stack([z.real, z.imag], axis=-1)

    def coupler_angle(self, theta: ArrayLike) -> np.ndarray:
        """``φ`` at crank angles."""
        return self.loop(self.numbers, self.branch, np.asarray(theta, dtype=float))[0]

    def output(self, theta: ArrayLike) -> np.ndarray:
        """Follower angle or slider position at crank angles."""
        return self.loop(self.numbers, self.branch, np.asarray(theta, dtype=float))[1]

    @property
    def crank_turns(self) -> bool:
        """Whether the crank rotates fully."""
        return all(float(ca.DM(g)) >= -1e-12 for g in self.rotation_conditions(self.numbers, 0.0))

    def transmission(self, theta: ArrayLike | None = None) -> float:
        """Minimum transmission angle [rad] at crank angles, by default over one revolution."""
        turn = np.linspace(0, 2 * np.pi, 721) + self.angle if theta is None else theta
        phi, output = self.loop(self.numbers, self.branch, np.asarray(turn, dtype=float))
        sine = np.array(self.transmission_sine(self.numbers, ca.DM(phi), ca.DM(output)))
        return float(np.arcsin(np.clip(np.min(sine * self.branch), -1, 1)))

    def scaled(self, size: float, at: complex = 0.0) -> Self:
        """The linkage with all lengths multiplied by ``size``, then translated."""
        free = {n: v * size for n, v in self.numbers.items() if n != "angle"}
        free["x"], free["y"] = free["x"] + at.real, free["y"] + at.imag
        return type(self)(**{**self.numbers, **free}, branch=self.branch)


def least_squares(rows: np.ndarray, right: np.ndarray) -> np.ndarray:
    """(3, k) solutions of many systems ``(k, n, 3)``."""
    return np.asarray((np.linalg.pinv(rows) @ right[..., None])[..., 0]).T
