"""What changes of temperature, and moments about fixed axes, do to a structure in one load case."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.structures.assembly import Assembly
from dalembert.structures.block import ElementBlock

CHANGES = (
    "temperature",
    "temperature_gradient",
    "temperature_gradient_y",
    "temperature_gradient_z",
)
"""Quantities of elements that are changes of temperature; forces are linear in them."""


class ThermalLoad:
    """Forces of elements that cannot expand freely, ``∂V/∂u``, beside those of strain.

    For small displacements they are those at rest. Moments about fixed axes, which depend on the
    displacements likewise, are among them, as forces that would hold the node against them.

    Parameters
    ----------
    heated : block → what temperature adds to it, in the same order of elements
    size : number of displacements
    prescribed : numbers of the prescribed ones
    linear : for small displacements
    moments : blocks of moments about fixed axes
    """

    def __init__(
        self,
        heated: dict[ElementBlock, ElementBlock],
        size: int,
        prescribed: np.ndarray,
        linear: bool,
        moments: Sequence[ElementBlock] = (),
    ):
        self.heated, self.linear = heated, linear
        self.assembly = Assembly([*heated.values(), *moments], size, prescribed)
        self.depends_on_time = any(block.depends_on_time for block in self.assembly.blocks)
        self.symmetric = not moments

    def __bool__(self) -> bool:
        return bool(self.assembly.blocks)

    def place(self, u: np.ndarray) -> np.ndarray:
        """Displacements at which the forces are taken."""
        return np.zeros_like(u) if self.linear else u

    def forces(self, u: np.ndarray, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces that hold the heated elements, beside those of their strain."""
        return self.assembly.internal_forces(self.place(u), p, time)

    def stiffness(self, u: np.ndarray, p: np.ndarray):
        """Their derivative by the displacements."""
        if self.linear:
            return 0 * self.assembly.stiffness(self.place(u), p)
        return self.assembly.stiffness(u, p)

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the forces with the parameters."""
        return self.assembly.push(self.place(u), p, dp, time)

    def pull(self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, time: float = 0.0):
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return self.assembly.pull(self.place(u), p, weights, time)

    @property
    def expansion(self) -> Expansion:
        """The same as loads at small displacements."""
        return Expansion(self)

    # numbers of elements ------------------------------------------------------------------
    def data(self, block: ElementBlock, p: np.ndarray, share: float, time: float) -> np.ndarray:
        """(m, ne) numbers of the elements with a share of the changes of temperature."""
        hot = self.heated.get(block)
        if hot is None:
            return block.data(p)
        return self.shared(block, hot.data(p, time), share)

    def shared(self, block: ElementBlock, data: np.ndarray, share: float) -> np.ndarray:
        """Numbers, or changes or weights of them, with a share of the temperatures."""
        if share == 1.0 or block not in self.heated:
            return data
        found = data.copy()
        found[self.rows(block)] *= share
        return found

    def rows(self, block: ElementBlock) -> list[int]:
        """Rows of the changes of temperature."""
        return [block.kind.row(name) for name in CHANGES if name in block.kind.quantities]

    def source(self, block: ElementBlock) -> ElementBlock:
        """Whose numbers those of a block are."""
        return self.heated.get(block, block)


class Expansion:
    """Forces ``−∂V/∂u`` at rest, with which changes of temperature load a structure."""

    def __init__(self, thermal: ThermalLoad):
        self.thermal, self.depends_on_time = thermal, thermal.depends_on_time
        self.rest = np.zeros(thermal.assembly.size)

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces."""
        return -self.thermal.forces(self.rest, p, time)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) their change with the parameters."""
        return -self.thermal.push(self.rest, p, dp, time)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return -self.thermal.pull(self.rest, p, weights, time)
