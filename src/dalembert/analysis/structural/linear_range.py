"""Validity range of linear elasticity: the error of displacements that are linear in the forces.

Internal forces are ``f(u) = K u + ½ G(u) u + …`` with the geometric stiffness ``G``, so that under
the forces ``K u`` of the linear solution the displacements differ from it by

    e = −½ K⁻¹ G(u) u + …

(static modal derivatives: Jain, Tiso, Rutzmoser and Rixen, Computers & Structures 188, 2017): the
shortening of what bends, and the softening or stiffening by axial forces. Where this is no longer
small, nonlinear statics of the same elements under the same forces gives the difference.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.structural.balance import Balance
from dalembert.analysis.structural.nonlinear_statics import LoadPath, NonlinearStatics
from dalembert.analysis.structural.static_equations import StaticEquations
from dalembert.errors import AnalysisError, SingularityError
from dalembert.sparse.solver import Factors
from dalembert.structures.evaluation.assembly import Assembly
from dalembert.structures.evaluation.factors import factors_of
from dalembert.structures.loads.configuration_load import ConfigurationLoad
from dalembert.structures.model import StructuralModel
from dalembert.structures.reduction.rigid import node_places, rigid_motions

RELATIVE = 0.05
"""Error relative to the largest displacement above which a result carries a warning."""
SHORT = 1e-3
"""Rotation at which second differences of internal forces are taken [rad]."""
QUIET = 0.02
"""Rotation [rad], and change of a shape's stiffness by stress, that need no closer look."""
MEASURED = NonlinearStatics(steps=4, tolerance=1e-6)


