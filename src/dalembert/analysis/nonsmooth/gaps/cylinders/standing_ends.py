"""Points of ends of cylinders that stand, under force laws."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import Pairs, some_pairs
from dalembert.elements.contact.hull import MARKS

POINTS = Feature.WALL, Feature.FACE, Feature.CAP
RIMS = Feature.WALL_RIM, Feature.FACE_RIM, Feature.CAP_RIM
"""Features whose second shape has points on a rim, or the lowest point of a rim."""

Compliant = Callable[[np.ndarray, np.ndarray], np.ndarray]


def on_points_alone(listed: list[Pairs], flat: np.ndarray, compliant: Compliant) -> list[Pairs]:
    """The pairs without lowest points of rims, under force laws, of ends that stand on points.

    The lowest point of an end that stands moves round the rim as the end tilts. Its force would
    jump with it, and an upright cylinder would never be at rest.

    Parameters
    ----------
    flat : (s,) whether a shape is a cylinder
    compliant : mask of pairs of shapes with a force law
    """
    standing = [_ends(p, (p.other - 2) // MARKS)[_on_mark(p, flat)] for p in listed]
    standing = [ends for ends in standing if ends.size]
    if not standing:
        return listed
    ends = {tuple(row) for row in np.vstack(standing).tolist()}
    return [
        _without(pairs, ends, compliant) if pairs.feature in RIMS else pairs for pairs in listed
    ]


def _on_mark(pairs: Pairs, flat: np.ndarray) -> np.ndarray:
    """(n,) mask of pairs whose second feature is a point on the rim of a cylinder."""
    return flat[pairs.second] & (pairs.other >= 2) & (pairs.feature in POINTS)


def _ends(pairs: Pairs, end: np.ndarray) -> np.ndarray:
    """(n, 3) shapes, and the end of the second."""
    return np.column_stack([pairs.first, pairs.second, end])


def _without(pairs: Pairs, ends: set[tuple[int, ...]], compliant: Compliant) -> Pairs:
    """The pairs without rims of the ends under force laws."""
    stands = np.array(
        [tuple(row) in ends for row in _ends(pairs, pairs.other).tolist()], dtype=bool
    )
    return some_pairs(pairs, ~(stands & compliant(pairs.first, pairs.second)))
