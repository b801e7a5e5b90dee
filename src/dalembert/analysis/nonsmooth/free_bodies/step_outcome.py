"""Outcome of a step in machine code, and columns of its record."""

from __future__ import annotations

from enum import IntEnum

DEPTH, LOSS, FRICTION, RESIDUAL, ROUNDS_OF, PRESSED, NUMBERS = range(7)
"""Columns of the record: smallest gap at the start, dissipation, that by friction, residual,
proximal problems and pressing contacts; their number."""


class StepOutcome(IntEnum):
    """Outcome of a call."""

    DONE = 0
    SINGULAR = 1
    OUTDATED = 2
    FULL = 3
    CLOSED = 4
    UNORDERED = 5
    UNSOLVED = 6
    MORE = 7
    UNCHANGED = 8
