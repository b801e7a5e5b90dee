"""Shapes of a floating structure as functions of its parameters, with tangent and adjoint.

The adjoint follows the steps of ``FloatingSlopes.push`` in reverse; ``x_bar`` are the weights of
``x``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dalembert.elements.flexible.shapes import FloatingShapes
from dalembert.model.assembled.reduction.basis import modal_basis, modes_of
from dalembert.model.assembled.reduction.craig_bampton import CraigBampton
from dalembert.model.assembled.reduction.floating import (
    NO_PAIRS,
    floating_shapes,
    mass_centre,
    momentum_shares,
    symmetric,
)
from dalembert.model.assembled.reduction.floating_slopes import FloatingSlopes
from dalembert.model.assembled.reduction.rigid import (
    carry_transposed,
    node_positions,
    pull_positions,
    rigid_motions,
    spins,
)


class FloatingWeights:
    """Weights of the parameters (np,) from weights of the shapes and their integrals.

    Parameters
    ----------
    slopes : FloatingSlopes
    weights : of inertia, stiffness, mass, critical damping and sections
    """

    def __init__(self, slopes: FloatingSlopes, weights: FloatingShapes):
        self.forward, self.weights = slopes, weights
        self.reduced, self.degrees = slopes.reduced, slopes.degrees
        self.assembly, self.p = slopes.reduced.assembly, slopes.reduced.p
        self.p_bar = np.zeros(self.p.size)
        self.motions_bar = np.zeros_like(slopes.reduced.shapes)
        self.positions_bar = np.zeros_like(slopes.positions)
        self.origin_bar = np.zeros(slopes.positions.shape[1])

    def parameters(self) -> np.ndarray:
        """(np,) weights of the parameters."""
        f, first, m = self.forward, self.forward.rigid.shape[1], self.forward.count
        stiffness_bar, inertia_bar = self._inertia_weights()
        fields_bar = 2 * f.mass @ (f.fields @ inertia_bar)
        self._pull_mass(f.fields @ inertia_bar, f.fields)
        last = first + f.now.displacements.shape[1]
        rigid_bar, amplitudes_bar = fields_bar[:, :first], fields_bar[:, first:last]
        amplitudes_bar = amplitudes_bar + carry_transposed(self.degrees, fields_bar[:, last:])
        self._sections(amplitudes_bar)
        shapes_bar = amplitudes_bar[:, :m].copy()
        if len(f.pairs):
            self._relief(amplitudes_bar[:, m:], shapes_bar, stiffness_bar)
        stiffness_bar = symmetric(stiffness_bar)
        shapes_bar += 2 * f.stiffness @ (f.shapes @ stiffness_bar)
        self._pull_stiffness(f.shapes @ stiffness_bar, f.shapes)
        if f.held is None:
            shapes_bar, more = self._mean_axes(shapes_bar)
            rigid_bar = rigid_bar + more
        self._shapes(shapes_bar)
        self._rigid(rigid_bar)
        self._origin()
        blocks = self.assembly.blocks
        return self.p_bar + pull_positions(blocks, self.degrees, self.p, self.positions_bar)

    def _inertia_weights(self) -> tuple[np.ndarray, np.ndarray]:
        """Weights of stiffness and inertia, including those of damping and mass."""
        f, w = self.forward, self.weights
        squares, modes = modes_of(f.now.stiffness, f.now.mass)
        frequencies, carrying = np.sqrt(squares), f.now.mass @ modes
        sums = frequencies[:, None] + frequencies
        means = (squares[:, None] + squares) / 2
        own = carrying.T @ symmetric(w.critical) @ carrying
        stiffness_bar = symmetric(w.stiffness) + modes @ (2 * own / sums) @ modes.T
        mass_bar = symmetric(w.mass) + modes @ (own * (sums - 2 * means / sums)) @ modes.T
        inertia_bar = symmetric(w.inertia)
        place = slice(f.rigid.shape[1], f.rigid.shape[1] + f.count)
        inertia_bar[place, place] += mass_bar
        return stiffness_bar, inertia_bar * f.now.counted

    def _sections(self, amplitudes_bar: np.ndarray) -> None:
        d = self.origin_bar.size
        for i in self.reduced.interfaces:
            own, bar = self.forward.now.sections[i.name], self.weights.sections[i.name]
            pushed = np.linalg.pinv(i.motions).T @ np.concatenate([bar.shift, bar.turn])
            amplitudes_bar[i.degrees] += pushed
            moves = np.concatenate([own.shift, own.turn])
            self.motions_bar[i.degrees, self.reduced.columns[i.name]] -= pushed @ moves.T
            self.positions_bar[i.nodes] += bar.place[:d] / len(i.nodes)
            self.origin_bar -= bar.place[:d]

    def _relief(
        self, second_bar: np.ndarray, shapes_bar: np.ndarray, stiffness_bar: np.ndarray
    ) -> None:
        """Second-order displacements; adds to the weights of shapes and stiffness."""
        f, r = self.forward, self.forward.relief
        full_bar = second_bar * r.halves
        shapes_bar += full_bar @ r.along.T
        eased = np.linalg.solve(f.now.stiffness, f.shapes.T @ full_bar)
        stiffness_bar -= eased @ r.along.T
        third_bar = r.subtracted * eased
        shapes_bar += r.loads @ third_bar.T
        efforts_bar, open_bar = r.solve(full_bar)
        loads_bar = f.shapes @ third_bar - efforts_bar
        self._pull_stiffness(-efforts_bar, r.full)
        sides_bar = (-r.loads - f.stiffness @ r.full) @ open_bar.T
        sides_bar += (full_bar - f.stiffness @ efforts_bar) @ r.moves.T
        self.motions_bar[:, r.moving] += sides_bar
        for (k, l), bar in zip(r.pairs, loads_bar.T, strict=True):
            u, x = (np.ascontiguousarray(f.shapes[:, i]) for i in (k, l))
            arguments = np.ascontiguousarray(bar), x, u, self.p
            u_bar, p_bar = self.assembly.pull_stiffness(*arguments, of="change")
            self.p_bar += p_bar
            shapes_bar[:, k] += u_bar
            shapes_bar[:, l] += r.strained[k] @ bar

    def _mean_axes(self, shapes_bar: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the shapes before subtraction of their momenta, and of rigid motions."""
        f = self.forward
        raw = self.reduced.shapes @ f.basis.adapt(self.reduced)[1]
        rigid, heavy = f.rigid, f.mass @ f.rigid
        shares = momentum_shares(f.mass, rigid, raw)
        eased = np.linalg.solve(rigid.T @ heavy, -rigid.T @ shapes_bar)
        inertia_bar = -eased @ shares.T
        heavy_bar = raw @ eased.T + rigid @ inertia_bar
        rigid_bar = -shapes_bar @ shares.T + heavy @ inertia_bar.T + f.mass @ heavy_bar
        self._pull_mass(heavy_bar, rigid)
        return shapes_bar + heavy @ eased, rigid_bar

    def _shapes(self, raw_bar: np.ndarray) -> None:
        f, count = self.forward, self.forward.basis.momenta.shape[1]
        inverse, coordinates = f.basis.adapt(self.reduced)
        moved_bar = raw_bar @ coordinates.T
        if count:
            modes, free = self.reduced.shapes[:, -count:], self.assembly.free
            lost_bar = -inverse.T @ (modes.T @ raw_bar) @ coordinates[-count:].T
            moved_bar[free, -count:] += f.basis.momenta @ lost_bar
        none = np.zeros_like(moved_bar)
        self.p_bar += f.slopes.pull_shapes(moved_bar, none, none.copy(), self.motions_bar)

    def _rigid(self, rigid_bar: np.ndarray) -> None:
        d = self.degrees.dimension
        rows = self.degrees.table[:, :d]
        for k, spin in enumerate(spins(d)):
            arms_bar = rigid_bar[rows, d + k] @ spin
            self.positions_bar += arms_bar
            self.origin_bar -= arms_bar.sum(axis=0)

    def _origin(self) -> None:
        f, bar = self.forward, self.origin_bar
        if f.held is not None:
            self.positions_bar[f.held.nodes] += bar / len(f.held.nodes)
            return
        shift, rows = rigid_motions(self.degrees, f.positions)[:, :1], self.degrees.table[:, 0]
        weights = (f.mass @ shift)[rows, 0]
        bar = bar / weights.sum()
        self.positions_bar += np.outer(weights, bar)
        own = np.zeros_like(shift)
        own[rows, 0] = (f.positions - mass_centre(f.mass, self.degrees, f.positions)) @ bar
        self._pull_mass(own, shift)

    def _pull_mass(self, bars: np.ndarray, table: np.ndarray) -> None:
        self.p_bar += self.forward.slopes.pull_mass(bars, table)

    def _pull_stiffness(self, bars: np.ndarray, table: np.ndarray) -> None:
        self.p_bar += self.forward.slopes.pull_stiffness(bars, table)


