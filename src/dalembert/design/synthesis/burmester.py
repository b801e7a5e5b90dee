"""Burmester dyads: points of a moving plane that lie on a circle or a line in all poses.

A point ``w`` of the plane is at ``A_j = P_j + R_j w`` in pose j. Its distance from a centre ``C``
is constant if

    |P_j|² + 2 Re(P̄_j R_j w) − 2 Re(C̄ (P_j + (R_j − 1) w)) = 0,   P_0 = 0, R_0 = 1,

one equation ``M_j(w) (C_x, C_y, 1) = 0`` for each pose after the first. Five poses have up to four
such points, four poses a cubic curve, three poses all points. A centre at infinity is a slider.
Source: O. Bottema, B. Roth, *Theoretical Kinematics* (1979), ch. 8; J. M. McCarthy, G. S. Soh,
*Geometric Design of Linkages* (2011), ch. 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import AnalysisError

FAR = 1e4
"""Threshold for a line instead of a circle: distance of the centre, in sizes of the poses."""
RANK = 1e-7
"""Upper limit of the relative singular value of equations with a centre."""
SAME = 1e-6
"""Threshold for equal points, relative to their size."""


@dataclass(frozen=True, eq=False)
class Dyad:
    """A point of the moving plane with the centre of its circle, or the direction of its line.

    Attributes
    ----------
    point : point of the moving plane in the first pose, complex
    center : centre of its circle; None for a line
    direction : direction of its line [rad]; 0 for a circle
    places : (n,) positions of the point in all poses, complex
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
            distances = np.imag((self.places - self.places[0]) * np.exp(-1j * self.direction))
            return float(np.max(abs(distances)))
        radii = abs(self.places - self.center)
        return float(np.ptp(radii))


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses of a plane relative to the first, scaled by their size.

    Attributes
    ----------
    P, R : (n,) displacements and rotations as complex numbers
    size, at : length scale and origin
    """

    P: np.ndarray
    R: np.ndarray
    size: float
    at: complex

    @classmethod
    def of(cls, points: ArrayLike, angles: ArrayLike) -> Poses:
        """Poses from points and angles.

        Raises
        ------
        AnalysisError
            There are not two to five poses, or two poses are equal.
        """
        coordinates, alpha = np.asarray(points, dtype=float), np.asarray(angles, dtype=float)
        if coordinates.ndim != 2 or coordinates.shape[1] != 2 or alpha.shape != (len(coordinates),):
            raise AnalysisError("points are (n, 2) and angles (n,), one for each pose")
        if not 2 <= len(coordinates) <= 5:
            raise AnalysisError(f"two to five poses have exact linkages, got {len(coordinates)}")
        if not (np.all(np.isfinite(coordinates)) and np.all(np.isfinite(alpha))):
            raise AnalysisError("poses must be finite")
        positions, rotations = (
            coordinates[:, 0] + 1j * coordinates[:, 1],
            np.exp(1j * (alpha - alpha[0])),
        )
        size = float(np.max(abs(positions - positions[0]))) or 1.0
        P = (positions - positions[0]) / size
        for i, j in combinations(range(len(coordinates)), 2):
            if abs(P[i] - P[j]) + abs(rotations[i] - rotations[j]) < 1e-9:
                raise AnalysisError(f"poses {i + 1} and {j + 1} are equal; give distinct poses")
        return cls(P, rotations, size, complex(positions[0]))

    def rows(self, w: complex) -> np.ndarray:
        """(n − 1, 3) homogeneous equations for the centre of a point."""
        P, R = self.P[1:], self.R[1:]
        moved = P + (R - 1) * w
        free = abs(P) ** 2 + 2 * np.real(np.conj(P) * R * w)
        return np.stack([-2 * moved.real, -2 * moved.imag, free], axis=1)

    def dyad(self, w: complex) -> Dyad | None:
        """The dyad of a point; None if its equations have no centre."""
        rows = self.rows(w)
        # two rows or fewer always have a centre; the nearest one is selected
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
    """All real points with five positions on a circle, by elimination.

    All 3 × 3 minors of ``M`` vanish. In isotropic coordinates ``w, w̄`` a combination of minors is
    quadratic in ``w`` with quadratic coefficients in ``w̄``. The resultant of two such combinations
    is a polynomial eigenvalue problem of size four; Newton steps and the rank of all equations
    remove extraneous roots.
    """
    generator = np.random.default_rng(0)
    first, second = (_combined_minor(poses, generator) for _ in range(2))
    roots = [w for w in _common_roots(first, second) if np.isfinite(w)]
    points: list[complex] = []
    for w in roots:
        z = _refine(poses, w)
        if z is not None and not any(abs(z - other) < SAME * (1 + abs(z)) for other in points):
            points.append(z)
    return sorted(points, key=lambda z: (z.real, z.imag))


def _combined_minor(poses: Poses, generator: np.random.Generator) -> np.ndarray:
    """(3, 3) coefficients of ``w^i w̄^k`` in the determinant of three combined equations."""
    mixed = generator.normal(size=(3, 4))
    P, R = poses.P[1:], poses.R[1:]
    # columns of the centre in isotropic coordinates: c̄ (1, w), c (1, w̄), and the constant
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
    # degree at most two in each variable: interpolation at roots of unity
    return np.asarray(np.fft.fft2(values) / 9)


def _common_roots(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """``w`` of the common roots of two quadratics whose coefficients are quadratic in ``w̄``."""
    from scipy.linalg import eig

    sylvester = np.zeros((3, 4, 4), dtype=complex)
    for power in range(3):
        for row, polynomial in enumerate((p, q)):
            for shift in (0, 1):
                sylvester[power, 2 * shift + row, shift : shift + 3] = polynomial[:, power]
    zero, unit = np.zeros((4, 4)), np.eye(4)
    left = np.block([[zero, unit], [-sylvester[0], -sylvester[1]]])
    right = np.block([[unit, zero], [zero, sylvester[2]]])
    vectors = eig(left, right)[1]
    powers = vectors[:4]  # of 1, w, w², w³
    largest = np.argmax(abs(powers[:3]), axis=0)
    columns = np.arange(powers.shape[1])
    with np.errstate(all="ignore"):
        return np.asarray(powers[largest + 1, columns] / powers[largest, columns])


def _refine(poses: Poses, w: complex) -> complex | None:
    """The point refined by Newton's method; None if the root is not real."""
    if abs(w) > FAR:
        return None
    center = np.linalg.svd(poses.rows(w))[2][2]
    z = np.array([w.real, w.imag, *center])
    for _ in range(12):
        rows = poses.rows(complex(z[0], z[1]))
        # derivatives of the rows by the coordinates of the point; the rows are linear in it
        derivatives = [
            poses.rows(complex(z[0] + dx, z[1] + dy)) - rows for dx, dy in ((1, 0), (0, 1))
        ]
        residual = np.append(rows @ z[2:], z[2:] @ z[2:] - 1)
        jacobian = np.zeros((5, 5))
        jacobian[:4, 0], jacobian[:4, 1] = derivatives[0] @ z[2:], derivatives[1] @ z[2:]
        jacobian[:4, 2:], jacobian[4, 2:] = rows, 2 * z[2:]
        step = np.linalg.lstsq(jacobian, residual, rcond=None)[0]
        z = z - step
    point = complex(z[0], z[1])
    if not np.all(np.isfinite(z)) or abs(point - w) > 1e-3 * (1 + abs(w)):
        return None
    return point if np.max(abs(step)) < 1e-9 * (1 + abs(point)) else None


