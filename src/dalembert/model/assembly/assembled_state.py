"""Where a mechanism starts, and what had to change for it to close."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass
class AssembledState:
    """Consistent initial state.

    Attributes
    ----------
    y, v : (n,) arrays
    residual : largest remaining violation
    corrections : coordinate name → change of its guess by assembly
    velocity_corrections : speed name → change of its guess, if guesses were inconsistent
    projected_speeds : whether inconsistent guesses of speeds were projected
    """

    y: np.ndarray
    v: np.ndarray
    residual: float
    corrections: dict[str, float] = field(default_factory=dict)
    velocity_corrections: dict[str, float] = field(default_factory=dict)
    projected_speeds: bool = False
