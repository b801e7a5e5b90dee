"""Augmented Lagrangian formulation, or augmented mass method (7.5–7.6)."""

from __future__ import annotations

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.formulations.augmented_mass import AugmentedLagrangianSolver, AugmentedMass
from dalembert.formulations.base import Formulation
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.inertia import Inertia
from dalembert.options import options

VIOLATION_GAIN = 300.0
"""Decrease of ``α`` with the violation: ``m/α`` per squared violation in natural units [-]."""
LEAST_FACTOR = 1e4
"""Lower limit of ``factor`` when the violation reduces ``α`` [-]."""


@options
class AugmentedLagrangian(Formulation):
    """``(M + CᵀαC) v̇ = f − d + Cᵀ(α ξ − λ*)``, ``λ* ← λ* + α (C v̇ − ξ)`` (7.5–7.6).

    Supports redundant constraints, singular positions, and massless members fixed by
    constraints. With redundant constraints ``v̇`` and all unique forces agree with every other
    formulation; multipliers that are not unique have minimum ``Σ λ²``, with forces in newtons and
    moments in newton-metres. Gradients are exact for unique quantities, not for single redundant
    multipliers.

    Parameters
    ----------
    factor : ``α`` over the mean effective mass of the constraints [-]
    iterations : number of updates of ``λ*``, with one factorisation

    Raises
    ------
    UnsupportedError
        ``factor`` not positive or ``iterations`` below one.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("door on two hinges", gravity=(0, -10))
    >>> door = system.add(planar.Bar("door", length=2.0, mass=3.0))
    >>> a = system.add(planar.Revolute("A", system.ground.center, door.start))
    >>> b = system.add(planar.Weld("B", system.ground.center, door.start))  # redundant
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 0.1, step=0.1, formulation=da.AugmentedLagrangian())
    >>> [round(motion[f"{name}.force.y"][0].item(), 6) for name in "AB"]  # equal shares
    [15.0, 15.0]
    """

    factor: float = 1e7
    iterations: int = 5

    def __post_init__(self) -> None:
        if not 0 < self.factor < float("inf") or self.iterations < 1:
            raise UnsupportedError(
                f"AugmentedLagrangian(factor={self.factor}, iterations={self.iterations}): factor "
                "must be positive and finite, iterations at least 1"
            )

    @property
    def every_equation(self) -> bool:
        return True

    @property
    def report(self) -> dict[str, float]:
        return {"augmented mass / mean mass": self.factor, "iterations of λ": self.iterations}

    def saddle(self, e: Equations) -> AugmentedLagrangianSolver:
        """Solver with a smaller ``α`` at violated constraints, in intermediate states of a step.

        ``C`` is accurate there to the size of the violation only: redundant equations contradict
        each other by that much, and a large ``α`` would amplify the contradiction.
        """
        least = min(self.factor, LEAST_FACTOR)
        violation = VIOLATION_GAIN * self.factor * ca.sumsqr(e.constraints / e.scales.rows)
        factor = least + (self.factor - least) / (1 + violation)
        augmented = AugmentedMass(e.inertia, e.jacobian, e.massless, factor)
        return AugmentedLagrangianSolver(augmented, self.iterations)

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> AugmentedLagrangianSolver:
        augmented = AugmentedMass(inertia, jacobian, massless, self.factor)
        return AugmentedLagrangianSolver(augmented, self.iterations)
