"""What acts on nodes, one direction at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Load:
    """Forces, or an initial motion, in one direction at some nodes: for all, or for each.

    Attributes
    ----------
    fixed_axes : whether it is a moment about a fixed axis of space
    """

    nodes: np.ndarray
    direction: str
    value: Any
    entity: str
    fixed_axes: bool = False

    @property
    def nothing(self) -> np.ndarray:
        """At which nodes it is zero, whatever the parameters are."""
        values = self.value if isinstance(self.value, list) else [self.value]
        return np.array([value.sx.is_zero() for value in values])

    @property
    def each(self) -> Any:
        """A formula for all nodes, or an array with one for each."""
        if not isinstance(self.value, list):
            return self.value
        return np.fromiter(self.value, dtype=object, count=len(self.value))
