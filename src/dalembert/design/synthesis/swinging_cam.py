"""Disc cams with oscillating followers.

The pivot is at ``x = distance``, the cam rotates counterclockwise about the origin by ``θ``, and
``ψ = ψ_0 + s(θ)`` is the angle between the line from the pivot to the cam and the arm.
Source: R. L. Norton, *Cam Design and Manufacturing Handbook*, ch. 7; J. E. Shigley, J. J. Uicker,
*Theory of Machines and Mechanisms*, ch. 5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.synthesis.cam import Cam, RolledCam
from dalembert.elements.laws.base import GivenLaw
from dalembert.errors import AnalysisError
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True, eq=False, kw_only=True)
class SwingingRollerCam(RolledCam):
    """Oscillating follower with a roller at the end of its arm.

    ``p = c − a e^{−iψ}`` with the arm a and the distance c of the pivot; ``|p| = R + r`` at the
    start. The pressure angle is ``atan((a (1 + ψ') − c cos ψ)/(c sin ψ))``.

    Parameters
    ----------
    arm : distance of the roller centre from the pivot [m]
    distance : distance of the pivot from the cam axis [m]
    roller_radius : ``r`` [m]

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> import dalembert as da
    >>> swing = da.CycloidalRise(height=0.2, duration=2.0, fall=2.0, period=2 * math.pi)
    >>> sizes = dict(base_radius=0.04, roller_radius=0.01, arm=0.1, distance=0.12)
    >>> cam = da.SwingingRollerCam(law=swing, **sizes)
    >>> np.linalg.norm(cam.pitch([0.0]), axis=1).round(6), cam.undercut()  # R + r
    (array([0.05]), False)
    """

    arm: float
    distance: float

    def __post_init__(self) -> None:
        super().__post_init__()
        reach = self.base_radius + self.roller_radius
        if self.roller_radius < 0 or not abs(self.distance - self.arm) < reach:
            raise AnalysisError(
                f"an arm of {self.arm:g} at a distance of {self.distance:g} does not bring its "
                f"roller, of radius {self.roller_radius:g}, to the base circle, "
                f"{self.base_radius:g}"
            )
        if reach >= self.distance + self.arm:
            raise AnalysisError(
                f"the base circle, {self.base_radius:g}, is out of reach of the arm"
            )
        highest = self.start + float(self.lift(self.turn)[0].max())
        if highest >= math.pi:
            raise AnalysisError(f"the arm would swing through the pivot line, to {highest:.3g} rad")

    @cached_property
    def start(self) -> float:
        """``ψ_0`` [rad]."""
        a, c, reach = self.arm, self.distance, self.base_radius + self.roller_radius
        return math.acos((c**2 + a**2 - reach**2) / (2 * c * a))

    def centre(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        s, rate, second = self.lift(theta)
        arm = self.arm * np.exp(-1j * (self.start + s))
        return self.distance - arm, 1j * rate * arm, (1j * second + rate**2) * arm

    def direction(self, theta: np.ndarray) -> np.ndarray:
        return 1j * np.exp(-1j * (self.start + self.lift(theta)[0]))

    @classmethod
    @check_arguments
    def smallest(
        cls,
        law: GivenLaw,
        pressure_angle: float,
        arm: float,
        roller_radius: float = 0.0,
        minimum_radius: float = 0.0,
    ) -> Self:
        """Cam with the smallest base circle, and its pivot distance, for a maximum pressure angle
        [rad] and a minimum radius of curvature ``minimum_radius`` of convex parts of the profile.

        Raises
        ------
        AnalysisError
            The angle is not between 0 and π/2, or no cam with this arm satisfies it.
        """
        from scipy.optimize import minimize_scalar

        if not 0 < pressure_angle < math.pi / 2:
            raise AnalysisError(f"the pressure angle is between 0 and π/2, got {pressure_angle:g}")
        limits = _Limits(cls, law, pressure_angle, arm, roller_radius, minimum_radius)
        distances = np.linspace(0.4, 2.5, 64) * arm
        sizes = [limits.size(c) for c in distances]
        k = int(np.argmin(sizes))
        if not np.isfinite(sizes[k]):
            raise AnalysisError(
                f"no cam has a pressure angle below {pressure_angle:g} with an arm of {arm:g}; "
                "give a longer arm or a larger angle"
            )
        ends = distances[max(k - 1, 0)], distances[min(k + 1, distances.size - 1)]
        result = minimize_scalar(
            lambda c: min(limits.size(c), 1e3 * arm),
            bounds=ends,
            method="bounded",
            options={"xatol": 1e-5 * arm},
        )
        distance = float(result.x) if result.fun <= sizes[k] else float(distances[k])
        return cls(
            law=law,
            base_radius=limits.size(distance),
            arm=arm,
            distance=distance,
            roller_radius=roller_radius,
        )


class _Limits:
    """Limits of the smallest cam, vectorised over initial angles of the arm."""

    def __init__(
        self,
        kind: type[SwingingRollerCam],
        law: GivenLaw,
        pressure_angle: float,
        arm: float,
        roller: float,
        least: float,
    ):
        unit = kind(law=law, base_radius=arm, arm=arm, distance=arm)
        self.motion = unit.lift(unit.turn[::2])
        self.tangent, self.arm, self.roller = math.tan(pressure_angle), arm, roller
        self.pitch = roller + least

    def size(self, distance: float) -> float:
        """Smallest base radius for a pivot distance; infinite if none satisfies the limits."""
        low, high = 0.01, math.pi - 0.05 - float(self.motion[0].max())
        for _ in range(5):  # first feasible angle by successive refinement
            starts = np.linspace(low, high, 41)
            feasible = self._feasible(distance, starts)
            if not feasible.any():
                return math.inf
            k = int(np.argmax(feasible))
            low, high = starts[max(k - 1, 0)], starts[k]
        a, c = self.arm, distance
        return math.sqrt(a**2 + c**2 - 2 * a * c * math.cos(high)) - self.roller

    def _feasible(self, c: float, starts: np.ndarray) -> np.ndarray:
        """(n,) whether pressure angle and curvature satisfy the limits for initial angles."""
        s, rate, second = self.motion
        a, psi = self.arm, starts[:, None] + s
        tangent = (a * (1 + rate) - c * np.cos(psi)) / (c * np.sin(psi))
        arm = a * np.exp(-1j * psi)
        pitch_tangent = 1j * (rate * arm - (c - arm))
        pitch_curvature = (1j * second + rate**2) * arm + 2 * rate * arm - (c - arm)
        with np.errstate(divide="ignore"):
            pitch = abs(pitch_tangent) ** 3 / -(pitch_tangent.conj() * pitch_curvature).imag
        curvature_ok = np.where(pitch > 0, pitch, np.inf).min(axis=1) >= self.pitch * (1 + 1e-9)
        reach = np.sqrt(a**2 + c**2 - 2 * a * c * np.cos(starts))
        return (abs(tangent).max(axis=1) <= self.tangent) & curvature_ok & (reach > self.roller)


@dataclass(frozen=True, eq=False, kw_only=True)
class SwingingFlatCam(Cam):
    """Oscillating flat-faced follower; the face is parallel to the arm, ``offset`` to the cam.

    The distance of the face from the cam axis is ``H = c sin ψ − f``, in a direction rotated by
    ``ψ + θ``: the profile is ``e^{−i(ψ+θ)} (c cos ψ ψ'/(1 + ψ') + i H)``.

    Parameters
    ----------
    distance : distance of the pivot from the cam axis [m]
    offset : distance of the face from the pivot, towards the cam [m]

    Examples
    --------
    >>> import math
    >>> import numpy as np
    >>> import dalembert as da
    >>> swing = da.CycloidalRise(height=0.2, duration=2.0, fall=2.0, period=2 * math.pi)
    >>> cam = da.SwingingFlatCam(law=swing, base_radius=0.04, distance=0.12)
    >>> radii = np.linalg.norm(cam.profile([0.0, 2.0]), axis=1)
    >>> radii.round(6), round(0.12 * math.sin(math.asin(1 / 3) + 0.2), 6)  # R, c sin ψ
    (array([0.04   , 0.06168]), 0.06168)
    """

    distance: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.base_radius + self.offset < self.distance:
            raise AnalysisError(
                f"a pivot at a distance of {self.distance:g} and a face offset by {self.offset:g} "
                f"do not touch the base circle, {self.base_radius:g}"
            )
        s, rate, _ = self.lift(self.turn)
        if self.start + float(s.max()) >= math.pi / 2:
            raise AnalysisError("the face would swing beyond the perpendicular to the pivot line")
        if float(rate.min()) <= -1:
            raise AnalysisError("the follower falls as fast as the cam turns; give it more time")

    @cached_property
    def start(self) -> float:
        """``ψ_0`` [rad]."""
        return math.asin((self.base_radius + self.offset) / self.distance)

    def profile(self, theta: ArrayLike | None = None) -> np.ndarray:
        angles = self._angles(theta)
        s, rate, _ = self.lift(angles)
        psi = self.start + s
        tangential = self.distance * np.cos(psi) * rate / (1 + rate)
        height = self.distance * np.sin(psi) - self.offset
        z = np.exp(-1j * (psi + angles)) * (tangential + 1j * height)
        return np.stack([z.real, z.imag], axis=-1)

    def radius(self, theta: ArrayLike | None = None) -> np.ndarray:
        """``ρ = H + d²H/dβ²`` with ``β = ψ + θ``."""
        s, rate, second = self.lift(self._angles(theta))
        psi, c, speed = self.start + s, self.distance, 1 + rate
        derivative = c * np.cos(psi) * second / speed**2 - c * np.sin(psi) * rate**2 / speed
        return c * np.sin(psi) - self.offset + derivative / speed

    def undercut(self) -> bool:
        return bool(self.radius().min() <= 0)

    def contact(self, theta: ArrayLike | None = None) -> np.ndarray:
        """(n,) position of the contact on the face, from the foot of the pivot [m]."""
        s, rate, _ = self.lift(self._angles(theta))
        return self.distance * np.cos(self.start + s) / (1 + rate)

    def pressure_angle(self, theta: ArrayLike | None = None) -> np.ndarray:
        return np.arctan2(self.offset, self.contact(theta))

    @property
    def face(self) -> tuple[float, float]:
        """Range of the contact on the face, from the foot of the pivot [m]."""
        positions = self.contact()
        return float(positions.min()), float(positions.max())
