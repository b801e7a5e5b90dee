"""Implicit elimination: direct solution of the saddle system (5.7)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.formulations.base import Formulation, SaddleSolver
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.model.graph.scales import Scales
from dalembert.symbolic.equations.factor import QrFactor


class KKTSolver(SaddleSolver):
    """Sparse Householder QR of the saddle matrix (5.7), scaled by natural sizes if given."""

    def __init__(self, inertia: Inertia, jacobian: ca.SX, scales: Scales | None = None):
        mass = inertia.matrix
        self.speed_count = mass.shape[0]
        m = jacobian.shape[0]
        matrix = ca.vertcat(ca.horzcat(mass, jacobian.T), ca.horzcat(jacobian, ca.SX(m, m)))
        rows = columns = None
        if scales is not None:  # sizes of accelerations and multipliers
            rows = np.concatenate([scales.efforts, scales.rows / scales.time**2])
            columns = np.concatenate([scales.speeds / scales.time, scales.multipliers])
        self.factor = QrFactor(matrix, rows, columns)

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        solution = self.factor.solve(ca.vertcat(r1, r2))
        return solution[: self.speed_count, :], solution[self.speed_count :, :]


@dataclass(frozen=True)
class KKT(Formulation):
    """Implicit elimination: ``[M Cᵀ; C 0] [v̇; λ] = [f − d; ξ]`` (5.7) solved directly.

    Supports massless bodies; costs more than ``RangeSpace``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("rod without mass", gravity=(0, -10))
    >>> rod = system.add(planar.Bar("rod", length=1.0))
    >>> bob = system.add(planar.Particle("bob", mass=2.0, position=(1, 0)))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, rod.start))
    >>> end = system.add(planar.Revolute("A", rod.end, bob.center))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1, formulation=da.KKT())
    >>> round(motion["bob.ay"][0].item(), 6)
    -10.0
    """

    @property
    def needs_mass(self) -> bool:
        return False

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> KKTSolver:
        return KKTSolver(inertia, jacobian)

    def saddle_at(self, e: Equations, inertia: Inertia, jacobian: ca.SX) -> KKTSolver:
        return KKTSolver(inertia, jacobian, e.scales)
