"""Penalty formulation (7.1–7.4): constraints replaced by stiff forces with damping and inertia."""

from __future__ import annotations

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.formulations.augmented_mass import AugmentedLagrangianSolver, AugmentedMass
from dalembert.formulations.base import NONE, Formulation, Level, SaddleSolver
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.options import options


class PenaltySolver(SaddleSolver):
    """``M x + Cᵀ z = r1``, ``C x − z/α = r2``: (7.4) with its forces ``z`` as unknowns."""

    def __init__(self, augmented: AugmentedMass):
        self.augmented, self.softness = augmented, 1 / augmented.alpha
        self.speed_count = augmented.inertia.size

    def solve(self, r1: ca.SX, r2: ca.SX) -> tuple[ca.SX, ca.SX]:
        return self.augmented.refined(r1, r2, 3, self.softness)  # recovers digits lost to a large α

    @property
    def corrector(self) -> AugmentedLagrangianSolver:
        return AugmentedLagrangianSolver(self.augmented, 3, rounds=1)


@options
class Penalty(Formulation):
    """``(M + CᵀαC) v̇ = f − d − Cᵀα(2ηΦ̇ + ω²Φ − ξ)`` (7.4), ``λ = α(C v̇ − ξ + 2ηΦ̇ + ω²Φ)``.

    Constraints hold approximately, ``Φ̈ + 2ηΦ̇ + ω²Φ = λ/α``: errors of ``v̇`` and ``λ`` are
    proportional to ``1/α``. Supports redundant constraints and singular positions.

    Parameters
    ----------
    factor : ``α`` over the mean effective mass of the constraints [-]
    omega : stiffness of the constraints over ``α``, as a frequency ``ω`` [rad/s]
    eta : their damping over ``2α``, ``η`` [1/s]; at least ``omega``, critical when equal

    Raises
    ------
    UnsupportedError
        ``factor`` or ``omega`` not positive, ``eta`` below ``omega``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> model = system.build()
    >>> gaps = []
    >>> for factor in (1e5, 1e6):
    ...     soft = dict(formulation=da.Penalty(factor), stabilization=da.Stabilization())
    ...     motion = da.solve_dynamics(model, 0.5, step=1e-3, **soft)
    ...     gaps.append(motion["position_violation"].max().item())
    >>> round(gaps[0] / gaps[1], 1)  # ten times as stiff, a tenth of the gap
    10.0
    """

    factor: float = 1e6
    omega: float = 10.0
    eta: float = 10.0

    def __post_init__(self) -> None:
        for name in ("factor", "omega"):
            value = getattr(self, name)
            if not 0 < value < float("inf"):
                raise UnsupportedError(f"Penalty: {name}={value} must be positive and finite")
        if not self.omega <= self.eta < float("inf"):
            raise UnsupportedError(
                f"Penalty: eta={self.eta} must be at least omega={self.omega}, or the constraints "
                f"oscillate; eta={self.omega} damps them critically"
            )

    @property
    def every_equation(self) -> bool:
        return True

    @property
    def report(self) -> dict[str, float]:
        return {"augmented mass / mean mass": self.factor}

    @property
    def exact_levels(self) -> frozenset[Level]:
        return NONE

    @property
    def feedback(self) -> tuple[float, float]:
        return 2 * self.eta, self.omega**2

    def solver(self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]) -> PenaltySolver:
        return PenaltySolver(AugmentedMass(inertia, jacobian, massless, self.factor))

    def constraint_acceleration(self, e: Equations, xi: ca.SX) -> ca.SX:
        damping, stiffness = self.feedback
        return xi - damping * e.velocity_constraints - stiffness * e.constraints
