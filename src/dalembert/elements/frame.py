"""Frames fixed in bodies: a point with axes, which joints hold on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from dalembert.elements.base import Vector
from dalembert.elements.point import Carrier, Point
from dalembert.elements.rotation import as_orientation, off_orthonormal, orthonormal, unit, within
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import as_sx
from dalembert.symbolic.rotation import across, from_matrix, product

PARALLEL = 1e-9
Frames = Mapping[str, Mapping[str, Any]]
"""Name → keywords of a frame: ``place``, ``axis``, ``x``, ``axes``, ``rotation``."""


class Frame(Point):
    """A frame fixed in a body; a joint's axis is its z axis.

    Parameters
    ----------
    body : the body
    place : (3,) its origin in the body frame [m]
    axis, x : (3,) its z axis, and its x axis, perpendicular to it; if none is given, one is chosen
    axes : (3, 3) its axes as columns
    rotation : its orientation in the body frame
    name : str, optional

    Raises
    ------
    ModelError
        Axes that are no frame, or given twice.

    Examples
    --------
    >>> from dalembert import spatial
    >>> arm = spatial.Body("arm", mass=1.0, inertia=(0.1, 0.1, 0.1))
    >>> pin = spatial.Frame(arm, (0.5, 0, 0), axis=(0, 1, 0), name="pin")
    >>> slide = arm.frame((0, 0, 0), axis=(1, 0, 0), x=(0, 0, 1))  # by a method of the body
    >>> pin.name, type(slide) is spatial.Frame
    ('arm.pin', True)
    """

    def __init__(
        self,
        body: Carrier,
        place: Vector = (0.0, 0.0, 0.0),
        *,
        axis: Vector | None = None,
        x: Vector | None = None,
        axes: Any = None,
        rotation: Any = None,
        name: str = "",
    ):
        super().__init__(body, place, name)
        spoken = self.name or f"frame of {body.name}"
        ways = [axis is not None or x is not None, axes is not None, rotation is not None]
        if sum(ways) > 1:
            raise ModelError("give axis=, axes= or rotation=, not several", spoken)
        self._given: list[tuple[ca.SX, str, ca.SX]] = []
        self.complete = x is not None or axis is None
        """Whether its x axis was given, and not chosen."""
        if axes is not None:
            self.local_axes = orthonormal(_matrix(axes, spoken), spoken)
        elif rotation is not None:
            orientation = as_orientation(rotation, spoken)
            self.local_axes, self._given = orientation.matrix, orientation.conditions()
        elif axis is not None:
            self.local_axes = _about(as_expression(axis, spoken, "", 3).sx, x, spoken)
        elif x is not None:
            raise ModelError("x= is given without axis=", spoken)
        else:
            self.local_axes = ca.SX.eye(3)

    @property
    def orientation(self) -> ca.SX:
        """(4,) its Euler parameters."""
        return product(self.body.orientation, from_matrix(self.local_axes))

    def conditions(self) -> list[tuple[ca.SX, str, ca.SX]]:
        """That its axes are some at the values of their parameters, as ``Element.conditions``."""
        off = off_orthonormal(self.local_axes)
        wrong = (
            f"the axes of a frame of {self.body.name} are off orthonormal ones by {{:.3g}}: "
            "an axis has no length, axis and x are parallel, or a matrix is no rotation"
        )
        return [*self._given, *([within(off, wrong)] if off.numel() else [])]

    @property
    def axes(self) -> ca.SX:
        """(3, 3) its axes as columns, inertial components."""
        return ca.horzcat(*(self.body.turned(self.local_axes[:, k]) for k in range(3)))

    @property
    def axis(self) -> ca.SX:
        """Its z axis, inertial components."""
        return self.body.turned(self.local_axes[:, 2])


def _matrix(axes: Any, entity: str) -> ca.SX:
    try:
        rows = [as_sx(list(row)) for row in axes]
    except (TypeError, ValueError):
        rows = []
    if len(rows) != 3 or any(row.numel() != 3 for row in rows):
        raise ModelError(f"axes must be a 3×3 matrix, got {axes!r}", entity)
    return ca.vertcat(*(row.T for row in rows))


def _about(axis: ca.SX, x: Vector | None, entity: str) -> ca.SX:
    """Axes about z; without x any others."""
    z = unit(axis, entity)
    if x is not None:
        given = unit(as_expression(x, entity, "", 3).sx, entity)
        beside = given - ca.dot(given, z) * z
        if beside.is_constant() and float(ca.norm_2(beside)) < PARALLEL:
            raise ModelError("axis and x are parallel", entity)
        beside = unit(beside, entity)
        return ca.horzcat(beside, ca.cross(z, beside), z)
    return ca.horzcat(across(z), z)
