"""Motions of a mechanism in equilibrium that no stiffness resists, and their bodies."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.equilibrium.static_balance import NEUTRAL, Forces
from dalembert.model.graph.model import Model

MOVING = 1e-6
"""Threshold of a moving coordinate, relative to the largest displacement."""
LISTED = 6
"""Upper limit of the bodies that are named."""
REMEDY = "attach them by a joint, spring or support, or prescribe the motion by a driver"


def neutral_warnings(model: Model, forces: Forces) -> list[str]:
    """Warning about an equilibrium that is one of many, because bodies move without resistance."""
    motions = _neutral_motions(forces)
    if not motions.shape[1]:
        return []
    count = motions.shape[1]
    freedom = "1 direction" if count == 1 else f"{count} directions"
    return [
        f"the equilibrium is one of many: nothing resists displacements of "
        f"{_bodies(model, forces.free @ motions)} in {freedom}; {REMEDY}"
    ]


def unbalanced_text(model: Model, forces: Forces) -> str:
    """Message about forces along motions without resistance; empty if there are none."""
    motions = _neutral_motions(forces)
    along = motions.T @ forces.value
    if not np.any(np.abs(along) > NEUTRAL * np.abs(forces.value).max(initial=0.0)):
        return ""
    moving = _bodies(model, forces.free @ motions @ along[:, None])
    return f"; nothing balances the forces on {moving}: {REMEDY}"


def _neutral_motions(forces: Forces) -> np.ndarray:
    """(k, r) orthonormal combinations of the free directions without stiffness."""
    if not (np.all(np.isfinite(forces.stiffness)) and forces.stiffness.size):
        return np.zeros((len(forces.stiffness), 0))
    _, stiffness, directions = np.linalg.svd(forces.stiffness)
    size = max(stiffness[0], np.max(forces.scale, initial=0.0))
    return np.asarray(directions[stiffness <= NEUTRAL * size].T)


def _bodies(model: Model, motions: np.ndarray) -> str:
    """The bodies that move, each with its moving coordinates."""
    guesses, sizes = model.closure.guesses, model.equations.scales.displacements
    lengths = np.linalg.norm(motions[: sizes.size] / sizes[:, None], axis=1)
    moving: dict[str, list[str]] = {}
    names = zip(guesses.owners, guesses.speed_names, lengths, strict=True)
    for owner, name, length in names:
        if length > MOVING * lengths.max():
            moving.setdefault(owner, []).append(name.removeprefix(f"{owner}."))
    parts = [f"{owner} ({', '.join(directions)})" for owner, directions in moving.items()]
    more = len(parts) - LISTED
    return ", ".join([*parts[:LISTED], *([f"{more} more"] if more > 0 else [])])
