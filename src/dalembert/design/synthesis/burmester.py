"""Burmester dyads: points of a moving plane that stay on a circle, or on a line, in given poses.

A point ``w`` of the plane is at ``A_j = P_j + R_j w`` in pose j. It stays at one distance from a
centre ``C`` where

    |P_j|² + 2 Re(P̄_j R_j w) − 2 Re(C̄ (P_j + (R_j − 1) w)) = 0,   P_0 = 0, R_0 = 1,

one equation ``M_j(w) (C_x, C_y, 1) = 0`` for each further pose. Five poses leave up to four points,
four poses a cubic curve of them, three poses every point. A centre at infinity is a line: a slider.
Source: O. Bottema, B. Roth, *Theoretical Kinematics* (1979), ch. 8; J. M. McCarthy, G. S. Soh,
*Geometric Design of Linkages* (2011), ch. 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError

FAR = 1e4
"""Distance of a centre, in sizes of the poses, from which its circle counts as a line."""
RANK = 1e-7
"""Relative singular value up to which the equations of a point have a centre."""
SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Dyad:
    """A point of the moving plane and the centre of its circle, or the direction of its line.

    Attributes
    ----------
    point : of the moving plane, in the first pose, complex
    center : of its circle; None for a line
    direction : of its line [rad]; 0 for a circle
    places : (n,) of the point in all poses, complex
    """

    point: complex
    center: complex | None
    direction: float
    places: np.ndarray

    @property
    def is_slider(self) -> bool:
        """Whether the point moves on a line."""
        return self.center is None

    @property
    def residual(self) -> float:
        """Largest deviation from the circle or the line."""
        if self.center is None:
            off = np.imag((self.places - self.places[0]) * np.exp(-1j * self.direction))
            return float(np.max(abs(off)))
        radii = abs(self.places - self.center)
        return float(np.ptp(radii))


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of a plane relative to the first, in units of their size.

    Attributes
    ----------
    P, R : (n,) displacements and rotations as complex numbers
    size, at : unit of length and origin
    """

    P: np.ndarray
    R: np.ndarray
    size: float
    at: complex

    @classmethod
    def of(cls, points: Any, angles: Any) -> Poses:
        """Checked poses.

        Raises
        ------
        AnalysisError
            Not two to five of them, or two that are one.
        """
        z, alpha = np.asarray(points, dtype=float), np.asarray(angles, dtype=float)
        if z.ndim != 2 or z.shape[1] != 2 or alpha.shape != (len(z),):
            raise AnalysisError("points are (n, 2) and angles (n,), one for each pose")
        if not 2 <= len(z) <= 5:
            raise AnalysisError(f"two to five poses have exact linkages, got {len(z)}")
        if not (np.all(np.isfinite(z)) and np.all(np.isfinite(alpha))):
            raise AnalysisError("poses must be finite")
        place, turned = z[:, 0] + 1j * z[:, 1], np.exp(1j * (alpha - alpha[0]))
        size = float(np.max(abs(place - place[0]))) or 1.0
        P = (place - place[0]) / size
        for i, j in combinations(range(len(z)), 2):
            if abs(P[i] - P[j]) + abs(turned[i] - turned[j]) < 1e-9:
                raise AnalysisError(f"poses {i + 1} and {j + 1} are one; give poses apart")
        return cls(P, turned, size, complex(place[0]))

    def rows(self, w: complex) -> np.ndarray:
        """(n − 1, 3) equations of the centre of a point, homogeneous."""
        P, R = self.P[1:], self.R[1:]
        moved = P + (R - 1) * w
        free = abs(P) ** 2 + 2 * np.real(np.conj(P) * R * w)
        return np.stack([-2 * moved.real, -2 * moved.imag, free], axis=1)

    def dyad(self, w: complex) -> Dyad | None:
        """The dyad of a point; None where its equations have no centre."""
        rows = self.rows(w)
        # with two rows or less there is always a centre: the nearest one
        _, sizes, frames = np.linalg.svd(rows, full_matrices=True)
        if len(sizes) > 2 and sizes[2] > RANK * sizes[0]:
            return None
        x, y, scale = frames[2]
        places = self.at + self.size * (self.P + self.R * w)
        point = self.at + self.size * w
        if abs(scale) * FAR <= np.hypot(x, y):
            return Dyad(point, None, float(np.arctan2(x, -y)), places)
        return Dyad(point, self.at + self.size * complex(x, y) / scale, 0.0, places)


def five_poses(poses: Poses) -> list[complex]:
    """All real points with five places on a circle, by elimination.

    The 3 × 3 minors of ``M`` vanish together. In isotropic coordinates ``w, w̄`` a combination of
    minors is quadratic in ``w`` with quadratic coefficients in ``w̄``. The resultant of two such
    combinations is a polynomial eigenvalue problem of size four; Newton steps and the rank of all
    equations remove what is extraneous.
    """
    generator = np.random.default_rng(0)
    first, second = (_combined(poses, generator) for _ in range(2))
    roots = [w for w in _common_roots(first, second) if np.isfinite(w)]
    found: list[complex] = []
    for w in roots:
        z = _polished(poses, w)
        if z is not None and not any(abs(z - other) < SAME * (1 + abs(z)) for other in found):
            found.append(z)
    return sorted(found, key=lambda z: (z.real, z.imag))


