"""Checks of first-order probabilities: the surface is bent, or the region of failure is a layer."""

from __future__ import annotations

from dalembert.design.reliability.first_order import DesignPoint
from dalembert.design.reliability.reliable import Reliability
from dalembert.design.reliability.second_order import second_order

BENT = 0.2
"""Difference of first and second order, relative to the larger, beyond which there is a warning."""
THROUGH = (0.03, 0.1, 0.3, 1.0, 1.6)
"""Distances behind a design point at which the limit state is evaluated, as shares of the depth
``1/max(β, 1)`` in which most of the probability lies."""


def _counts(found: Reliability, point: DesignPoint) -> bool:
    """Whether the probability of a point is a share of the whole that matters."""
    share = point.probability / max(found.probability, 1e-300)
    return found.system != "series" or share >= BENT / 2


def curvature_warnings(found: Reliability) -> list[str]:
    """Points of which a plane and a paraboloid have different probabilities."""
    made = []
    for point in found.points:
        if point.curvatures is None or not _counts(found, point):
            continue
        plane, second = point.probability, second_order(found.searches[point.row], point)
        bent, other = second.breitung, second.tvedt
        if all(abs(p - plane) <= BENT * max(p, plane) for p in (bent, other)):
            continue
        told = (
            "the surface bends around the median there, so that there is no second-order estimate"
            if not (bent <= 1 and 0 <= other <= 1)
            else f"to second order {bent:.3g} (Breitung) or {other:.3g} (Tvedt)"
        )
        made.append(
            f"{point.limit}: the surface is curved at β = {point.beta:.4g}: the probability is "
            f"{plane:.3g} to first order, {told}; compare importance_sampling"
        )
    return list(dict.fromkeys(made))


def layer_warnings(found: Reliability) -> list[str]:
    """Points behind which the limit state is safe again soon."""
    from scipy.special import ndtr

    made = []
    for point in found.points:
        if not (point.converged and point.beta > 0 and _counts(found, point)):
            continue
        search, depth = found.searches[point.row], 1 / max(point.beta, 1.0)
        behind = [point.beta + share * depth for share in THROUGH]
        values = [search.value(beta * point.alpha) for beta in behind]
        end = next((b for b, g in zip(behind, values, strict=True) if g > 0), None)
        if end is not None:
            layer = float(ndtr(-point.beta) - ndtr(-end))
            made.append(
                f"{point.limit}: is safe again at β = {end:.4g} behind the design point at β = "
                f"{point.beta:.4g}: first order is {point.probability:.3g}, that layer at most "
                f"{layer:.3g}; compare importance_sampling"
            )
    return list(dict.fromkeys(made))
