"""What acts on nodes, one direction at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Load:
    """Forces, or initial motions, in one direction at nodes; one value for all, or one per node.

    Attributes
    ----------
    fixed_axes : whether it is a moment about a fixed spatial axis
    """

    nodes: np.ndarray
    direction: str
    value: Any
    entity: str
    fixed_axes: bool = False

    @property
    def nothing(self) -> np.ndarray:
        """Mask of the nodes at which it is zero for all parameter values."""
        values = self.value if isinstance(self.value, list) else [self.value]
        return np.array([value.sx.is_zero() for value in values])

    @property
    def each(self) -> Any:
        """A formula for all nodes, or an array with one per node."""
        if not isinstance(self.value, list):
            return self.value
        return np.fromiter(self.value, dtype=object, count=len(self.value))
