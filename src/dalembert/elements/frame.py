"""Frames fixed in bodies: points with axes, to which joints are attached."""

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
"""Threshold of the sine of two directions below which they are parallel."""
Frames = Mapping[str, Mapping[str, Any]]
"""Name → keywords of a frame: ``place``, ``axis``, ``x``, ``axes``, ``rotation``."""


class Frame(Point):
    """A frame fixed in a body; a joint's axis is its z axis.

    Parameters
    ----------
    body : the body
    place : (3,) its origin in the body frame [m]
    axis, x : (3,) its z axis, and its x axis, perpendicular to it, chosen by default
    axes : (3, 3) its axes as columns
    rotation : its orientation in the body frame
    name : str, optional

    Raises
    ------
    ModelError
        Axes that are not a frame, or specified twice.

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
        entity = self.name or f"frame of {body.name}"
        specified = [axis is not None or x is not None, axes is not None, rotation is not None]
        if sum(specified) > 1:
            raise ModelError("give axis=, axes= or rotation=, not several", entity)
        self._rotation_conditions: list[tuple[ca.SX, str, ca.SX]] = []
        self.has_x_axis = x is not None or axis is None
        """Whether its x axis was specified, not chosen."""
        if axes is not None:
            self.local_axes = orthonormal(_matrix(axes, entity), entity)
        elif rotation is not None:
            orientation = as_orientation(rotation, entity)
            self.local_axes = orientation.matrix
            self._rotation_conditions = orientation.conditions()
        elif axis is not None:
            self.local_axes = _about(as_expression(axis, entity, "", 3).sx, x, entity)
        elif x is not None:
            raise ModelError("x= is given without axis=", entity)
        else:
            self.local_axes = ca.SX.eye(3)

    @property
    def orientation(self) -> ca.SX:
        """(4,) its Euler parameters."""
        return product(self.body.orientation, from_matrix(self.local_axes))

    def conditions(self) -> list[tuple[ca.SX, str, ca.SX]]:
        """Orthonormality of its axes at the values of parameters, as ``Element.conditions``."""
        off = off_orthonormal(self.local_axes)
        wrong = (
            f"the axes of a frame of {self.body.name} are off orthonormal ones by {{:.3g}}: "
            "an axis has no length, axis and x are parallel, or a matrix is no rotation"
        )
        return [*self._rotation_conditions, *([within(off, wrong)] if off.numel() else [])]

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
    """Axes about z; the x axis is arbitrary if not specified."""
    z = unit(axis, entity)
    if x is not None:
        direction = unit(as_expression(x, entity, "", 3).sx, entity)
        normal = direction - ca.dot(direction, z) * z
        if normal.is_constant() and float(ca.norm_2(normal)) < PARALLEL:
            raise ModelError("axis and x are parallel", entity)
        normal = unit(normal, entity)
        return ca.horzcat(normal, ca.cross(z, normal), z)
    return ca.horzcat(across(z), z)
