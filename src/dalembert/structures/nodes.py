"""Sets of nodes as arrays: the points of a mesh and selections of them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


class Nodes:
    """Set of nodes of a structure, returned by ``structure.add_nodes``.

    A node is called ``name[k]``, in formulas and messages, too.

    Parameters
    ----------
    name : str
    points : (count, d) coordinates [m], numbers or formulas
    index : (k,) the selected nodes, by default all
    """

    def __init__(self, name: str, points, index: np.ndarray | None = None):
        self.name = name
        self.points = self._checked(points) if index is None else points
        self.index = np.arange(len(self.points)) if index is None else index

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[1])

    @property
    def names(self) -> list[str]:
        """Names of the selected nodes."""
        return [f"{self.name}[{k}]" for k in self.index]

    @property
    def positions(self) -> np.ndarray:
        """(k, d) coordinates of the selected nodes; formulas are NaN."""
        selected = self.points[self.index]
        if selected.dtype != object:
            return selected
        numbers = [[_number(c) for c in row] for row in selected]
        return np.array(numbers, dtype=float).reshape(selected.shape)

    def __len__(self) -> int:
        return int(self.index.size)

    def __getitem__(self, which) -> Nodes:
        """Selection of these nodes by number, slice or mask."""
        try:
            return Nodes(self.name, self.points, np.atleast_1d(self.index[which]))
        except IndexError:
            raise ModelError(f"has {len(self)} nodes; there is no {which!r}", self.name) from None

    def where(
        self,
        condition: Callable[..., np.ndarray] | None = None,
        *,
        tolerance: float | None = None,
        **coordinates: float,
    ) -> Nodes:
        """Nodes at coordinates, e.g. ``x=0``, or where ``condition(x, y)`` is true.

        Parameters
        ----------
        condition : function of the coordinate arrays to an array of truth values
        tolerance : distance from the coordinates; by default 1e-9 of the extent [m]
        **coordinates : x, y, z

        Raises
        ------
        ModelError
            No node fulfils the condition.
        """
        positions = self.positions
        if tolerance is None:
            tolerance = 1e-9 * float(np.ptp(positions, axis=0).max(initial=0.0))
        mask = np.ones(len(self), dtype=bool)
        for axis, value in coordinates.items():
            if axis not in "xyz"[: self.dimension]:
                raise ModelError(f"has no coordinate {axis!r}", self.name)
            mask &= np.abs(positions[:, "xyz".index(axis)] - value) <= tolerance
        if condition is not None:
            values = np.asarray(condition(*positions.T), dtype=bool)
            if values.shape not in ((), mask.shape):
                raise ModelError(
                    f"the condition gives shape {values.shape}; it needs one truth value for each "
                    f"of {len(self)} nodes",
                    self.name,
                )
            mask &= values
        if not mask.any():
            wanted = ", ".join(f"{a} = {v:g}" for a, v in coordinates.items())
            raise ModelError(f"no node fulfils {wanted or 'the condition'}", self.name)
        return self[mask]

    def nearest(self, *place: float) -> Nodes:
        """The node nearest to a point [m]."""
        if len(place) != self.dimension:
            raise ModelError(f"a place has {self.dimension} coordinates; got {place}", self.name)
        return self[int(np.argmin(np.linalg.norm(self.positions - np.array(place), axis=1)))]

    def _checked(self, points) -> np.ndarray:
        try:
            mixed = np.asarray(points)
        except ValueError:
            raise ModelError("points must all have as many coordinates", self.name) from None
        if mixed.ndim != 2 or not 1 <= mixed.shape[1] <= 3 or not len(mixed):
            raise ModelError(
                f"points must be an array (count, 1 to 3); got shape {mixed.shape}", self.name
            )
        if mixed.dtype == object:
            return mixed
        mixed = mixed.astype(float)
        if not np.all(np.isfinite(mixed)):
            number = int(np.argwhere(~np.isfinite(mixed))[0, 0])
            raise ModelError(f"point {number} is not finite", self.name)
        return mixed

    def __repr__(self) -> str:
        return f"<Nodes {self.name!r}: {len(self)} of {len(self.points)}>"


def _number(value) -> float:
    if isinstance(value, Expression):
        return float(value.sx) if value.sx.is_constant() else np.nan
    return float(value)
