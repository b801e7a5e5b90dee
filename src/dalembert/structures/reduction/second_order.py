"""Displacements of second order that go with shapes, such as the shortening of a bent beam.

Shapes ``φ_k, φ_l`` strain the structure in the second order; static displacements ``Θ_kl`` relieve
it, ``K Θ_kl = −(∂K/∂u · φ_k) φ_l`` with the frame at rest (static modal derivatives: Jain, Tiso,
Rutzmoser and Rixen, A quadratic manifold for model order reduction of nonlinear structural
dynamics, Computers & Structures 188, 2017). Their inertia makes centrifugal stiffening, as in
Kane, Ryan and Banerjee (1987). With them the strain energy stays ``½ Σ k q²`` to the third order,
where products with a softer shape move the stiffest shape of three only, shared among equals.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from dalembert.structures.reduction.craig_bampton import CraigBampton
from dalembert.structures.reduction.interface import Interface

NONE = 1e-7
"""Share of the largest displacement of second order below which one is left out."""


def second_order_shapes(
    reduced: CraigBampton, held: Interface, shapes: np.ndarray, stiffness: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pairs (k, 2) of shapes, by rising stiffness, and (n, k) displacements of ``q_k q_l``.

    Parameters
    ----------
    held : interface in which the frame is fixed
    shapes : (n, m) with the frame at rest, K-orthogonal
    stiffness : (m,) rising
    """
    p, count = reduced.p, shapes.shape[1]
    pairs = list(combinations_with_replacement(range(count), 2))
    strained = [reduced.assembly.geometric(shapes[:, k], p) for k in range(count)]
    loads = np.stack([strained[k] @ shapes[:, l] for k, l in pairs], axis=1)
    relief = _relieved(reduced, held, -loads)
    third = shapes.T @ loads
    for column, (k, l) in enumerate(pairs):
        # what the full relief moves along shape i is −third/stiffness
        share = np.array([_share(i, k, l) for i in range(count)])
        relief[:, column] += shapes @ ((1 - share) * third[:, column] / stiffness)
    relief *= np.array([0.5 if k == l else 1.0 for k, l in pairs])
    sizes = np.abs(relief).max(axis=0)
    kept = sizes > NONE * sizes.max(initial=0.0)
    return np.array(pairs, dtype=int).reshape(-1, 2)[kept], relief[:, kept]


def _share(i: int, k: int, l: int) -> float:
    """Part of the relief of shapes k and l along shape i, by which is the stiffest of the three."""
    three = (i, k, l)
    return 1.0 / three.count(i) if i == max(three) else 0.0


def _relieved(reduced: CraigBampton, held: Interface, loads: np.ndarray) -> np.ndarray:
    """(n, k) static displacements under loads, the held interface at rest, the others rigid.

    By the coordinates of the interfaces and what the loads do between them, which do no work on
    each other.
    """
    inner, size = reduced.assembly, sum(i.motions.shape[1] for i in reduced.interfaces)
    found = np.zeros_like(loads)
    if reduced.factor is not None:
        found[inner.free] = reduced.factor.solve(loads[inner.free])
    moving = np.setdiff1d(np.arange(size), np.arange(size)[reduced.columns[held.name]])
    if moving.size:
        modes = reduced.shapes[:, moving]
        stiffness = reduced.stiffness[np.ix_(moving, moving)]
        found += modes @ np.linalg.solve(stiffness, modes.T @ loads)
    return found
