"""Rotation vectors: the turn about their direction by their length [rad].

Both maps are smooth at zero: a power series stands in for the quotients ``0/0`` there, and the
closed form is kept finite where it is not taken, so that derivatives of every order are too.
"""

from __future__ import annotations

import casadi as ca

from dalembert.symbolic.rotation import alternating, angle_over_sine

SMALL_SQUARE = 0.25
"""Square of an angle [rad²] below which series are taken."""
SMALL_VERSINE, VERSINE_TERMS = 0.1, 15
"""The same for ``1 − cos θ``, and their number of terms."""


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

    The spin is ``ω = 𝗧 ṙ`` in fixed axes, and ``𝗧ᵀ ṙ`` in axes that turn along. It is
    singular where θ is a multiple of 2π but zero.
    """
    square = ca.sumsqr(r)
    small = square < SMALL_SQUARE
    angle = ca.sqrt(ca.if_else(small, 1.0, square))
    versine = ca.if_else(small, alternating(square, 2), (1 - ca.cos(angle)) / angle**2)
    lag = ca.if_else(small, alternating(square, 3), (angle - ca.sin(angle)) / angle**3)
    cross = ca.skew(r)
    return ca.SX.eye(3) + versine * cross + lag * ca.mtimes(cross, cross)


def turn_of(u: ca.SX) -> ca.SX:
    """(3, 3) rotation of a node of space, whose vector or matrix is behind its displacement."""
    return ca.reshape(u[3:], 3, 3) if u.numel() == 12 else rotation_matrix(u[3:])


def vector_of(u: ca.SX) -> ca.SX:
    """The same as a rotation vector; of a matrix the shortest one, by less than π."""
    return rotation_vector(ca.reshape(u[3:], 3, 3)) if u.numel() == 12 else u[3:]


def carried_by_node(u: ca.SX, v: ca.SX) -> ca.SX:
    """Velocity of a node with its spin in axes that turn with it; ``v`` itself but in space."""
    if v.numel() < 6:
        return v
    return ca.vertcat(v[:3], ca.mtimes(spin_map(u[3:]).T, v[3:]))


def rotation_vector(matrix: ca.SX) -> ca.SX:
    """The vector of a rotation by less than π, ``(θ/sin θ) axial(𝗥 − 𝗥ᵀ)/2``."""
    versine = (3 - ca.trace(matrix)) / 2
    small = versine < SMALL_VERSINE
    apart = ca.if_else(small, 1.0, versine)
    sine = ca.sqrt(apart * (2 - apart))
    near = angle_over_sine(versine, VERSINE_TERMS)
    factor = ca.if_else(small, near, ca.atan2(sine, 1 - apart) / sine)
    return factor * ca.inv_skew((matrix - matrix.T) / 2)
