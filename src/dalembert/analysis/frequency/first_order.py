"""First-order form of a linear mechanism in minimal coordinates, ``ẋ = A x + B u``.

With a basis ``T`` of the motions that satisfy the constraints and their derivatives, ``x = T ξ``;
accelerations and multipliers follow from (5.7). The minimal coordinates ``ξ`` are some of the
displacements, speeds and states, chosen by a QR factorisation with pivots.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from dalembert.symbolic.formulas.expression import Expression

RANK = 1e-9
"""Singular values of constraints below this share of the largest one count as zero [-]."""

REGULAR = 1e6
"""Upper limit of the condition number of a choice of states [-]."""


@dataclass(eq=False)
class FirstOrder:
    """First-order form of a linear mechanism.

    Attributes
    ----------
    system : LinearMechanism
    """

    system: Any

    @cached_property
    def _split(self) -> tuple[int, int, int]:
        """Numbers of δ and z, of all states, and of the multipliers."""
        kernel = self.system.point.kernel
        moved, still = kernel.parts["state"].stop, kernel.parts["speed"].stop
        return moved, still, kernel.e.constraint_count

    @cached_property
    def _placing(self) -> tuple[np.ndarray, np.ndarray]:
        """Rates of displacements and states by all states and by the inputs, scaled."""
        static, _, inputs = self.system.scaled
        moved, states, _ = self._split
        time = self.system.model.scales.time
        return static[:moved, :states] / time, inputs[:moved] / time

    @cached_property
    def _solved(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Accelerations and multipliers ``X x + U u``, and the constraints ``G x = 0``, scaled."""
        static, rates, inputs = self.system.scaled
        moved, states, count = self._split
        efforts = slice(moved, static.shape[0] - count)
        levels = slice(static.shape[0] - count, static.shape[0])
        rate_of_place, shift = self._placing
        places, speeds = static[levels, :moved], static[levels, moved:states]
        positions = np.abs(speeds).max(axis=1, initial=0.0) == 0  # others are nonholonomic
        first = np.hstack([places, speeds])
        second = np.where(positions[:, None], places @ rate_of_place, first)
        constraints = np.vstack([first[positions], second])
        mass, push = rates[efforts, moved:states], static[efforts, states:]
        saddle = np.block([[mass, push], [second[:, moved:], np.zeros((count, count))]])
        by_state = np.vstack([-static[efforts, :states], -second[:, :moved] @ rate_of_place])
        by_input = np.vstack([-inputs[efforts], -second[:, :moved] @ shift])
        solved = np.linalg.solve(saddle, np.hstack([by_state, by_input]))
        return solved[:, :states], solved[:, states:], constraints

    @cached_property
    def _full(self) -> tuple[np.ndarray, np.ndarray]:
        """``A`` and ``B`` of all states, scaled, valid along the constraints."""
        moved, states, _ = self._split
        by_state, by_input, _ = self._solved
        rate_of_place, shift = self._placing
        speeds = states - moved
        a = np.vstack([rate_of_place, by_state[:speeds]])
        return a, np.vstack([shift, by_input[:speeds]])

    @property
    def forces(self) -> tuple[np.ndarray, np.ndarray]:
        """Multipliers by states and inputs, scaled."""
        moved, states, _ = self._split
        by_state, by_input, _ = self._solved
        return by_state[states - moved :], by_input[states - moved :]

    @cached_property
    def basis(self) -> tuple[np.ndarray, np.ndarray]:
        """``T`` (states, f), scaled, and numbers (f,) of the states that are ``ξ``."""
        constraints = self._solved[2]
        states = self._split[1]
        basis = np.eye(states)
        if constraints.size:
            _, values, vectors = np.linalg.svd(constraints)
            rank = int((values > RANK * values.max(initial=0.0)).sum())
            basis = vectors[rank:].T
        if not basis.shape[1]:
            return basis, np.zeros(0, dtype=int)
        chosen = self._with_rates(basis)
        if chosen is None:
            order = scipy.linalg.qr(basis.T, pivoting=True, mode="r")[1]
            chosen = np.sort(order[: basis.shape[1]])
        return basis @ np.linalg.inv(basis[chosen]), chosen

    def _with_rates(self, basis: np.ndarray) -> np.ndarray | None:
        """Displacements with their own rates, and states, where these suffice."""
        moved, total, _ = self._split
        displacements = total - moved
        triangle, order = scipy.linalg.qr(basis[:moved].T, pivoting=True, mode="r")
        sizes = np.abs(np.diag(triangle))
        places = np.sort(order[: int((sizes > RANK * sizes.max(initial=0.0)).sum())])
        chosen = np.concatenate([places, places[places < displacements] + moved])
        if chosen.size != basis.shape[1] or np.linalg.cond(basis[chosen]) > REGULAR:
            return None
        return chosen

    @cached_property
    def scaled_matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """``A`` (f, f) and ``B`` (f, inputs), states in natural sizes."""
        (basis, chosen), (a, b) = self.basis, self._full
        return a[chosen] @ basis, b[chosen]

    @property
    def matrices(self) -> tuple[np.ndarray, np.ndarray]:
        """``A`` and ``B`` in SI units."""
        sizes = self.sizes
        a, b = self.scaled_matrices
        return a * sizes[:, None] / sizes, b * sizes[:, None]

    @property
    def sizes(self) -> np.ndarray:
        """(f,) natural sizes of the states."""
        return self.system.sizes[self.basis[1]]

    @property
    def names(self) -> list[str]:
        """(f,) names of the states."""
        return [self.system.unknown_names[k] for k in self.basis[1]]

    @property
    def units(self) -> list[str]:
        """(f,) units of the states."""
        return [self.system.unknown_units[k] for k in self.basis[1]]

    def output(self, measure: Expression) -> tuple[np.ndarray, np.ndarray]:
        """Rows of ``C`` (f,) and ``D`` (inputs,) of a measure, in SI units."""
        row, (basis, _), sizes = self.system.row(measure), self.basis, self.system.sizes
        states = self._split[1]
        (a, b), (by_state, by_input) = self._full, self.forces
        static, rate = row.static * sizes, row.rates[:states] * sizes[:states]
        c = static[:states] + static[states:] @ by_state + rate @ a
        d = static[states:] @ by_input + rate @ b + row.direct
        return (c @ basis) / self.sizes, d

    @cached_property
    def poles(self) -> np.ndarray:
        """Eigenvalues of ``A`` [1/s]."""
        values: np.ndarray = np.linalg.eigvals(self.scaled_matrices[0])
        return values
