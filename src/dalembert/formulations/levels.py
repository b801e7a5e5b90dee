"""The levels at which constraints hold: of a position, a speed, an acceleration."""

from __future__ import annotations

from enum import IntEnum


class Level(IntEnum):
    """How often ``Φ`` is differentiated: ``Φ = 0``, ``Ψ = 0``, ``C v̇ = ξ``."""

    POSITION = 0
    SPEED = 1
    ACCELERATION = 2


NONE: frozenset[Level] = frozenset()
