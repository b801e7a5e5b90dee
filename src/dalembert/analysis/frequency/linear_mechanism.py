"""A mechanism that is linear about an operating point: harmonic motions and first-order form.

A harmonic input ``Re û exp(iωt)`` causes the changes ``w = [δ; z; v; λ]`` with

    (K₀ + iω K₁) w = −b û,      y = (c₀ + iω c₁) w + d û.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.analysis.frequency.first_order import FirstOrder
from dalembert.analysis.frequency.operating_point import OperatingPoint
from dalembert.analysis.modes.linearization_kernel import linearization_kernel
from dalembert.analysis.modes.linearized import Linearized
from dalembert.errors import SingularityError
from dalembert.model.graph.coordinates import AbsoluteCoordinates
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner

RESONANT = 1e-12
"""Right-hand side relative to the terms of its row below which a system is singular [-]."""
ENTRIES = 4_000_000
"""Entries of the matrices that are solved at once."""
NEGLIGIBLE = 1e-13
"""Dependence of a constraint on an input that counts as none, in natural sizes [-]."""


@dataclass(frozen=True)
class OutputRow:
    """Derivatives of an output: ``y = (c₀ + iω c₁) w + d û``.

    Attributes
    ----------
    static, rates : (N,) ``c₀``, ``c₁``
    direct : (inputs,) ``d``
    """

    static: np.ndarray
    rates: np.ndarray
    direct: np.ndarray

    def at(self, omega: np.ndarray, motions: np.ndarray) -> np.ndarray:
        """(K, inputs) outputs of harmonic motions (K, N, inputs)."""
        static = np.einsum("n,kni->ki", self.static, motions)
        rate = np.einsum("n,kni->ki", self.rates, motions)
        return static + 1j * omega[:, None] * rate + self.direct

    def rate(self, omega: np.ndarray, motions: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """(K, inputs) derivatives of the outputs by ``ω``, from those of the motions."""
        static = np.einsum("kn,kni->ki", self.weights(omega), rates)
        return static + 1j * np.einsum("n,kni->ki", self.rates, motions)

    def weights(self, omega: np.ndarray) -> np.ndarray:
        """(K, N) ``c₀ + iω c₁``."""
        return self.static + 1j * omega[:, None] * self.rates


@dataclass(eq=False)
class LinearMechanism(CacheOwner):
    """Linear system of a mechanism with inputs.

    Attributes
    ----------
    point : OperatingPoint
    directions : (np, inputs) change of the parameter vector by each input
    """

    point: OperatingPoint
    directions: np.ndarray

    @property
    def model(self):
        return self.point.model

    @property
    def p(self) -> np.ndarray:
        return self.point.p

    @property
    def time(self) -> float:
        return self.point.time

    @property
    def residual(self) -> float:
        return self.point.residual

    @property
    def warnings(self) -> tuple[str, ...]:
        return self.point.warnings

    @property
    def statistics(self) -> dict[str, int]:
        """Number of unknowns."""
        return {"unknowns": self.sizes.size}

    @property
    def sizes(self) -> np.ndarray:
        """(N,) natural sizes of the unknowns."""
        return self.point.kernel.sizes

    @cached_property
    def matrices(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``K₀``, ``K₁`` (N, N) and ``b`` (N, inputs)."""
        kernel = self.point.kernel
        jacobian = kernel.jacobian(*self.point.arguments).full()
        static, rates = jacobian[:, kernel.unknowns], np.zeros((jacobian.shape[0],) * 2)
        moving = jacobian[:, kernel.rates]
        rates[:, : moving.shape[1]] = moving
        return static, rates, jacobian[:, kernel.parts["parameter"]] @ self.directions

    @cached_property
    def scaled(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The matrices with unknowns and equations relative to their natural sizes."""
        static, rates, inputs = self.matrices
        rows, sizes = self.point.kernel.rows[:, None], self.sizes
        return static * sizes / rows, rates * sizes / rows, inputs / rows

    def motions(self, omega: np.ndarray) -> np.ndarray:
        """(K, N, inputs) harmonic motions for unit inputs at angular frequencies (K,).

        Raises
        ------
        SingularityError
            An undamped resonance, or at zero frequency a free motion.
        """
        _, _, inputs = self.scaled
        right = np.broadcast_to(-inputs, (omega.size, *inputs.shape))
        return self._solve(omega, right) * self.sizes[:, None]

    def rates(self, omega: np.ndarray, motions: np.ndarray) -> np.ndarray:
        """(K, N, inputs) derivatives of harmonic motions by ``ω``."""
        right = np.einsum("rn,kni->kri", 1j * self.matrices[1], motions)
        return self.changes(omega, right)

    def changes(self, omega: np.ndarray, equations: np.ndarray) -> np.ndarray:
        """(K, N, columns) changes of motions from changes (K, N, columns) of the equations."""
        return (
            self._solve(omega, -equations / self.point.kernel.rows[:, None]) * self.sizes[:, None]
        )

    def adjoints(self, omega: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(K, N, columns) weights of equations from weights (K, N, columns) of motions."""
        right = -weights * self.sizes[:, None]
        return self._solve(omega, right, True) / self.point.kernel.rows[:, None]

    def _solve(self, omega: np.ndarray, right: np.ndarray, transposed: bool = False) -> np.ndarray:
        static, rates, _ = self.scaled
        size = static.shape[0]
        solution = np.zeros(right.shape, complex)
        step = max(1, ENTRIES // max(1, size**2))
        for first in range(0, omega.size, step):
            part = slice(first, first + step)
            matrix = static + 1j * omega[part, None, None] * rates
            matrix = matrix.transpose(0, 2, 1) if transposed else matrix
            solution[part] = self._checked(omega[part], matrix, right[part])
        return solution

    def _checked(self, omega: np.ndarray, matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
        try:
            solution = np.linalg.solve(matrix, right)
        except np.linalg.LinAlgError:
            smallest = [np.linalg.svd(m, compute_uv=False)[-1] for m in matrix]
            k = int(np.argmin(smallest))
            raise self.refusal(float(omega[k]), np.linalg.svd(matrix[k])[2][-1]) from None
        terms = np.abs(matrix) @ np.abs(solution)
        shares = np.divide(np.abs(right), terms, out=np.zeros(terms.shape), where=terms > 0)
        largest, active = shares.max(axis=1), np.abs(right).max(axis=1) > 0
        place = int(np.argmin(np.where(active, largest, 1.0)))
        k, column = divmod(place, largest.shape[1])
        if active[k, column] and largest[k, column] < RESONANT:
            raise self.refusal(float(omega[k]), solution[k, :, column])
        return solution

    def refusal(self, omega: float, motion: np.ndarray | None) -> SingularityError:
        names = [*self.unknown_names]
        leading = "" if motion is None else f" of {names[int(np.argmax(np.abs(motion)))]}"
        if omega == 0:
            return SingularityError(
                f"no static response: a motion{leading} is free; leave out 0 Hz, or constrain it"
            )
        return SingularityError(
            f"no finite response at {omega / (2 * np.pi):.9g} Hz: an undamped motion{leading} "
            "resonates; add damping, or leave out this frequency"
        )

    @cached_property
    def unknown_names(self) -> list[str]:
        """Names of the unknowns: displacements, states, rates of displacements, multipliers."""
        kernel, guesses = self.point.kernel, self.model.guesses
        moved = list(guesses.speed_names)
        states = [guesses.names[k] for k in kernel.states]
        forces = [self.model.equation_names[k] for k in self.model.closure.rows]
        return [*moved, *states, *(f"{name} rate" for name in moved), *forces]

    @cached_property
    def unknown_units(self) -> list[str]:
        """Units of displacements, states and rates of displacements."""
        kernel, guesses = self.point.kernel, self.model.guesses
        moved = list(guesses.speed_units)
        states = [guesses.units[k] for k in kernel.states]
        return [*moved, *states, *(f"{unit}/s" for unit in moved)]

    def row(self, measure: Expression) -> OutputRow:
        """Derivatives of a measure."""
        kernel = self.point.kernel
        row = kernel.measure_row(measure)(*self.point.arguments).full().ravel()
        rate = np.zeros(self.sizes.size)
        moving = row[kernel.rates]
        rate[: moving.size] = moving
        return OutputRow(
            row[kernel.unknowns], rate, row[kernel.parts["parameter"]] @ self.directions
        )

    @cached_property
    def first_order(self) -> FirstOrder:
        """First-order form in minimal coordinates."""
        return FirstOrder(self)

    @cached_property
    def poles(self) -> np.ndarray:
        """Eigenvalues [1/s]; none if a motion has no mass."""
        try:
            return self.first_order.poles
        except np.linalg.LinAlgError:
            return np.zeros(0, complex)

    def oscillations(self, motions: np.ndarray) -> np.ndarray:
        """(6, n, K) oscillation of the coordinates in harmonic motions (K, N); see ``Linearized``.

        A mechanism with motions that have no mass has only the coordinates at rest, (1, n, 1).
        """
        point, moved = self.point, self.point.kernel.parts["state"].stop
        changes = point.kernel.basis(point.y).full() @ motions[:, :moved].T
        try:
            kernel = linearization_kernel(self.model, AbsoluteCoordinates())
        except SingularityError:
            return point.y[None, :, None]
        state = np.concatenate([point.y, point.v])
        return Linearized(kernel, point.time, state, point.p).oscillations_of(changes)

    def combined(self, amplitudes: np.ndarray) -> LinearMechanism:
        """The system with one input, a combination of its inputs."""
        return LinearMechanism(self.point, self.directions @ amplitudes[:, None])

    def constraining(self) -> Sequence[int]:
        """Numbers of the inputs that enter constraint equations."""
        count = self.point.kernel.e.constraint_count
        rows = np.abs(self.scaled[2][self.sizes.size - count :])
        return [int(k) for k in np.flatnonzero(rows.max(axis=0, initial=0.0) > NEGLIGIBLE)]
