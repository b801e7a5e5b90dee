"""Numbers of the entries of points, radii, axes and laws of shapes in one vector of formulas."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.elements.contact.pairs import COEFFICIENTS

PARTS = "corners", "walls", "radii", "origins", "laws", "axes", "constants"
"""Parts of the vector, in their order."""


class GeometryEntries:
    """Numbers of entries in the geometry of ``GapFormulas``.

    Parameters
    ----------
    sizes : of the parts
    hulls : number of shapes before the walls

    Attributes
    ----------
    zero : number of the constant 0
    """

    def __init__(self, sizes: Sequence[int], hulls: int):
        starts = np.cumsum([0, *sizes[:-1]])
        self._start = dict(zip(PARTS, map(int, starts), strict=True))
        self._sizes = dict(zip(PARTS, map(int, sizes), strict=True))
        self._hulls, self.zero = hulls, self._start["constants"]

    def parts(self, geometry: ca.SX) -> dict[str, ca.SX]:
        """The parts of the vector by their names."""
        starts, sizes = self._start, self._sizes
        return {part: geometry[starts[part] : starts[part] + sizes[part]] for part in PARTS}

    def corners(self, corners: np.ndarray) -> np.ndarray:
        """(n, 3 k) positions of corners (n, k)."""
        numbers = self._numbers("corners", corners.ravel(), 3)
        return numbers.reshape(-1, 3 * corners.shape[1])

    def walls(self, shape: np.ndarray) -> np.ndarray:
        """(n, 6) points and normals."""
        return self._numbers("walls", shape - self._hulls, 6)

    def radii(self, shape: np.ndarray) -> np.ndarray:
        """(n, 1) radii."""
        return self._numbers("radii", shape, 1)

    def origins(self, shape: np.ndarray) -> np.ndarray:
        """(n, 3) reference points of the bodies."""
        return self._numbers("origins", shape, 3)

    def axes(self, boundary: np.ndarray) -> np.ndarray:
        """(n, 2) first axes of the bodies of boundaries."""
        return self._numbers("axes", boundary, 2)

    def sectors(self, sector: np.ndarray) -> np.ndarray:
        """(n, 3) directions of sectors of rims, behind the constant 0."""
        return 1 + self._numbers("constants", sector, 3)

    def laws(self, law: np.ndarray, count: int) -> np.ndarray:
        """(n, count) first coefficients of laws."""
        return self._numbers("laws", law, len(COEFFICIENTS))[:, :count]

    def _numbers(self, part: str, number: np.ndarray, width: int) -> np.ndarray:
        numbers: np.ndarray = self._start[part] + width * number[:, None] + np.arange(width)
        return numbers
