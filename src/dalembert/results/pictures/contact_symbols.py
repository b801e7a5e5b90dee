"""Contact points and contact forces of a scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.elements.point import AXES
from dalembert.results.contact_forces import ContactForces
from dalembert.results.labelled import LabelledRecording

MOST = 300
"""Upper limit of the contacts drawn at an instant; those with the largest forces."""


def contact_symbols(
    motion: LabelledRecording, keep: np.ndarray, dimension: int
) -> list[dict[str, Any]]:
    """Symbols of contacts with columns of position and force; NaN where a symbol is unused.

    A contact keeps its symbol while it lasts.
    """
    instants = [motion.drawn_contacts(int(row)) for row in keep]
    contacts = [_largest(instant) for instant in instants if instant is not None]
    if not contacts:
        return []
    count = max(instant.keys.size for instant in contacts)
    columns = np.full((count, len(keep), 2, dimension), np.nan)
    names, symbols = np.full(count, "", dtype=object), dict[int, int]()
    for k, instant in enumerate(contacts):
        symbols = _assigned(instant, symbols, count)
        own = [symbols[key] for key in instant.keys.tolist()]
        size = instant.places.shape[1]
        columns[own, k, 0, :size], columns[own, k, 1, :size] = instant.places, instant.forces
        columns[own, k, :, size:] = 0.0
        names[own] = instant.names
    return [_symbol(names[n], columns[n]) for n in range(count)]


def _assigned(instant: ContactForces, before: dict[int, int], count: int) -> dict[int, int]:
    """Symbol of each contact: the same as at the instant before, or a free one."""
    keys = instant.keys.tolist()
    assigned = {key: before[key] for key in keys if key in before}
    free = iter(sorted(set(range(count)) - set(assigned.values())))
    return assigned | {key: next(free) for key in keys if key not in before}


def _largest(instant: ContactForces) -> ContactForces:
    """The contacts with the largest forces."""
    order = np.sort(np.argsort(-np.linalg.norm(instant.forces, axis=1), kind="stable")[:MOST])
    return instant.some(order)


def _symbol(name: str, columns: np.ndarray) -> dict[str, Any]:
    dimension = columns.shape[2]
    symbol: dict[str, Any] = {"name": name, "description": "contact", "symbol": "contact"}
    symbol |= {"body": "ground", "point": [0.0] * dimension, "grounded": False}
    for k, kind in enumerate(("at", "force")):
        symbol |= {f"{kind}_{AXES[n]}": columns[:, k, n].tolist() for n in range(dimension)}
    return symbol
