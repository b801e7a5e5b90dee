"""The equations of motion of a structure, ``M a + C v + ∂W/∂u(u) = P(t)``, at given parameters."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as linalg

from dalembert.elements.base import Scalar
from dalembert.errors import ModelError, SingularityError
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.expression import as_expression, free_symbols
from dalembert.symbolic.parametric_array import ArrayEntries, ParametricArray


@dataclass(frozen=True, eq=False)
class Rayleigh:
    """Proportional damping, ``C = α M + β K`` with the stiffness ``K`` at rest (Rayleigh 1877).

    A mode of angular frequency ``ω`` has the damping ratio ``(α/ω + β ω)/2``.

    Parameters
    ----------
    mass : ``α`` [1/s], number or formula of parameters
    stiffness : ``β`` [s], likewise
    """

    mass: Scalar = 0.0
    stiffness: Scalar = 0.0

    def coefficients(self, model: StructuralModel) -> ParametricArray:
        """``(α, β)`` as functions of the model's parameters.

        Raises
        ------
        ModelError
            A formula of anything else.
        """
        entries = ArrayEntries(2)
        for k, name in enumerate(("mass", "stiffness")):
            made = as_expression(getattr(self, name), f"Rayleigh.{name}")
            foreign = free_symbols(made.sx) - set(model.parameters)
            if foreign:
                raise ModelError(
                    f"depends on {', '.join(sorted(foreign))}, no parameters of {model.name}",
                    f"Rayleigh.{name}",
                )
            entries.add(k, made)
        return entries.array(model.p)


class Motions(NamedTuple):
    """Displacements, velocities and accelerations, (n,) or (n, columns)."""

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray


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
    mass, stiffness : (n, n) sparse; the stiffness at rest
    alpha, beta : coefficients of the damping
    """

    def __init__(
        self, model: StructuralModel, p: np.ndarray, case: str, damping: Rayleigh, lumped: bool
    ):
        self.model, self.p, self.lumped = model, p, lumped
        self.assembly, self.linear = model.assembly, model.linear
        self.free, self.held = self.assembly.free, self.assembly.prescribed
        self.load_case, self.damping = model.loads[case], damping.coefficients(model)
        self.alpha, self.beta = (float(c) for c in self.damping.values(p))
        rest = np.zeros(self.assembly.size)
        self.mass = self.assembly.mass(p, lumped)
        self.stiffness = self.assembly.stiffness(rest, p)
        self._at_rest = self.assembly.internal_forces(rest, p)
        self.supports = (
            model.prescribed,
            model.prescribed.derivative,
            model.prescribed.derivative.derivative,
        )

    @cached_property
    def massive(self) -> np.ndarray:
        """Free displacements that move mass."""
        return self.free[self.mass.diagonal()[self.free] > 0]

    @cached_property
    def _constant_load(self) -> np.ndarray | None:
        case = self.load_case
        return None if case.depends_on_time else case.values(self.p)

    def loads(self, time: float) -> np.ndarray:
        """(n,) applied forces."""
        constant = self._constant_load
        return self.load_case.values(self.p, time) if constant is None else constant

    def support_motion(self, time: float) -> Motions:
        """(held,) prescribed displacements with their velocities and accelerations."""
        return Motions(*(array.values(self.p, time) for array in self.supports))

    def tangent(self, u: np.ndarray) -> sparse.csc_matrix:
        """``∂²W/∂u²``."""
        return self.stiffness if self.linear else self.assembly.stiffness(u, self.p)

    def internal_forces(self, u: np.ndarray) -> np.ndarray:
        """(n,) ``∂W/∂u``."""
        if self.linear:
            return self._at_rest + self.stiffness @ u
        return self.assembly.internal_forces(u, self.p)

    def damped(self, v: np.ndarray) -> np.ndarray:
        """``C v`` for one or many columns."""
        found = np.zeros_like(v)
        if self.alpha:
            found += self.alpha * (self.mass @ v)
        if self.beta:
            found += self.beta * (self.stiffness @ v)
        return found

    def forces(self, motion: Motions) -> np.ndarray:
        """(n,) forces that the motion needs, ``M a + C v + ∂W/∂u``."""
        return self.mass @ motion.a + self.damped(motion.v) + self.internal_forces(motion.u)

    def external_forces(self, motion: Motions, time: float) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        found = self.loads(time).copy()
        found[self.held] = (self.forces(motion) - found)[self.held]
        return found

    def changed(self, tangent: sparse.csc_matrix, change: Motions) -> np.ndarray:
        """``M da + C dv + K du`` for many columns; symmetric matrices, so its transpose too."""
        return self.mass @ change.a + self.damped(change.v) + tangent @ change.u


def factors(matrix: sparse.csc_matrix, what: str) -> linalg.SuperLU | None:
    """Sparse factors of a symmetric positive matrix.

    Raises
    ------
    SingularityError
        It is singular; ``what`` tells what that means.
    """
    if not matrix.shape[0]:
        return None
    try:
        return linalg.splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        raise SingularityError(what) from None
