"""Tangent of the shapes of a floating structure, and of their integrals, by its parameters.

The quantities of ``floating_shapes`` are differentiated in the same order; ``x_`` is the change of
``x`` along a direction of the parameters.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from dalembert.elements.flexible.shapes import FloatingShapes, SectionShapes
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.assembled.reduction.basis import ShapeBasis, modes_of
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton
from dalembert.model.assembled.reduction.floating import (
    Relief,
    floating_shapes,
    mass_centre,
    momentum_shares,
    symmetric,
)
from dalembert.model.assembled.reduction.rigid import (
    carry,
    node_positions,
    push_positions,
    rigid_motions,
)
from dalembert.model.assembled.reduction.slopes import ReductionSlopes


class FloatingSlopes:
    """Directional derivatives of the shapes of a floating structure.

    Parameters
    ----------
    reduced : CraigBampton
    basis : ShapeBasis
    pairs : (k, 2) shapes whose products have second-order displacements
    """

    def __init__(
        self, reduced: CraigBampton, degrees: Numbering, basis: ShapeBasis, pairs: np.ndarray
    ):
        self.reduced, self.degrees, self.basis, self.pairs = reduced, degrees, basis, pairs
        self.slopes = ReductionSlopes(reduced, degrees)
        self.stiffness, self.mass = self.slopes.stiffness, self.slopes.mass
        self.held = basis.held(reduced)
        self.positions = node_positions(reduced.assembly.blocks, degrees, reduced.p)
        self.now = floating_shapes(reduced, degrees, self.positions, basis, pairs, None)
        self.rigid = rigid_motions(degrees, self.positions - self.now.origin)
        self.count = self.now.count
        self.shapes = self.now.displacements[:, : self.count]

    @cached_property
    def fields(self) -> np.ndarray:
        """(n, N) ``W`` of all nodes."""
        amplitudes = self.now.displacements
        return np.concatenate([self.rigid, amplitudes, carry(self.degrees, amplitudes)], axis=1)

    @cached_property
    def relief(self) -> Relief:
        held = self.held
        assert held is not None
        return Relief(self.reduced, held, self.shapes, self.now.stiffness, self.pairs)

    def push(self, dp: np.ndarray) -> FloatingShapes:
        """Changes of inertia, stiffness, damping and sections along a change of the parameters."""
        positions_ = push_positions(self.reduced.assembly.blocks, self.degrees, self.reduced.p, dp)
        origin_ = self._origin(positions_, dp)
        rigid_ = rigid_motions(self.degrees, positions_ - origin_)
        rigid_ -= rigid_motions(self.degrees, np.zeros_like(positions_))  # the constant part
        shapes_ = self._shapes(rigid_, dp)
        stiffer = self.slopes.push_stiffness(self.shapes, dp)
        stiffness_ = 2 * symmetric(shapes_.T @ (self.stiffness @ self.shapes))
        stiffness_ += symmetric(self.shapes.T @ stiffer)
        amplitudes_ = shapes_
        if len(self.pairs):
            second_ = self._relief(shapes_, stiffness_, dp)
            amplitudes_ = np.concatenate([shapes_, second_], axis=1)
        fields_ = np.concatenate([rigid_, amplitudes_, carry(self.degrees, amplitudes_)], axis=1)
        heavier = self.slopes.push_mass(self.fields, dp)
        inertia_ = 2 * symmetric(fields_.T @ (self.mass @ self.fields))
        inertia_ += symmetric(self.fields.T @ heavier)
        inertia_ *= self.now.counted
        first = self.rigid.shape[1]
        mass_ = inertia_[first : first + self.count, first : first + self.count]
        return replace(
            self.now,
            stiffness=stiffness_,
            mass=mass_,
            critical=self._critical(stiffness_, mass_),
            inertia=inertia_,
            sections=self._sections(positions_, origin_, amplitudes_, dp),
            origin=origin_,
            displacements=amplitudes_,
        )

    def _origin(self, positions_: np.ndarray, dp: np.ndarray) -> np.ndarray:
        if self.held is not None:
            return positions_[self.held.nodes].mean(axis=0)
        d = self.degrees.dimension
        shift = rigid_motions(self.degrees, self.positions)[:, :1]
        rows = self.degrees.table[:, 0]
        weights = (self.mass @ shift)[rows, 0]
        weights_ = self.slopes.push_mass(shift, dp)[rows, 0]
        total, total_ = weights.sum(), float(shift[:, 0] @ self.slopes.push_mass(shift, dp)[:, 0])
        centre = mass_centre(self.mass, self.degrees, self.positions)
        return (weights_ @ self.positions + weights @ positions_ - total_ * centre)[:d] / total

    def _shapes(self, rigid_: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(n, m) changes of the shapes: those of the reduction, minus the momenta in mean axes."""
        moved, count = self.slopes.push_shapes(dp), self.basis.momenta.shape[1]
        inverse, coordinates = self.basis.adapt(self.reduced)
        shapes_ = moved @ coordinates
        if count:
            modes, free = self.reduced.shapes[:, -count:], self.reduced.assembly.free
            lost = self.basis.momenta.T @ moved[free, -count:]
            shapes_ -= modes @ (inverse @ (lost @ coordinates[-count:]))
        if self.held is not None:
            return shapes_
        raw = self.reduced.shapes @ coordinates
        rigid, heavy = self.rigid, self.mass @ self.rigid
        heavy_ = self.slopes.push_mass(rigid, dp) + self.mass @ rigid_
        shares = momentum_shares(self.mass, rigid, raw)
        inertia_ = rigid_.T @ heavy + rigid.T @ heavy_
        momenta_ = heavy_.T @ raw + heavy.T @ shapes_
        shares_ = np.linalg.solve(rigid.T @ heavy, momenta_ - inertia_ @ shares)
        return shapes_ - rigid_ @ shares - rigid @ shares_

    def _relief(self, shapes_: np.ndarray, stiffness_: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(n, k) changes of the second-order displacements."""
        r = self.relief
        loads_ = np.stack([self._load(k, l, shapes_, dp) for k, l in r.pairs], axis=1)
        sides = self.slopes.push_motions(dp)[:, r.moving]
        apart = sides @ r.moves
        efforts = -loads_ - self.slopes.push_stiffness(r.full, dp) - self.stiffness @ apart
        interface_loads = sides.T @ (-r.loads - self.stiffness @ r.full)
        full_ = apart + r.solve(efforts, interface_loads)[0]
        third_ = shapes_.T @ r.loads + self.shapes.T @ loads_
        along_ = np.linalg.solve(self.now.stiffness, r.subtracted * third_ - stiffness_ @ r.along)
        return (full_ + shapes_ @ r.along + self.shapes @ along_) * r.halves

    def _load(self, k: int, l: int, shapes_: np.ndarray, dp: np.ndarray) -> np.ndarray:
        u, x = (np.ascontiguousarray(self.shapes[:, i]) for i in (k, l))
        changed = self.reduced.assembly.push_stiffness(
            x, u, self.reduced.p, np.ascontiguousarray(shapes_[:, k]), dp, of="change"
        )
        return changed + self.relief.strained[k] @ shapes_[:, l]

    def _critical(self, stiffness_: np.ndarray, mass_: np.ndarray) -> np.ndarray:
        """Change of ``2 M (M⁻¹ K)^½``, in modal coordinates; frequencies may coincide."""
        squares, modes = modes_of(self.now.stiffness, self.now.mass)
        frequencies, carrying = np.sqrt(squares), self.now.mass @ modes
        a, b = modes.T @ mass_ @ modes, modes.T @ stiffness_ @ modes
        sums = frequencies[:, None] + frequencies
        means = (squares[:, None] + squares) / 2
        return carrying @ (2 * (b - a * means) / sums + a * sums) @ carrying.T

    def _sections(
        self, positions_: np.ndarray, origin_: np.ndarray, amplitudes_: np.ndarray, dp: np.ndarray
    ) -> dict[str, SectionShapes]:
        motions_, sections, d = self.slopes.push_motions(dp), {}, origin_.size
        for i in self.reduced.interfaces:
            section = self.now.sections[i.name]
            moves = np.concatenate([section.shift, section.turn])
            apart = motions_[i.degrees, self.reduced.columns[i.name]] @ moves
            moves_ = np.linalg.lstsq(i.motions, amplitudes_[i.degrees] - apart, rcond=None)[0]
            place_ = positions_[i.nodes].mean(axis=0) - origin_
            sections[i.name] = SectionShapes(place_, moves_[:d], moves_[d:])
        return sections
