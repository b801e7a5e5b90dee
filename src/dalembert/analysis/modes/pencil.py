"""Pairs of symmetric matrices of a structure, ``A φ = λ B φ``, with derivatives by the parameters.

Vibration has ``A = K`` and ``B = M``; buckling has ``A = −K_g`` and ``B = K``. Each matrix is a sum
of terms; a term may depend on the displacements of a preceding static analysis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.model.assembled.evaluation.assembly import Assembly
from dalembert.model.assembled.evaluation.inertia import from_rest
from dalembert.model.assembled.evaluation.pattern import combine
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.result import StructuralResult


@dataclass(frozen=True, eq=False)
class Loaded:
    """A structure at rest or under one load case.

    Attributes
    ----------
    model : StructuralModel
    p : (np,) parameters
    result : statics with one load case; None at rest
    """

    model: StructuralModel
    p: np.ndarray
    result: StructuralResult | None = None

    def __post_init__(self) -> None:
        if self.result is not None:
            for case in self.result.cases[:1]:
                self.model.loads[case].refuse_fixed_axes(
                    "vibration or buckling of a loaded structure",
                    "use a load without fixed_axes",
                )

    @property
    def heated(self) -> Assembly:
        """Thermal terms of the elements; none at rest."""
        if self.result is None:
            return self.model.assembly.split(lambda _: False)[1]
        return self.model.loads[self.result.cases[0]].configuration.assembly

    @property
    def u(self) -> np.ndarray:
        """(n,) displacements."""
        if self.result is None:
            return np.zeros(len(self.model.degrees))
        return self.result.displacements[:, 0]


@dataclass(frozen=True, eq=False)
class Term:
    """One matrix ``X(u, p)``, which is symmetric.

    Attributes
    ----------
    state : state at which the matrix is evaluated
    """

    state: Loaded

    def matrix(self) -> scipy.sparse.csc_matrix:
        """(n, n)."""
        raise NotImplementedError

    def push(self, b: np.ndarray, du: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(n,) change of ``X b`` with displacements and parameters."""
        raise NotImplementedError

    def pull(self, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Derivatives of ``aᵀ X b`` by displacements (n,) and parameters (np,)."""
        raise NotImplementedError


@dataclass(frozen=True, eq=False)
class Mass(Term):
    """Mass matrix ``M(u)``, lumped or consistent; it may rotate with the elements.

    A motion that starts from rest with the accelerations ``b`` has the inertia forces ``M b``.
    """

    lumped: bool = False

    def matrix(self) -> scipy.sparse.csc_matrix:
        s, (steady, turning) = self.state, self._parts
        mass = steady.mass(s.p, self.lumped)
        if turning.blocks:
            start = from_rest(np.zeros_like(s.u), s.u)
            mass = mass + turning.inertia_slopes(start, s.p, self.lumped)[2]
        return mass

    def push(self, b: np.ndarray, du: np.ndarray, dp: np.ndarray) -> np.ndarray:
        s = self.state
        direct = s.model.assembly.push_inertia(from_rest(b, s.u), s.p, dp, self.lumped)
        return direct + self._turned(b) @ du

    def pull(self, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s = self.state
        direct = s.model.assembly.pull_inertia(from_rest(b, s.u), s.p, a, self.lumped)
        return self._turned(b).T @ a, direct

    def _turned(self, b: np.ndarray) -> scipy.sparse.csc_matrix:
        """(n, n) change of ``M b`` with the displacements."""
        s, (_, turning) = self.state, self._parts
        return turning.inertia_slopes(from_rest(b, s.u), s.p, self.lumped)[0]

    @cached_property
    def _parts(self) -> tuple[Assembly, Assembly]:
        return self.state.model.assembly.split(lambda block: block.kind.turning(self.lumped))


@dataclass(frozen=True, eq=False)
class Tangent(Term):
    """The tangent stiffness ``∂²W/∂u²`` at the displacements of the state."""

    def matrix(self) -> scipy.sparse.csc_matrix:
        s = self.state
        parts = (s.model.assembly, s.heated)
        return combine(*((1.0, part.stiffness(s.u, s.p)) for part in parts))

    def push(self, b: np.ndarray, du: np.ndarray, dp: np.ndarray) -> np.ndarray:
        s = self.state
        arguments = b, s.u, s.p, du, dp
        return s.model.assembly.push_stiffness(*arguments) + s.heated.push_stiffness(*arguments)

    def pull(self, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s = self.state
        cold, hot = (x.pull_stiffness(a, b, s.u, s.p) for x in (s.model.assembly, s.heated))
        return cold[0] + hot[0], cold[1] + hot[1]


@dataclass(frozen=True, eq=False)
class Geometric(Term):
    """``f K_g``: the geometric stiffness ``K_g = σ · ∂²ε/∂u² (0)`` times a number.

    ``σ`` are the stresses of the displacements ``u``, those of hindered thermal expansion included.
    Displacements themselves do not enter: their first order alone, without the second, would soften
    structures that bend before they buckle.
    """

    factor: float = 1.0

    def matrix(self) -> scipy.sparse.csc_matrix:
        s = self.state
        strained = s.model.assembly.geometric(s.u, s.p)
        hot = s.heated.stiffness(np.zeros_like(s.u), s.p)
        return combine((self.factor, strained), (self.factor, hot))

    def push(self, b: np.ndarray, du: np.ndarray, dp: np.ndarray) -> np.ndarray:
        s, rest = self.state, np.zeros_like(b)
        change = s.model.assembly.push_stiffness(b, s.u, s.p, du, dp, of="geometric")
        return self.factor * (change + s.heated.push_stiffness(b, rest, s.p, rest, dp))

    def pull(self, a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        s, a = self.state, self.factor * a
        u_bar, p_bar = s.model.assembly.pull_stiffness(a, b, s.u, s.p, of="geometric")
        return u_bar, p_bar + s.heated.pull_stiffness(a, b, np.zeros_like(b), s.p)[1]


@dataclass(frozen=True, eq=False)
class Pencil:
    """``A φ = λ B φ`` in the free displacements; the prescribed ones are zero.

    Attributes
    ----------
    model : StructuralModel
    left, right : terms of ``A`` and of ``B``
    """

    model: StructuralModel
    left: Sequence[Term]
    right: Sequence[Term]

    @property
    def free(self) -> np.ndarray:
        """Numbers of the free displacements."""
        return self.model.assembly.free

    def matrices(self) -> tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
        """``A`` and ``B``, free displacements only."""
        return self._sum(self.left), self._sum(self.right)

    def _sum(self, terms: Sequence[Term]) -> scipy.sparse.csc_matrix:
        total = combine(*((1.0, term.matrix()) for term in terms))
        return self.model.assembly.inner(total)
