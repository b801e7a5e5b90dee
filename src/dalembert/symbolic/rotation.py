"""Spatial rotations by Euler parameters ``e = (e0, e1, e2, e3)``, the scalar first (Ch. 2).

They map body-frame components to the inertial frame, ``r = R(e) s'``, with ``|e| = 1``. Angular
velocities ``ω'`` and small rotations ``δ'`` have components in body axes. Functions of an angle
that are 0/0 at zero are power series.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import factorial

import casadi as ca

from dalembert.errors import ModelError
from dalembert.symbolic.once import template

IDENTITY = (1.0, 0.0, 0.0, 0.0)
VERSINE_TERMS = 20
"""Terms of the series of ``θ/sin θ`` in ``1 − cos θ``; exact to 1e-13 up to 1 rad."""
TERMS = 10
"""Terms of series in the square of an angle, exact to rounding up to 1.5 rad."""
EULER_PARAMETERS = ("e0", "e1", "e2", "e3")
SPIN = ("turn_x", "turn_y", "turn_z")
"""Names of the components of ``δ'``."""


def power_series(argument: ca.SX, factors: Sequence[float]) -> ca.SX:
    """``Σ cₖ xᵏ`` by Horner's rule."""
    total = ca.SX(0)
    for factor in reversed(factors):
        total = total * argument + factor
    return total


def alternating(square: ca.SX, first: int) -> ca.SX:
    """``Σ (−θ²)^k / (2k + first)!`` of ``θ²``: ``sin θ/θ``, ``(1 − cos θ)/θ²``, …"""
    factors = [(-1) ** k / factorial(2 * k + first) for k in range(TERMS)]
    return power_series(square, factors)


def angle_over_sine(versine: ca.SX, terms: int) -> ca.SX:
    """``θ/sin θ`` of ``1 − cos θ``."""
    factors = [2**k * factorial(k) ** 2 / factorial(2 * k + 1) for k in range(terms)]
    return power_series(versine, factors)


def skew(a: ca.SX) -> ca.SX:
    """``ã`` with ``ã b = a × b``."""
    return ca.vertcat(
        ca.horzcat(0, -a[2], a[1]), ca.horzcat(a[2], 0, -a[0]), ca.horzcat(-a[1], a[0], 0)
    )


@template(4)
def matrix(e: ca.SX) -> ca.SX:
    """``R(e)`` (3, 3) for ``|e| = 1``."""
    w, x, y, z = e[0], e[1], e[2], e[3]
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def about_z(angle: ca.SX) -> ca.SX:
    """Rotation about the z axis."""
    return ca.vertcat(ca.cos(angle / 2), 0, 0, ca.sin(angle / 2))


@template(4, 4)
def product(a: ca.SX, b: ca.SX) -> ca.SX:
    """``a ⊗ b``: rotation b in the frame rotated by a; ``R(a ⊗ b) = R(a) R(b)``."""
    vector = a[0] * b[1:] + b[0] * a[1:] + ca.cross(a[1:], b[1:])
    return ca.vertcat(a[0] * b[0] - ca.dot(a[1:], b[1:]), vector)


def conjugate(e: ca.SX) -> ca.SX:
    """The inverse rotation."""
    return ca.vertcat(e[0], -e[1:])


@template(4, 3)
def rate(e: ca.SX, turning: ca.SX) -> ca.SX:
    """``ė = e ⊗ (0, ω') / 2``."""
    return product(e, ca.vertcat(0, turning)) / 2


@template(4, 3)
def turned(e: ca.SX, turn: ca.SX) -> ca.SX:
    """``e ⊗ (1, δ'/2)``, normalised: e after a small rotation δ'; the inverse of ``turn``.

    It agrees with the exponential to second order.
    """
    moved = product(e, ca.vertcat(1, turn / 2))
    return moved / ca.sqrt(ca.sumsqr(moved))


@template(4, 4)
def turn(e: ca.SX, other: ca.SX) -> ca.SX:
    """Rotation δ' from one orientation to another; infinite for half a turn."""
    between = product(conjugate(e), other)
    return 2 * between[1:] / between[0]


