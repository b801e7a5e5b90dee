"""Orientations from matrices, axis and angle, Euler and Bryant angles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition
from dalembert.errors import ModelError
from dalembert.symbolic import rotation as turning
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx
from dalembert.text.arguments import check_arguments

__all__ = ["Orientation", "axis_angle", "bryant", "euler", "from_matrix", "identity"]

ORTHONORMAL = 1e-6
"""Upper limit of the deviation of axes from orthonormal ones; smaller ones are corrected."""
NEAR = math.radians(2)
"""Threshold of the distance from the singular attitude for a warning [rad]."""
AXES = "xyz"


class Orientation(Expression):
    """Euler parameters, the scalar first, as a formula of parameters.

    Attributes
    ----------
    off : deviation of the original matrix of formulas from an orthonormal one
    warnings : as ``Element.warnings``

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import rotation
    >>> quarter = rotation.axis_angle((0, 0, 1), math.pi / 2)
    >>> half = quarter @ quarter  # two successive rotations
    >>> isinstance(half, rotation.Orientation), round(float(half.sx[3]), 6)
    (True, 1.0)
    """

    def __init__(self, sx: ca.SX, off: ca.SX | None = None, warnings: Sequence[Condition] = ()):
        super().__init__(sx)
        self.off = ca.SX(0, 1) if off is None else off
        self.warnings = list(warnings)

    @property
    def matrix(self) -> ca.SX:
        """(3, 3) axes of the rotated frame as columns."""
        return turning.matrix(self.sx)

    def __matmul__(self, other: Orientation) -> Orientation:
        """This rotation, then the other one in the rotated frame."""
        off = ca.vertcat(self.off, other.off)
        warnings = [*self.warnings, *other.warnings]
        return Orientation(turning.product(self.sx, other.sx), off, warnings)

    def conditions(self) -> list[tuple[ca.SX, str, ca.SX]]:
        """Orthonormality at the values of the parameters, as ``Element.conditions``."""
        off = ca.vertcat(self.off, ca.sumsqr(self.sx) - 1)
        wrong = (
            "its rotation is none: an axis has no length, or a matrix is off orthonormal by {:.3g}"
        )
        return [within(off, wrong)]


def identity() -> Orientation:
    """The identity.

    Examples
    --------
    >>> from dalembert import rotation
    >>> [float(e) for e in rotation.identity().sx.elements()]  # Euler parameters
    [1.0, 0.0, 0.0, 0.0]
    """
    return Orientation(ca.SX(list(turning.IDENTITY)))


@check_arguments
def axis_angle(axis, angle) -> Orientation:
    """Rotation about an axis.

    Parameters
    ----------
    axis : (3,) direction, of any length
    angle : [rad]

    Examples
    --------
    >>> import math
    >>> import casadi as ca
    >>> import dalembert as da
    >>> turn = da.rotation.axis_angle((0, 0, 2), math.pi / 6)
    >>> ca.DM(turn.matrix[:2, :2]).full().round(6)
    array([[ 0.866025, -0.5     ],
           [ 0.5     ,  0.866025]])
    """
    direction = unit(as_expression(axis, "axis", "", 3).sx, "axis")
    half = as_expression(angle, "angle", "rad").sx / 2
    return Orientation(ca.vertcat(ca.cos(half), ca.sin(half) * direction))


def euler(sequence: str, *angles) -> Orientation:
    """Successive rotations about body axes.

    Parameters
    ----------
    sequence : axes such as ``"zxz"`` (Euler) or ``"xyz"`` (Bryant)
    angles : one per axis [rad]

    Raises
    ------
    ModelError
        Unknown axes, or a different number of angles.

    Examples
    --------
    >>> import math
    >>> import casadi as ca
    >>> from dalembert import rotation
    >>> turn = rotation.euler("zxz", math.pi / 2, math.pi / 6, 0.0)
    >>> ca.DM(turn.matrix[:, 2]).full().ravel().round(6) + 0.0  # direction of the third axis
    array([0.5     , 0.      , 0.866025])
    """
    letters = list(sequence.lower()) if isinstance(sequence, str) else []
    if not letters or any(letter not in AXES for letter in letters):
        raise ModelError(f"a sequence of axes consists of x, y and z; got {sequence!r}", "rotation")
    if len(letters) != len(angles):
        raise ModelError(f"{sequence!r} takes {len(letters)} angles, got {len(angles)}", "rotation")
    orientation = identity()
    for letter, angle in zip(letters, angles, strict=True):
        orientation = orientation @ axis_angle(np.eye(3)[AXES.index(letter)], angle)
    return Orientation(orientation.sx, warnings=_singularity_warnings(letters, angles))


def _singularity_warnings(letters: list[str], angles: Sequence) -> list[Condition]:
    """Warning of angles near the attitude in which the first and third axes coincide."""
    if len(letters) != 3 or letters[1] in (letters[0], letters[2]):
        return []
    middle = as_expression(angles[1], "angle", "rad").sx
    sine = ca.fabs(ca.sin(middle) if letters[0] == letters[2] else ca.cos(middle))
    text = (
        f"its angles {''.join(letters)} are {{:.2g}}° from their singular attitude, where the "
        "first and the third turn about the same axis; another sequence has it elsewhere"
    )
    return [(sine - math.sin(NEAR), text, ca.asin(sine) * 180 / math.pi)]


@check_arguments
def bryant(x, y, z) -> Orientation:
    """Bryant (Cardan) angles: successive rotations about the body's x, y and z axes [rad].

    Parameters
    ----------
    x, y, z : angles [rad], numbers or formulas

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> turn = da.rotation.bryant("10 deg", "20 deg", "30 deg")
    >>> wing = spatial.Body("wing", mass=1.0, inertia=(1, 1, 1), rotation=turn)
    >>> system = da.System("attitude")
    >>> body = system.add(wing)
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    >>> (motion["wing.bryant"][0].values * 180 / math.pi).round(6)  # read back
    array([10., 20., 30.])
    """
    return euler("xyz", x, y, z)


@check_arguments
def from_matrix(rows) -> Orientation:
    """Orientation from a rotation matrix, whose columns are the axes of the rotated frame.

    Parameters
    ----------
    rows : (3, 3) numbers or formulas

    Raises
    ------
    ModelError
        It is not orthonormal, or left-handed.

    Examples
    --------
    >>> import numpy as np
    >>> from dalembert import rotation
    >>> turn = rotation.from_matrix([[0, -1, 0], [1, 0, 0], [0, 0, 1]])  # columns: rotated axes
    >>> [round(float(e) * 2**0.5, 6) for e in turn.sx.elements()]
    [1.0, 0.0, 0.0, 1.0]
    """
    return as_orientation(rows, "rotation")


def as_orientation(value: Any, entity: str) -> Orientation:
    """An orientation from an ``Orientation``, a matrix or a SciPy rotation.

    Raises
    ------
    ModelError
        The value is not an orientation.
    """
    if isinstance(value, Orientation):
        return value
    if hasattr(value, "as_quat"):  # SciPy, scalar last
        parts = np.asarray(value.as_quat(), dtype=float).ravel()
        if parts.size != 4:
            raise ModelError(f"one rotation is needed; got {parts.size // 4}", entity)
        x, y, z, w = parts
        return Orientation(ca.SX([w, x, y, z]))
    try:
        rows = [as_sx(list(row)) for row in value]
    except (TypeError, ValueError):
        rows = []
    if len(rows) != 3 or any(row.numel() != 3 for row in rows):
        raise ModelError(
            "give da.rotation.axis_angle(axis, angle), .euler(…), .bryant(…), a 3×3 matrix or "
            f"scipy.spatial.transform.Rotation; got {value!r}",
            entity,
        )
    matrix = orthonormal(ca.vertcat(*(r.T for r in rows)), entity)
    return Orientation(turning.from_matrix(matrix), off_orthonormal(matrix))


def orthonormal(matrix: ca.SX, entity: str) -> ca.SX:
    """The nearest orthonormal axes, if the deviation is small.

    Raises
    ------
    ModelError
        The axes are not orthonormal, or left-handed.
    """
    if matrix.is_constant():
        numbers = np.array(ca.DM(matrix).full())
        off = np.abs(numbers.T @ numbers - np.eye(3)).max()
        if not off <= ORTHONORMAL:
            raise ModelError(
                f"the axes are not orthonormal, off by {off:.3g}; give columns of length one at "
                "right angles",
                entity,
            )
        if np.linalg.det(numbers) < 0:
            raise ModelError("the axes are left-handed; swap two of them or turn one", entity)
        left, _, right = np.linalg.svd(numbers)
        return ca.SX(left @ right)
    return matrix


def off_orthonormal(matrix: ca.SX) -> ca.SX:
    """Deviation of formulas of axes from right-handed orthonormal ones; empty for numbers."""
    if matrix.is_constant():
        return ca.SX(0, 1)
    products = ca.mtimes(matrix.T, matrix) - ca.SX.eye(3)
    return ca.vertcat(ca.densify(ca.vec(products)), ca.det(matrix) - 1)


def within(off: ca.SX, wrong: str) -> tuple[ca.SX, str, ca.SX]:
    """The condition that a deviation from orthonormal axes is within the limit."""
    size = ca.sqrt(ca.sumsqr(off))  # a norm, because a maximum ignores NaN
    return ORTHONORMAL - size, wrong, size


def unit(vector: ca.SX, entity: str) -> ca.SX:
    """The vector normalised.

    Raises
    ------
    ModelError
        The vector is zero.
    """
    if vector.is_constant() and float(ca.norm_2(vector)) == 0.0:
        raise ModelError("a direction needs a length: all its components are zero", entity)
    return vector / ca.sqrt(ca.sumsqr(vector))
