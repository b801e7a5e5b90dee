"""Augmented Lagrangian formulation, or augmented mass method (7.5–7.6)."""

from __future__ import annotations

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.formulations.augmented_mass import AugmentedLagrangianSolver, AugmentedMass
from dalembert.formulations.base import Formulation
from dalembert.model.equations import Equations
from dalembert.model.inertia import Inertia
from dalembert.options import options

DISTRUST = 300.0
"""Per square of the violation by its natural size, ``m/α`` is at least this."""
ENOUGH = 1e4
"""Factor below which the violation does not push ``α``."""


@options
class AugmentedLagrangian(Formulation):
    """``(M + CᵀαC) v̇ = f − d + Cᵀ(α ξ − λ*)``, ``λ* ← λ* + α (C v̇ − ξ)`` (7.5–7.6).

    Takes redundant constraints, passes through singular positions, and takes massless members
    that are held by constraints. With redundant constraints ``v̇`` and all forces that are unique
    are those of any formulation; of the multipliers that are not, the smallest are found: least
    ``Σ λ²``, forces in newtons and moments in newton-metres alike. Gradients are exact for unique
    quantities; those of single redundant multipliers are not.

    Parameters
    ----------
    factor : ``α`` over the mean of the masses that the constraints see
    iterations : of ``λ*``, with one factorisation

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
    >>> b = system.add(planar.Weld("B", system.ground.center, door.start))  # holds it once more
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 0.1, step=0.1, formulation=da.AugmentedLagrangian())
    >>> [round(motion[f"{name}.force.y"][0].item(), 6) for name in "AB"]  # they share the weight
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
        """``α`` is smaller where the constraints are violated, in intermediate states of a step.

        ``C`` is right there to the size of the violation only: redundant equations contradict
        each other that much, and a large ``α`` would take them at their word.
        """
        least = min(self.factor, ENOUGH)
        violation = DISTRUST * self.factor * ca.sumsqr(e.constraints / e.scales.rows)
        factor = least + (self.factor - least) / (1 + violation)
        augmented = AugmentedMass(e.inertia, e.jacobian, e.massless, factor)
        return AugmentedLagrangianSolver(augmented, self.iterations)

    def solver(
        self, inertia: Inertia, jacobian: ca.SX, massless: tuple[int, ...]
    ) -> AugmentedLagrangianSolver:
        augmented = AugmentedMass(inertia, jacobian, massless, self.factor)
        return AugmentedLagrangianSolver(augmented, self.iterations)
