"""All four-bars with given pivots whose coupler point passes five points.

In isotropic coordinates the pin at ``x`` from the coupler point keeps its distance to its pivot,

    (d_j + r_j x)(d̂_j + x̂/r_j) = (d_0 + x)(d̂_0 + x̂),   r_j = e^{iθ_j},

and so does the other pin: eight equations in eight unknowns, with 36 solutions for points in
general position. They are found for random points by monodromy (Duff, Hill, Jensen, Lee, Leykin
and Sommars 2019) and followed to the given ones by continuation.
Source: A. P. Morgan, C. W. Wampler (1990), Journal of Mechanical Design 112, 544-550.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np

from dalembert.design.synthesis.four_bar import FourBar
from dalembert.errors import AnalysisError
from dalembert.options import random_generator

GENERIC = 36
"""Solutions for points in general position."""
LOOPS = 60
"""Loops in the space of points at most."""
FAR = 1e5
"""Size from which on a solution has gone to infinity."""
ACCURATE, SHORTEST = 1e-9, 1e-9
MOST_STEPS = 2000


@dataclass(frozen=True, eq=False)
class PrecisionFourBar:
    """A four-bar through the points.

    Attributes
    ----------
    linkage : FourBar on the branch of the first point
    crank_angles : (5,) at the points
    on_one_branch : the coupler angles of one branch lead through all points
    """

    linkage: FourBar
    crank_angles: np.ndarray
    on_one_branch: bool


@dataclass(frozen=True, eq=False)
class PrecisionPoints:
    """Solutions of the five-point problem.

    Attributes
    ----------
    four_bars : those that can be built
    isolated : number of all isolated solutions, complex ones included
    residual : largest of the equations of those that can be built
    """

    four_bars: list[PrecisionFourBar]
    isolated: int
    residual: float


def five_point_four_bars(
    points: Any, pivots: Any = ((0.0, 0.0), (1.0, 0.0)), rng: int = 0
) -> PrecisionPoints:
    """All four-bars on two pivots whose coupler point passes five points, in any order.

    Parameters
    ----------
    points : (5, 2) of the coupler point
    pivots : (2, 2) of crank and follower
    rng : seed of the path that the continuation takes

    Raises
    ------
    AnalysisError
        Not five points, two that are one, or pivots that are one.

    Examples
    --------
    >>> import dalembert as da
    >>> bar = da.FourBar(crank=0.4, coupler=1.1, follower=0.9, ground=1.0, u=0.5, v=0.4)
    >>> points = bar.path([0.2, 0.9, 1.7, 2.6, 3.4])
    >>> found = da.five_point_four_bars(points, rng=2)
    >>> found.isolated
    36
    """
    given, (first, second) = _checked(points, pivots)
    apart = second - first
    d = (given - first) / apart  # pivots at 0 and 1
    target = np.array([d, np.conj(d)])
    generic, solutions = general_solutions(rng)
    found = _distinct(_polished(follow(solutions, generic, target), target))
    real = np.array([z for z in found if _is_real(z)]).reshape(-1, 8)
    made = [_built(z, d, first, apart) for z in real]
    off = np.abs(equations(real, target[:, None, :]))
    return PrecisionPoints(made, len(found), float(off.max(initial=0.0)))


def _checked(points: Any, pivots: Any) -> tuple[np.ndarray, np.ndarray]:
    made = []
    for name, value, count in (("points", points, 5), ("pivots", pivots, 2)):
        array = np.asarray(value, dtype=float)
        if array.shape != (count, 2) or not np.all(np.isfinite(array)):
            raise AnalysisError(f"{name}: {count} pairs of finite numbers are needed")
        z = array[:, 0] + 1j * array[:, 1]
        near = np.abs(z[:, None] - z) + np.eye(count)
        if near.min() == 0:
            raise AnalysisError(f"two of the {name} are one; give {name} apart")
        made.append(z)
    return made[0], made[1]


# equations -----------------------------------------------------------------------------------
def equations(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    """(K, 8) residuals of solutions ``x, x̂, y, ŷ, r_1 … r_4`` for points d and d̂, (2, K, 5)."""
    r, rows = z[:, 4:], []
    for (e, f), x, bar in _pins(z, d):
        inner = e[:, 1:] * f[:, 1:] - e[:, :1] * f[:, :1] - e[:, :1] * bar - f[:, :1] * x
        rows.append(f[:, 1:] * x * r**2 + inner * r + e[:, 1:] * bar)
    return np.concatenate(rows, axis=1)


def _pins(z: np.ndarray, d: np.ndarray) -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Of both pins: points from their pivots, and the pin from the coupler point."""
    return [(d, z[:, 0, None], z[:, 1, None]), (d - 1, z[:, 2, None], z[:, 3, None])]