class HeldStructure(StaticEquations):
    """A structure in a frame, under forces in the axes of the frame.

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
        self.given, self.balance = np.zeros(self.held.size), Balance(model, p)

    def factor(self, stiffness) -> Factors | None:
        return factors_of(self.assembly.inner(stiffness), self.model.degrees, self.free)


@dataclass(frozen=True)
class LinearRange:
    """Linear displacements of a structure, and how far they are from those of its elements.

    Parameters
    ----------
    model : StructuralModel, with exact energies
    p : (np,) parameters
    u : (n,) displacements
    held : numbers of displacements that are zero
    solve : (n,) forces → (n,) displacements by the linear stiffness
    floating : displacements are compared up to rigid motions
    """

    model: StructuralModel
    p: np.ndarray
    u: np.ndarray
    held: np.ndarray
    solve: Callable[[np.ndarray], np.ndarray]
    floating: bool = False

    @cached_property
    def turned(self) -> tuple[float, str]:
        """Largest rotation or strain of a line between nodes of an element, and the element."""
        largest, where, d = 0.0, "", self.model.degrees.dimension
        shift = self.model.degrees.table[:, :d]
        moves = np.where(shift >= 0, self.u[shift], 0.0)
        for block in self.model.assembly.blocks:
            n = block.nodes.shape[0]
            if n < 2:
                continue
            places = block.data(self.p)[: n * d].reshape(n, d, -1)
            apart = np.linalg.norm(places[1:] - places[0], axis=1)
            moved = np.linalg.norm(moves[block.nodes[1:]] - moves[block.nodes[0]], axis=2)
            shares = np.divide(moved, apart, out=np.zeros_like(moved), where=apart > 0).max(axis=0)
            e = int(np.argmax(shares))
            if shares[e] > largest:
                largest, where = float(shares[e]), block.names.name(e)
        return largest, where

    @cached_property
    def places(self) -> np.ndarray:
        """(nodes, d) of the undeformed structure."""
        return node_places(self.model.assembly.blocks, self.model.degrees, self.p)

    @cached_property
    def displacement(self) -> float:
        """The largest of a node [m]."""
        return float(np.linalg.norm(self._moved(self.u) - self.places, axis=1).max(initial=0.0))

    @cached_property
    def extent(self) -> float:
        """Of the structure, along a diagonal [m]."""
        return float(np.linalg.norm(np.ptp(self.places, axis=0)))

    @cached_property
    def second_order(self) -> np.ndarray:
        """(n,) forces ``½ G(u) u``, by a second difference of the internal forces."""
        share = SHORT / max(self.turned[0], 1e-300)
        forces = self.model.assembly.internal_forces
        ahead, behind = forces(share * self.u, self.p), forces(-share * self.u, self.p)
        return (ahead + behind - 2 * forces(0 * self.u, self.p)) / (2 * share**2)

    @cached_property
    def estimate(self) -> float:
        """Error of second order, relative to the largest displacement.

        What can move without straining errs by half of its rotation.
        """
        try:
            return self._error(self.u - self.solve(self.second_order))
        except SingularityError:
            return self.turned[0] / 2

    def measured(self, forces: np.ndarray) -> float:
        """The same against nonlinear statics under forces (n,), infinite where that has no answer.

        Without a stable equilibrium there is none.
        """
        path = LoadPath(MEASURED, HeldStructure(self.model, self.p, self.held, forces))
        try:
            for _ in path.follow():
                pass
            factor = path.record().factor
        except (SingularityError, AnalysisError):
            return np.inf
        stable = not isinstance(factor, Factors) or factor.negative == 0
        return self._error(path.u) if stable and not path.lost else np.inf

    def _moved(self, u: np.ndarray) -> np.ndarray:
        table = self.model.degrees.table[:, : self.model.degrees.dimension]
        return self.places + np.where(table >= 0, u[table], 0.0)

    def _error(self, u: np.ndarray) -> float:
        here, there = self._moved(self.u), self._moved(u)
        if self.floating:
            there = aligned(there, here)
        error = float(np.linalg.norm(there - here, axis=1).max(initial=0.0))
        return error / max(self.displacement, 1e-300)


def linear_doubts(
    model: StructuralModel,
    p: np.ndarray,
    names: Sequence[str],
    u: np.ndarray,
    solve: Callable[[np.ndarray], np.ndarray],
    cure: str,
) -> list[str]:
    """Warnings about displacements (n, states) of a linear analysis that are too large for it.

    Parameters
    ----------
    model : StructuralModel, with exact energies
    names : of the states
    solve : (n,) forces → (n,) displacements
    cure : what to do
    """
    found: list[tuple[float, str]] = []
    for name, column in zip(names, u.T, strict=True):
        near = LinearRange(model, p, column, np.zeros(0, dtype=int), solve)
        if near.turned[0] < QUIET or not np.isfinite(near.turned[0]) or near.estimate < RELATIVE:
            continue
        turn, where = near.turned
        text = (
            f"{name}: displacements reach {near.displacement / max(near.extent, 1e-300):.2g} of "
            f"the size of the structure (rotation or strain of element {where}: {turn:.2g}); those "
            f"of linear equations err by about {percent(near.estimate)} of the largest; {cure}"
        )
        found.append((near.estimate, text))
    if not found:
        return []
    worst = max(found)[1]
    return [worst if len(found) == 1 else f"{worst} ({len(found)} of {len(names)} states)"]


def percent(share: float) -> str:
    """A share by two digits, such as ``56 %``."""
    return f"{float(f'{100 * share:.2g}'):g} %"


def aligned(places: np.ndarray, to: np.ndarray) -> np.ndarray:
    """Places (nodes, d), moved rigidly as near to others as can be (Kabsch 1976)."""
    centre, target = places.mean(axis=0), to.mean(axis=0)
    left, _, right = np.linalg.svd((places - centre).T @ (to - target))
    signs = np.ones(left.shape[0])
    signs[-1] = np.sign(np.linalg.det(left @ right)) or 1.0
    return (places - centre) @ (left * signs @ right) + target


def isostatic(model: StructuralModel, places: np.ndarray, nodes: np.ndarray) -> np.ndarray:
    """Numbers of displacements of nodes that just hold all rigid motions, far from each other."""
    degrees = model.degrees
    motions = rigid_motions(degrees, places - places.mean(axis=0))
    motions[:, degrees.dimension :] /= max(np.ptp(places), 1e-300)
    for chosen in (nodes, np.arange(len(degrees.table))):
        numbers = degrees.table[chosen, : degrees.dimension].ravel()
        rows = motions[numbers]
        if np.linalg.matrix_rank(rows, tol=1e-6) == motions.shape[1]:
            order = scipy.linalg.qr(rows.T, mode="r", pivoting=True)[1]
            return np.sort(numbers[order[: motions.shape[1]]])
    turning = np.flatnonzero(np.isin(np.arange(len(degrees)), degrees.table[nodes]))
    order = scipy.linalg.qr(motions[turning].T, mode="r", pivoting=True)[1]
    return np.sort(turning[order[: motions.shape[1]]])
