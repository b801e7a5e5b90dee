"""Harmonic motions as sums of modes with static correction.

    x(ω) = Σ_k r_k l_kᵀ b/(iω − s_k) + (x_static − Σ_k r_k l_kᵀ b/(−s_k))

With all modes the static correction vanishes, and the sum equals the direct solution.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.frequency.linear_mechanism import LinearMechanism
from dalembert.analysis.frequency.linear_structure import LinearStructure
from dalembert.errors import UnsupportedError
from dalembert.sparse.factorise import indefinite_factors

RESONANT = 1e-12
"""Distance of a frequency from an undamped resonance, relative to this one [-]."""
MODES = 30
"""Default number of superposed modes of a structure."""


def superposed(system: LinearMechanism | LinearStructure, count: int | None) -> Any:
    """The system with harmonic motions from its modes of lowest frequency."""
    if isinstance(system, LinearStructure):
        fixed = system.analysis, system.pencil, system.inputs, system.mix
        return ModalStructure(*fixed, count or MODES)
    return ModalMechanism(system.point, system.directions, count)


@dataclass(eq=False)
class ModalMechanism(LinearMechanism):
    """Linear system whose harmonic motions are sums of modes with static correction.

        x(ω) = Σ_k r_k l_kᵀ b/(iω − s_k) + (x_static − Σ_k r_k l_kᵀ b/(−s_k))

    Attributes
    ----------
    count : number of modes by increasing ``|s|``, all if None
    """

    count: int | None = None

    @property
    def statistics(self) -> dict[str, int]:
        return super().statistics | {"modes": self._modes[0].size}

    @cached_property
    def _modes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Eigenvalues, right vectors and ``lᵀ b`` of the superposed modes."""
        a, b = self.first_order.scaled_matrices
        values, right = np.linalg.eig(a)
        shares = np.linalg.solve(right, b.astype(complex))
        order = np.argsort(np.abs(values), kind="stable")
        count = len(order) if self.count is None else min(2 * self.count, len(order))
        chosen = order[:count]
        return values[chosen], right[:, chosen], shares[chosen]

    def motions(self, omega: np.ndarray) -> np.ndarray:
        if numbers := self.constraining():
            raise UnsupportedError(
                f"input number {numbers[0] + 1} enters constraint equations, so that motions "
                "depend on its derivatives, which modes do not have; use method='direct'"
            )
        values, right, shares = self._modes
        basis, _ = self.first_order.basis
        states = np.einsum("fk,nk,ki->nfi", right, self._gains(omega, values), shares)
        if values.size < len(right):
            a, b = self.first_order.scaled_matrices
            rest = self._gains(np.zeros(1), values)
            states = (
                states + np.linalg.solve(-a, b) - np.einsum("fk,nk,ki->nfi", right, rest, shares)
            )
        forces, direct = self.first_order.forces
        motions = basis @ states
        return np.concatenate([motions, forces @ motions + direct], axis=1) * self.sizes[:, None]

    def _gains(self, omega: np.ndarray, values: np.ndarray) -> np.ndarray:
        """(K, modes) ``1/(iω − s)``."""
        distance = 1j * omega[:, None] - values
        resonant = np.abs(distance) <= RESONANT * np.abs(values)
        if np.any(resonant):
            raise self.refusal(float(omega[int(np.argwhere(resonant)[0, 0])]), None)
        return 1 / distance


@dataclass(eq=False)
class ModalStructure(LinearStructure):
    """Linear structure whose harmonic motions are sums of modes with static correction.

    Attributes
    ----------
    count : number of modes
    """

    count: int = MODES

    @property
    def statistics(self) -> dict[str, Any]:
        return super().statistics | {"modes": self.spectrum[0].size}

    @cached_property
    def spectrum(self) -> tuple[np.ndarray, np.ndarray]:
        """(m,) ``ω²`` and (f, m) shapes of the superposed modes."""
        return self.modes(self.count)

    def motions(self, omega: np.ndarray) -> np.ndarray:
        size, held = self.model.assembly.size, self.model.assembly.prescribed
        motions = np.zeros((omega.size, size, self.mix.shape[1]), complex)
        motions[:, held] = self.supports
        motions[:, self.pencil.free] = self._superposed(omega)
        return motions

    def _superposed(self, omega: np.ndarray) -> np.ndarray:
        """(K, f, columns) free displacements from modes, with static correction of the others.

        Forces consist of applied ones, and of those of moving supports with factors of ``ω``.
        """
        squares, shapes = self.spectrum
        alpha, beta = self.coefficients
        viscous = alpha + beta * squares + 2 * self.analysis.damping_ratio * np.sqrt(squares)
        w = omega[:, None]
        stiff = squares * (1 + 1j * self.analysis.loss_factor)
        distance = stiff - w**2 + 1j * w * viscous
        resonant = np.abs(distance) <= RESONANT * (squares + w**2)
        if np.any(resonant):
            raise self.refusal(float(omega[int(np.argwhere(resonant)[0, 0])]))
        rest = self._static_rest(squares, shapes)
        total = np.zeros((omega.size, shapes.shape[0], self.mix.shape[1]), complex)
        for part, scale in self._forces(omega):
            shares = shapes.T @ part
            gains = (1 / distance)[:, :, None] * shares
            correction = rest(part) / (1 + 1j * self.analysis.loss_factor)
            total += scale[:, None, None] * (np.einsum("fm,kmi->kfi", shapes, gains) + correction)
        return total

    def _static_rest(self, squares: np.ndarray, shapes: np.ndarray) -> Any:
        """Static response without the superposed modes; none of unsupported structures."""
        if squares.min(initial=np.inf) <= 0:
            return np.zeros_like
        solve = indefinite_factors(self.free_matrices[0]).solve

        def rest(forces: np.ndarray) -> np.ndarray:
            parts = solve(forces.real.copy()) + 1j * solve(forces.imag.copy())
            return parts - shapes @ ((shapes.T @ forces) / squares[:, None])

        return rest

    def _forces(self, omega: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Forces (f, columns) on the free displacements and their factors (K,)."""
        free, held = self.pencil.free, self.model.assembly.prescribed
        yield self.forces[free].astype(complex), np.ones(omega.size)
        if self.supports.any():
            factors = np.array([self.factors(w) for w in omega])
            for matrix, scale in zip(self.full, factors.T, strict=True):
                yield -(matrix[free][:, held] @ self.supports), scale
