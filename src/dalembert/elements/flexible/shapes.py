"""Shapes of a reduced structure in a floating frame, and its inertia integrals.

Nodal displacements in the floating frame are ``u = Φ q + ½ Σ Θ_kl q_k q_l``, so ``u = Φ_a a(q)``
with the amplitudes ``a = (q, q_k q_l)``. A velocity of the body is

    w = T v' + R ω' + Φ_a ȧ + Σ (e_j × Φ_a) a ω'_j = W s,      s = (v', ω', ȧ, a ⊗ ω')

in nodal velocities ``w`` in the axes of the frame, so that the kinetic energy is
``½ sᵀ (Wᵀ M W) s`` with the mass matrix ``M`` of the finite elements: all inertia integrals are
entries of one numerical matrix. With products of amplitudes it includes terms up to second order
and all terms quadratic in ``ȧ`` (nodal-based floating frame: Zwölfer and Gerstmayr, The nodal-based
floating frame of reference formulation, Acta Mechanica 232, 2021).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from dalembert.symbolic.once import CacheOwner


@dataclass(frozen=True, eq=False)
class SectionShapes:
    """Motion of an interface in the floating frame.

    Attributes
    ----------
    place : (d,) undeformed position
    shift : (d, amplitudes)
    turn : (rotations, amplitudes) small rotations; no rows if it only translates
    """

    place: np.ndarray
    shift: np.ndarray
    turn: np.ndarray


@dataclass(frozen=True, eq=False)
class FloatingShapes(CacheOwner):
    """A structure in a floating frame by ``m`` shapes.

    Attributes
    ----------
    dimension : 2 or 3
    frequencies : (m,) of the modes with the frame at rest [rad/s]
    stiffness, mass : (m, m) of the shapes; diagonal if the shapes are these modes
    critical : (m, m) damping matrix that damps all these modes critically
    pairs : (k, 2) pairs of shapes with second-order displacements
    inertia : (N, N) ``Wᵀ M W``
    counted : (N, N) one for entries of the inertia that are included, else zero
    sections : interface → SectionShapes
    origin : (d,) of the frame, in the axes of the structure
    displacements : (n, amplitudes) of all nodes, ``Φ_a``
    structure, p : structural model and its parameter values
    """

    dimension: int
    frequencies: np.ndarray
    stiffness: np.ndarray
    mass: np.ndarray
    critical: np.ndarray
    pairs: np.ndarray
    inertia: np.ndarray
    counted: np.ndarray
    sections: Mapping[str, SectionShapes]
    origin: np.ndarray
    displacements: np.ndarray
    structure: Any
    p: np.ndarray

    @property
    def count(self) -> int:
        """Number of shapes ``m``."""
        return len(self.stiffness)

    @property
    def total_mass(self) -> float:
        """Mass of the body [kg]."""
        return float(self.inertia[0, 0])

    @property
    def rotations(self) -> int:
        """Number of rotation axes."""
        return 1 if self.dimension == 2 else 3


class FollowingStructure(Protocol):
    """Shapes chosen at nominal parameters, as functions of the parameters."""

    chosen: FloatingShapes

    def at(self, parameters: Mapping[str, float]) -> FloatingShapes:
        """The shapes at parameter values."""

    def push(self, parameters: Mapping[str, float], changes: Mapping[str, float]) -> FloatingShapes:
        """Derivatives of the shapes along changes of parameters."""

    def pull(
        self, parameters: Mapping[str, float], weights: FloatingShapes, names: Sequence[str]
    ) -> np.ndarray:
        """Adjoints of parameters from adjoints of the shapes."""


class FlexibleStructure(Protocol):
    """Interface of structures that can be flexible bodies, such as ``StructuralModel``."""

    name: str
    parameters: Mapping[str, Any]

    def following(
        self,
        interface: Any,
        modes: int = 6,
        *,
        up_to: float | None = None,
        frame: str = "",
        second_order: bool = False,
        parameters: Mapping[str, float] | None = None,
    ) -> FollowingStructure:
        """Its shapes in a floating frame."""
