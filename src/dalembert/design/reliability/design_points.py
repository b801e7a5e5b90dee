"""Design points of a limit state: searches from several starts, ranked by their index."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from dalembert.design.reliability.first_order import DesignPoint, Search
from dalembert.design.reliability.second_order import principal_axes
from dalembert.errors import AnalysisError

NEGLIGIBLE = 1e-6
"""Share of the probability of the nearest point below which another one is left out."""
STARTS = 3
"""Searches from beside a median at which the limit state does not change."""
BESIDE = 0.1
"""Distance from a point, as a share of its index, at which a surface that bends back is noticed."""
WAY = (0.2, 0.4, 0.6, 0.8, 0.9)
"""Shares of the way from the median to a point at which the limit state is evaluated."""
ROUNDS = 5
"""Upper limit of searches that follow one another from a point to nearer ones."""
SCAN = 2000
"""Random points at which a formula is evaluated to check that no nearer point exists."""
NEAR_SURFACE = 1e-2
"""Residual up to which a search that did not converge has come to the limit state."""


@dataclass
class PointSearches:
    """Outcome of the searches of one limit state.

    Attributes
    ----------
    points : nearest first; a point that did not converge keeps its rank
    searches : number of them
    failed : searches that could not be evaluated to their end
    astray : searches that did not converge, away from the limit state
    beyond : searches that came to where a region of failure ends again
    """

    points: list[DesignPoint] = field(default_factory=list)
    searches: int = 0
    failed: int = 0
    astray: int = 0
    beyond: int = 0

    @property
    def warning(self) -> str:
        """Searches without a result, in a sentence; empty where there are none."""
        ended = [
            (self.failed, "ended at values that cannot be evaluated"),
            (self.astray, "did not come to the limit state"),
            (self.beyond, "came to where the region behind the limit state ends again"),
        ]
        told = " and ".join(f"{count} {text}" for count, text in ended if count)
        if not told:
            return ""
        label = self.points[0].limit
        return (
            f"{label}: of {self.searches} searches for design points {told}; first order may "
            "be wrong: compare importance_sampling or subset_simulation"
        )


def design_points(search: Search, starts: int, rng: Any) -> PointSearches:
    """Design points of a limit state from the median and from starts around it, nearest first.

    Points that matter less than ``NEGLIGIBLE`` of the nearest are left out. A point that did not
    converge stays where its index ranks it, unless a converged one is beside it. Each point is
    checked: the way to it from the median is safe, and the surface bends less around the median
    than the sphere through the point; otherwise the search goes on from where it is nearer.

    Raises
    ------
    AnalysisError
        Not even the search from the median can be made.
    """
    n = search.nataf.size
    median = search.needed(np.zeros(n))
    scale = abs(median) or abs(search.needed(np.full(n, 0.1))) or 1.0
    check = _PointCheck(search, scale, np.sign(median))
    found = PointSearches([check.nearest(_first(search, scale, rng))], 1)
    radius = max(abs(found.points[0].beta), 1.0)
    for _ in range(starts - 1):
        direction = rng.normal(size=n)
        begin = radius * direction / np.linalg.norm(direction)
        found.searches += 1
        try:
            one = search.solve(begin, scale)
            if not any(p.converged and _close(one, p) for p in found.points):
                found.points.append(check.nearest(one))
        except AnalysisError:
            found.failed += 1
    found.points = _ranked(found, check.side)
    for _ in range(ROUNDS if search.limits.cheap else 0):
        start = check.scanned(found.points[0], rng)
        if start is None:
            break
        found.searches += 1
        try:
            found.points.append(check.nearest(search.solve(start, scale)))
        except AnalysisError:
            found.failed += 1
        found.points = _ranked(found, check.side)
    return found


def _ranked(found: PointSearches, side: float) -> list[DesignPoint]:
    """Different points, nearest first; converged ones stand for others beside them."""
    some: list[DesignPoint] = []
    for one in sorted(found.points, key=lambda p: (not p.converged, abs(p.beta))):
        if some and not one.converged and one.residual > NEAR_SURFACE:
            found.astray += 1
        elif some and one.beta * side < 0:
            found.beyond += 1
        elif not any(_close(one, other) for other in some):
            some.append(one)
    matching = [p for p in some if not p.beta * side < 0] or some
    found.beyond += len(some) - len(matching)
    matching.sort(key=lambda p: abs(p.beta))
    least = NEGLIGIBLE * _beyond(matching[0])
    return [p for p in matching if p is matching[0] or _beyond(p) > least]


def _close(one: DesignPoint, other: DesignPoint) -> bool:
    return bool(np.linalg.norm(one.u - other.u) <= 0.05 * max(abs(one.beta), 1.0))


def _beyond(point: DesignPoint) -> float:
    """``Φ(−|β|)``, what is on the other side of the surface than the median, to first order."""
    from scipy.special import ndtr

    return float(ndtr(-abs(point.beta)))


@dataclass
class _PointCheck:
    """Whether a stationary point of ``|u|`` on the surface can be the nearest of its region.

    Parameters
    ----------
    side : sign of ``G`` at the median
    """

    search: Search
    scale: float
    side: float

    def nearest(self, point: DesignPoint) -> DesignPoint:
        """The point, or the one to which a search leads from where the limit state is nearer."""
        for _ in range(ROUNDS):
            if not point.converged or not self.side:
                return point
            start = self._before(point)
            if start is None:
                point, start = self._beside(point)
            if start is None:
                return point
            try:
                nearer = self.search.solve(start, self.scale)
            except AnalysisError:
                return point
            if not (nearer.converged and np.linalg.norm(nearer.u) < np.linalg.norm(point.u)):
                return point
            point = nearer
        return point

    def scanned(self, point: DesignPoint, rng: Any) -> np.ndarray | None:
        """The nearest of random points within the index of a point that are over the surface."""
        directions = rng.normal(size=(SCAN, point.u.size))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        radii = 0.98 * abs(point.beta) * rng.uniform(0.2, 1, SCAN)
        u = radii[:, None] * directions
        values = (
            self.side * self.search.limits.many(self.search.nataf.values(u))[:, self.search.row]
        )
        over = np.flatnonzero(values < -10 * self.search.tolerance * self.scale)
        return u[over[np.argmin(radii[over])]] if over.size and point.converged else None

    def _before(self, point: DesignPoint) -> np.ndarray | None:
        """Where the straight way from the median to the point has crossed the surface already."""
        shares = WAY if point.beta * self.side >= 0 else (*WAY, 1 - 1e-3)
        crossed = (s for s in shares if self._over(s * point.u))
        share = next(crossed, None)
        return None if share is None else share * point.u

    def _over(self, u: np.ndarray) -> bool:
        """Whether a point is on the other side of the surface than the median."""
        value = self.side * self.search.value(u)
        return bool(value < -10 * self.search.tolerance * self.scale)

    def _beside(self, point: DesignPoint) -> tuple[DesignPoint, np.ndarray | None]:
        """The point with its curvatures, and a start beside it where the surface bends around the
        median: from an axis of symmetry a search comes to the farthest point."""
        if point.u.size < 2:
            return point, None
        try:
            curvatures, axes = principal_axes(self.search, point)
        except AnalysisError:
            return point, None
        point = replace(point, curvatures=curvatures)
        radius = float(np.linalg.norm(point.u))
        if not (curvatures * point.beta).min() < -1 or not radius:
            return point, None
        away = axes[:, int(np.argmin(curvatures * point.beta))]
        for sign in (1.0, -1.0):
            there = point.u + sign * BESIDE * max(radius, 1.0) * away
            there *= radius / np.linalg.norm(there)
            if self._over(there):
                return point, there
        return point, None


def _first(search: Search, scale: float, rng: Any) -> DesignPoint:
    """The point reached from the median, or from beside it where no gradient shows the way there.

    Raises
    ------
    AnalysisError
        None of these searches can be made.
    """
    n = search.nataf.size
    try:
        return search.solve(np.zeros(n), scale)
    except AnalysisError:
        if np.any(search.slope(np.zeros(n))[0]):
            raise
        for _ in range(STARTS):
            direction = rng.normal(size=n)
            try:
                return search.solve(direction / np.linalg.norm(direction), scale)
            except AnalysisError:
                continue
        raise
