"""Energy projection: correction of the energy after that of the constraints (5.22–5.23)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.formulations.base import WORK, Formulation, memory_symbols, state_symbols
from dalembert.formulations.stabilization import Projection
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.implicit import ImplicitFunction

APPLICABLE = 0.5
"""Upper limit of ``|Ψ_E| / T`` for a correction: at small ``T`` speeds cannot correct energy."""


@dataclass(frozen=True)
class EnergyProjection(Projection):
    """Projection (5.21), then ``v ← v √(1 − Ψ_E / T)`` with ``Ψ_E = T + V − E_ref`` (5.23).

    ``E_ref`` is the initial energy plus the energy supplied minus the energy dissipated since.
    Scleronomic constraints stay satisfied, because they do not depend on the magnitude of v.

    The correction suits conservative systems with one degree of freedom. One number cannot correct
    several speeds: with more degrees of freedom the energy is right while the motion is as wrong
    as before, and if energy is supplied or dissipated the reference itself is integrated. Both
    cases cause a warning.

    Parameters
    ----------
    every : correct after every k-th step
    iterations : number of iterations of the position correction

    Raises
    ------
    UnsupportedError
        A rheonomic constraint: scaled speeds would violate it.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bob = system.add(planar.Particle("bob", mass=1.0, position=(1, 0)))
    >>> rod = system.add(planar.RigidLink("rod", system.ground.center, bob.center, length=1.0))
    >>> model = system.build()
    >>> keep = da.EnergyProjection()
    >>> motion = da.solve_dynamics(model, 2.0, step=0.02, integrator=da.Heun(), stabilization=keep)
    >>> bool(abs(motion["energy"]).max() < 1e-12)  # zero at the start
    True
    """

    @property
    def translates(self) -> bool:
        # speeds compensate Ψ_E, which is of the size of position errors: a jump in their history
        return True

    def correction(self, e: Equations, formulation: Formulation) -> ImplicitFunction | None:
        imposed = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        if not imposed.is_zero():
            raise UnsupportedError(
                "EnergyProjection scales all speeds, but a driver or a constraint in time "
                "prescribes some; use stabilization=Projection()"
            )
        projection = super().correction(e, formulation)
        moved = projection.outputs[0] if projection is not None else state_symbols(e)
        n, k = e.coordinate_count, e.speed_count
        y, v = moved[:n], moved[n : n + k]
        energies = ca.vertcat(e.kinetic_energy, e.potential)
        kinetic, potential = ca.vertsplit(
            ca.substitute(energies, ca.vertcat(e.y, e.v), ca.vertcat(y, v))
        )
        excess = kinetic + potential - (WORK[1] - WORK[0])
        applies = ca.fabs(excess) < APPLICABLE * kinetic
        share = ca.if_else(applies, excess / ca.if_else(applies, kinetic, 1), 0)
        outputs = [ca.vertcat(y, ca.sqrt(1 - share) * v, memory_symbols(e))]
        if projection is None:
            return ImplicitFunction("energy", [e.t, state_symbols(e), e.p], [], outputs)
        return ImplicitFunction("energy", projection.inputs, projection.stages, outputs)

    def reference_energy(self, e: Equations) -> ca.SX:
        return e.kinetic_energy + e.potential

    def warnings(self, freedom: int, exchanged: float) -> list[str]:
        warnings = []
        if freedom > 1:
            warnings.append(
                f"EnergyProjection corrects {freedom} degrees of freedom by one number: the energy "
                "will be right, the motion need not be (5.4.3); compare with a shorter step"
            )
        if exchanged > 0:
            warnings.append(
                f"EnergyProjection: up to {exchanged:.3g} J were put in or dissipated; this part "
                "of the reference energy is integrated and no better than the motion"
            )
        return warnings
