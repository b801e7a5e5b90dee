"""Validity range of linear elasticity: the error of displacements that are linear in the forces.

Internal forces are ``f(u) = K u + ½ G(u) u + …`` with the geometric stiffness ``G``, so that under
the forces ``K u`` of the linear solution the displacements differ from it by

    e = −½ K⁻¹ G(u) u + …

(static modal derivatives: Jain, Tiso, Rutzmoser and Rixen, Computers & Structures 188, 2017): the
shortening of bent parts, and the softening or stiffening by axial forces. Where this is no longer
small, nonlinear statics of the same elements under the same forces gives the difference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.equilibrium.load_steps import LoadSteps, StepControl
from dalembert.analysis.equilibrium.static_equations import Balance, StaticEquations
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.stiffness_solvers import factors_of, free_displacements
from dalembert.model.assembled.load_case import ConfigurationLoad
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.assembled.reduction.rigid import node_positions, rigid_motions
from dalembert.sparse.solver import Factors, SparseSolver

RELATIVE = 0.05
"""Error relative to the largest displacement above which a result carries a warning."""
SHORT = 1e-3
"""Rotation for second differences of internal forces [rad]."""
QUIET = 0.02
"""Threshold of rotation [rad], and of relative stiffness change by stress, for a closer check."""
MEASURED = StepControl(steps=4, tolerance=1e-6)


class HeldStructure(StaticEquations):
    """Equations of a structure in a frame, under forces in the axes of the frame.

    Parameters
    ----------
    model : StructuralModel, with exact energies
    p : (np,) parameters
    held : numbers of displacements that are zero
    forces : (n,) on it
    """

    def __init__(self, model: StructuralModel, p: np.ndarray, held: np.ndarray, forces: np.ndarray):
        whole = model.assembly
        self.model, self.p, self.case = model, p, ""
        self.assembly = Assembly(whole.blocks, whole.size, held, whole.pattern)
        self.free, self.held = self.assembly.free, self.assembly.prescribed
        self.applied = forces
        self.moving = ConfigurationLoad([], [], whole.size, held, model.linear)
        self.prescribed, self.balance = np.zeros(self.held.size), Balance(model, p)

    def factor(self, stiffness) -> Factors | None:
        return factors_of(self.assembly.inner(stiffness), self.model.degrees, self.free)


@dataclass(frozen=True)
class LinearRange:
    """Linear displacements of a structure, compared with nonlinear ones.

    Parameters
    ----------
    model : StructuralModel, with exact energies
    p : (np,) parameters
    u : (n,) displacements
    held : numbers of displacements that are zero
    solve : (n,) forces → (n,) displacements by the linear stiffness
    floating : whether displacements are compared up to rigid motions
    """

    model: StructuralModel
    p: np.ndarray
    u: np.ndarray
    held: np.ndarray
    solve: Callable[[np.ndarray], np.ndarray]
    floating: bool = False

    @cached_property
    def largest_rotation(self) -> tuple[float, str]:
        """Largest rotation or strain of a line between nodes of an element, and its name."""
        largest, where, d = 0.0, "", self.model.degrees.dimension
        shift = self.model.degrees.table[:, :d]
        moves = np.where(shift >= 0, self.u[shift], 0.0)
        for block in self.model.assembly.blocks:
            n = block.nodes.shape[0]
            if n < 2:
                continue
            positions = block.data(self.p)[: n * d].reshape(n, d, -1)
            distances = np.linalg.norm(positions[1:] - positions[0], axis=1)
            relative = np.linalg.norm(moves[block.nodes[1:]] - moves[block.nodes[0]], axis=2)
            rotations = np.divide(
                relative, distances, out=np.zeros_like(relative), where=distances > 0
            ).max(axis=0)
            e = int(np.argmax(rotations))
            if rotations[e] > largest:
                largest, where = float(rotations[e]), block.names.name(e)
        return largest, where

    @cached_property
    def undeformed(self) -> np.ndarray:
        """(nodes, d) positions in the undeformed structure [m]."""
        return node_positions(self.model.assembly.blocks, self.model.degrees, self.p)

    @cached_property
    def displacement(self) -> float:
        """Largest displacement of a node [m]."""
        return float(
            np.linalg.norm(self._positions(self.u) - self.undeformed, axis=1).max(initial=0.0)
        )

    @cached_property
    def extent(self) -> float:
        """Diagonal of the bounding box of the structure [m]."""
        return float(np.linalg.norm(np.ptp(self.undeformed, axis=0)))

    @cached_property
    def second_order(self) -> np.ndarray:
        """(n,) forces ``½ G(u) u``, by a second difference of the internal forces."""
        share = SHORT / max(self.largest_rotation[0], 1e-300)
        forces = self.model.assembly.internal_forces
        ahead, behind = forces(share * self.u, self.p), forces(-share * self.u, self.p)
        return (ahead + behind - 2 * forces(0 * self.u, self.p)) / (2 * share**2)

    @cached_property
    def estimate(self) -> float:
        """Second-order error, relative to the largest displacement.

        For rigid motions it is half of the rotation.
        """
        try:
            return self._error(self.u - self.solve(self.second_order))
        except SingularityError:
            return self.largest_rotation[0] / 2

    def nonlinear_error(self, forces: np.ndarray) -> float:
        """Relative error against nonlinear statics under forces (n,).

        It is infinite without a stable equilibrium.
        """
        path = LoadSteps(MEASURED, HeldStructure(self.model, self.p, self.held, forces))
        try:
            for _ in path.follow():
                pass
            stable = path.end().record.negative == 0
        except (SingularityError, AnalysisError):
            return np.inf
        return self._error(path.u) if stable and not path.failure else np.inf

    def _positions(self, u: np.ndarray) -> np.ndarray:
        table = self.model.degrees.table[:, : self.model.degrees.dimension]
        return self.undeformed + np.where(table >= 0, u[table], 0.0)

    def _error(self, u: np.ndarray) -> float:
        linear, nonlinear = self._positions(self.u), self._positions(u)
        if self.floating:
            nonlinear = align(nonlinear, linear)
        error = float(np.linalg.norm(nonlinear - linear, axis=1).max(initial=0.0))
        return error / max(self.displacement, 1e-300)


def linear_range_warnings(
    model: StructuralModel,
    p: np.ndarray,
    names: Sequence[str],
    u: np.ndarray,
    factor: SparseSolver | None = None,
) -> list[str]:
    """Warnings about displacements (n, states) that are too large for a linear analysis.

    Parameters
    ----------
    model : StructuralModel, with exact energies
    names : names of the states
    factor : of the stiffness of the free displacements at rest; by default computed on demand
    """

    def solve(forces: np.ndarray) -> np.ndarray:
        assembly, own = model.linearized.assembly, factor
        if own is None:
            stiffness = assembly.inner(assembly.stiffness(np.zeros_like(forces), p))
            own = factors_of(stiffness, model.degrees, assembly.free)
        return free_displacements(own, assembly.free, forces)

    warnings: list[tuple[float, str]] = []
    for name, column in zip(names, u.T, strict=True):
        linear_range = LinearRange(model, p, column, np.zeros(0, dtype=int), solve)
        turn, element = linear_range.largest_rotation
        if turn < QUIET or not np.isfinite(turn) or linear_range.estimate < RELATIVE:
            continue
        size = linear_range.displacement / max(linear_range.extent, 1e-300)
        error = linear_range.estimate
        text = (
            f"{name}: displacements reach {size:.2g} of "
            f"the size of the structure (rotation or strain of element {element}: {turn:.2g}); "
            f"those of linear equations err by about {percent(error)} of the largest; use "
            "nonlinear=True"
        )
        warnings.append((error, text))
    if not warnings:
        return []
    worst = max(warnings)[1]
    return [worst if len(warnings) == 1 else f"{worst} ({len(warnings)} of {len(names)} states)"]


def percent(share: float) -> str:
    """A share with two digits, such as ``56 %``."""
    return f"{float(f'{100 * share:.2g}'):g} %"


def align(positions: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Positions (nodes, d), moved rigidly as close as possible to others (Kabsch 1976)."""
    centre, target = positions.mean(axis=0), to.mean(axis=0)
    left, _, right = np.linalg.svd((positions - centre).T @ (to - target))
    signs = np.ones(left.shape[0])
    signs[-1] = np.sign(np.linalg.det(left @ right)) or 1.0
    return (positions - centre) @ (left * signs @ right) + target


def isostatic(model: StructuralModel, positions: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Numbers of nodal displacements that suppress all rigid motions, far from each other."""
    degrees = model.degrees
    motions = rigid_motions(degrees, positions - positions.mean(axis=0))
    motions[:, degrees.dimension :] /= max(np.ptp(positions), 1e-300)
    for candidates in (nodes, np.arange(len(degrees.table))):
        numbers = degrees.table[candidates, : degrees.dimension].ravel()
        rows = motions[numbers]
        if np.linalg.matrix_rank(rows, tol=1e-6) == motions.shape[1]:
            order = scipy.linalg.qr(rows.T, mode="r", pivoting=True)[1]
            return np.sort(numbers[order[: motions.shape[1]]])
    rotations = np.flatnonzero(np.isin(np.arange(len(degrees)), degrees.table[nodes]))
    order = scipy.linalg.qr(motions[rotations].T, mode="r", pivoting=True)[1]
    return np.sort(rotations[order[: motions.shape[1]]])
