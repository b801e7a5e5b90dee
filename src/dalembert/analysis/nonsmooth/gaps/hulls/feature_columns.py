"""Arguments of the gap functions of pairs of features, by the positions of the shapes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.positions import Positions


@dataclass(frozen=True, eq=False)
class FeatureColumns:
    """Features of one body of each pair.

    Attributes
    ----------
    shape : (n,) numbers of the shapes
    wall : (n,) numbers of the walls; None for hulls
    corners : (n, k) numbers of the corners that define each feature; None for walls
    start : (n, 3) starts for the angles of rims; None for other features
    sharp : (n,) mask of the features without a radius; None if all have that of their shape
    """

    shape: np.ndarray
    wall: np.ndarray | None = None
    corners: np.ndarray | None = None
    start: np.ndarray | None = None
    sharp: np.ndarray | None = None

    def __call__(self, at: Positions) -> np.ndarray:
        """(m, n) points, radii and reference points of the bodies at a position."""
        points = at.corners[self.corners] if self.wall is None else at.walls[self.wall]
        count = points.shape[1]
        m = 3 * count if self.start is None else 3 * count + 3
        columns = np.empty((self.shape.size, m + 4))
        columns[:, : 3 * count] = points.reshape(-1, 3 * count)
        if self.start is not None:
            columns[:, 3 * count : m] = self.start
        columns[:, m] = at.radii[self.shape]
        if self.sharp is not None:
            columns[self.sharp, m] = 0.0
        columns[:, m + 1 :] = at.origins[self.shape]
        return columns.T
