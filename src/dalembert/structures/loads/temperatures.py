"""Numbers of elements with the changes of temperature of one load case."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from dalembert.structures.evaluation.block import ElementBlock

CHANGES = (
    "temperature",
    "temperature_gradient",
    "temperature_gradient_y",
    "temperature_gradient_z",
)
"""Quantities of elements that are changes of temperature; forces are linear in them."""


@dataclass(frozen=True)
class Temperatures:
    """Changes of temperature of one load case.

    Attributes
    ----------
    heated : block → what temperature adds to it, in the same order of elements
    """

    heated: Mapping[ElementBlock, ElementBlock] = field(default_factory=dict)

    def data(self, block: ElementBlock, p: np.ndarray, share: float, time: float) -> np.ndarray:
        """(m, ne) numbers of the elements with a share of the changes."""
        return self.shared(block, self.source(block).data(p, time), share)

    def shared(self, block: ElementBlock, data: np.ndarray, share: float) -> np.ndarray:
        """Numbers, or changes or weights of them, with a share of the temperatures."""
        if share == 1.0 or block not in self.heated:
            return data
        found = data.copy()
        found[self.rows(block)] *= share
        return found

    def rows(self, block: ElementBlock) -> list[int]:
        """Rows of the changes that this load case makes."""
        if block not in self.heated:
            return []
        return [block.kind.row(name) for name in CHANGES if name in block.kind.quantities]

    def source(self, block: ElementBlock) -> ElementBlock:
        """Whose numbers those of a block are."""
        return self.heated.get(block, block)
