"""Sets of nodes as arrays, such as the points of a mesh, and selections of them."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.elements.fem.nodal import NodeLike
from dalembert.elements.fem.node import RigidMotion, node_body
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, as_sx


class Nodes(NodeLike):
    """Set of nodes, returned by ``system.add_nodes``.

    A node is called ``name[k]``, in formulas and messages, too. In a mechanism each is a body, as
    a single ``Node`` is.

    Parameters
    ----------
    name : str
    points : (count, d) coordinates [m], numbers or formulas
    index : (k,) the selected nodes, by default all
    """

    def __init__(self, name: str, points):
        self.name = name
        self.points = self._checked(points)
        self.index = np.arange(len(self.points))
        self.whole = self
        self.rotates = np.zeros(len(self.points), dtype=bool)
        self.motion: RigidMotion | None = None

    @property
    def dimension(self) -> int:  # type: ignore[override]
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
            index = np.atleast_1d(self.index[which])
        except IndexError:
            raise ModelError(f"has {len(self)} nodes; there is no {which!r}", self.name) from None
        selection = copy(self)
        vars(selection).pop("_all_bodies", None)
        selection.index = index
        return selection

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
        """The node nearest to a point [m].

        Raises
        ------
        ModelError
            Another number of coordinates, or coordinates of nodes that are formulas.
        """
        if len(place) != self.dimension:
            raise ModelError(f"a place has {self.dimension} coordinates; got {place}", self.name)
        away = np.linalg.norm(self.positions - np.array(place), axis=1)
        if np.isnan(away).any():
            raise ModelError("coordinates are formulas; choose a node by its group", self.name)
        return self[int(np.argmin(away))]

    # in a mechanism --------------------------------------------------------------------------
    @property
    def body(self) -> Any:  # type: ignore[override]
        """The only node as a body.

        Raises
        ------
        ModelError
            Several nodes.
        """
        if len(self) != 1:
            raise ModelError(f"has {len(self)} nodes; choose one, e.g. nodes[0]", self.name)
        return self.bodies[0]

    @property
    def bodies(self) -> list[Any]:
        """The selected nodes as bodies."""
        return [self.whole._all_bodies[k] for k in self.index]

    @cached_property
    def _all_bodies(self) -> list[Any]:
        """All nodes of the set as bodies."""
        places = (as_sx(list(row)) for row in self.points)
        return [
            node_body(f"{self.name}[{k}]", place, bool(self.rotates[k]), self.motion)
            for k, place in enumerate(places)
        ]

    def rotate(self, numbers: np.ndarray, entity: str) -> None:
        """Give nodes of the set a rotation, for elements.

        Raises
        ------
        ModelError
            One is already the body of a joint or force, without rotation.
        """
        if "_all_bodies" in vars(self.whole) and not self.rotates[numbers].all():
            raise ModelError(
                f"rotates nodes of {self.name}, which are already points of joints, forces or "
                "formulas; add the elements before these",
                entity,
            )
        self.rotates[numbers] = True

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
