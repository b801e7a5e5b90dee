"""Sums over the elements of a small structure as graphs of displacements and parameters."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.elements.fem.energies import Rows
from dalembert.model.assembled.evaluation.block import ElementBlock
from dalembert.model.assembled.load_case import LoadCase
from dalembert.model.assembled.measures import (
    Compliance,
    Displacement,
    ElementMeasure,
    ExternalForce,
    LoadFactor,
    Measure,
    Total,
)
from dalembert.model.assembled.model import StructuralModel

MEASURES = (Compliance, Displacement, ElementMeasure, ExternalForce, LoadFactor, Total)
"""Measures with a graph."""


class StructureGraph:
    """Forces, matrices and measures of a structure with small displacements.

    Parameters
    ----------
    model : for small displacements
    p : MX (np,) symbols of the parameters
    """

    def __init__(self, model: StructuralModel, p: ca.MX):
        self.model, self.p = model, p
        self.free = model.assembly.free
        self.size, self.count = model.assembly.size, self.free.size
        self._quantities: dict[tuple[int, str, int], ca.MX] = {}

    # displacements ------------------------------------------------------------------------
    def displaced(self, free: ca.MX, prescribed: bool = True) -> ca.MX:
        """(n,) displacements from the free ones; the others prescribed, or zero."""
        u = ca.mtimes(_places(self.size, self.free), free)
        held = self.model.assembly.prescribed
        if not prescribed or not held.size:
            return u
        return u + ca.mtimes(_places(self.size, held), self.model.prescribed.graph(self.p))

    def gathered(self, block: ElementBlock, u: ca.MX) -> ca.MX:
        """(k, ne) displacements of the elements."""
        numbers = block.degrees.ravel(order="F").tolist()
        return ca.reshape(u[numbers], *block.degrees.shape)

    def _scattered(self, block: ElementBlock, forces: ca.MX) -> ca.MX:
        return ca.mtimes(_places(self.size, block.degrees.ravel(order="F")), ca.vec(forces))

    # forces -------------------------------------------------------------------------------
    def internal_forces(self, u: ca.MX) -> ca.MX:
        """(n,) of strain."""
        return self._forces(self.model.assembly.blocks, u)

    def _forces(self, blocks: Sequence[ElementBlock], u: ca.MX) -> ca.MX:
        total = ca.MX.zeros(self.size)
        for b in blocks:
            columns = self.gathered(b, u), b.data_graph(self.p)
            total += self._scattered(b, _summed(b, "force", b.kind.cls.samples, *columns))
        return total

    def applied(self, case: LoadCase) -> ca.MX:
        """(n,) forces of a load case."""
        forces = case.nodal.graph(self.p) - self._forces(case.spread, ca.MX.zeros(self.size))
        for weight in case.weights:
            forces += self._inertia(weight.assembly.blocks, weight.field.graph(self.p))
        return forces

    def inertia(self, accelerations: ca.MX) -> ca.MX:
        """(n,) mass matrix times accelerations of all displacements."""
        return self._inertia(self.model.assembly.blocks, accelerations)

    def _inertia(self, blocks: Sequence[ElementBlock], accelerations: ca.MX) -> ca.MX:
        total = ca.MX.zeros(self.size)
        for b in blocks:
            field, masses, k = self.gathered(b, accelerations), self._masses(b), b.degrees.shape[0]
            products = [
                ca.mtimes(ca.reshape(masses[:, e], k, k), field[:, e]) for e in range(b.count)
            ]
            total += self._scattered(b, ca.horzcat(*products))
        return total

    # matrices -----------------------------------------------------------------------------
    def stiffness(self) -> ca.MX:
        """(f², 1) entries of the stiffness of the free displacements, by columns."""
        blocks, rest = self.model.assembly.blocks, ca.MX.zeros(self.size)
        parts = []
        for b in blocks:
            columns = self.gathered(b, rest), b.data_graph(self.p)
            parts.append(_summed(b, "tangent", b.kind.cls.samples, *columns))
        return self._assembled(blocks, parts)

    def mass(self) -> ca.MX:
        """(f², 1) entries of the consistent mass matrix of the free displacements, by columns."""
        blocks = self.model.assembly.blocks
        return self._assembled(blocks, [self._masses(b) for b in blocks])

    def _masses(self, b: ElementBlock) -> ca.MX:
        return _summed(b, "masses", b.kind.cls.kinetic_samples, b.data_graph(self.p))

    def _assembled(self, blocks: Sequence[ElementBlock], parts: list[ca.MX]) -> ca.MX:
        number = np.full(self.size, -1)
        number[self.free] = np.arange(self.count)
        total = ca.MX.zeros(self.count**2)
        for b, part in zip(blocks, parts, strict=True):
            at = number[b.degrees]
            place = at[:, None] * self.count + at[None]
            inside = ((at[:, None] >= 0) & (at[None] >= 0)).ravel(order="F")
            entries = np.flatnonzero(inside)
            rows = place.ravel(order="F")[entries]
            shape = (self.count**2, inside.size)
            ones = [1.0] * entries.size
            sums = ca.DM.triplet(rows.tolist(), entries.tolist(), ones, *shape)
            total += ca.mtimes(sums, ca.vec(part))
        return total

    # measures -----------------------------------------------------------------------------
    def measure(self, measure: Measure, u: ca.MX, forces: ca.MX) -> ca.MX:
        """A measure of a state."""
        if isinstance(measure, Displacement):
            return u[measure.degree]
        if isinstance(measure, ExternalForce):
            return forces[measure.degree]
        if isinstance(measure, Compliance):
            return ca.dot(u, forces)
        if isinstance(measure, LoadFactor):
            return ca.MX(1.0)
        if isinstance(measure, Total):
            return sum(
                (ca.sum1(self._quantity(b, measure.name, u)) for b in measure.blocks), ca.MX(0)
            )
        assert isinstance(measure, ElementMeasure)
        values = self._quantity(measure.block, measure.name, u)[measure.rows.tolist()]
        if measure.reduction == "sum":
            return ca.sum1(values)
        sign = 1.0 if measure.reduction == "max" else -1.0
        top = ca.mmax(sign * values)
        if measure.smooth is not None:
            top += ca.log(ca.sum1(ca.exp(measure.smooth * (sign * values - top)))) / measure.smooth
        return sign * top

    def _quantity(self, b: ElementBlock, name: str, u: ca.MX) -> ca.MX:
        """(ne,) quantity of the elements."""
        key = id(b), name, u.__hash__()
        if key not in self._quantities:
            base, samples = b.kind.station(name)
            columns = self.gathered(b, u), b.data_graph(self.p)
            self._quantities[key] = ca.vec(_summed(b, f"measure {base}", samples, *columns))
        return self._quantities[key]


def _summed(b: ElementBlock, name: str, samples: Rows, *columns: ca.MX) -> ca.MX:
    """Results of a function of the elements, summed over the samples."""
    function = b.kind.graphs.function(name).map(b.count)
    parts = [
        function(ca.repmat(ca.DM(np.reshape(at, (len(at), 1))), 1, b.count), *columns)
        for at in samples
    ]
    return sum(parts[1:], parts[0])


def _places(size: int, numbers: np.ndarray) -> ca.DM:
    """Matrix that adds entries at their numbers."""
    columns, ones = list(range(numbers.size)), [1.0] * numbers.size
    return ca.DM.triplet(np.asarray(numbers).tolist(), columns, ones, size, numbers.size)
