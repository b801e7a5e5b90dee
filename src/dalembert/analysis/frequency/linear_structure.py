"""A structure that is linear about an operating point, driven by load cases or parameters.

(K (1 + iη) + iω (α M + β K) − ω² M) û = f̂
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
import scipy

from dalembert.analysis.frequency.lowest_modes import lowest_modes
from dalembert.analysis.frequency.structure_outputs import StructureRow, StructureState
from dalembert.analysis.modes.pencil import Loaded, Pencil
from dalembert.analysis.modes.vibration import vibration_pencil
from dalembert.errors import AnalysisError, SingularityError, UnsupportedError
from dalembert.model.assembled.measures import State
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.measured_states import Formula
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import CacheOwner

RESONANT = 1e-12
"""Right-hand side relative to the terms of its row below which a system is singular [-]."""
PIVOTS: dict[str, Any] = {"diag_pivot_thresh": 1e-3, "options": {"SymmetricMode": True}}
"""Options of SuperLU that keep the elimination order; a refinement makes up for weak pivots."""
GRID_MODES = 10
"""Resonances of the default frequencies."""
MOST_MODES = 320
"""Upper limit of the modes that a span of frequencies requires."""


@dataclass(eq=False)
class LinearStructure(CacheOwner):
    """Linear system of a structure with inputs.

    Attributes
    ----------
    analysis : strategy object with ``damping``, ``loss_factor``, ``damping_ratio``, ``lumped``
    pencil : stiffness and mass
    inputs : names of load cases and parameters
    mix : (inputs, columns) complex amplitudes of the inputs in each column
    """

    analysis: Any
    pencil: Pencil
    inputs: list[str]
    mix: np.ndarray

    time: ClassVar[float] = 0.0
    residual: ClassVar[float] = 0.0
    warnings: ClassVar[tuple[str, ...]] = ()

    @property
    def model(self) -> StructuralModel:
        return self.pencil.model

    @property
    def loaded(self) -> Loaded:
        """State at which the structure is linear."""
        return self.pencil.left[-1].state

    @property
    def p(self) -> np.ndarray:
        return self.loaded.p

    @property
    def statistics(self) -> dict[str, Any]:
        """Numbers of displacements."""
        return {"displacements": self.model.assembly.size, "free": int(self.pencil.free.size)}

    # matrices ------------------------------------------------------------------------------
    @cached_property
    def full(self) -> tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
        """``K`` and ``M`` (n, n)."""
        terms = self.pencil.left, self.pencil.right
        stiffness, mass = (sum(term.matrix() for term in part) for part in terms)
        return stiffness.tocsc(), mass.tocsc()

    @cached_property
    def coefficients(self) -> tuple[float, float]:
        """``α`` and ``β``."""
        alpha, beta = self.analysis.damping.coefficients(self.model).values(self.p)
        return float(alpha), float(beta)

    def factors(self, omega: float) -> tuple[complex, complex]:
        """Factors of ``K`` and ``M`` at an angular frequency."""
        alpha, beta = self.coefficients
        stiffness = 1 + 1j * (self.analysis.loss_factor + omega * beta)
        return stiffness, 1j * omega * alpha - omega**2

    def dynamic(self, omega: float) -> scipy.sparse.csc_matrix:
        """(n, n) dynamic stiffness."""
        (k, m), (stiffness, mass) = self.full, self.factors(omega)
        return stiffness * k + mass * m

    def dynamic_rate(self, omega: float) -> scipy.sparse.csc_matrix:
        """(n, n) derivative of the dynamic stiffness by ``ω``."""
        (k, m), (alpha, beta) = self.full, self.coefficients
        return 1j * beta * k + (1j * alpha - 2 * omega) * m

    @cached_property
    def directions(self) -> np.ndarray:
        """(np, columns) changes of the parameters by the inputs."""
        names = list(self.model.parameters)
        unit = np.zeros((self.p.size, len(self.inputs)))
        for k, name in enumerate(self.inputs):
            if name not in self.model.loads:
                unit[names.index(name), k] = 1.0
        return unit @ self.mix

    @cached_property
    def forces(self) -> np.ndarray:
        """(n, columns) amplitudes of the applied forces."""
        loads, unit = self.model.loads, np.eye(self.p.size)
        names = list(self.model.parameters)
        columns = []
        for name in self.inputs:
            if name in loads:
                columns.append(loads[name].values(self.p))
            else:
                dp = unit[names.index(name)]
                pushed = [load.push(self.p, dp) for load in loads.values()]
                columns.append(np.sum(pushed, axis=0))
        return np.array(columns).T @ self.mix

    @cached_property
    def supports(self) -> np.ndarray:
        """(prescribed, columns) amplitudes of the prescribed displacements."""
        d, prescribed = self.directions, self.model.prescribed
        columns = [
            prescribed.push(self.p, a) + 1j * prescribed.push(self.p, b)
            for a, b in zip(d.real.T, d.imag.T, strict=True)
        ]
        return np.array(columns).T

    # harmonic motions ------------------------------------------------------------------------
    def motions(self, omega: np.ndarray) -> np.ndarray:
        """(K, n, columns) harmonic motions.

        Raises
        ------
        SingularityError
            An undamped resonance, or at zero frequency a free motion.
        """
        n, held = self.model.assembly.size, self.model.assembly.prescribed
        motions = np.zeros((omega.size, n, self.mix.shape[1]), complex)
        motions[:, held] = self.supports
        free = self.pencil.free
        for k, w in enumerate(omega):
            right = self.forces - self.dynamic(w) @ motions[k] if held.size else self.forces
            motions[k, free] = self.solve(w, right[free])
        return motions

    def rates(self, omega: np.ndarray, motions: np.ndarray) -> np.ndarray:
        """(K, n, columns) derivatives of harmonic motions by ``ω``."""
        rates, free = np.zeros_like(motions), self.pencil.free
        for k, w in enumerate(omega):
            rates[k, free] = self.solve(w, -(self.dynamic_rate(w) @ motions[k])[free])
        return rates

    def solve(self, omega: float, right: np.ndarray) -> np.ndarray:
        """(f, columns) free displacements for forces; the matrix is symmetric."""
        if not right.shape[0]:
            return right.astype(complex)
        matrix = self._inner(omega)
        order = self._order
        permuted = matrix[order][:, order].tocsc()
        try:
            lu = scipy.sparse.linalg.splu(permuted, permc_spec="NATURAL", **PIVOTS)
        except RuntimeError:
            raise self.refusal(omega) from None
        solution = np.zeros(right.shape, complex)
        ordered = np.ascontiguousarray(right[order].astype(complex))
        first = lu.solve(ordered)
        solution[order] = first + lu.solve(ordered - permuted @ first)
        terms = abs(matrix) @ np.abs(solution)
        shares = np.divide(np.abs(right), terms, out=np.zeros(terms.shape), where=terms > 0)
        active = np.abs(right).max(axis=0) > 0
        if np.any(active & (shares.max(axis=0) < RESONANT)):
            raise self.refusal(omega)
        return solution

    def _inner(self, omega: float) -> scipy.sparse.csc_matrix:
        (k, m), (stiffness, mass) = self.free_matrices, self.factors(omega)
        return (stiffness * k + mass * m).tocsc()

    @cached_property
    def free_matrices(self) -> tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
        return self.pencil.matrices()

    @cached_property
    def _order(self) -> np.ndarray:
        """Elimination order of the free displacements, the same for all frequencies."""
        k, m = self.free_matrices
        pattern = abs(k) + abs(m)
        dominant = pattern + scipy.sparse.diags(np.asarray(pattern.sum(axis=1)).ravel() + 1.0)
        lu = scipy.sparse.linalg.splu(
            dominant.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}
        )
        return np.argsort(lu.perm_c)

    def refusal(self, omega: float) -> SingularityError:
        if omega == 0:
            return SingularityError(
                "no static response: a part of the structure moves freely; leave out 0 Hz, or "
                "support it"
            )
        return SingularityError(
            f"no finite response at {omega / (2 * np.pi):.9g} Hz: an undamped mode resonates; add "
            "damping= or loss_factor=, or leave out this frequency"
        )

    # modes ---------------------------------------------------------------------------------
    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray]:
        """(m,) ``ω²`` and (f, m) shapes of the lowest modes."""
        stored: dict[int, Any] = self.cache.setdefault(self.modes.__func__, {})  # type: ignore[attr-defined]
        if count not in stored:
            stored[count] = lowest_modes(*self.free_matrices, count)
        return stored[count]  # type: ignore[no-any-return]

    @property
    def is_undamped(self) -> bool:
        """Whether no damping acts at all."""
        ratios = self.analysis.loss_factor, self.analysis.damping_ratio
        return not any((*self.coefficients, *ratios))

    @cached_property
    def poles(self) -> np.ndarray:
        """Eigenvalues of the lowest modes [1/s]."""
        return self._poles_of(self.modes(GRID_MODES)[0])

    def poles_up_to(self, frequency: float) -> np.ndarray:
        """Eigenvalues of all modes up to a frequency [Hz]."""
        count = GRID_MODES
        while True:
            squares = self.modes(count)[0]
            beyond = squares.size < count or np.sqrt(squares[-1]) > 2 * np.pi * frequency
            if beyond or count >= MOST_MODES:
                return self._poles_of(squares)
            count *= 2

    def _poles_of(self, squares: np.ndarray) -> np.ndarray:
        omega = np.sqrt(squares[squares > 0])
        alpha, beta = self.coefficients
        ratio = (alpha / omega + beta * omega + self.analysis.loss_factor) / 2
        ratio = np.minimum(ratio + self.analysis.damping_ratio, 1.0)
        return omega * (-ratio + 1j * np.sqrt(1 - ratio**2))

    # inputs and outputs ------------------------------------------------------------------------
    def combined(self, amplitudes: np.ndarray) -> LinearStructure:
        """The system with one input, a combination of its inputs."""
        return replace(self, mix=self.mix @ amplitudes[:, None])

    @cached_property
    def state(self) -> StructureState:
        """The operating state."""
        loaded, n = self.loaded, self.model.assembly.size
        forces = np.zeros(n) if loaded.result is None else loaded.result.forces[:, 0]
        return StructureState(loaded.model, self.p, State(loaded.u, forces, self.p))  # type: ignore[abstract]

    def formula(self, measure: Expression) -> Formula:
        """A measure at the operating state."""
        return Formula(self.state, measure.sx)

    def row(self, measure: Expression) -> StructureRow:
        """Derivatives of a measure.

        Raises
        ------
        UnsupportedError
            It has a kink at the operating state, such as an equivalent stress at rest.
        """
        rows: dict[Any, StructureRow] = self.cache.setdefault(self.row.__func__, {})  # type: ignore[attr-defined]
        if measure not in rows:
            weights = self.formula(measure).weights(0)
            parts = weights.u, weights.forces, weights.p
            if not all(np.all(np.isfinite(part)) for part in parts):
                raise UnsupportedError(
                    f"{measure.name or 'the measure'} has a kink at the operating state; use its "
                    "components"
                )
            rows[measure] = StructureRow(self, weights)
        return rows[measure]


def linear_structure(
    analysis: Any, model: StructuralModel, p: np.ndarray, about: Any
) -> LinearStructure:
    """Linear system of a structure at rest, or of a loaded state."""
    if about is not None and not about.status.success:
        raise AnalysisError(f"about is no equilibrium: {about.status}", about.status.residual)
    pencil = vibration_pencil(model, p, analysis.lumped, about)
    names: list[str] = list(analysis.inputs)
    return LinearStructure(analysis, pencil, names, np.eye(len(names)))
