"""Five-point path synthesis: all four-bars on given pivots through five coupler points.

In isotropic coordinates the pin at ``x`` from the coupler point has a constant distance to its
pivot,

    (d_j + r_j x)(d̂_j + x̂/r_j) = (d_0 + x)(d̂_0 + x̂),   r_j = e^{iθ_j},

and likewise the other pin: eight equations in eight unknowns, with 36 solutions for points in
general position. They are computed for random points by monodromy (Duff, Hill, Jensen, Lee, Leykin
and Sommars 2019) and continued to the given points by homotopy.
Source: A. P. Morgan, C. W. Wampler (1990), Journal of Mechanical Design 112, 544-550.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.errors import AnalysisError
from dalembert.options import random_generator

GENERIC = 36
"""Number of solutions for points in general position."""
LOOPS = 60
"""Upper limit of monodromy loops."""
FAR = 1e5
"""Threshold for solutions at infinity."""
ACCURATE, MIN_STEP = 1e-9, 1e-9
"""Upper limit of the last Newton correction, and lower limit of continuation steps."""
MAX_STEPS = 2000
"""Upper limit of continuation steps."""


@dataclass(frozen=True, eq=False)
class PrecisionFourBar:
    """A four-bar through the points.

    Attributes
    ----------
    linkage : FourBar on the branch of the first point
    crank_angles : (5,) at the points
    on_one_branch : whether all points are on one branch
    """

    linkage: FourBar
    crank_angles: np.ndarray
    on_one_branch: bool


@dataclass(frozen=True, eq=False)
class PrecisionPoints:
    """Solutions of the five-point problem.

    Attributes
    ----------
    four_bars : real solutions
    isolated : number of all isolated solutions, including complex ones
    residual : largest residual of the equations of the real solutions
    """

    four_bars: list[PrecisionFourBar]
    isolated: int
    residual: float


def five_point_four_bars(
    points: ArrayLike, pivots: ArrayLike = ((0.0, 0.0), (1.0, 0.0)), rng: int = 0
) -> PrecisionPoints:
    """All four-bars on two pivots with a coupler point through five points, in any order.

    Parameters
    ----------
    points : (5, 2) positions of the coupler point
    pivots : (2, 2) positions of the pivots of crank and follower
    rng : seed of the random points of the continuation

    Raises
    ------
    AnalysisError
        There are not five points, two points are equal, or the pivots are equal.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.0, u=0.5, v=0.4)
    >>> points = bar.path([0.2, 0.9, 1.7, 2.6, 3.4])
    >>> result = da.five_point_four_bars(points, rng=2)
    >>> result.isolated
    36
    """
    positions, (first, second) = _check_points(points, pivots)
    frame = second - first
    d = (positions - first) / frame  # pivots at 0 and 1
    target = np.array([d, np.conj(d)])
    generic, solutions = general_solutions(rng)
    solutions_at_target = _distinct(_refine(follow(solutions, generic, target), target))
    real = np.array([z for z in solutions_at_target if _is_real(z)]).reshape(-1, 8)
    four_bars = [_four_bar(z, d, first, frame) for z in real]
    residuals = np.abs(equations(real, target[:, None, :]))
    return PrecisionPoints(four_bars, len(solutions_at_target), float(residuals.max(initial=0.0)))


def _check_points(points: ArrayLike, pivots: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    arrays = []
    for name, value, count in (("points", points, 5), ("pivots", pivots, 2)):
        array = np.asarray(value, dtype=float)
        if array.shape != (count, 2) or not np.all(np.isfinite(array)):
            raise AnalysisError(f"{name}: {count} pairs of finite numbers are needed")
        z = array[:, 0] + 1j * array[:, 1]
        distances = np.abs(z[:, None] - z) + np.eye(count)
        if distances.min() == 0:
            raise AnalysisError(f"two of the {name} are equal; give distinct {name}")
        arrays.append(z)
    return arrays[0], arrays[1]


# equations -----------------------------------------------------------------------------------
def equations(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(K, 8) residuals of solutions ``x, x̂, y, ŷ, r_1 … r_4`` for points d and d̂, (2, K, 5)."""
    r, rows = z[:, 4:], []
    for (e, f), x, bar in _pins(z, d):
        inner = e[:, 1:] * f[:, 1:] - e[:, :1] * f[:, :1] - e[:, :1] * bar - f[:, :1] * x
        rows.append(f[:, 1:] * x * r**2 + inner * r + e[:, 1:] * bar)
    return np.concatenate(rows, axis=1)


