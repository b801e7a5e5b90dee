"""Disc cams with translating followers.

The cam rotates counterclockwise by ``θ``; the follower translates along y, at ``x = offset``, by
``s(θ)``.
Source: R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 7.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from dalembert.elements.laws.base import GivenLaw, as_law
from dalembert.errors import AnalysisError
from dalembert.text.arguments import check_arguments

SAMPLES = 1441
"""Number of angles per revolution."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cam(ABC):
    """Base class of disc cams.

    Parameters
    ----------
    law : motion of the follower over the cam angle, which replaces time; a law, or a formula in t
    base_radius : radius of the base circle, the contact radius at zero lift [m]
    """

    law: GivenLaw
    base_radius: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.base_radius) and self.base_radius > 0):
            raise AnalysisError(f"base_radius must be positive, got {self.base_radius!r:.30}")

    @cached_property
    def _lift(self) -> ca.Function:
        time = ca.SX.sym("t")
        s = as_law(self.law, "law").value(time)
        if ca.symvar(ca.substitute(s, time, 0)):
            raise AnalysisError("the law of a cam contains parameters; replace them by numbers")
        rate = ca.gradient(s, time)
        return ca.Function("lift", [time], [s, rate, ca.gradient(rate, time)])

    def lift(self, theta: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``s`` and its first two derivatives by the cam angle."""
        angles = np.asarray(theta, dtype=float)
        rows = self._lift.map(angles.size)(angles.reshape(1, -1))
        s, rate, second = (np.array(row).reshape(angles.shape) for row in rows)
        return s, rate, second

    @property
    def turn(self) -> np.ndarray:
        """Angles of one revolution."""
        return np.linspace(0, 2 * np.pi, SAMPLES)

    @abstractmethod
    def profile(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n, 2) contact points at cam angles, in the frame of the cam."""

    @abstractmethod
    def radius(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n,) radius of curvature of the profile, negative if concave [m]."""

    @abstractmethod
    def undercut(self) -> bool:
        """Whether the profile is undercut."""

    def pressure_angle(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n,) angle between the force on the follower and its direction of motion [rad]."""
        return np.zeros(np.shape(self._angles(theta)))

    def _angles(self, theta: ArrayLike | None) -> np.ndarray:
        return self.turn if theta is None else np.asarray(theta, dtype=float)


def _plane(z: np.ndarray) -> np.ndarray:
    return np.stack([z.real, z.imag], axis=-1)


@dataclass(frozen=True, eq=False, kw_only=True)
class FlatFaceCam(Cam):
    """Flat-faced follower, perpendicular to its motion: ``P = e^{−iθ}(s' + i (R + s))``.

    Parameters
    ----------
    law : lift [m] over the cam angle [rad], a Law or a formula in ``da.t``
    base_radius : ``R`` [m]

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> import dalembert as da
    >>> lift = da.CycloidalRise(height=0.01, duration=2.0, fall=2.0, period=2 * math.pi)
    >>> cam = da.FlatFaceCam(law=lift, base_radius=0.04)
    >>> np.linalg.norm(cam.profile([0.0, 2.0]), axis=1).round(6)  # base circle, with the lift added
    array([0.04, 0.05])
    >>> [round(side * 1e3, 3) for side in cam.face]  # ± s' = 2 h/2 [mm]: half its face
    [-10.0, 10.0]
    """

    def profile(self, theta: ArrayLike | None = None) -> np.ndarray:
        angles = self._angles(theta)
        s, rate, _ = self.lift(angles)
        return _plane(np.exp(-1j * angles) * (rate + 1j * (self.base_radius + s)))

    def radius(self, theta: ArrayLike | None = None) -> np.ndarray:
        """``ρ = R + s + s''``."""
        s, _, second = self.lift(self._angles(theta))
        return self.base_radius + s + second

    def undercut(self) -> bool:
        return bool(self.radius().min() <= 0)

    @property
    def face(self) -> tuple[float, float]:
        """Range of the contact point on either side of the follower axis [m]."""
        rate = self.lift(self.turn)[1]
        return float(rate.min()), float(rate.max())

    @classmethod
    @check_arguments
    def smallest(cls, law: GivenLaw, minimum_radius: float) -> Self:
        """Cam with the smallest base circle for a minimum radius of curvature [m]."""
        unit = cls(law=law, base_radius=1.0)
        curvature_limit = 1.0 + minimum_radius - float(unit.radius().min())
        lift_limit = -float(unit.lift(unit.turn)[0].min()) + minimum_radius
        return cls(law=law, base_radius=max(curvature_limit, lift_limit, minimum_radius))


@dataclass(frozen=True, eq=False, kw_only=True)
class RolledCam(Cam):
    """Base class of cams with a roller follower.

    With the roller centre ``p(θ)`` in the complex plane, the pitch curve is ``e^{−iθ} p`` in the
    frame of the cam; its derivatives, without the rotation, are ``p' − i p`` and
    ``p'' − 2i p' − p``.
    """

    roller_radius: float = 0.0

    @abstractmethod
    def centre(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``p`` and its first two derivatives by the cam angle."""

    @abstractmethod
    def direction(self, theta: np.ndarray) -> np.ndarray:
        """Direction of motion of the roller centre for a rising follower."""

    def pitch(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n, 2) positions of the roller centre in the frame of the cam."""
        angles = self._angles(theta)
        return _plane(np.exp(-1j * angles) * self.centre(angles)[0])

    def profile(self, theta: ArrayLike | None = None) -> np.ndarray:
        angles = self._angles(theta)
        position, tangent = self.centre(angles)[0], self._tangent(angles)
        inward = -1j * tangent / abs(tangent)
        return _plane(np.exp(-1j * angles) * (position + self.roller_radius * inward))

    def _tangent(self, angles: np.ndarray) -> np.ndarray:
        position, rate, _ = self.centre(angles)
        return rate - 1j * position

    def pressure_angle(self, theta: ArrayLike | None = None) -> np.ndarray:
        angles = self._angles(theta)
        return np.angle(1j * self._tangent(angles) / self.direction(angles))

    def pitch_radius(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n,) radius of curvature of the pitch curve [m]."""
        angles = self._angles(theta)
        position, rate, second = self.centre(angles)
        tangent, curvature = rate - 1j * position, second - 2j * rate - position
        with np.errstate(divide="ignore"):  # the cam lies on the right of the curve
            return abs(tangent) ** 3 / -(tangent.conj() * curvature).imag

    def radius(self, theta: ArrayLike | None = None) -> np.ndarray:
        return self.pitch_radius(theta) - self.roller_radius

    def undercut(self) -> bool:
        pitch = self.pitch_radius()
        return bool(np.any((pitch > 0) & (pitch <= self.roller_radius)))


@dataclass(frozen=True, eq=False, kw_only=True)
class RollerCam(RolledCam):
    """Translating follower with a roller of radius ``r`` and an offset ``e``.

    ``p = e + i h``, ``h = √((R + r)² − e²) + s``; the pressure angle is ``atan((s' − e)/h)``. For
    ``r = 0`` it is a knife-edge follower.

    Parameters
    ----------
    law : lift [m] over the cam angle [rad], a Law or a formula in ``da.t``
    base_radius : ``R`` [m]
    roller_radius : ``r`` [m]
    offset : ``e``, distance of the follower axis from the cam axis [m]

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> lift = da.CycloidalRise(height=0.01, duration=2.0, fall=2.0, period=2 * math.pi)
    >>> cam = da.RollerCam(law=lift, base_radius=0.04, roller_radius=0.01)
    >>> round(math.tan(cam.pressure_angle(1.0)) * 5.5, 6)  # s'/(R + r + s) = 1/5.5
    1.0
    >>> cam.undercut()
    False
    """

    offset: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.roller_radius < 0 or abs(self.offset) >= self.base_radius + self.roller_radius:
            raise AnalysisError(
                f"the roller, of radius {self.roller_radius:g}, and its offset {self.offset:g} do "
                f"not fit the base circle, {self.base_radius:g}"
            )

    @property
    def _height(self) -> float:
        return math.sqrt((self.base_radius + self.roller_radius) ** 2 - self.offset**2)

    def centre(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        s, rate, second = self.lift(theta)
        return self.offset + 1j * (self._height + s), 1j * rate, 1j * second

    def direction(self, theta: np.ndarray) -> np.ndarray:
        return np.full(theta.shape, 1j)

    @classmethod
    @check_arguments
    def smallest(
        cls,
        law: GivenLaw,
        pressure_angle: float,
        roller_radius: float = 0.0,
        minimum_radius: float = 0.0,
    ) -> RollerCam:
        """Cam with the smallest base circle, and its offset, for a maximum pressure angle [rad] and
        a minimum radius of curvature ``minimum_radius`` of convex parts of the profile [m].

        Raises
        ------
        AnalysisError
            The angle is not between 0 and π/2.
        """
        from scipy.optimize import minimize_scalar

        if not 0 < pressure_angle < math.pi / 2:
            raise AnalysisError(f"the pressure angle is between 0 and π/2, got {pressure_angle:g}")
        unit = cls(law=law, base_radius=1.0)
        s, rate, _ = unit.lift(unit.turn)
        slope = math.tan(pressure_angle)

        def cam_at(offset: float) -> RollerCam:
            height = max(float(np.max(abs(rate - offset) / slope - s)), 1e-9 - float(s.min()))
            pitch = max(math.hypot(height, offset), roller_radius * (1 + 1e-9) + 1e-12)
            cam = cls(
                law=law,
                base_radius=pitch - roller_radius or 1e-12,
                roller_radius=roller_radius,
                offset=offset,
            )
            for _ in range(200):
                pitched = cam.pitch_radius()
                convex = pitched[pitched > 0]
                if not convex.size or convex.min() >= roller_radius + minimum_radius:
                    break
                cam = replace(
                    cam, base_radius=(cam.base_radius + roller_radius) * 1.02 - roller_radius
                )
            return cam

        best = minimize_scalar(
            lambda offset: cam_at(offset).base_radius,
            bounds=(float(rate.min()), float(rate.max())),
            method="bounded",
            options={"xatol": 1e-6 * float(np.ptp(rate) or 1.0)},
        )
        return cam_at(float(best.x))
