"""Gradients of eigenvalues and mode shapes of structures, ``A φ = λ B φ`` with ``φᵀ B φ = 1``.

Differentiation gives, with the shapes ``Φ`` of an eigenvalue and of all coincident ones,

    dλ̂ = Φᵀ (dA − λ dB) Φ,   (A − λ B) dΦ = −(dA − λ dB) Φ + B Φ dλ̂,   Φᵀ B dΦ = −Φᵀ dB Φ / 2

(Nelson, AIAA Journal 14, 1976; Dailey, AIAA Journal 27, 1989). The shapes of a repeated eigenvalue
are unique up to a rotation, and single shapes have no derivative; functions that are invariant
under the rotation have one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from dalembert.analysis.modes.pencil import Loaded, Pencil, Term
from dalembert.analysis.modes.spectrum import Spectrum
from dalembert.errors import SingularityError
from dalembert.model.assembled.measures import Weights
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.statics import StaticsTangent
from dalembert.sparse.eigenvalues import EQUAL_WEIGHTS, coincidence, weighed_differently


class PencilTangent:
    """Derivatives of ``A`` and ``B`` by the parameters.

    Parameters
    ----------
    pencil : Pencil
    """

    def __init__(self, pencil: Pencil):
        self.pencil, self.along = pencil, cache(self._along)
        terms = (*pencil.left, *pencil.right)
        self.parameter_count = terms[0].state.p.size
        loaded = {id(t.state): t.state for t in terms if t.state.result is not None}
        self.statics = {
            key: StaticsTangent(state.result)  # type: ignore[arg-type]
            for key, state in loaded.items()
        }

    def pull(self, a: np.ndarray, b: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """(np,) weights of the parameters in ``Σ_k aₖᵀ A φₖ + bₖᵀ B φₖ``, all arrays (n, m)."""
        gradient = np.zeros(self.parameter_count)
        displacements = {key: np.zeros(phi.shape[0]) for key in self.statics}
        for terms, columns in ((self.pencil.left, a), (self.pencil.right, b)):
            for term in terms:
                for weight, shape in zip(columns.T, phi.T, strict=True):
                    u_bar, p_bar = term.pull(weight, shape)
                    gradient += p_bar
                    if id(term.state) in displacements:
                        displacements[id(term.state)] += u_bar
        for key, u_bar in displacements.items():
            weights = Weights(u_bar, np.zeros_like(u_bar), np.zeros(gradient.size))
            gradient += self.statics[key].pull(0, [weights])[:, 0]
        return gradient

    def _along(self, column: int) -> PencilChange:
        """Change along one parameter, by its number."""
        dp = np.eye(1, self.parameter_count, column).ravel()
        displacements = {key: statics.push(0, dp)[0] for key, statics in self.statics.items()}
        return PencilChange(self.pencil, dp, displacements)


@dataclass(frozen=True)
class PencilChange:
    """Changes of ``A`` and ``B`` along a direction of the parameters.

    Attributes
    ----------
    dp : (np,) the direction
    displacements : state → (n,) change of its displacements
    """

    pencil: Pencil
    dp: np.ndarray
    displacements: dict[int, np.ndarray]

    def of(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``dA Φ`` and ``dB Φ`` for shapes (n, m)."""
        return self._sum(self.pencil.left, phi), self._sum(self.pencil.right, phi)

    def _sum(self, terms, phi: np.ndarray) -> np.ndarray:
        columns = np.zeros_like(phi)
        for term in terms:
            du = self._displacement(term)
            for k, shape in enumerate(phi.T):
                columns[:, k] += term.push(shape, du, self.dp)
        return columns

    def _displacement(self, term: Term) -> np.ndarray:
        state: Loaded = term.state
        return self.displacements.get(id(state), np.zeros(len(state.model.degrees)))


@dataclass(frozen=True)
class Group:
    """Coincident eigenvalues and their weights in a response.

    Attributes
    ----------
    indices : (m,) indices in the spectrum
    value : weight of each eigenvalue
    shapes : (n, m) weights of the shapes
    """

    spectrum: Spectrum
    indices: list[int]
    value: float
    shapes: np.ndarray

    @property
    def eigenvalues(self) -> np.ndarray:
        """(m,) ``λ``."""
        return self.spectrum.eigenvalues[self.indices]

    @property
    def phi(self) -> np.ndarray:
        """(n, m) ``Φ``."""
        return self.spectrum.shapes[:, self.indices]

    @cached_property
    def scaled(self) -> np.ndarray:
        """(n, m) ``B Φ``."""
        return self.spectrum.scaled(self.phi)

    @cached_property
    def rotation_weights(self) -> np.ndarray:
        """(m, m) ``H = Φᵀ Φ̄``; symmetric for responses invariant under rotations of the shapes."""
        return self.phi.T @ self.shapes

    def complement(self, rhs: np.ndarray) -> np.ndarray:
        """(n, m) ``V`` with ``(A − λ B) V = R − B Φ Φᵀ R`` and ``Φᵀ B V = 0``."""
        solution = self.spectrum.solve(self.indices, rhs - self.scaled @ (self.phi.T @ rhs))
        return solution - self.phi @ (self.scaled.T @ solution)

    def pull(self) -> tuple[np.ndarray, np.ndarray]:
        """(n, m) ``a`` and ``b``: the derivative is ``Σ aᵀ dA φ + bᵀ dB φ``."""
        a, b = self.value * self.phi, np.zeros_like(self.phi)
        if self.shapes.any():
            a -= self.complement(self.shapes)
            b -= self.phi @ self.rotation_weights / 2
        return a, b - a * self.eigenvalues

    def push(self, da: np.ndarray, db: np.ndarray) -> float:
        """The derivative from ``dA Φ`` and ``dB Φ``, both (n, m)."""
        residual = da - db * self.eigenvalues
        change = self.value * float(np.einsum("nm,nm->", self.phi, residual))
        if self.shapes.any():
            dphi = -self.complement(residual) - self.phi @ (self.phi.T @ db) / 2
            change += float(np.einsum("nm,nm->", self.shapes, dphi))
        return change


