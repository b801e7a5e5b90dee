"""Tangents of contacts that follow their normals, as in parallel transport.

    t' = t − (n·t) (n₀ + n) / (1 + n₀·n)

are the tangents ``t`` of a normal ``n₀``, turned to the normal ``n`` about the axis ``n₀ × n``.
Those of ``across`` also spin about the normal, by an angle that depends on the axes of the model.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import casadi as ca
import numpy as np
import scipy

from dalembert.integrators.contact.contacts import Contacts
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel
from dalembert.symbolic.rotation import across


def tangent_rotation(first: ca.SX, normal: ca.SX) -> ca.SX:
    """(2, 2) components of the tangents of a normal that has turned from ``first``, along those of
    ``across``; the identity if it has turned by a right angle or more, or is zero."""
    along = ca.dot(first, normal)
    turns = along > 0
    tangents = across(ca.if_else(turns, first, ca.vertcat(0, 0, 1)))
    own = across(ca.if_else(turns, normal, ca.vertcat(0, 0, 1)))
    share = ca.mtimes(normal.T, tangents) / (1 + ca.fmax(along, 0))
    turned = tangents - ca.mtimes(first + normal, share)
    return ca.if_else(turns, ca.mtimes(turned.T, own), ca.SX.eye(2))


def with_tangents_of(gaps: Contacts, first: np.ndarray, normals: np.ndarray) -> Contacts:
    """Spatial gaps with the tangents of normals ``first`` (n, 3), turned to their own ones.

    Normals that are zero have turned by nothing.
    """
    rotations = _kernel()([first.T], [normals.T])[0]
    rows = np.flatnonzero((rotations != np.eye(2)).any(axis=(1, 2)))
    directions, drift, width = gaps.directions.copy(), gaps.drift.copy(), gaps.drift.shape[1]
    for tangent in (1, 3) if len(gaps.groups) > 1 else (1,):
        own = slice(tangent, tangent + 2)
        drift[rows, own] = (rotations[rows] @ drift[rows, own, None])[..., 0]
        pair = width * rows[:, None] + np.arange(width)[own]
        if isinstance(directions, np.ndarray):
            directions[pair] = rotations[rows] @ directions[pair]
        else:
            _turn_rows(directions, pair, rotations[rows])
    return replace(gaps, directions=directions, drift=drift)


def _turn_rows(matrix: scipy.sparse.csr_array, pair: np.ndarray, rotations: np.ndarray) -> None:
    """Turn pairs of rows (n, 2) of a matrix, each with the same columns, by (n, 2, 2)."""
    sizes = np.diff(matrix.indptr)[pair[:, 0]]
    number = np.repeat(np.arange(sizes.size), sizes)
    within = np.arange(number.size) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    places = matrix.indptr[pair][number] + within[:, None]
    matrix.data[places] = (rotations[number] @ matrix.data[places][..., None])[..., 0]


@cache
def _kernel() -> MappedKernel:
    first, normal = ca.SX.sym("first", 3), ca.SX.sym("normal", 3)
    rotation = ca.densify(tangent_rotation(first, normal))
    return MappedKernel(ca.Function("tangents", [first, normal], [rotation]))
