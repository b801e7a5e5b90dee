"""Velocities of gaps at the end of a step, for bodies that turn within it.

Angular velocities of bodies in space are in axes of the body. In the axes at the start of a step
``y⁺ = y ⊕ h (θ v⁺ + (1−θ) v)``, the speeds at its end are ``E v⁺`` to second order in the turn,
where ``E`` rotates each angular velocity ω about itself,

    E = 1 + c×/s + c× c×/(s (s + 1)),     c = (1−θ) h ω,     s² = 1 + c²,     E v = v

Gaps and impulses have the directions ``W E``,

    u⁺ = W(y) E v⁺ + w,      M (v⁺ − v) = h F + (W(y) E)ᵀ P

With ``W(y)`` alone, the direction of the change of the angular momentum would be wrong by half of
the turn for ``θ = ½``. For a ball and small impulses, the change in a step with the attitude
``e ⊗ (1, h (ω⁺ + ω)/4)`` at the end, normalised, is ``(1 − c×)⁻¹ Eᵀ τ = τ/s`` of a torque normal to
the spin; impacts are those of a ball that does not turn, as ``E`` is a rotation.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import scipy

from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.manifold import Manifold
from dalembert.symbolic.evaluation.kernel import Matrix


def turned_speeds(manifold: Manifold, turn: ca.SX, v: ca.SX) -> ca.SX:
    """``E v`` for a displacement ``turn``, ``(1−θ) h v`` of a step."""
    turned = ca.SX(v)
    for _, first in manifold.attitudes:
        own = slice(first, first + 3)
        root = ca.sqrt(1 + ca.sumsqr(turn[own]))
        across = ca.cross(turn[own], v[own])
        turned[own] += across / root + ca.cross(turn[own], across) / (root * (root + 1))
    return turned


def turned(manifold: Manifold, turn: np.ndarray, contacts: Contacts) -> Contacts:
    """Gaps with the directions ``W E`` for a displacement ``turn``, ``(1−θ) h v`` of a step."""
    first = np.array([speed for _, speed in manifold.attitudes], dtype=int)
    own = first[:, None] + np.arange(3)
    if not (first.size and contacts.count and turn[own].any()):
        return contacts
    matrices = _rotations(turn[own])
    rows = contacts.directions
    if not scipy.sparse.issparse(rows):
        directions = np.array(rows)
        directions[:, own] = np.einsum("iak,akl->ial", rows[:, own], matrices)
        return replace(contacts, directions=directions)
    return replace(contacts, directions=_turned_rows(rows, own, matrices))


def _turned_rows(rows: Matrix, own: np.ndarray, matrices: np.ndarray) -> Matrix:
    """Sparse rows times ``E``."""
    n = rows.shape[1]
    number = np.full(n, -1)
    number[own] = np.arange(len(own))[:, None]
    rows = scipy.sparse.csr_array(rows)
    places = np.flatnonzero(number[rows.indices] >= 0)
    columns, whole = rows.indices[places], places.size % 3 == 0
    if whole and np.array_equal(columns.reshape(-1, 3), own[number[columns[::3]]]):
        data = rows.data.copy()
        parts = data[places].reshape(-1, 1, 3) @ matrices[number[columns[::3]]]
        data[places] = parts.ravel()
        return scipy.sparse.csr_array((data, rows.indices, rows.indptr), shape=rows.shape)
    others = np.flatnonzero(number < 0)
    lines = np.concatenate([others, np.repeat(own.ravel(), 3)])
    turned_to = np.concatenate([others, np.repeat(own, 3, axis=0).ravel()])
    values = np.concatenate([np.ones(others.size), matrices.ravel()])
    product = rows @ scipy.sparse.csr_array((values, (lines, turned_to)), shape=(n, n))
    product.sort_indices()
    return product


def _rotations(turns: np.ndarray) -> np.ndarray:
    """(m, 3, 3) ``E`` of angular velocities times ``(1−θ) h``."""
    cross = np.zeros((len(turns), 3, 3))
    cross[:, [2, 0, 1], [1, 2, 0]] = turns
    cross[:, [1, 2, 0], [2, 0, 1]] = -turns
    root = np.sqrt(1 + (turns**2).sum(axis=1))[:, None, None]
    return np.eye(3) + cross / root + cross @ cross / (root * (root + 1))
