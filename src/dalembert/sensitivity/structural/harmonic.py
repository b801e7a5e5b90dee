"""Gradients of harmonic responses of structures.

With the dynamic stiffness ``Z = κ K + μ M``, ``Z û = f̂`` in the free displacements, and an output
``H = c_u·û + c_f·Z û``,

    dH = (c_f − λ)ᵀ dZ û + λᵀ df̂ + dc·(û, Z û) + (c_u + Zᵀ c_f − Zᵀ λ)ᵀ dû_p,   Z λ = c_u + Zᵀ c_f,

with zeros of ``λ`` and ``û_p`` at prescribed and at free displacements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.frequency.linear_structure import LinearStructure
from dalembert.analysis.frequency.modal_motions import ModalStructure
from dalembert.errors import UnsupportedError
from dalembert.model.assembled.measures import State
from dalembert.results.harmonic import HarmonicResponse
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.harmonic import complex_seeds
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.eigenpairs import PencilTangent


@dataclass(frozen=True)
class Term:
    """One output at one frequency for one column of inputs.

    Attributes
    ----------
    output : measure
    seed : ``s``, ``dR = Re s dH``
    omega : [rad/s]
    column : number of the column
    motion : (n,) ``û``
    adjoint : (n,) ``λ``
    """

    output: Any
    seed: complex
    omega: float
    column: int
    motion: np.ndarray
    adjoint: np.ndarray


class StructuralHarmonicGradient:
    """Row of the gradient for one sampled response of a structure.

    Raises
    ------
    UnsupportedError
        The response is a modal superposition.
    """

    def __init__(self, sample: Sample, shared: dict):
        self.sample = sample
        self.result: HarmonicResponse = sample.motion
        self.system: LinearStructure = self.result.record
        if isinstance(self.system, ModalStructure):
            raise UnsupportedError(
                "gradients of a modal superposition are not available; use method='direct'"
            )
        if id(self.system.pencil) not in shared:
            shared[id(self.system.pencil)] = PencilTangent(self.system.pencil)
        self.tangent: PencilTangent = shared[id(self.system.pencil)]
        self.seeds, self.own = complex_seeds(sample)

    @cached_property
    def terms(self) -> list[Term]:
        """All terms with their adjoint solutions."""
        system, terms = self.system, []
        free = system.pencil.free
        for name, table in self.seeds.items():
            output = self.result.output(name)
            weights = system.row(output).weights
            for k in np.flatnonzero(np.abs(table).any(axis=1)):
                omega = float(self.result.omega[k])
                right = weights.u + system.dynamic(omega).T @ weights.forces
                adjoint = np.zeros(right.size, complex)
                adjoint[free] = system.solve(omega, right[free, None])[:, 0]
                terms += [
                    Term(output, table[k, c], omega, int(c), self.result.motions[k, :, c], adjoint)
                    for c in np.flatnonzero(table[k])
                ]
        return terms

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one solution per frequency and output."""
        gradient = np.array(self.own)
        stiff, heavy, shapes = [], [], []
        for term in self.terms:
            weights = self.system.row(term.output).weights
            left = term.seed * (weights.forces - term.adjoint)
            kappa, mu = self.system.factors(term.omega)
            for part, turn in ((term.motion.real, 1.0), (term.motion.imag, 1j)):
                stiff.append((turn * kappa * left).real)
                heavy.append((turn * mu * left).real)
                shapes.append(part)
            gradient += self._rest(term, left)
        if shapes:
            columns = (np.array(part).T for part in (stiff, heavy, shapes))
            gradient += self.tangent.pull(*columns)
        return gradient

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives along one parameter after the other."""
        gradient = self.own[list(columns)]
        rest = [self._rest(term, self._left(term)) for term in self.terms]
        for i, column in enumerate(columns):
            along = self.tangent.along(column)
            for term, other in zip(self.terms, rest, strict=True):
                shapes = np.array([term.motion.real, term.motion.imag]).T
                dk, dm = along.of(shapes)
                kappa, mu = self.system.factors(term.omega)
                change = kappa * (dk[:, 0] + 1j * dk[:, 1]) + mu * (dm[:, 0] + 1j * dm[:, 1])
                gradient[i] += float((self._left(term) @ change).real) + other[column]
        return gradient

    def _left(self, term: Term) -> np.ndarray:
        weights = self.system.row(term.output).weights
        return term.seed * (weights.forces - term.adjoint)  # type: ignore[no-any-return]

    def _rest(self, term: Term, left: np.ndarray) -> np.ndarray:
        """(np,) derivative through damping coefficients, loads, supports and the measure."""
        system = self.system
        return (
            self._by_damping(term, left)
            + self._by_inputs(term)
            + self._by_measure(term)
            + self._by_state(term)
        ) * np.ones(system.p.size)

    def _by_damping(self, term: Term, left: np.ndarray) -> np.ndarray:
        system, (k, m) = self.system, self.system.full
        coefficients = system.analysis.damping.coefficients(system.model)
        by_alpha = (1j * term.omega * (left @ (m @ term.motion))).real
        by_beta = (1j * term.omega * (left @ (k @ term.motion))).real
        pulled: np.ndarray = coefficients.pull(system.p, np.array([by_alpha, by_beta]))
        return pulled

    def _by_inputs(self, term: Term) -> np.ndarray:
        """Through the forces and the motions of supports of the inputs."""
        system, p = self.system, self.system.p
        weights = system.row(term.output).weights
        held = system.model.assembly.prescribed
        moving = weights.u + system.dynamic(term.omega).T @ (weights.forces - term.adjoint)
        gradient = np.zeros(p.size)
        for number, name in enumerate(system.inputs):
            share = term.seed * system.mix[number, term.column]
            force = (share * term.adjoint).real
            if name in system.model.loads:
                gradient += system.model.loads[name].pull(p, force)
                continue
            dp = np.eye(p.size)[list(system.model.parameters).index(name)]
            for load in system.model.loads.values():
                gradient += load.turn(p, force, dp)
            support = (share * moving[held]).real
            gradient += system.model.prescribed.turn(p, support, dp)
        return gradient

    def _by_measure(self, term: Term) -> np.ndarray:
        """Through the derivatives of the measure."""
        weights = self._measure_change(term)
        return weights[1]

    def _by_state(self, term: Term) -> np.ndarray:
        """Through the displacements of a loaded state."""
        u_bar = self._measure_change(term)[0]
        state = self.system.loaded
        if state.result is None or not u_bar.any():
            return np.zeros(self.system.p.size)
        raise UnsupportedError(
            "gradients of outputs that are nonlinear in the displacements of a loaded state are "
            "not available; use method='finite-difference', or displacements as outputs"
        )

    def _measure_change(self, term: Term) -> tuple[np.ndarray, np.ndarray]:
        """Weights of displacements and parameters in ``Re s (c_u·û + c_f·Z û + c_p·dp)``."""
        system = self.system
        formula = system.formula(term.output)
        forces = system.dynamic(term.omega) @ term.motion
        direction = system.directions[:, term.column]
        total_u, total_p = np.zeros(term.motion.size), np.zeros(system.p.size)
        for turn in (1.0, 1j):
            u, f, p = (
                part.real if turn == 1.0 else part.imag for part in (term.motion, forces, direction)
            )
            weights = formula.turn(0, State(u, f, p), (term.seed * turn).real)
            total_u += weights.u
            total_p += weights.p
        return total_u, total_p


class StructuralHarmonicEngine(RowEngine):
    """Engine for harmonic responses of structures, row by row."""

    row = StructuralHarmonicGradient
