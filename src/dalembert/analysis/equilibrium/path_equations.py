"""The bordered equations of a load path, ``[K −q; nᵀ/s² ν]`` with ``q = P_f − K_fp U_p``."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.analysis.equilibrium.static_equations import (
    ForceResidual,
    StaticEquations,
    free_factors,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.structural.load_path import Plane
from dalembert.sparse.factorise import general_factors, symmetric_factors
from dalembert.sparse.solver import Factors
from dalembert.symbolic.equations.newton import ROUNDING, Equations, Residual


class PathEquations:
    """Equilibrium in free displacements and load factor, ``point = (u_f, λ)``.

    Parameters
    ----------
    model : StructuralModel
    p : (np,) parameters
    case : load case

    Raises
    ------
    AnalysisError
        The load moves nothing; ``SingularityError``: the structure is a mechanism.
    """

    def __init__(self, model: StructuralModel, p: np.ndarray, case: str):
        self.model, self.p, self.statics = model, p, StaticEquations(model, p, case)
        self.free, self.held = self.statics.free, self.statics.held
        self.size = int(self.free.size)
        model.loads[case].refuse_fixed_axes(
            "a load path, which counts negative eigenvalues,",
            "use solve_statics(…, nonlinear=True)",
        )
        stiffness, load, _ = self.matrix(np.zeros(self.size + 1))
        factor = free_factors(model, stiffness)
        self._slope = factor.solve(load) if factor is not None else np.zeros(0)
        arms = self.statics.balance.arms[self.free]
        length = float(np.linalg.norm(arms * self._slope))
        self.scale = length / arms
        if not length > 0:
            raise AnalysisError(f"load case {case!r} moves nothing; give it loads")

    def start(self) -> np.ndarray:
        """Unit direction of the path at rest."""
        return np.append(self._slope, 1.0) / np.sqrt(2.0)

    def metric(self, direction: np.ndarray) -> np.ndarray:
        """The vector whose product with another direction is their inner product."""
        return np.append(direction[:-1] / self.scale**2, direction[-1])

    def displacements_at(self, point: np.ndarray) -> np.ndarray:
        """(n,) all displacements."""
        u = np.zeros(self.statics.assembly.size)
        u[self.free], u[self.held] = point[:-1], point[-1] * self.statics.prescribed
        return u

    def forces(self, point: np.ndarray) -> np.ndarray:
        """(n,) applied forces, and reactions at prescribed displacements."""
        return self.statics.forces(self.displacements_at(point), point[-1])

    def residual(self, point: np.ndarray) -> ForceResidual:
        """Unbalanced forces on the free displacements."""
        return self.statics.residual(self.displacements_at(point), point[-1])

    def matrix(self, point: np.ndarray, stiffness: Any = None) -> tuple[Any, np.ndarray, Any]:
        """``K_ff``, ``q`` and the whole stiffness, computed unless passed."""
        statics = self.statics
        if stiffness is None:
            stiffness = statics.stiffness(self.displacements_at(point), point[-1])
        tangent, load_forces = stiffness.tocsr(), statics.applied
        if statics.moving:
            load_forces = load_forces - statics.moving.forces(self.displacements_at(point), self.p)
        rows = tangent[self.free]
        load = load_forces[self.free] - rows[:, self.held] @ statics.prescribed
        return rows[:, self.free].tocsc(), load, tangent

    def factor(self, point: np.ndarray, plane: Plane, tangent: Any = None) -> Factors:
        """Factors of the bordered matrix, regular at limit points.

        Raises
        ------
        SingularityError
            The point is a bifurcation.
        """
        stiffness, load, _ = self.matrix(point, tangent)
        row = plane.row
        parts = [[stiffness, -load[:, None]], [row[None, :-1], row[None, -1:]]]
        try:
            return general_factors(scipy.sparse.bmat(parts, format="csc"))
        except np.linalg.LinAlgError:
            raise SingularityError("the path branches there") from None

    def direction(self, point: np.ndarray, plane: Plane) -> np.ndarray:
        """Unit direction of the path at a point, along the normal of the plane."""
        ahead = np.eye(1, self.size + 1, self.size).ravel()
        tangent = self.factor(point, plane).solve(ahead)
        return tangent / np.sqrt(tangent @ self.metric(tangent))

    def negative(self, point: np.ndarray) -> int:
        """Number of negative eigenvalues of ``K_ff``, from the pivots of its factors."""
        if not self.size:
            return 0
        try:
            return symmetric_factors(self.matrix(point)[0]).negative
        except np.linalg.LinAlgError:
            return 0


class Crossing(Equations[np.ndarray]):
    """The point where a path crosses a plane."""

    def __init__(self, path: PathEquations, plane: Plane):
        self.path, self.plane = path, plane

    def residual(self, x: np.ndarray) -> ForceResidual:
        forces, row = self.path.residual(x), np.abs(self.plane.row)
        value = np.append(forces.value, -self.plane.distance(x))
        noise = np.append(forces.rounding, ROUNDING * (row @ np.abs(x)))
        return ForceResidual(value, np.append(forces.scale, 1.0), noise, stiffness=forces.stiffness)

    def step(self, x: np.ndarray, residual: Residual) -> np.ndarray:
        assert isinstance(residual, ForceResidual)
        return self.path.factor(x, self.plane, residual.stiffness).solve(residual.value)