def vector(e: ca.SX) -> ca.SX:
    """(3,) rotation vector of a rotation by less than π/2, the same for e and −e.

    ``θ/sin θ`` times the axial vector, by its series: smooth at zero without a branch.
    """
    versine = 2 * ca.sumsqr(e[1:])
    return angle_over_sine(versine, VERSINE_TERMS) * 2 * e[0] * e[1:]


def exponential(r: ca.SX) -> ca.SX:
    """(3, 3) matrix of a rotation vector shorter than π/2, without a branch (Rodrigues)."""
    cross = skew(r)
    by_first, by_second = (alternating(ca.sumsqr(r), k) for k in (1, 2))
    return ca.SX.eye(3) + by_first * cross + by_second * ca.mtimes(cross, cross)


def turning_map(r: ca.SX) -> ca.SX:
    """(3, 3) ``𝗧'`` of a rotation vector: ``axial(Rᵀ Ṙ) = 𝗧' ṙ``."""
    cross = skew(r)
    by_first, by_second = (alternating(ca.sumsqr(r), k) for k in (2, 3))
    return ca.SX.eye(3) - by_first * cross + by_second * ca.mtimes(cross, cross)


def across(z: ca.SX) -> ca.SX:
    """(3, 2) unit vectors perpendicular to z and to each other, right-handed.

    The formula of Duff et al. (2017) has no singularity.
    """
    sign = ca.if_else(z[2] < 0, -1, 1)
    a = -1 / (sign + z[2])
    b = z[0] * z[1] * a
    first = ca.vertcat(1 + sign * z[0] ** 2 * a, sign * b, -sign * z[0])
    second = ca.vertcat(b, sign + z[1] ** 2 * a, -z[1])
    return ca.horzcat(first, second)


def from_matrix(r: ca.SX) -> ca.SX:
    """Euler parameters of a rotation matrix, by the largest of the four squares (Shepperd 1978)."""
    squares = [
        1 + r[0, 0] + r[1, 1] + r[2, 2],
        1 + r[0, 0] - r[1, 1] - r[2, 2],
        1 - r[0, 0] + r[1, 1] - r[2, 2],
        1 - r[0, 0] - r[1, 1] + r[2, 2],
    ]
    a = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    b = [r[1, 0] + r[0, 1], r[2, 0] + r[0, 2], r[2, 1] + r[1, 2]]
    rows = [
        ca.vertcat(squares[0], a[0], a[1], a[2]),
        ca.vertcat(a[0], squares[1], b[0], b[1]),
        ca.vertcat(a[1], b[0], squares[2], b[2]),
        ca.vertcat(a[2], b[1], b[2], squares[3]),
    ]
    selected, largest = rows[0], squares[0]
    for row, square in zip(rows[1:], squares[1:], strict=True):
        selected = ca.if_else(square > largest, row, selected)
        largest = ca.fmax(square, largest)
    return selected / ca.sqrt(ca.sumsqr(selected))


def angles(r: ca.SX, sequence: str) -> ca.SX:
    """(3,) angles of successive rotations about body axes; ``xyz``: Bryant angles.

    Raises
    ------
    ModelError
        Other than three axes, or the same axis twice in a row.
    """
    valid = isinstance(sequence, str) and len(sequence) == 3 and set(sequence) <= set("xyz")
    if not valid or sequence[1] in (sequence[0], sequence[2]):
        raise ModelError(
            f"angles are about three axes, none twice in a row, as 'xyz' or 'zxz'; got {sequence!r}"
        )
    i, j = ("xyz".index(letter) for letter in sequence[:2])
    k, sign = 3 - i - j, 1 if (j - i) % 3 == 1 else -1
    if sequence[2] == sequence[0]:
        first, third = ca.atan2(r[j, i], -sign * r[k, i]), ca.atan2(r[i, j], sign * r[i, k])
        across = ca.sqrt(r[i, j] ** 2 + r[i, k] ** 2)
        return ca.vertcat(first, ca.atan2(across, r[i, i]), third)
    first, third = ca.atan2(-sign * r[j, k], r[k, k]), ca.atan2(-sign * r[i, j], r[i, i])
    along = ca.sqrt(r[i, i] ** 2 + r[i, j] ** 2)
    return ca.vertcat(first, ca.atan2(sign * r[i, k], along), third)
