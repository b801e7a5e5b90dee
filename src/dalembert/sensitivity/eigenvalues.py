"""Gradients of eigenvalues of a linearised mechanism.

The modes solve ``(J − s) τ + Gᵀ μ = 0``, ``G τ = 0`` with ``J = ∂F/∂x`` and ``G = ∂(Φ, Ψ)/∂x`` at
the state ``x(p)``, independent of a basis of the tangent space. With bases ``T, U`` of the right
and left invariant subspaces of coincident eigenvalues, ``Uᴴ T = I``, and ``G⁺ = Gᵀ (G Gᵀ)⁻¹``,
differentiation gives for their sum

    d Σ s = tr(Uᴴ dJ T) − tr(Uᴴ J G⁺ dG T) − tr(Uᴴ dGᵀ G⁺ᵀ J T),

for a single eigenvalue ``wᴴ dJ τ`` plus the rotation of the tangent space; ``dJ`` and ``dG``
include the change of the state, ``dx = (∂x/∂p) dp``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.modes.linearized import Linearized
from dalembert.errors import SingularityError, UnsupportedError
from dalembert.results.mechanism_modes import IMAG, REAL
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.sparse.eigenvalues import COINCIDE, coincidence, weighed_differently
from dalembert.symbolic.equations.implicit import ImplicitFunction


def invariant_subspaces(
    matrix: np.ndarray, values: np.ndarray, group: list[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Bases ``V`` and ``W`` of the right and left subspaces of some eigenvalues, ``Wᴴ V = I``.

    Computed by ordered Schur decompositions, which are robust for defective eigenvalues.

    Raises
    ------
    SingularityError
        They cannot be separated from the other eigenvalues.
    """
    from scipy.linalg import schur

    centre = values[group].mean()
    inside = np.abs(values[group] - centre).max()
    rest = np.delete(values, group)
    outside = np.abs(rest - centre).min() if rest.size else inside + 2.0
    radius = (inside + outside) / 2

    def basis(of: np.ndarray, near: complex) -> np.ndarray:
        _, vectors, count = schur(of, "complex", sort=lambda s: abs(s - near) <= radius)
        if count != len(group):
            raise SingularityError(f"eigenvalues near s = {centre:.6g} 1/s cannot be separated")
        return vectors[:, :count]

    right, left = basis(matrix, centre), basis(matrix.conj().T, np.conj(centre))
    return right, left @ np.linalg.inv(right.conj().T @ left)


PARTS = ca.vertcat(REAL, IMAG)


@dataclass(frozen=True)
class Probes:
    """Gradient in the form ``Σ_k a_k·dJ q_k + b_k·dG q_k``.

    Attributes
    ----------
    q, a, b : (N, c), (N, c), (m, c)
    """

    q: np.ndarray
    a: np.ndarray
    b: np.ndarray


