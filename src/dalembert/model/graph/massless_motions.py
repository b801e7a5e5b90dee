"""Motions without kinetic energy, for which dynamics is singular."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.model.graph.assembly.closure import Closure
from dalembert.model.graph.assembly.independence import columns_of, least_fill
from dalembert.model.graph.description import Description
from dalembert.model.graph.natural_units import body_sizes

MASSLESS = 1e-12
"""Threshold for zero mass, relative to the largest one of the same body."""
MOVING = 1e-6
"""Threshold for a body that takes part in a motion, relative to the largest component."""


def massless_bodies(
    d: Description, closure: Closure, mass: scipy.sparse.csc_array
) -> tuple[str, ...]:
    """Bodies that take part in a free motion without kinetic energy, ``C δ = M δ = 0``.

    Masses of different bodies are not compared, as a small ball may move beside a heavy machine.
    An inertia is compared with the mass of its body times the square of the body's reach: the
    characteristic length of the mechanism if the body has a joint, or the size of its shapes.
    """
    if not mass.shape[0]:  # blocks alone
        return ()
    scale = scipy.sparse.diags_array(closure.scales.displacements)
    scaled_mass = scipy.sparse.csr_array(scale @ mass @ scale)
    largest = abs(scaled_mass).max(axis=1).toarray().ravel()
    heavy = np.flatnonzero(largest > MASSLESS * _references(d, closure, largest))
    equations = scipy.sparse.vstack([closure.jacobian[closure.rows], scaled_mass[heavy]])
    motions = columns_of(equations, least_fill(equations))
    if not motions.free:
        return ()
    motion = np.abs(motions.any_kernel(np.random.default_rng(0)))
    moving = motion > MOVING * motion.max()
    return tuple(dict.fromkeys(o for o, m in zip(closure.guesses.owners, moving, strict=True) if m))


def _references(d: Description, closure: Closure, scaled: np.ndarray) -> np.ndarray:
    """(n,) what the mass of each coordinate is compared with, in the same natural units."""
    length = closure.scales.length
    reach = body_sizes(d, closure.all_equations, closure.nominal)
    reach |= {body.name: length for joint in d.constraints for body in joint.parts()}
    kinds = list(zip(closure.guesses.owners, closure.guesses.speed_units, strict=True))
    largest = dict[tuple[str, str], float]()
    for kind, value in zip(kinds, scaled.tolist(), strict=True):
        largest[kind] = max(value, largest.get(kind, 0.0))
    references = [largest[kind] for kind in kinds]
    for k, (owner, unit) in enumerate(kinds):
        if unit == "rad":
            translating = largest.get((owner, "m"), 0.0)
            rotating = translating * (reach.get(owner, 0.0) / length) ** 2
            references[k] = max(references[k], rotating)
    return np.array(references)
