"""Equations of motion of a structure, ``M a + C v + ∂W/∂u(u) = P(t)``, at parameter values.

Where inertia rotates with elements, ``M a`` is ``d/dt ∂T/∂v − ∂T/∂u`` of their kinetic energy.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy

from dalembert.analysis.rayleigh import Rayleigh
from dalembert.errors import SingularityError, UnsupportedError
from dalembert.integrators.newmark.rule import Moving
from dalembert.model.assembled.evaluation.pattern import combine
from dalembert.model.assembled.load_case import ConfigurationLoad, Expansion
from dalembert.model.assembled.model import StructuralModel
from dalembert.sparse.factorise import indefinite_factors, symmetric_factors
from dalembert.sparse.solver import Factors


class Motions(NamedTuple):
    """Displacements, velocities and accelerations, (n,) or (n, columns)."""

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray


def motion_of(x: Moving) -> Motions:
    """The motion without the memory variable of the method."""
    return Motions(x.u, x.v, x.a)


class Slopes(NamedTuple):
    """Derivatives of the forces of a motion by displacements, velocities and accelerations."""

    u: scipy.sparse.csc_matrix
    v: scipy.sparse.csc_matrix
    a: scipy.sparse.csc_matrix

    def along(self, change: Motions) -> np.ndarray:
        """Change of the forces, for one or many columns."""
        return self.a @ change.a + self.v @ change.v + self.u @ change.u

    def weigh(self, weights: np.ndarray) -> Motions:
        """Weights of the motion from those of the forces."""
        return Motions(*(slope.T @ weights for slope in self))


class EquationOfMotion:
    """Matrices and forces of a structure at parameter values.

    Parameters
    ----------
    model : linear, or with the exact energies
    p : (np,) values of the parameters
    case : name of the load case
    damping : Rayleigh
    lumped : whether the mass matrix is diagonal

    Attributes
    ----------
    mass, stiffness : (n, n) sparse; in the initial configuration
    steady, turning : sums over the elements with constant and with rotating inertia
    alpha, beta : coefficients of the damping
    """

    def __init__(
        self, model: StructuralModel, p: np.ndarray, case: str, damping: Rayleigh, lumped: bool
    ):
        self.model, self.p, self.lumped = model, p, lumped
        self.assembly, self.linear = model.assembly, model.linear
        self.free, self.held = self.assembly.free, self.assembly.prescribed
        self.load_case, self.damping = model.loads[case], damping.coefficients(model)
        moving = self.load_case.configuration
        if moving.depends_on_time and not self.linear:
            raise UnsupportedError(
                f"temperatures or moments about fixed axes of load case {case!r} depend on time, "
                "which nonlinear transients do not support; use nonlinear=False, or constant ones"
            )
        no_load = ConfigurationLoad([], [], self.assembly.size, self.held, self.linear)
        self.expansion = Expansion(moving if self.linear else no_load)
        self.heated = no_load.assembly if self.linear else moving.assembly
        self.alpha, self.beta = (float(c) for c in self.damping.values(p))
        rest = np.zeros(self.assembly.size)
        self.mass = self.assembly.mass(p, lumped)
        self.stiffness = self.assembly.stiffness(rest, p)
        self._at_rest = self.assembly.internal_forces(rest, p)
        self.steady, self.turning = self.assembly.split(lambda b: b.kind.turning(lumped))
        self._inertia = self.steady.mass(p, lumped) if self.turns else self.mass
        self._damper = combine((self.beta, self.stiffness))
        self.supports = (
            model.prescribed,
            model.prescribed.derivative,
            model.prescribed.derivative.derivative,
        )

    @property
    def rest(self) -> Motions:
        """Zero displacements, velocities and accelerations."""
        return Motions(*np.zeros((3, self.assembly.size)))

    @property
    def symmetric(self) -> bool:
        """Whether all derivatives of the forces are symmetric."""
        return not self.turns and self.load_case.configuration.symmetric

    @property
    def turns(self) -> bool:
        """Whether any inertia depends on the displacements."""
        return bool(self.turning.blocks)

    @cached_property
    def sizes(self) -> tuple[scipy.sparse.csc_matrix, scipy.sparse.csc_matrix]:
        """Magnitudes of the entries of mass and damping matrix in the initial configuration."""
        return abs(self.mass), abs(self.alpha * self.mass + self._damper)

    @cached_property
    def massive(self) -> np.ndarray:
        """Free displacements with mass."""
        return self.free[self.mass.diagonal()[self.free] > 0]

    @cached_property
    def _constant_load(self) -> np.ndarray | None:
        changing = self.load_case.depends_on_time
        return None if changing or self.expansion.depends_on_time else self._loads(0.0)

    def _loads(self, time: float) -> np.ndarray:
        return self.load_case.values(self.p, time) + self.expansion.values(self.p, time)

    def loads(self, time: float) -> np.ndarray:
        """(n,) applied forces, with those of hindered thermal expansion."""
        constant = self._constant_load
        return self._loads(time) if constant is None else constant

    def support_motion(self, time: float) -> Motions:
        """(held,) prescribed displacements with their velocities and accelerations."""
        return Motions(*(array.values(self.p, time) for array in self.supports))

    def tangent(self, u: np.ndarray) -> scipy.sparse.csc_matrix:
        """``∂²W/∂u²``, thermal terms included."""
        if self.linear:
            return self.stiffness
        stiffness = self.assembly.stiffness(u, self.p)
        return stiffness + self.heated.stiffness(u, self.p) if self.heated.blocks else stiffness

    def internal_forces(self, u: np.ndarray) -> np.ndarray:
        """(n,) ``∂W/∂u``."""
        if self.linear:
            return self._at_rest + self.stiffness @ u
        forces = self.assembly.internal_forces(u, self.p)
        return forces + self.heated.internal_forces(u, self.p)

    def parts(self, motion: Motions) -> list[np.ndarray]:
        """Forces (n,) required by the motion: inertia, mass and stiffness damping, strain."""
        forces = [self._inertia @ self._damped_acceleration(motion)]
        if self.beta:
            forces.append(self._damper @ motion.v)
        if self.turns:
            moved = motion._replace(a=self._damped_acceleration(motion))
            forces.append(self.turning.inertia_forces(moved, self.p, self.lumped))
        if self.linear or not self.heated.blocks:
            return [*forces, self.internal_forces(motion.u)]
        parts = (self.assembly, self.heated)
        return [*forces, *(part.internal_forces(motion.u, self.p) for part in parts)]

    def forces(self, motion: Motions) -> np.ndarray:
        """(n,) forces required by the motion, ``d/dt ∂T/∂v − ∂T/∂u + C v + ∂W/∂u``."""
        return sum(self.parts(motion), np.zeros(self.assembly.size))

    def momentum(self, u: np.ndarray, v: np.ndarray) -> np.ndarray:
        """``∂T/∂v``, for one or many columns."""
        momentum = self._inertia @ v
        if self.turns and v.ndim > 1:
            return np.stack([self.momentum(*column) for column in zip(u.T, v.T, strict=True)], 1)
        if self.turns:
            still = np.zeros_like(u)
            momentum = momentum + self.turning.inertia_forces((u, still, v), self.p, self.lumped)
        return momentum

    def external_forces(self, motion: Motions, time: float) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        loads = self.loads(time)
        forces = self.load_case.values(self.p, time) if self.expansion else loads.copy()
        forces[self.held] = (self.forces(motion) - loads)[self.held]
        return forces

    def slopes(self, motion: Motions, stiffness: scipy.sparse.csc_matrix | None = None) -> Slopes:
        """Derivatives of ``forces``; the stiffness is computed unless passed."""
        constant = self._constant_slopes
        if self.linear:
            return constant
        strain = self.tangent(motion.u) if stiffness is None else stiffness
        if not self.turns:
            return constant._replace(u=strain)
        moved = motion._replace(a=self._damped_acceleration(motion))
        by_u, by_v, by_a = self.turning.inertia_slopes(moved, self.p, self.lumped)
        return Slopes(
            combine((1.0, strain), (1.0, by_u)),
            combine((1.0, constant.v), (1.0, by_v), (self.alpha, by_a)),
            combine((1.0, constant.a), (1.0, by_a)),
        )

    @cached_property
    def _constant_slopes(self) -> Slopes:
        """``K``, ``C`` and ``M`` of the elements with constant inertia."""
        damper = combine((self.alpha, self._inertia), (1.0, self._damper))
        return Slopes(self.stiffness, damper, self._inertia)

    def _damped_acceleration(self, motion: Motions) -> np.ndarray:
        """``a + α v``: mass damping is the inertia of these accelerations."""
        return motion.a + self.alpha * motion.v if self.alpha else motion.a


def factors(matrix: scipy.sparse.csc_matrix, reason: str, symmetric: bool = True) -> Factors | None:
    """Sparse factors of a matrix, usually symmetric and positive definite.

    Raises
    ------
    SingularityError
        It is singular; ``reason`` is the message.
    """
    if not matrix.shape[0]:
        return None
    try:
        return symmetric_factors(matrix) if symmetric else indefinite_factors(matrix)
    except np.linalg.LinAlgError:
        raise SingularityError(reason) from None
