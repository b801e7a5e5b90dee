"""Load case: nodal and distributed forces, temperatures, displacement-dependent forces."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from dalembert.elements.fem.energies import CHANGES
from dalembert.errors import UnsupportedError
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.evaluation.inertia import from_rest
from dalembert.symbolic.parametric_array import ParametricArray


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
        return self.scale(block, self.source(block).data(p, time), share)

    def scale(self, block: ElementBlock, data: np.ndarray, share: float) -> np.ndarray:
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


class ConfigurationLoad:
    """Forces of hindered thermal expansion, and of moments about fixed axes.

    They are internal forces, in addition to those of strain; for small displacements those at rest.

    Parameters
    ----------
    expanding : thermal blocks of elements
    moments : blocks of moments about fixed axes
    size : number of displacements
    prescribed : numbers of the prescribed displacements
    linear : for small displacements
    """

    def __init__(
        self,
        expanding: Sequence[ElementBlock],
        moments: Sequence[ElementBlock],
        size: int,
        prescribed: np.ndarray,
        linear: bool,
    ):
        self.linear, self.symmetric = linear, not moments
        self.assembly = Assembly([*expanding, *moments], size, prescribed)
        self.depends_on_time = any(block.depends_on_time for block in self.assembly.blocks)

    def __bool__(self) -> bool:
        return bool(self.assembly.blocks)

    def configuration(self, u: np.ndarray) -> np.ndarray:
        """Displacements at which the forces are evaluated."""
        return np.zeros_like(u) if self.linear else u

    def forces(self, u: np.ndarray, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) internal forces, in addition to those of strain."""
        return self.assembly.internal_forces(self.configuration(u), p, time)

    def stiffness(self, u: np.ndarray, p: np.ndarray) -> scipy.sparse.csc_matrix:
        """Derivative of the forces by the displacements."""
        stiffness = self.assembly.stiffness(self.configuration(u), p)
        return 0 * stiffness if self.linear else stiffness

    def push(self, u: np.ndarray, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the forces with the parameters."""
        return self.assembly.push(self.configuration(u), p, dp, time)

    def pull(
        self, u: np.ndarray, p: np.ndarray, weights: np.ndarray, time: float = 0.0
    ) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return self.assembly.pull(self.configuration(u), p, weights, time)


class Expansion:
    """Thermal loads: forces ``−∂V/∂u`` at rest.

    Parameters
    ----------
    internal : internal forces
    """

    def __init__(self, internal: ConfigurationLoad):
        self.internal, self.depends_on_time = internal, internal.depends_on_time
        self.rest = np.zeros(internal.assembly.size)

    def __bool__(self) -> bool:
        return bool(self.internal)

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces."""
        return -self.internal.forces(self.rest, p, time)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) their change with the parameters."""
        return -self.internal.push(self.rest, p, dp, time)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(np,) weights of the parameters from weights (n,) of the forces."""
        return -self.internal.pull(self.rest, p, weights, time)


@dataclass(frozen=True)
class MassForce:
    """Forces ``M(p) a(p, t)`` of a field of accelerations on the masses of some elements."""

    assembly: Assembly
    field: ParametricArray

    def values(self, p: np.ndarray, time: float) -> np.ndarray:
        """(n,) forces."""
        return self.assembly.mass(p) @ self.field.values(p, time)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float) -> np.ndarray:
        """(n,) their change with the parameters."""
        own = self.assembly.push_inertia(from_rest(self.field.values(p, time)), p, dp)
        return own + self.assembly.mass(p) @ self.field.push(p, dp, time)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float) -> np.ndarray:
        """(m,) weights of the parameters from weights (n,) of the forces."""
        own = self.assembly.pull_inertia(from_rest(self.field.values(p, time)), p, weights)
        return own + self.field.pull(p, self.assembly.mass(p) @ weights, time)

    def turn(self, p: np.ndarray, weights: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(m,) change of the result of ``pull`` with the parameters."""
        field, change = self.field.values(p, 0.0), self.field.push(p, dp, 0.0)
        heavier = self.assembly.push_inertia(from_rest(weights), p, dp)
        return (
            self.assembly.turn_inertia(from_rest(field), p, weights, dp)
            + self.assembly.pull_inertia(from_rest(change), p, weights)
            + self.field.turn(p, self.assembly.mass(p) @ weights, dp)
            + self.field.pull(p, heavier, 0.0)
        )


class LoadCase:
    """Forces on all displacements, ``P(p, t)``.

    Parameters
    ----------
    nodal : forces at nodes
    spread : blocks of dead loads, whose energy is the negative work of the load
    weights : mass forces
    temperatures : temperature changes of the elements
    configuration : displacement-dependent forces, those of hindered expansion included
    fixed_axes : whether there are moments about fixed axes, whose tangent at large displacements is
        not symmetric
    """

    def __init__(
        self,
        nodal: ParametricArray,
        spread: Sequence[ElementBlock],
        weights: Sequence[MassForce],
        temperatures: Temperatures,
        configuration: ConfigurationLoad,
        fixed_axes: bool = False,
    ):
        self.temperatures, self.configuration = temperatures, configuration
        self.fixed_axes = fixed_axes
        self.nodal, self.spread, self.weights = nodal, list(spread), list(weights)
        self.size = nodal.constants.size
        self.depends_on_time = nodal.depends_on_time or any(
            w.field.depends_on_time for w in weights
        )

    def refuse_fixed_axes(self, analysis: str, cure: str) -> None:
        """Raise where an analysis does not support moments about fixed axes.

        Raises
        ------
        UnsupportedError
            There are such moments.
        """
        if self.fixed_axes:
            raise UnsupportedError(
                f"{analysis} does not take moments about fixed axes, whose stiffness is not "
                f"symmetric; {cure}"
            )

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) forces."""
        forces = self.nodal.values(p, time)
        for block, rest in self._at_rest():
            forces -= block.scatter(block.kind.forces(rest, block.data(p)), self.size)
        return forces + sum(w.values(p, time) for w in self.weights)

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) their change with the parameters."""
        change = self.nodal.push(p, dp, time)
        for block, rest in self._at_rest():
            element_change = block.kind.push(rest, block.data(p), block.push_data(p, dp))
            change -= block.scatter(element_change, self.size)
        return change + sum(w.push(p, dp, time) for w in self.weights)

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m,) weights of the parameters from weights (n,) of the forces."""
        p_bar = self.nodal.pull(p, weights, time)
        for block, rest in self._at_rest():
            data_bar = block.kind.pull(rest, block.data(p), block.gather(weights))
            p_bar -= block.pull_data(p, data_bar)
        return p_bar + sum(w.pull(p, weights, time) for w in self.weights)

    def turn(self, p: np.ndarray, weights: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(m,) change of the result of ``pull`` with the parameters."""
        change = self.nodal.turn(p, weights, dp)
        for block, rest in self._at_rest():
            change -= block.turn(rest, p, block.gather(weights), rest, dp)[1]
        return change + sum(w.turn(p, weights, dp) for w in self.weights)

    def _at_rest(self):
        return ((b, np.zeros(b.degrees.shape)) for b in self.spread)