class EigenvalueGradient:
    """Rows of the gradient for one sampled response.

    Raises
    ------
    SingularityError
        Coincident eigenvalues with different weights in the response, the frequency of a zero
        eigenvalue, or a state without derivative.
    """

    def __init__(self, sample: Sample, shared: dict | None = None):
        self.sample, self.modes = sample, sample.motion
        self.state: Linearized = self.modes.record
        if self.state.origin is None:
            raise UnsupportedError(
                "gradients of modes about the end of a motion are not available; use "
                "method='finite-difference'"
            )
        self.origin: ImplicitFunction = self.state.origin
        self.near = np.asarray(self.state.near)
        slopes, own = self.modes.slopes(sample.measure)
        active = sample.weights != 0
        if not np.all(np.isfinite(slopes[active])):
            raise SingularityError(
                f"{sample.response.label}: an eigenvalue is zero, where the measure has a kink; "
                "use eigenvalue_real"
            )
        self.slopes = np.where(active, sample.weights * slopes, 0)
        self.own = own[:, active] @ sample.weights[active]
        self.probes = self._probes()

    def _probes(self) -> Probes:
        """Probes from all eigenvalues that the response depends on."""
        (jacobian, tangency), (states, rows) = self.state.scaled, self.state.sizes
        inverse = np.linalg.pinv(tangency)
        q, a, b = [], [], []
        for group, weight in self._groups():
            right, left = invariant_subspaces(self.state.matrix, self.state.eigenvalues, group)
            self._refuse_nonlinear(group, left.conj().T @ self.state.matrix @ right)
            right, left = weight * self.state.basis @ right, self.state.basis @ left
            for d, u in ((right.real, left.real), (right.imag, left.imag)):
                q += [d, u]
                a += [u, np.zeros_like(u)]
                b += [-inverse.T @ (jacobian.T @ u), -inverse.T @ (jacobian @ d)]
        units = (states, q), (1 / states, a), (1 / rows, b)
        return Probes(*(np.hstack([np.zeros((u.size, 0)), *c]) * u[:, None] for u, c in units))

    def _refuse_nonlinear(self, group: list[int], block: np.ndarray) -> None:
        """Raise for nonlinear measures of defective eigenvalues, which split like roots."""
        values = self.state.eigenvalues
        nonlinear = ca.depends_on(ca.jacobian(self.sample.measure.sx, PARTS), PARTS)
        spread = np.abs(block - np.diag(np.full(len(group), values[group].mean()))).max()
        if nonlinear and spread > COINCIDE * np.abs(values).max():
            raise SingularityError(
                f"{self._refusal(group)}, and without independent shapes only that of "
                "eigenvalue_real or eigenvalue_imag"
            )

    def _groups(self) -> list[tuple[list[int], complex]]:
        """Coincident eigenvalues and the weight of each, half of it for its conjugate."""
        values = self.state.eigenvalues
        weights = np.zeros(values.size, dtype=complex)
        for position, slope in zip(self.modes.positions, self.slopes, strict=True):
            if values[position].imag > 0:  # its conjugate follows it
                weights[position] += slope / 2
                weights[position + 1] += slope.conj() / 2
            else:
                weights[position] += slope
        active = self.modes.positions[self.sample.weights != 0]
        groups, largest = [], np.abs(weights).max(initial=0.0)
        for group in self.state.groups:
            mean = weights[group].mean()
            if weighed_differently(weights[group], largest):
                raise SingularityError(self._refusal(group))
            if not values[group].imag.any():  # real eigenvalues remain real
                mean = mean.real
            if mean != 0 or np.isin(group, active).any():
                groups.append((group, complex(mean)))
        return groups

    def _refusal(self, group: list[int]) -> str:
        pairs = self.state.wanted()
        numbers = [int(k) + 1 for k in np.flatnonzero(np.isin(pairs, group))]
        return coincidence(numbers, f"s = {self.state.eigenvalues[group].mean():.6g} 1/s")

    def _point(self) -> tuple:
        return self.state.time, self.state.x, self.state.p

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one adjoint of the tangent for each probe, and one of the state."""
        q, count = self.probes.q, self.probes.q.shape[1]
        gradient = self.own.copy()
        if not count:
            return gradient
        mapped = self.state.small_motions.adjoint.map(count)
        weights = mapped(*self._point(), q, self.probes.a, self.probes.b)
        x_bar, p_bar = (part.full().sum(axis=1) for part in weights[1:3])
        back = self.origin.adjoint(self.state.time, self.near, self.state.p, x_bar)
        return self._finite(gradient + p_bar + back[2].full().ravel())

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one tangent of the tangent for each parameter and probe."""
        q, count, p = self.probes.q, self.probes.q.shape[1], self.state.p
        changes = self.modes.model.tangents(p, columns)
        gradient = self.own @ changes
        if not count:
            return gradient
        still, zero_near = np.zeros_like(q), np.zeros(self.near.size)
        mapped = self.state.small_motions.tangent.map(count)
        for i, dp in enumerate(changes.T):
            dx = self.origin.tangent(self.state.time, self.near, p, 0, zero_near, dp).full()
            rates = mapped(*self._point(), q, 0, dx, dp, still)
            by_state, by_level = (part.full() for part in rates)
            gradient[i] += (self.probes.a * by_state).sum() + (self.probes.b * by_level).sum()
        return self._finite(gradient)

    def _finite(self, gradient: np.ndarray) -> np.ndarray:
        if not np.all(np.isfinite(gradient)):
            raise SingularityError(
                "the linearised state is no function of the parameters: the equilibrium "
                "is not isolated; use equilibrium=False, or constrain the free motion"
            )
        return gradient


class EigenvalueEngine(RowEngine):
    """Engine for eigenvalues of linearised mechanisms, row by row."""

    row = EigenvalueGradient