def _pins(z: np.ndarray, d: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """For both pins: points relative to their pivots, and the pin relative to the coupler point."""
    return [(d, z[:, 0, None], z[:, 1, None]), (d - 1, z[:, 2, None], z[:, 3, None])]


def _jacobian(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    r, jacobian = z[:, 4:], np.zeros((len(z), 8, 8), dtype=complex)
    columns = np.arange(4)
    for block, ((e, f), x, bar) in enumerate(_pins(z, d)):
        rows = 4 * block + columns
        jacobian[:, rows, 2 * block] = f[:, 1:] * r**2 - f[:, :1] * r
        jacobian[:, rows, 2 * block + 1] = e[:, 1:] - e[:, :1] * r
        inner = e[:, 1:] * f[:, 1:] - e[:, :1] * f[:, :1] - e[:, :1] * bar - f[:, :1] * x
        jacobian[:, rows, 4 + columns] = 2 * f[:, 1:] * x * r + inner
    return jacobian


def _newton(z: np.ndarray, d: np.ndarray, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Corrected solutions, and the relative size of the last correction of each."""
    change = np.full(len(z), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(steps):
            correction = _solve(_jacobian(z, d), equations(z, d))
            z = z - correction
            change = np.abs(correction).max(axis=1) / (1 + np.abs(z).max(axis=1))
    return z, np.nan_to_num(change, nan=np.inf)


def _solve(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions of many linear systems; by least squares if singular."""
    invalid = ~np.isfinite(matrices).all(axis=(1, 2))
    matrices, right = matrices.copy(), right.copy()
    matrices[invalid], right[invalid] = np.eye(8), np.nan
    try:
        return np.linalg.solve(matrices, right[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        return (np.linalg.pinv(matrices) @ right[:, :, None])[:, :, 0]


# continuation --------------------------------------------------------------------------------
def follow(z: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Solutions at the end of a straight homotopy path, with individual step sizes.

    Solutions that diverge or coalesce are discarded.
    """
    z, rate = z.copy(), (end - start)[:, None, :]
    s, h = np.zeros(len(z)), np.full(len(z), 0.02)

    def points(fractions: np.ndarray) -> np.ndarray:
        return start[:, None, :] + fractions[None, :, None] * rate

    for _ in range(MAX_STEPS):
        k = np.flatnonzero((s < 1) & (h > MIN_STEP) & (np.abs(z).max(axis=1) < FAR))
        if not k.size:
            break
        step = np.minimum(h[k], 1 - s[k])
        guess = _predict(z[k], s[k], step, points, rate)
        corrected, change = _newton(guess, points(s[k] + step), 2)
        correction = np.abs(corrected - guess).max(axis=1) / (1 + np.abs(z[k]).max(axis=1))
        accepted = (change < ACCURATE) & (correction < 1e-3)
        z[k[accepted]], s[k[accepted]] = corrected[accepted], s[k[accepted]] + step[accepted]
        h[k] = np.where(accepted, np.minimum(1.6 * step, 0.2), step / 3)
    arrived = (s > 1 - 1e-6) & (np.abs(z).max(axis=1) < 1e3)
    return np.asarray(z[arrived])


def _predict(
    z: np.ndarray,
    s: np.ndarray,
    h: np.ndarray,
    points: Callable[[np.ndarray], np.ndarray],
    rate: np.ndarray,
) -> np.ndarray:
    """Predicted solutions after one step of the fourth-order Runge–Kutta method."""
    step, middle = h[:, None], points(s + h / 2)
    k1 = _tangent(z, points(s), rate)
    k2 = _tangent(z + step / 2 * k1, middle, rate)
    k3 = _tangent(z + step / 2 * k2, middle, rate)
    k4 = _tangent(z + step * k3, points(s + h), rate)
    return np.asarray(z + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


def _tangent(z: np.ndarray, d: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """Derivative of the solutions along the homotopy path."""
    step = 1e-7
    change = equations(z, d + step * rate) - equations(z, d - step * rate)
    return -_solve(_jacobian(z, d), change / (2 * step))


@lru_cache(maxsize=2)
def general_solutions(rng: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points, and all solutions for these points."""
    generator = random_generator(rng)

    def random_complex(*shape: int) -> np.ndarray:
        return generator.normal(size=shape) + 1j * generator.normal(size=shape)

    base = random_complex(2, 5)
    solutions, change = _newton(random_complex(1500, 8), base[:, None, :].repeat(1500, axis=1), 40)
    distinct = _distinct(solutions[change < ACCURATE])
    for _ in range(LOOPS):
        if len(distinct) >= GENERIC:
            break
        corners, continued = [base, random_complex(2, 5), random_complex(2, 5), base], distinct
        for start, end in pairwise(corners):
            continued = follow(continued, start, end)
        distinct = _distinct(np.concatenate([distinct, continued]))
    return base, distinct


def _refine(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    refined, change = _newton(z, d[:, None, :].repeat(len(z), axis=1), 12)
    return np.asarray(refined[change < 1e-8])


def _distinct(z: np.ndarray) -> np.ndarray:
    """Distinct solutions, without those with vanishing rotations."""
    distinct: list[np.ndarray] = []
    for solution in z:
        if (
            not np.all(np.isfinite(solution))
            or np.abs(solution[4:]).min() < 1e-6
            or np.abs(solution).max() > FAR
        ):
            continue
        if np.abs(solution[:4]).max() < 1e-8:
            continue
        if not any(
            np.abs(solution - other).max() < 1e-6 * (1 + np.abs(solution).max())
            for other in distinct
        ):
            distinct.append(solution)
    return np.array(distinct).reshape(-1, 8)


def _is_real(z: np.ndarray) -> bool:
    """Whether isotropic pairs are conjugates and rotations have modulus one."""
    size = 1e-6 * (1 + np.abs(z).max())
    pairs = abs(z[1] - np.conj(z[0])) + abs(z[3] - np.conj(z[2]))
    return bool(pairs < size and np.abs(np.abs(z[4:]) - 1).max() < 1e-6)


def _four_bar(z: np.ndarray, d: np.ndarray, first: complex, frame: complex) -> PrecisionFourBar:
    """The four-bar of a real solution, in the original coordinates."""
    rotations = np.concatenate([[1.0], z[4:]])
    pin, end = d + rotations * z[0], d + rotations * z[2]
    coupler = rotations * (z[2] - z[0])
    signs = np.sign(np.imag((end - 1) * np.conj(coupler)))
    size, angle = abs(frame), float(np.angle(frame))
    point = -z[0] / ((z[2] - z[0]) / abs(z[2] - z[0]))
    linkage = FourBar(
        crank=size * float(abs(pin[0])),
        coupler=size * float(abs(coupler[0])),
        follower=size * float(abs(end[0] - 1)),
        ground=size,
        x=first.real,
        y=first.imag,
        angle=angle,
        u=size * float(point.real),
        v=size * float(point.imag),
        branch=int(signs[0]) or 1,
    )
    return PrecisionFourBar(linkage, np.angle(pin) + angle, bool(np.all(signs == signs[0])))