def _jacobian(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    r, made = z[:, 4:], np.zeros((len(z), 8, 8), dtype=complex)
    each = np.arange(4)
    for block, ((e, f), x, bar) in enumerate(_pins(z, d)):
        rows = 4 * block + each
        made[:, rows, 2 * block] = f[:, 1:] * r**2 - f[:, :1] * r
        made[:, rows, 2 * block + 1] = e[:, 1:] - e[:, :1] * r
        inner = e[:, 1:] * f[:, 1:] - e[:, :1] * f[:, :1] - e[:, :1] * bar - f[:, :1] * x
        made[:, rows, 4 + each] = 2 * f[:, 1:] * x * r + inner
    return made


def _newton(z: np.ndarray, d: np.ndarray, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Corrected solutions, and the size of the last correction of each."""
    last = np.full(len(z), np.inf)
    with np.errstate(all="ignore"):
        for _ in range(steps):
            move = _solve(_jacobian(z, d), equations(z, d))
            z = z - move
            last = np.abs(move).max(axis=1) / (1 + np.abs(z).max(axis=1))
    return z, np.nan_to_num(last, nan=np.inf)


def _solve(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions of many systems; of singular ones by least squares."""
    bad = ~np.isfinite(matrices).all(axis=(1, 2))
    matrices, right = matrices.copy(), right.copy()
    matrices[bad], right[bad] = np.eye(8), np.nan
    try:
        return np.linalg.solve(matrices, right[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        return (np.linalg.pinv(matrices) @ right[:, :, None])[:, :, 0]


# continuation --------------------------------------------------------------------------------
def follow(z: np.ndarray, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Solutions for the points at the end of a straight way, each with steps of its own.

    Those that go to infinity, or meet others on the way, are left out.
    """
    z, rate = z.copy(), (end - begin)[:, None, :]
    s, h = np.zeros(len(z)), np.full(len(z), 0.02)

    def points(at: np.ndarray) -> np.ndarray:
        return begin[:, None, :] + at[None, :, None] * rate

    for _ in range(MOST_STEPS):
        k = np.flatnonzero((s < 1) & (h > SHORTEST) & (np.abs(z).max(axis=1) < FAR))
        if not k.size:
            break
        step = np.minimum(h[k], 1 - s[k])
        guess = _predicted(z[k], s[k], step, points, rate)
        new, last = _newton(guess, points(s[k] + step), 2)
        moved = np.abs(new - guess).max(axis=1) / (1 + np.abs(z[k]).max(axis=1))
        good = (last < ACCURATE) & (moved < 1e-3)
        z[k[good]], s[k[good]] = new[good], s[k[good]] + step[good]
        h[k] = np.where(good, np.minimum(1.6 * step, 0.2), step / 3)
    near = (s > 1 - 1e-6) & (np.abs(z).max(axis=1) < 1e3)
    return np.asarray(z[near])


def _predicted(
    z: np.ndarray,
    s: np.ndarray,
    h: np.ndarray,
    points: Callable[[np.ndarray], np.ndarray],
    rate: np.ndarray,
) -> np.ndarray:
    """Solutions one step ahead, by the Runge–Kutta method of order four."""
    step, middle = h[:, None], points(s + h / 2)
    k1 = _tangent(z, points(s), rate)
    k2 = _tangent(z + step / 2 * k1, middle, rate)
    k3 = _tangent(z + step / 2 * k2, middle, rate)
    k4 = _tangent(z + step * k3, points(s + h), rate)
    return np.asarray(z + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))


def _tangent(z: np.ndarray, d: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """How solutions go with the points."""
    little = 1e-7
    change = equations(z, d + little * rate) - equations(z, d - little * rate)
    return -_solve(_jacobian(z, d), change / (2 * little))


@lru_cache(maxsize=2)
def general_solutions(rng: int) -> tuple[np.ndarray, np.ndarray]:
    """Random points, and all solutions for them."""
    generator = random_generator(rng)

    def drawn(*shape: int) -> np.ndarray:
        return generator.normal(size=shape) + 1j * generator.normal(size=shape)

    base = drawn(2, 5)
    found, last = _newton(drawn(1500, 8), base[:, None, :].repeat(1500, axis=1), 40)
    known = _distinct(found[last < ACCURATE])
    for _ in range(LOOPS):
        if len(known) >= GENERIC:
            break
        corners, went = [base, drawn(2, 5), drawn(2, 5), base], known
        for begin, end in pairwise(corners):
            went = follow(went, begin, end)
        known = _distinct(np.concatenate([known, went]))
    return base, known


def _polished(z: np.ndarray, d: np.ndarray) -> np.ndarray:
    found, last = _newton(z, d[:, None, :].repeat(len(z), axis=1), 12)
    return np.asarray(found[last < 1e-8])


def _distinct(z: np.ndarray) -> np.ndarray:
    """Each solution once; those with vanishing rotations are none."""
    kept: list[np.ndarray] = []
    for one in z:
        if not np.all(np.isfinite(one)) or np.abs(one[4:]).min() < 1e-6 or np.abs(one).max() > FAR:
            continue
        if np.abs(one[:4]).max() < 1e-8:
            continue
        if not any(np.abs(one - other).max() < 1e-6 * (1 + np.abs(one).max()) for other in kept):
            kept.append(one)
    return np.array(kept).reshape(-1, 8)


def _is_real(z: np.ndarray) -> bool:
    """Whether hats are conjugates and rotations have length one."""
    size = 1e-6 * (1 + np.abs(z).max())
    pairs = abs(z[1] - np.conj(z[0])) + abs(z[3] - np.conj(z[2]))
    return bool(pairs < size and np.abs(np.abs(z[4:]) - 1).max() < 1e-6)


def _built(z: np.ndarray, d: np.ndarray, first: complex, apart: complex) -> PrecisionFourBar:
    """The four-bar of a real solution, moved back to its pivots."""
    turns = np.concatenate([[1.0], z[4:]])
    pin, end = d + turns * z[0], d + turns * z[2]
    along = turns * (z[2] - z[0])
    signs = np.sign(np.imag((end - 1) * np.conj(along)))
    size, angle = abs(apart), float(np.angle(apart))
    point = -z[0] / ((z[2] - z[0]) / abs(z[2] - z[0]))
    made = FourBar(
        crank=size * float(abs(pin[0])),
        coupler=size * float(abs(along[0])),
        follower=size * float(abs(end[0] - 1)),
        ground=size,
        x=first.real,
        y=first.imag,
        angle=angle,
        u=size * float(point.real),
        v=size * float(point.imag),
        branch=int(signs[0]) or 1,
    )
    return PrecisionFourBar(made, np.angle(pin) + angle, bool(np.all(signs == signs[0])))