class FollowingShapes:
    """Shapes chosen at some parameter values, continued smoothly to others.

    Parameters
    ----------
    model : StructuralModel
    interface, modes, up_to, frame, second_order : see ``StructuralModel.floating``
    parameters : values at which they are chosen

    Attributes
    ----------
    chosen : FloatingShapes at these values
    """

    def __init__(
        self,
        model,
        interface,
        modes: int,
        up_to: float | None,
        frame: str,
        second_order: bool,
        parameters: Mapping[str, float] | None,
    ):
        self.model, self.interface = model, interface
        self._cache: FloatingSlopes | None = None
        reduced = model.craig_bampton(interface, modes, up_to=up_to, parameters=parameters)
        self.modes = reduced.frequencies.size
        positions = node_positions(model.blocks, model.degrees, reduced.p)
        self.basis = modal_basis(reduced, model.degrees, positions, frame)
        arguments = model.degrees, positions, self.basis, None if second_order else NO_PAIRS, model
        shapes = floating_shapes(reduced, *arguments)
        self.pairs = shapes.pairs
        self.chosen: FloatingShapes = replace(
            shapes,
            stiffness=_diagonal(shapes.stiffness),
            mass=_diagonal(shapes.mass),
            critical=_diagonal(shapes.critical),
        )

    def at(self, parameters: Mapping[str, float]) -> FloatingShapes:
        """The shapes at other parameter values of the structure.

        Raises
        ------
        ModelError, AnalysisError
            Invalid values, or values too far for the shapes to follow.
        """
        reduced = self._reduced(parameters)
        positions = node_positions(self.model.blocks, self.model.degrees, reduced.p)
        arguments = self.model.degrees, positions, self.basis, self.pairs, self.model
        return floating_shapes(reduced, *arguments)

    def push(self, parameters: Mapping[str, float], changes: Mapping[str, float]) -> FloatingShapes:
        """Changes of the shapes and their integrals with changes of some parameters."""
        direction = np.array([changes.get(name, 0.0) for name in self.model.parameters])
        return self._slopes(parameters).push(direction)

    def pull(
        self, parameters: Mapping[str, float], weights: FloatingShapes, names: Sequence[str]
    ) -> np.ndarray:
        """Weights of some parameters from weights of the shapes and their integrals."""
        p_bar = FloatingWeights(self._slopes(parameters), weights).parameters()
        all_names = list(self.model.parameters)
        return p_bar[[all_names.index(name) for name in names]]

    def _slopes(self, parameters: Mapping[str, float]) -> FloatingSlopes:
        """Derivatives at parameter values; the last ones are cached."""
        values = self.model.values(parameters)
        if self._cache is None or not np.array_equal(self._cache.reduced.p, values):
            reduced = self._reduced(parameters)
            self._cache = FloatingSlopes(reduced, self.model.degrees, self.basis, self.pairs)
        return self._cache

    def _reduced(self, parameters: Mapping[str, float]) -> CraigBampton:
        return self.model.craig_bampton(self.interface, self.modes, parameters=parameters)


def _diagonal(matrix: np.ndarray) -> np.ndarray:
    """The diagonal part; the rest is round-off."""
    return np.diag(np.diag(matrix))