def four_poses(poses: Poses, samples: int) -> list[complex]:
    """Points of the circle-point curve on the lines of a grid over the poses."""
    levels = np.linspace(-2.0, 2.0, max(samples // 2, 1))
    points = []
    for level in levels:
        for turn in (1.0, 1j):
            nodes = np.array([-1.5, -0.5, 0.5, 1.5])
            values = [_determinant(poses, turn * complex(level, x)) for x in nodes]
            roots = np.roots(np.polyfit(nodes, values, 3))
            real = roots[abs(roots.imag) < SAME].real
            points += [turn * complex(level, x) for x in real if abs(x) < 10]
    return points


def _determinant(poses: Poses, w: complex) -> float:
    return float(np.linalg.det(poses.rows(w)))


def burmester_dyads(points: ArrayLike, angles: ArrayLike, samples: int = 24) -> list[Dyad]:
    """Dyads that guide a plane through two to five poses exactly.

    Five poses have up to four dyads, all of which are returned. For four poses, samples of the
    circle-point curve are returned; for three or two poses, samples of the plane.

    Parameters
    ----------
    points : (n, 2) positions of a point of the plane in each pose
    angles : (n,) angles of the plane [rad]
    samples : approximate number of dyads for fewer than five poses

    Raises
    ------
    AnalysisError
        There are not two to five poses, or two poses are equal.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.2, u=0.5, v=0.6)
    >>> turn = [0.2, 0.9, 1.7, 2.6, 3.4]
    >>> dyads = da.burmester_dyads(bar.path(turn), bar.coupler_angle(turn))
    >>> sorted(round(abs(dyad.center), 6) for dyad in dyads)[:2]  # both pivots of the four-bar
    [0.0, 1.2]
    """
    poses = Poses.of(points, angles)
    count = len(poses.P)
    if count == 5:
        candidates = five_poses(poses)
    elif count == 4:
        candidates = four_poses(poses, samples)
    else:
        side = np.linspace(-1.5, 1.5, max(int(np.ceil(np.sqrt(samples))), 2))
        candidates = [complex(x, y) for x in side for y in side]
    dyads = (poses.dyad(w) for w in candidates)
    size = poses.size
    return [dyad for dyad in dyads if dyad is not None and dyad.residual < 1e-6 * size]