def _combined(poses: Poses, generator: np.random.Generator) -> np.ndarray:
    """(3, 3) coefficients of ``w^i w̄^k`` of the determinant of three mixed equations."""
    mixed = generator.normal(size=(3, 4))
    P, R = poses.P[1:], poses.R[1:]
    # columns of the centre in isotropic coordinates: c̄ (1, w), c (1, w̄), and the free one
    w_column = mixed @ np.stack([-P, -(R - 1)], axis=1)
    bar_column = mixed @ np.stack([-np.conj(P), -(np.conj(R) - 1)], axis=1)
    free = mixed @ np.stack([abs(P) ** 2, np.conj(P) * R, P * np.conj(R)], axis=1)
    sampled = np.exp(2j * np.pi * np.arange(3) / 3)
    values = np.empty((3, 3), dtype=complex)
    for i, w in enumerate(sampled):
        for k, bar in enumerate(sampled):
            columns = (
                w_column @ [1, w],
                bar_column @ [1, bar],
                free @ [1, w, bar],
            )
            values[i, k] = np.linalg.det(np.stack(columns, axis=1))
    # degrees are at most two in each: interpolation at roots of unity
    return np.asarray(np.fft.fft2(values) / 9)


def _common_roots(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """``w`` of the common roots of two quadratics whose coefficients are quadratic in ``w̄``."""
    from scipy.linalg import eig

    sylvester = np.zeros((3, 4, 4), dtype=complex)
    for power in range(3):
        for row, one in enumerate((p, q)):
            for shift in (0, 1):
                sylvester[power, 2 * shift + row, shift : shift + 3] = one[:, power]
    zero, unit = np.zeros((4, 4)), np.eye(4)
    left = np.block([[zero, unit], [-sylvester[0], -sylvester[1]]])
    right = np.block([[unit, zero], [zero, sylvester[2]]])
    vectors = eig(left, right)[1]
    powers = vectors[:4]  # of 1, w, w², w³
    at = np.argmax(abs(powers[:3]), axis=0)
    each = np.arange(powers.shape[1])
    with np.errstate(all="ignore"):
        return np.asarray(powers[at + 1, each] / powers[at, each])


def _polished(poses: Poses, w: complex) -> complex | None:
    """The point to which Newton's method leads from a root; None where it is not real."""
    if abs(w) > FAR:
        return None
    center = np.linalg.svd(poses.rows(w))[2][2]
    z = np.array([w.real, w.imag, *center])
    for _ in range(12):
        rows = poses.rows(complex(z[0], z[1]))
        # slopes of the rows by the two coordinates of the point: they are linear in it
        slopes = [poses.rows(complex(z[0] + dx, z[1] + dy)) - rows for dx, dy in ((1, 0), (0, 1))]
        residual = np.append(rows @ z[2:], z[2:] @ z[2:] - 1)
        jacobian = np.zeros((5, 5))
        jacobian[:4, 0], jacobian[:4, 1] = slopes[0] @ z[2:], slopes[1] @ z[2:]
        jacobian[:4, 2:], jacobian[4, 2:] = rows, 2 * z[2:]
        step = np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        z = z - step
    found = complex(z[0], z[1])
    if not np.all(np.isfinite(z)) or abs(found - w) > 1e-3 * (1 + abs(w)):
        return None
    return found if np.max(abs(step)) < 1e-9 * (1 + abs(found)) else None


def four_poses(poses: Poses, samples: int) -> list[complex]:
    """Points of the cubic of circle points, on lines of a grid over the poses."""
    reach = np.linspace(-2.0, 2.0, max(samples // 2, 1))
    found = []
    for level in reach:
        for turn in (1.0, 1j):
            nodes = np.array([-1.5, -0.5, 0.5, 1.5])
            values = [_determinant(poses, turn * complex(level, x)) for x in nodes]
            roots = np.roots(np.polyfit(nodes, values, 3))
            real = roots[abs(roots.imag) < SAME].real
            found += [turn * complex(level, x) for x in real if abs(x) < 10]
    return found


def _determinant(poses: Poses, w: complex) -> float:
    return float(np.linalg.det(poses.rows(w)))


def burmester_dyads(points: Any, angles: Any, samples: int = 24) -> list[Dyad]:
    """Dyads that guide a plane through two to five poses exactly.

    Five poses have up to four dyads, all of which are returned. Of four poses samples of the
    circle-point curve are returned, of three and two poses samples of the plane.

    Parameters
    ----------
    points : (n, 2) of a point of the plane in each pose
    angles : (n,) of the plane [rad]
    samples : of the dyads of less than five poses, about

    Raises
    ------
    AnalysisError
        Not two to five poses, or two that are one.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.2, u=0.5, v=0.6)
    >>> turn = [0.2, 0.9, 1.7, 2.6, 3.4]
    >>> dyads = da.burmester_dyads(bar.path(turn), bar.coupler_angle(turn))
    >>> sorted(round(abs(one.center), 6) for one in dyads)[:2]  # both pivots of the four-bar
    [0.0, 1.2]
    """
    poses = Poses.of(points, angles)
    count = len(poses.P)
    if count == 5:
        chosen = five_poses(poses)
    elif count == 4:
        chosen = four_poses(poses, samples)
    else:
        side = np.linspace(-1.5, 1.5, max(int(np.ceil(np.sqrt(samples))), 2))
        chosen = [complex(x, y) for x in side for y in side]
    found = (poses.dyad(w) for w in chosen)
    size = poses.size
    return [one for one in found if one is not None and one.residual < 1e-6 * size]
