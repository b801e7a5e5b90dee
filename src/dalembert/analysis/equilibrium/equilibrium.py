"""Static equilibrium: balance of applied forces and reactions.

``f(y, 0) − d(y, 0) − Cᵀ λ = 0``, ``Φ(y) = 0``. On the tangent space of the constraints this is
``r = Zᵀ f = 0``. Newton's method uses a positive definite modification of the tangent stiffness
``Zᵀ K Z``, so that it descends towards a stable position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.equilibrium_batch import EquilibriumBatch
from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.contact.gap_checks import ignored_contacts
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.equilibrium.static_balance import (
    StaticBalance,
    StaticsKernel,
    rest_text,
    statics_kernel,
)
from dalembert.analysis.keywords import EquilibriumKeywords, NonlinearStaticsKeywords
from dalembert.analysis.requirements import need_model
from dalembert.analysis.residual_check import MOTION, ResidualCheck
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.formulations.base import Level
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.batch.batch import Batch
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.result import Analysis
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.equations.newton import NewtonSettings, Solution, solve
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns

TOLERANCE = 1e-10
"""Default tolerance of the residual, relative to the largest applied force."""


@dataclass(frozen=True)
class EquilibriumRecord:
    """Record of an equilibrium for gradients."""

    kernel: StaticsKernel


@options
class Equilibrium(Analysis[Model, Motion]):
    """Static equilibrium as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are evaluated [s]
    tolerance : tolerance of the residual, relative to the largest applied force
    max_iterations : upper limit of Newton iterations

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> weight = system.parameter("weight", 2.0, unit="kg", bounds=(1, 5))
    >>> pan = system.add(planar.Particle("pan", mass=weight, position=(0, -0.1)))
    >>> spring = planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0)
    >>> hung = system.add(spring)
    >>> analysis = da.Equilibrium()  # an analysis that can be repeated and optimised
    >>> model = system.build()
    >>> [round(analysis.run(model, {"weight": m})["pan.y"].item(), 6) for m in (2, 4)]  # -m g/k
    [-0.2, -0.4]
    """

    spoken = "static equilibrium"
    at_rest = True
    batched = EquilibriumBatch

    time: float = 0.0
    tolerance: float = TOLERANCE
    max_iterations: int = 200

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: Any = False,
        start: np.ndarray | None = None,
    ) -> Motion:
        """Compute the equilibrium near the assembled position, or near the pose ``start``.

        The result is a motion with one instant; ``statistics`` contains its stability.

        Raises
        ------
        AssemblyError
            The mechanism cannot be assembled.
        """
        p = model.values(parameters)
        return _Search(self, model, p).execute(start)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The equilibrium at other parameter values, starting from this one."""
        return self.run(motion.model, p, start=motion.trajectory.y[:, 0])

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The same, at the instant of the equilibrium.

        Raises
        ------
        AnalysisError
            Any other time.
        """
        if np.any(times != self.time):
            raise AnalysisError(
                f"an equilibrium has one instant, t = {self.time:g} s, and t = {times[0]:g} s was "
                "requested; use the final value"
            )
        return motion


class _Search:
    """Search for an equilibrium from the assembled position."""

    def __init__(self, analysis: Equilibrium, model: Model, p: np.ndarray):
        self.analysis, self.model, self.p = analysis, model, p
        self.kernel = statics_kernel(model)

    def execute(self, start: np.ndarray | None = None) -> Motion:
        balance = StaticBalance(self.kernel, self.analysis.time, self.p)
        y = self.model.assemble(self.p, self.analysis.time).y
        if start is not None:
            moved = balance.onto_constraints(start)
            y = y if moved is None else moved
        settings = NewtonSettings(
            tolerance=self.analysis.tolerance,
            max_iterations=self.analysis.max_iterations,
            slack=1.0,
        )
        return self.result(balance, solve(balance, y, settings))

    def result(self, balance: StaticBalance, solution: Solution[np.ndarray]) -> Motion:
        n, forces = self.model.equations.speed_count, balance.residual(solution.x)
        residual = float(np.abs(forces.value).max(initial=0.0)) / self.model.scales.length
        stable = bool(np.all(forces.resistance > 0)) if forces.conservative else forces.stable
        text = rest_text(residual, solution.iterations, stable, forces.conservative)
        outcome = Outcome.COMPLETED if solution.accepted else Outcome.NOT_CONVERGED
        status = Status(outcome, text, self.analysis.time, solution.residual)
        column = (-1, 1)
        trajectory = Trajectory(
            np.array([self.analysis.time]),
            solution.x.reshape(column),
            np.zeros((n, 1)),
            np.zeros((n, 1)),
            self.model.all_multipliers(forces.multiplier.reshape(column)),
            np.zeros((2, 1)),
        )
        tolerance = max(MOTION, self.analysis.tolerance)
        check = ResidualCheck(self.model, trajectory, self.p, [Level.POSITION], tolerance)
        return Motion(
            self.model,
            self.analysis,
            self.p,
            trajectory,
            check.verify(status),
            {"iterations": solution.iterations, "stable": stable, "residual [N or N m]": residual},
            warnings=[
                *ignored_contacts(self.model, trajectory, self.p),
                *elastic_warnings(self.model, trajectory, self.p),
            ],
            record=EquilibriumRecord(self.kernel),
        )


@overload
def solve_equilibrium(
    model: Model,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> Motion: ...


@overload
def solve_equilibrium(
    model: StructuralModel,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[NonlinearStaticsKeywords],
) -> StructuralResult: ...


@overload
def solve_equilibrium(
    model: Model,
    *,
    parameters: ManyDesigns,
    workers: int | None = None,
    **options: Unpack[EquilibriumKeywords],
) -> Batch: ...


@overload
def solve_equilibrium(
    model: StructuralModel,
    *,
    parameters: ManyDesigns,
    workers: int | None = None,
    **options: Unpack[NonlinearStaticsKeywords],
) -> Batch: ...


@check_arguments
def solve_equilibrium(
    model: Model | StructuralModel,
    *,
    parameters: Any = None,
    workers: int | None = None,
    **options: Any,
) -> Motion | StructuralResult | Batch:
    """Static equilibrium near the assembled position, ``f − d − Cᵀλ = 0`` at rest.

    A structure is solved as by ``solve_statics(nonlinear=True)``, with displacements of any size.

    Parameters
    ----------
    model : Model or StructuralModel
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    workers : number of workers of a batch, by default one for each core
    **options : fields of ``Equilibrium``: time, tolerance, max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError`` where the mechanism cannot be assembled. A search that
        does not converge reports it in its status.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("lamp in the wind", gravity=(0, -10))
    >>> lamp = system.add(planar.Particle("lamp", mass=2.0, position=(0.1, -1)))
    >>> cord = system.add(planar.RigidLink("cord", system.ground.center, lamp.center, length=1.0))
    >>> wind = system.add(planar.Force("wind", lamp.center, (15.0, 0)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> rest["lamp.position"][0].values.round(6)  # along (F, -m g), a 3-4-5 triangle
    array([ 0.6, -0.8])
    """
    if isinstance(model, StructuralModel):
        analysis: Any = analysis_of(
            NonlinearStatics, "solve_equilibrium", model, parameters, **options
        )
    else:
        analysis = analysis_of(Equilibrium, "solve_equilibrium", model, parameters, **options)
    need_model(model, "solve_equilibrium")
    return run_analysis(analysis, model, parameters, workers=workers)  # type: ignore[no-any-return]
