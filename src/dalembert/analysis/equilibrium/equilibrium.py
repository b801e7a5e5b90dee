"""Static equilibrium: positions at which applied forces and reactions balance.

``f(y, 0) − d(y, 0) − Cᵀ λ = 0``, ``Φ(y) = 0``. On the tangent space of the constraints this is
``r = Zᵀ f = 0``; Newton's method uses the tangent stiffness ``Zᵀ K Z`` made positive definite,
so that it descends towards a stable position.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.rests import Rests
from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.contact.unseen import unseen_contacts
from dalembert.analysis.elastic_range import elastic_doubts
from dalembert.analysis.equilibrium.static_balance import (
    StaticBalance,
    StaticsKernel,
    rest_text,
    statics_kernel,
)
from dalembert.analysis.keywords import EquilibriumKeywords, NonlinearStaticsKeywords
from dalembert.analysis.model_truth import MOTION, ModelTruth
from dalembert.analysis.served import need_model
from dalembert.analysis.structural.nonlinear_statics import NonlinearStatics
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.formulations.base import Level
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.batch.batch import Batch
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.result import Analysis
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.equations.newton import NewtonSettings, Solution, solve
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns

TOLERANCE = 1e-10


@dataclass(frozen=True)
class EquilibriumRecord:
    """What a gradient needs."""

    kernel: StaticsKernel


@options
class Equilibrium(Analysis[Model, Motion]):
    """Static equilibrium as a strategy object.

    Parameters
    ----------
    time : instant at which laws and forces are taken [s]
    tolerance : of the residual relative to the largest applied force
    max_iterations : of Newton's method

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("scale", gravity=(0, -10))
    >>> weight = system.parameter("weight", 2.0, unit="kg", bounds=(1, 5))
    >>> pan = system.add(planar.Particle("pan", mass=weight, position=(0, -0.1)))
    >>> spring = planar.Spring("spring", system.ground.center, pan.center, stiffness=100.0)
    >>> hung = system.add(spring)
    >>> analysis = da.Equilibrium()  # an analysis that can be repeated, and designed for
    >>> model = system.build()
    >>> [round(analysis.run(model, {"weight": m})["pan.y"].item(), 6) for m in (2, 4)]  # -m g/k
    [-0.2, -0.4]
    """

    spoken = "static equilibrium"
    at_rest = True
    batched = Rests

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
        """Find the equilibrium nearest to the assembled position, or to the pose ``start``.

        The result is a motion of one instant; ``statistics`` tells whether it is stable.

        Raises
        ------
        AssemblyError
            The mechanism cannot be assembled.
        """
        p = model.values(parameters)
        return _Search(self, model, p).execute(start)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The equilibrium at other parameter values, reached from this one."""
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
                "asked for; take the final value"
            )
        return motion


class _Search:
    """From the assembled position to the equilibrium."""

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

    def result(self, balance: StaticBalance, found: Solution[np.ndarray]) -> Motion:
        n, here = self.model.equations.speed_count, balance.residual(found.x)
        residual = float(np.abs(here.value).max(initial=0.0)) / self.model.scales.length
        stable = bool(np.all(here.resistance > 0)) if here.conservative else here.stable
        text = rest_text(residual, found.iterations, stable, here.conservative)
        outcome = Outcome.COMPLETED if found.accepted else Outcome.NOT_CONVERGED
        status = Status(outcome, text, self.analysis.time, found.residual)
        column = (-1, 1)
        trajectory = Trajectory(
            np.array([self.analysis.time]),
            found.x.reshape(column),
            np.zeros((n, 1)),
            np.zeros((n, 1)),
            self.model.all_multipliers(here.multiplier.reshape(column)),
            np.zeros((2, 1)),
        )
        may_be_open = max(MOTION, self.analysis.tolerance)
        truth = ModelTruth(self.model, trajectory, self.p, [Level.POSITION], may_be_open)
        return Motion(
            self.model,
            self.analysis,
            self.p,
            trajectory,
            truth.judged(status),
            {"iterations": found.iterations, "stable": stable, "residual [N or N m]": residual},
            warnings=[
                *unseen_contacts(self.model, trajectory, self.p),
                *elastic_doubts(self.model, trajectory, self.p),
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


@spelled
def solve_equilibrium(
    model: Model | StructuralModel,
    *,
    parameters: Any = None,
    workers: int | None = None,
    **options: Any,
) -> Motion | StructuralResult | Batch:
    """Static equilibrium near the assembled position, ``f − d − Cᵀλ = 0`` at rest.

    That of a structure is ``solve_statics(nonlinear=True)``, at displacements of any size.

    Parameters
    ----------
    model : Model or StructuralModel
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    workers : of a batch; by default one for each core
    **options : fields of ``Equilibrium``: time, tolerance, max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``AssemblyError`` where the mechanism cannot be put together. A search that
        does not converge says so in its status.

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
        made: Any = analysis_of(NonlinearStatics, "solve_equilibrium", model, parameters, **options)
    else:
        made = analysis_of(Equilibrium, "solve_equilibrium", model, parameters, **options)
    need_model(model, "solve_equilibrium")
    return run_analysis(made, model, parameters, workers=workers)  # type: ignore[no-any-return]
