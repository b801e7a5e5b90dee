"""Inertia tensors: conversion and physical consistency."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx
from dalembert.symbolic.once import template

ROUNDING = 1e-9
"""Tolerance for rounded moments of inertia, relative to their norm."""
SYMMETRIC = 1e-9
"""Tolerance of the symmetry of an inertia matrix, relative to its largest moment."""


def as_moments(value: Any, entity: str) -> Expression:
    """``(Ixx, Iyy, Izz, Ixy, Iyz, Ixz)`` from three moments, six entries or the matrix.

    Raises
    ------
    ModelError
        Another number of entries, or a matrix that is not symmetric.
    """
    if isinstance(value, Expression):
        sx = value.sx
    else:
        rows = list(value) if np.iterable(value) and not isinstance(value, (str, bytes)) else []
        if len(rows) == 3 and all(isinstance(row, (list, tuple, np.ndarray)) for row in rows):
            return _of_matrix([list(row) for row in rows], entity)
        if len(rows) not in (3, 6):
            raise ModelError(
                "give (Ixx, Iyy, Izz), these followed by Ixy, Iyz, Ixz, or a 3×3 matrix; "
                f"got {value!r}",
                entity,
            )
        sx = as_sx(rows)
    if sx.numel() == 3:
        sx = ca.vertcat(sx, ca.SX.zeros(3))
    return as_expression(Expression(sx), entity, "kg m^2", 6)


def _of_matrix(rows: list[list], entity: str) -> Expression:
    if any(len(row) != 3 for row in rows):
        raise ModelError("an inertia matrix has three rows of three entries", entity)
    sizes = [abs(float(rows[k][k])) for k in range(3) if isinstance(rows[k][k], (int, float))]
    for i, j in ((0, 1), (1, 2), (0, 2)):
        a, b = rows[i][j], rows[j][i]
        numeric = isinstance(a, (int, float)) and isinstance(b, (int, float))
        if numeric and abs(a - b) > SYMMETRIC * max(sizes, default=1.0):
            raise ModelError(
                f"the matrix is not symmetric: entries {i + 1},{j + 1} and {j + 1},{i + 1} are "
                f"{a:g} and {b:g}",
                entity,
            )
    entries = [rows[0][0], rows[1][1], rows[2][2], rows[0][1], rows[1][2], rows[0][2]]
    return as_expression(entries, entity, "kg m^2", 6)


def tensor(moments: ca.SX) -> ca.SX:
    """``J'`` (3, 3) of ``(Ixx, Iyy, Izz, Ixy, Iyz, Ixz)``; zero entries are structural zeros."""
    xx, yy, zz, xy, yz, xz = ca.vertsplit(moments)
    return ca.sparsify(
        ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))
    )


def physical(moments: ca.SX) -> list[Condition]:
    """Conditions for moments of inertia of a physical body.

    ``∫ s sᵀ dm = tr(J)/2 − J`` is positive semidefinite: no principal minor is negative. For the
    diagonal entries this is the triangle inequality of the moments.
    """
    minors = ca.densify(_minors(moments))
    return [
        (
            minors[:3],
            "no body has the moments of inertia ({:g}, {:g}, {:g}): none may exceed the sum of the "
            "other two, and none is negative; mind that they are about the mass centre",
            moments[:3],
        ),
        (
            minors[3:],
            "no body has the moments of inertia ({:g}, {:g}, {:g}) with such products, Ixy, Iyz, "
            "Ixz = ({:g}, {:g}, {:g}): tr(J)/2 − J must be positive semidefinite",
            moments,
        ),
    ]


@template(6)
def _minors(moments: ca.SX) -> ca.SX:
    """(7,) principal minors of ``tr(J)/2 − J`` plus the tolerance for rounding."""
    second = ca.trace(tensor(moments)) / 2 * ca.SX.eye(3) - tensor(moments)
    size = ca.sumsqr(moments) ** 0.5
    singles = ca.diag(second) + ROUNDING * size
    pairs = [
        second[i, i] * second[j, j] - second[i, j] ** 2 + ROUNDING * size**2
        for i, j in ((0, 1), (1, 2), (0, 2))
    ]
    return ca.vertcat(singles, *pairs, ca.det(second) + ROUNDING * size**3)
