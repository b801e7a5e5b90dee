"""Element data with the temperature changes of one load case."""

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
"""Element quantities that are temperature changes; forces are linear in them."""


@dataclass(frozen=True)
class Temperatures:
    """Temperature changes of one load case.

    Attributes
    ----------
    heated : block → block of its thermal terms, in the same order of elements
    """

    heated: Mapping[ElementBlock, ElementBlock] = field(default_factory=dict)

    def data(self, block: ElementBlock, p: np.ndarray, share: float, time: float) -> np.ndarray:
        """(m, ne) data of the elements with a share of the temperature changes."""
        return self.shared(block, self.source(block).data(p, time), share)

    def shared(self, block: ElementBlock, data: np.ndarray, share: float) -> np.ndarray:
        """Data, or changes or weights of data, with a share of the temperature changes."""
        if share == 1.0 or block not in self.heated:
            return data
        scaled = data.copy()
        scaled[self.rows(block)] *= share
        return scaled

    def rows(self, block: ElementBlock) -> list[int]:
        """Rows of the temperature changes of this load case."""
        if block not in self.heated:
            return []
        return [block.kind.row(name) for name in CHANGES if name in block.kind.quantities]

    def source(self, block: ElementBlock) -> ElementBlock:
        """The block with the data of a block: its thermal block if it is heated."""
        return self.heated.get(block, block)
