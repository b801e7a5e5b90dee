"""Design points of a limit state: searches from several starts, ranked by their index."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from dalembert.design.reliability.first_order import DesignPoint, Search
from dalembert.design.reliability.second_order import principal_axes
from dalembert.errors import AnalysisError

NEGLIGIBLE = 1e-6
"""Threshold for discarding a point, as fraction of the probability of the nearest point."""
STARTS = 3
"""Number of random starts if the gradient of the limit state vanishes at the median."""
OFFSET = 0.1
"""Distance for checking a surface that curves back, as fraction of the reliability index."""
RAY_FRACTIONS = (0.2, 0.4, 0.6, 0.8, 0.9)
"""Positions on the ray from the median to a point at which the limit state is checked."""
BISECTIONS = 12
"""Number of bisections between the median and a point on the far boundary of a failure region."""
ROUNDS = 5
"""Upper limit of consecutive searches from a point to nearer ones."""
SCAN = 2000
"""Number of random points at which a formula is checked for nearer design points."""
NEAR_SURFACE = 1e-2
"""Upper limit of the residual of an unconverged search that has reached the limit state."""


@dataclass
class PointSearches:
    """Outcome of the searches of one limit state.

    Attributes
    ----------
    points : nearest first; an unconverged point keeps its rank
    searches : number of searches
    failed : number of searches that ended at values that cannot be evaluated
    astray : number of searches that did not converge, away from the limit state
    beyond : number of searches that reached the far boundary of a failure region
    """

    points: list[DesignPoint] = field(default_factory=list)
    searches: int = 0
    failed: int = 0
    astray: int = 0
    beyond: int = 0

    @property
    def warning(self) -> str:
        """Warning about searches without a result; empty if there are none."""
        outcomes = [
            (self.failed, "ended at values that cannot be evaluated"),
            (self.astray, "did not reach the limit state"),
            (self.beyond, "reached the far boundary of the failure region"),
        ]
        summary = " and ".join(f"{count} {text}" for count, text in outcomes if count)
        if not summary:
            return ""
        label = self.points[0].limit
        return (
            f"{label}: of {self.searches} searches for design points {summary}; first order may "
            "be wrong: compare importance_sampling or subset_simulation"
        )


def design_points(search: Search, starts: int, rng: np.random.Generator) -> PointSearches:
    """Design points of a limit state from the median and from starts around it, nearest first.

    Points with a probability below ``NEGLIGIBLE`` of that of the nearest point are discarded. An
    unconverged point is ranked by its index, unless a converged point is close to it. Each point
    is checked: the ray from the median to it must be safe, and the curvature of the surface must be
    less than that of the sphere through the point; otherwise the search continues from a nearer
    start.

    Raises
    ------
    AnalysisError
        The search from the median fails.
    """
    n = search.nataf.size
    median = search.finite_value(np.zeros(n))
    scale = abs(median) or abs(search.finite_value(np.full(n, 0.1))) or 1.0
    check = _PointCheck(search, scale, np.sign(median))
    outcome = PointSearches([check.nearest(_first(search, scale, rng))], 1)
    radius = max(abs(outcome.points[0].beta), 1.0)
    for _ in range(starts - 1):
        direction = rng.normal(size=n)
        offset = radius * direction / np.linalg.norm(direction)
        outcome.searches += 1
        try:
            point = search.solve(offset, scale)
            if not any(p.converged and _close(point, p) for p in outcome.points):
                outcome.points.append(check.nearest(point))
        except AnalysisError:
            outcome.failed += 1
    outcome.points = _ranked(outcome, check.side)
    for _ in range(ROUNDS if search.limits.cheap else 0):
        start = check.scan(outcome.points[0], rng)
        if start is None:
            break
        outcome.searches += 1
        try:
            outcome.points.append(check.nearest(search.solve(start, scale)))
        except AnalysisError:
            outcome.failed += 1
        outcome.points = _ranked(outcome, check.side)
    return outcome


def _ranked(outcome: PointSearches, side: float) -> list[DesignPoint]:
    """Distinct points, nearest first; a converged point represents others close to it."""
    distinct: list[DesignPoint] = []
    for point in sorted(outcome.points, key=lambda p: (not p.converged, abs(p.beta))):
        if distinct and not point.converged and point.residual > NEAR_SURFACE:
            outcome.astray += 1
        elif distinct and point.beta * side < 0:
            outcome.beyond += 1
        elif not any(_close(point, other) for other in distinct):
            distinct.append(point)
    matching = [p for p in distinct if not p.beta * side < 0]
    if not matching:  # none on the near boundary
        outcome.beyond += len(distinct)
        return [replace(point, converged=False) for point in distinct]
    outcome.beyond += len(distinct) - len(matching)
    matching.sort(key=lambda p: abs(p.beta))
    threshold = NEGLIGIBLE * _tail_probability(matching[0])
    return [p for p in matching if p is matching[0] or _tail_probability(p) > threshold]


def _close(point: DesignPoint, other: DesignPoint) -> bool:
    return bool(np.linalg.norm(point.u - other.u) <= 0.05 * max(abs(point.beta), 1.0))


def _tail_probability(point: DesignPoint) -> float:
    """``Φ(−|β|)``: first-order probability of the region separated from the median."""
    from scipy.special import ndtr

    return float(ndtr(-abs(point.beta)))


@dataclass
class _PointCheck:
    """Check whether a stationary point of ``|u|`` on the surface is the nearest of its region.

    Parameters
    ----------
    side : sign of ``G`` at the median
    """

    search: Search
    scale: float
    side: float

    def nearest(self, point: DesignPoint) -> DesignPoint:
        """The point, or the result of searches from starts at which the limit state is nearer."""
        for _ in range(ROUNDS):
            if not point.converged or not self.side:
                return point
            start = self._crossing(point)
            if start is None:
                point, start = self._curvature_check(point)
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

    def scan(self, point: DesignPoint, rng: np.random.Generator) -> np.ndarray | None:
        """Nearest failed point of a random sample within the sphere through a design point."""
        directions = rng.normal(size=(SCAN, point.u.size))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        radii = 0.98 * abs(point.beta) * rng.uniform(0.2, 1, SCAN)
        u = radii[:, None] * directions
        values = (
            self.side
            * self.search.limits.values_at(self.search.nataf.values(u))[:, self.search.row]
        )
        failed = np.flatnonzero(values < -10 * self.search.tolerance * self.scale)
        return u[failed[np.argmin(radii[failed])]] if failed.size and point.converged else None

    def _crossing(self, point: DesignPoint) -> np.ndarray | None:
        """First checked point on the ray from the median that is behind the surface."""
        shares = RAY_FRACTIONS if point.beta * self.side >= 0 else (*RAY_FRACTIONS, 1 - 1e-3)
        crossed = (s for s in shares if self._separated(s * point.u))
        share = next(crossed, None)
        if share is None or point.beta * self.side >= 0:
            return None if share is None else share * point.u
        safe = max((s for s in shares if s < share), default=0.0)
        for _ in range(BISECTIONS):  # to the near boundary, from which the search starts
            middle = (safe + share) / 2
            safe, share = (safe, middle) if self._separated(middle * point.u) else (middle, share)
        return share * point.u

    def _separated(self, u: np.ndarray) -> bool:
        """Whether the surface separates a point from the median."""
        value = self.side * self.search.value(u)
        return bool(value < -10 * self.search.tolerance * self.scale)

    def _curvature_check(self, point: DesignPoint) -> tuple[DesignPoint, np.ndarray | None]:
        """The point with its curvatures, and a start close to it if the surface curves around the
        median: a search along an axis of symmetry converges to the farthest point."""
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
        axis = axes[:, int(np.argmin(curvatures * point.beta))]
        for sign in (1.0, -1.0):
            start = point.u + sign * OFFSET * max(radius, 1.0) * axis
            start *= radius / np.linalg.norm(start)
            if self._separated(start):
                return point, start
        return point, None


def _first(search: Search, scale: float, rng: np.random.Generator) -> DesignPoint:
    """Design point from the median, or from random starts if the gradient vanishes there.

    Raises
    ------
    AnalysisError
        All of these searches fail.
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
