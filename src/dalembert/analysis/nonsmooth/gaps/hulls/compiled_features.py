"""Near features of convex hulls in machine code: all pairs in one call."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.form_tables import FormTables
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Rows
from dalembert.integrators.contact.machine_code import Loop, machine_code
from dalembert.integrators.contact.other_places import SearchCounts, SearchInputs, SearchOutputs

GEOMETRY = "hull_axes.c", "spatial_hulls.c", "planar_hulls.c"
"""Files of the search for features of two hulls."""
FILES = *GEOMETRY, "hull_search.c"
GROWTH = 2
"""Ratio of new memory to the need that first exceeded it."""


class CompiledFeatures:
    """Features of pairs of hulls that touch first, as ``spatial_features`` and ``planar_features``
    select them.

    Parameters
    ----------
    tables : forms of the hulls
    corners : number of all corners
    dimension : 2 or 3
    """

    def __init__(self, tables: FormTables, corners: int, dimension: int):
        self._tables, self._corners = tables, np.zeros((corners, 3))
        self._dimension, self._code = dimension, machine_code(*FILES)
        self._pairs = self._rows = 0
        if self.available:
            self._allocate(1, 1)

    @property
    def available(self) -> bool:
        """Whether there is machine code."""
        return self._code is not None

    def __call__(
        self,
        corners: np.ndarray,
        first: np.ndarray,
        second: np.ndarray,
        rounded: np.ndarray,
        limits: np.ndarray,
    ) -> list[Rows]:
        """Features of m pairs of hulls.

        Parameters
        ----------
        corners : (n, 3) of all hulls
        first, second : (m,) numbers of the hulls
        rounded : (m,) whether one hull of a pair has a radius
        limits : (m,) largest distance of the hulls without their radii [m]
        """
        count = first.size
        if count > self._pairs:
            self._allocate(GROWTH * count, self._rows)
        self._corners[:] = corners
        self._pair[:count, 0], self._pair[:count, 1] = first, second
        self._rounded[:count], self._limits[:count] = rounded, limits
        self._loop.counts[SearchCounts.PAIRS] = count
        self._loop()
        total = int(self._loop.counts[SearchCounts.FEATURES])
        if total > self._rows:
            self._allocate(self._pairs, GROWTH * total)
            return self(corners, first, second, rounded, limits)
        rows = self._listed[:total].astype(int)
        parts = [(feature, rows[rows[:, 0] == feature]) for feature in np.unique(rows[:, 0])]
        return [
            (Feature(int(feature)), part[:, 1], part[:, 2] == 1, part[:, 3], part[:, 4])
            for feature, part in parts
        ]

    def _allocate(self, pairs: int, rows: int) -> None:
        """Arrays for numbers of pairs of hulls and of features."""
        self._pairs, self._rows, tables = pairs, rows, self._tables
        self._pair, self._rounded = np.zeros((pairs, 2), np.int32), np.zeros(pairs, np.int32)
        self._limits, self._listed = np.zeros(pairs), np.zeros((rows, 5), np.int32)
        part, axes = np.zeros((tables.most, 4), np.int32), np.zeros((tables.axes, 3))
        inputs: dict[int, np.ndarray] = {
            SearchInputs.CORNERS: self._corners,
            SearchInputs.REACH: self._limits,
            SearchInputs.PAIRS: self._pair,
            SearchInputs.ROUNDED: self._rounded,
            SearchInputs.PLACES: tables.places,
            SearchInputs.FORMS: tables.records,
        }
        outputs: dict[int, np.ndarray] = {
            SearchOutputs.FEATURES: self._listed,
            SearchOutputs.PAIR_FEATURES: part,
            SearchOutputs.AXES: axes,
        }
        counts = {
            SearchCounts.HULLS: len(tables.places),
            SearchCounts.DIMENSION: self._dimension,
            SearchCounts.MAX_FEATURES: rows,
        }
        assert self._code is not None
        arrays = SearchInputs.arranged(inputs), SearchOutputs.arranged(outputs)
        self._loop = Loop(self._code, *arrays, SearchCounts.listed(counts), 3 * tables.longest)
