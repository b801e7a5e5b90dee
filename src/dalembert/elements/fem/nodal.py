"""Nodes of finite elements, as elements see them: displacements, and rotations by rotation vectors.

A rotation vector is the axis of a rotation times its angle [rad]. Its maps to matrix and spin are
smooth at zero: a power series replaces the quotients ``0/0`` there, and the closed form stays
finite in the unused branch, so that derivatives of all orders are finite.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.errors import ModelError
from dalembert.symbolic.rotation import alternating, angle_over_sine

TRANSLATIONS = ("ux", "uy", "uz")
ROTATIONS = {1: (), 2: ("rz",), 3: ("rx", "ry", "rz")}


def effort(direction: str) -> str:
    """Name of the force or moment along a displacement or rotation: ``fx`` of ``ux``."""
    return direction.replace("u", "f").replace("r", "m")


def missing_rotation(condition: str, entity: str) -> ModelError:
    """Error about a condition on the rotation of a node without one.

    Parameters
    ----------
    condition : name as in the call, such as ``mz``
    entity : of the condition
    """
    return ModelError(
        f"{condition}: no element turns this node; connect an element with rotations to it, such "
        "as a Frame or SpaceFrame",
        entity,
    )


class NodeLike:
    """A node, or a set of nodes.

    Attributes
    ----------
    dimension : number of its coordinates
    body : the node, or the only node of the set, as a body of a mechanism
    """

    name: str
    dimension: int
    body: Any


class Nodal(NodeLike):
    """A node of finite elements: a point with a stress-free position.

    Attributes
    ----------
    natural : SX (d,), stress-free position
    """

    natural: ca.SX


SMALL_SQUARE = 0.25
"""Threshold of the squared angle below which series are used [rad²]."""
SMALL_VERSINE, VERSINE_TERMS = 0.1, 15
"""Threshold of ``1 − cos θ`` below which its series is used, and its number of terms."""


def rotation_matrix(r: ca.SX) -> ca.SX:
    """``exp [r]× = 𝟭 + (sin θ/θ) [r]× + ((1 − cos θ)/θ²) [r]×²`` (Rodrigues), θ = |r|."""
    square = ca.sumsqr(r)
    small = square < SMALL_SQUARE
    angle = ca.sqrt(ca.if_else(small, 1.0, square))
    sine = ca.if_else(small, alternating(square, 1), ca.sin(angle) / angle)
    versine = ca.if_else(small, alternating(square, 2), (1 - ca.cos(angle)) / angle**2)
    cross = ca.skew(r)
    return ca.SX.eye(3) + sine * cross + versine * ca.mtimes(cross, cross)


def spin_map(r: ca.SX) -> ca.SX:
    """``𝗧 = 𝟭 + ((1 − cos θ)/θ²) [r]× + ((θ − sin θ)/θ³) [r]×²``.

    The angular velocity is ``ω = 𝗧 ṙ`` in fixed axes, and ``𝗧ᵀ ṙ`` in rotating axes. The map is
    singular at nonzero multiples θ of 2π.
    """
    square = ca.sumsqr(r)
    small = square < SMALL_SQUARE
    angle = ca.sqrt(ca.if_else(small, 1.0, square))
    versine = ca.if_else(small, alternating(square, 2), (1 - ca.cos(angle)) / angle**2)
    lag = ca.if_else(small, alternating(square, 3), (angle - ca.sin(angle)) / angle**3)
    cross = ca.skew(r)
    return ca.SX.eye(3) + versine * cross + lag * ca.mtimes(cross, cross)


def turn_of(u: ca.SX) -> ca.SX:
    """(3, 3) rotation of a spatial node, from the vector or matrix after its displacement."""
    return ca.reshape(u[3:], 3, 3) if u.numel() == 12 else rotation_matrix(u[3:])


def vector_of(u: ca.SX) -> ca.SX:
    """Rotation vector of a spatial node; that of a matrix is shorter than π."""
    return rotation_vector(ca.reshape(u[3:], 3, 3)) if u.numel() == 12 else u[3:]


def in_node_axes(u: ca.SX, v: ca.SX) -> ca.SX:
    """Velocity of a spatial node with its angular velocity in node axes; others unchanged."""
    if v.numel() < 6:
        return v
    return ca.vertcat(v[:3], ca.mtimes(spin_map(u[3:]).T, v[3:]))


def rotation_vector(matrix: ca.SX) -> ca.SX:
    """Vector of a rotation by less than π, ``(θ/sin θ) axial(𝗥 − 𝗥ᵀ)/2``."""
    versine = (3 - ca.trace(matrix)) / 2
    small = versine < SMALL_VERSINE
    safe_versine = ca.if_else(small, 1.0, versine)
    sine = ca.sqrt(safe_versine * (2 - safe_versine))
    near = angle_over_sine(versine, VERSINE_TERMS)
    factor = ca.if_else(small, near, ca.atan2(sine, 1 - safe_versine) / sine)
    return factor * ca.inv_skew((matrix - matrix.T) / 2)