class EigenpairGradient:
    """Row of the gradient for one sampled response, by groups of coincident eigenpairs.

    Parameters
    ----------
    sample : Sample
    shared : results shared by responses of the same modes

    Raises
    ------
    SingularityError
        Coincident modes that the response distinguishes, or a kink of the measure at an eigenvalue.
    """

    def __init__(self, sample: Sample, shared: dict):
        self.sample, self.modes = sample, sample.motion
        self.spectrum: Spectrum = self.modes.record
        self.shared = shared
        if not shared:
            shared["tangent"] = PencilTangent(self.spectrum.pencil)
        self.tangent: PencilTangent = shared["tangent"]
        self.own = np.zeros(self.modes.parameters.size)
        self.groups = self._groups()

    def _groups(self) -> list[Group]:
        values, shapes = (
            np.zeros(self.spectrum.eigenvalues.size),
            np.zeros_like(self.spectrum.shapes),
        )
        for k in np.flatnonzero(self.sample.weights):
            share = float(self.sample.weights[k])
            weights = self.modes.weights(self.sample.measure.sx, int(k))
            if not np.isfinite(weights.eigenvalue):
                raise SingularityError(
                    f"{self.sample.response.label}: the eigenvalue of mode {self.modes.numbers[k]} "
                    "is zero, where the measure has a kink; use eigenvalue"
                )
            index, free = int(self.modes.positions[k]), self.spectrum.pencil.free
            values[index] += share * weights.eigenvalue
            shapes[free, index] += share * weights.u[free]
            self.own += share * weights.p
        groups = []
        for indices in self.spectrum.groups:
            if values[indices].any() or shapes[:, indices].any():
                mean = float(values[indices].mean())
                group = Group(self.spectrum, indices, mean, shapes[:, indices])
                self._check(group, values[indices])
                groups.append(group)
        return groups

    def _check(self, group: Group, values: np.ndarray) -> None:
        """Raise if the response distinguishes coincident modes."""
        if len(group.indices) == 1:
            return
        h = group.rotation_weights
        size = np.linalg.norm(group.phi) * np.linalg.norm(group.shapes)
        varies = np.abs(h - h.T).max() > EQUAL_WEIGHTS * size
        if varies or weighed_differently(values, float(np.abs(values).max())):
            numbers = [k + 1 for k in group.indices]
            text = coincidence(numbers, self._value(group))
            raise SingularityError(
                f"{self.sample.response.label}: {text}; use a response that does not distinguish "
                "them, such as the mean over these modes (solve for all of them), or "
                "eigenvalue_slopes for their one-sided derivatives"
            )

    def _value(self, group: Group) -> str:
        """The main measure of these modes, such as a frequency or a load factor, with its unit."""
        main = self.modes.named[self.modes.main]
        k = int(np.flatnonzero(np.isin(self.modes.positions, group.indices))[0])
        value = f"{self.modes.values(self.modes.main)[k]:.9g}"
        return " ".join([self.modes.main.replace("_", " "), value, main.unit]).strip()

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one solution for each group of modes whose shapes have weights."""
        terms = (self.tangent.pull(*group.pull(), group.phi) for group in self.groups)
        return sum(terms, self.own)

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives along one parameter after the other."""
        gradient = self.own[list(columns)]
        for i, column in enumerate(columns):
            gradient[i] += sum(group.push(*self._change(group, column)) for group in self.groups)
        return gradient

    def _change(self, group: Group, column: int) -> tuple[np.ndarray, np.ndarray]:
        """``dA Φ`` and ``dB Φ`` along one parameter, shared by all responses."""
        key = (column, *group.indices)
        if key not in self.shared:
            self.shared[key] = self.tangent.along(column).of(group.phi)
        return self.shared[key]  # type: ignore[no-any-return]


class EigenpairEngine(RowEngine):
    """Gradient engine of eigenmodes; responses share factors for each group of modes."""

    row = EigenpairGradient
