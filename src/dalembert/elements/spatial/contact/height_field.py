"""Terrain given by heights over a rectangle."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Look, Rows, Scalar, Vector, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.hull import Hull
from dalembert.elements.contact.shapes import Shape
from dalembert.elements.frame import Frame
from dalembert.elements.spatial.look import Sheet
from dalembert.errors import ModelError
from dalembert.files import readable
from dalembert.symbolic.formulas.conversion import as_expression

MOST = 40_000
"""Upper limit of the number of heights."""
WEIGHT = 20
"""Memory per byte of a file while it is read [bytes]."""


@dataclass(eq=False)
class HeightField(Shape):
    """Material below a surface of triangles, with heights over a rectangle; for ``Collisions``.

    The rectangle lies in the x-y plane of a frame, about its origin. Row ``i`` and column ``j`` of
    the heights are at equal distances along x and y. Each cell consists of two triangles.

    Parameters
    ----------
    point : frame of a body
    size : (2,) lengths of the rectangle along x and y [m]
    heights : (n, m) heights above the x-y plane, in units of the scale
    file : CSV file with these, instead
    scale : length of their unit, which may be a formula [m]

    Raises
    ------
    ModelError
        No grid of finite numbers, or too many of them.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> contact = spatial.contact
    >>> system = da.System("slope", gravity=(0, 0, -10))
    >>> heights = np.outer(np.linspace(0.375, -0.375, 7), np.ones(5))  # slope 3/4
    >>> hill = contact.HeightField(system.ground.frame(), (1.0, 1.0), heights)
    >>> ball = system.add(spatial.Sphere("ball", radius=0.1, mass=1.0, position=(0, 0, 0.125)))
    >>> shapes = [contact.Sphere(ball.center, 0.1), hill]
    >>> touch = system.add(spatial.Collisions("touch", shapes, friction=0.8))
    >>> motion = da.solve_nonsmooth(system.build(), 0.2, step=0.01)
    >>> round(motion["ball.vx"][-1].item(), 6)  # 5/7 g sin α cos α t
    0.685714
    """

    space = 3
    point: Frame = option("frame in whose x-y plane the rectangle lies")
    size: Vector = quantity("m", "lengths along x and y", size=2, above=0.0)
    heights: Rows = option("heights above the x-y plane, by rows along x", default=None)
    file: Path | None = option("CSV file of the heights", default=None)
    scale: Scalar = quantity("m", "length of the unit of the heights", default=1.0, above=0.0)

    def __post_init__(self) -> None:
        if isinstance(self.point, BodyElement):
            self.point = Frame(self.point)
        if not isinstance(self.point, Frame):
            raise ModelError(
                f"needs a frame of a body, e.g. ground.frame(); got {self.point!r:.60}",
                "HeightField",
            )
        if (self.heights is None) == (self.file is None):
            raise ModelError("give either heights or file", "HeightField")
        self.table = self._checked(self._numbers())
        super().__post_init__()

    def _numbers(self) -> np.ndarray:
        if self.file is not None:
            readable(Path(self.file), WEIGHT)
            try:
                with warnings.catch_warnings(action="ignore"):  # of a file without numbers
                    return np.loadtxt(self.file, delimiter=",", ndmin=2)
            except ValueError as error:
                raise ModelError(
                    f"{self.file} is no table of numbers: {str(error).partition(';')[0]}",
                    "HeightField",
                ) from None
        try:
            return np.asarray(self.heights, dtype=float)
        except (TypeError, ValueError):
            pass
        rows = [as_expression(row, "HeightField.heights", "", len(row)).sx for row in self.heights]
        if len({row.numel() for row in rows}) != 1 or not all(row.is_constant() for row in rows):
            raise ModelError(
                "its heights are no rows of as many numbers; give numbers, and scale= as a formula",
                "HeightField",
            )
        return np.array([ca.DM(row).full().ravel() for row in rows])

    @staticmethod
    def _checked(table: np.ndarray) -> np.ndarray:
        if table.ndim != 2 or min(table.shape) < 2:
            text = f"its heights have the shape {table.shape}; give at least 2 by 2 finite numbers"
            raise ModelError(text, "HeightField")
        for i, j in np.argwhere(~np.isfinite(table))[:1].tolist():
            text = (
                f"its height in row {i + 1}, column {j + 1} is {table[i, j]}; give a finite number"
            )
            raise ModelError(text, "HeightField")
        if table.size > MOST:
            text = f"it has {table.size} heights and {MOST} are allowed; give a coarser grid"
            raise ModelError(text, "HeightField")
        return table

    @property
    def carrier(self) -> Any:
        return self.point.body

    @property
    def dimension(self) -> int:
        return 3

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *self.point.conditions()]

    @cached_property
    def triangles(self) -> np.ndarray:
        """(k, 3) numbers of heights, two triangles for each cell, anticlockwise from above."""
        n, m = self.table.shape
        corner = (np.arange(n - 1)[:, None] * m + np.arange(m - 1)).ravel()
        halves = [[corner, corner + m, corner + m + 1], [corner, corner + m + 1, corner + 1]]
        return np.array(halves).transpose(2, 0, 1).reshape(-1, 3)

    @cached_property
    def _edges(self) -> np.ndarray:
        """(k, 2) numbers of heights."""
        sides = np.sort(self.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        return np.unique(sides, axis=0)

    def hull(self) -> Hull:
        """The corner of the grid at height zero, those beside it along x and y, the surface."""
        n, m = self.table.shape
        cell = self.size.sx / ca.DM([n - 1, m - 1])
        axes, origin = self.point.local_axes, self.point.local.sx
        corner = origin - ca.mtimes(axes[:, :2], self.size.sx / 2)
        along = ca.horzcat(axes[:, 0] * cell[0], axes[:, 1] * cell[1], axes[:, 2] * self.scale.sx)
        i, j = np.indices((n, m))
        grid = np.stack([i.ravel(), j.ravel(), self.table.ravel()])
        frame = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
        places = ca.repmat(corner, 1, n * m + 3) + ca.mtimes(along, ca.DM(np.hstack([frame, grid])))
        faces, edges = (tuple(map(tuple, rows + 3)) for rows in (self.triangles, self._edges))
        return Hull(tuple(ca.horzsplit(places)), ca.SX(0), edges, faces, grid=(n, m))

    def look(self, near: ca.SX) -> list[Look]:
        return [Sheet(self.carrier, ca.horzcat(*self.hull().corners[3:]), self.triangles)]
