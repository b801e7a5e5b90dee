"""Points of rims that may touch lines or other rims: local minima of their distance."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import (
    SECTORS,
    Cylinders,
    sector_directions,
)
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows

Evaluate = Callable[[Rows], tuple[np.ndarray, np.ndarray, np.ndarray]]
"""Gaps (n,), contact points (n, 3) and normals (n, 3), from the first shape to the second."""

SAME = 1e-9
"""Distance of two points of a rim that are the same, by the largest coordinate."""
MEET = 1e-6
"""Distance of a contact point from its rim or edge that is an error of the point, by the size of
the shapes."""
TURNS = sector_directions(np.arange(SECTORS))[:, :2]
"""(SECTORS, 2) cosine and sine of the starts."""


def rims_at_lines(
    cylinders: Cylinders, starts: np.ndarray, along: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the pair, of the rim with its sector, and of the line (m, e, 3) at local minima.

    Parameters
    ----------
    starts, along : (m, e, 3) a point and the direction of each line; not normalised
    """
    unit = along / np.linalg.norm(along, axis=2, keepdims=True)

    def across(vectors: np.ndarray) -> np.ndarray:
        """(m, 2, e, 3) components of vectors normal to the lines."""
        lines = unit[:, None]
        return vectors - (vectors * lines).sum(axis=3, keepdims=True) * lines

    between = across(cylinders.ends[:, :, None] - starts[:, None])
    x, y = (across(cylinders.sides[:, :, None, k]) for k in range(2))
    radius, (c, s) = cylinders.radii[:, None, None, None], TURNS.T

    def product(one: np.ndarray, another: np.ndarray) -> np.ndarray:
        """(m, 2, e, 1)"""
        return (one * another).sum(axis=3)[..., None]

    square = radius**2 * (product(x, x) * c * c + product(y, y) * s * s + 2 * product(x, y) * c * s)
    square = square + 2 * radius * (product(between, x) * c + product(between, y) * s)
    pair, end, line, sector = np.nonzero(_smallest(square))
    return pair, end * SECTORS + sector, line


def rims_at_rims(first: Cylinders, second: Cylinders) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of the pair, and of the rims of both cylinders with their sectors."""
    sides, radius = first.sides, first.radii[:, None, None, None]
    circle = np.einsum("st,metx->mesx", TURNS, sides)
    places = (first.ends[:, :, None] + radius * circle)[:, :, None]
    relative = places - second.ends[:, None, :, None]
    height = (relative * second.outward[:, None, :, None]).sum(axis=4)
    coordinates = [(relative * second.sides[:, None, :, None, k]).sum(axis=4) for k in range(2)]
    beside = np.hypot(*coordinates) - second.radii[:, None, None, None]
    pair, i, j, sector = np.nonzero(_smallest(height**2 + beside**2))
    angle = np.arctan2(*(c[pair, i, j, sector] for c in coordinates[::-1]))
    other = np.round(angle * SECTORS / (2 * np.pi)).astype(int) % SECTORS
    return pair, i * SECTORS + sector, j * SECTORS + other


def evaluated(rows: Rows, evaluate: Evaluate) -> tuple[Rows, np.ndarray, np.ndarray, np.ndarray]:
    """Rows with a contact point, each point of a rim once; gaps, contact points and normals.

    Several starts may lead to one point of a rim, and a line along a rim has no normal.
    """
    feature, pair, swapped, own, other = rows
    if not pair.size:
        return rows, np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3))
    gap, place, normal = evaluate(rows)
    valid = np.flatnonzero(np.isfinite(gap))
    if feature in (Feature.RIM_LINE, Feature.RIM_EDGE, Feature.RIM_RIM):
        rim = other // SECTORS if feature is Feature.RIM_RIM else other
        cells = np.round(place[valid] / (SAME * np.abs(place[valid]).max(initial=1e-300)))
        table = np.column_stack([pair, swapped, own // SECTORS, rim])[valid]
        valid = valid[np.sort(np.unique(np.hstack([table, cells]), axis=0, return_index=True)[1])]
    return some_rows(rows, valid), gap[valid], place[valid], normal[valid]


def on_lines(places: np.ndarray, starts: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(n,) distances of places from lines (n, 3): of the second contact points of rims and edges.

    They are zero but where a rim is parallel to the edge at the point nearest to it, as of an end
    that stands on a box: both have no common normal there, and do not touch.
    """
    unit = along / np.linalg.norm(along, axis=1, keepdims=True)
    distance: np.ndarray = np.linalg.norm(np.cross(places - starts, unit), axis=1)
    return distance


def on_rims(places: np.ndarray, cylinders: Cylinders, end: np.ndarray) -> np.ndarray:
    """(n,) distances of places from the rims of ends, as ``on_lines``."""
    row = np.arange(end.size)
    relative, axis = places - cylinders.ends[row, end], cylinders.outward[row, end]
    height = (relative * axis).sum(axis=1)
    beside = np.linalg.norm(relative - height[:, None] * axis, axis=1) - cylinders.radii
    distance: np.ndarray = np.hypot(height, beside)
    return distance


def some_rows(rows: Rows, selected: np.ndarray) -> Rows:
    """The selected rows."""
    feature, pair, swapped, own, other = rows
    return feature, pair[selected], swapped[selected], own[selected], other[selected]


def _smallest(values: np.ndarray) -> np.ndarray:
    """Mask of local minima along the last, periodic axis."""
    before, after = np.roll(values, 1, axis=-1), np.roll(values, -1, axis=-1)
    smallest: np.ndarray = (values < before) & (values <= after)
    return smallest
