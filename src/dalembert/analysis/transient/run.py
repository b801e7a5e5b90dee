"""Time integration of a structure: start, steps, outputs, status."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from dalembert.analysis.equilibrium.linear_range import linear_range_warnings
from dalembert.analysis.output_places import OutputPlaces, outputs_of
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    afford_states,
    run_times,
    step_count,
    uniform_grid,
)
from dalembert.analysis.transient.equation import motion_of
from dalembert.analysis.transient.march import March
from dalembert.budget import check_budget
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.integrators.marching.steps import Steps, halving_warnings
from dalembert.integrators.newmark.family import NewmarkFamily
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.analysis import ParameterValues
from dalembert.results.status import Status
from dalembert.results.structural.motion import StructuralMotion
from dalembert.timing import Timing

ROUNDS = 3
"""Cost of a step in rounds of the budget."""


def check_rule(integrator: Any) -> None:
    """Check that an integrator is a rule of Newmark's family.

    Raises
    ------
    UnsupportedError
        Another one.
    """
    if not isinstance(integrator, NewmarkFamily):
        raise UnsupportedError(
            f"integrator is {integrator!r}; structures accept Newmark(), HHT() or "
            "GeneralizedAlpha()"
        )


class TransientRun:
    """One execution of the dynamics of a structure.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model : StructuralModel
    parameters : new values, or the whole vector

    Raises
    ------
    AnalysisError
        A parameter has the name of the time.
    """

    def __init__(self, analysis: Any, model: StructuralModel, parameters: ParameterValues):
        if "t" in model.parameters:
            raise AnalysisError(
                f"{model.name}: 't' is a parameter, but the time in transient analyses; rename the "
                "parameter"
            )
        check_rule(analysis.integrator)
        self.analysis, self.model, self.p = analysis, model, model.values(parameters)

    def execute(self, progress: Any = False) -> StructuralMotion:
        """Integrate and evaluate the outputs."""
        a, timing = self.analysis, Timing()
        (start, end, step, requested), n = run_times(a), len(self.model.degrees)
        count = step_count(start, end, step)
        cure = "use a longer step or a shorter run"
        check_budget(f"{count} steps of a structure", rounds=ROUNDS * count, cure=cure)
        afford_states(count, 4 * n)
        times = uniform_grid(start, end, step)
        afford_states(times.size if requested is None else requested.size, 8 * n)
        model = self.model if a.nonlinear else self.model.linearized
        march = March(a, model, self.p, start)
        with progress_reporter(progress, f"integrating {model.name}") as report:
            status = march.run(times, report)
        timing.lap("integration")
        if requested is None and march.steps.rejected:
            requested = times
        times_of_outputs, places = outputs_of(march.steps, requested)
        statistics = {
            "displacements": march.equation.assembly.size,
            "steps": march.steps.count,
            "rejected steps": march.steps.rejected,
            "iterations": march.iterations,
            "factorisations": march.factorisations,
            "build time [s]": round(model.build_time, 6),
        }
        motion = motion_at(march, a, times_of_outputs, places, status, statistics)
        timing.lap("outputs")
        motion.statistics |= timing.statistics
        motion.warnings = halving_warnings(march.steps.rejected)
        u = motion.displacements
        if u.size and not (a.nonlinear or self.model.linear):
            k = int(np.argmax(np.abs(u).max(axis=0)))
            name = f"at t = {motion.time[k]:.6g} s"
            motion.warnings += linear_range_warnings(self.model, self.p, [name], u[:, k : k + 1])
        return motion


def motion_at(
    march: March,
    analysis: Any,
    times: np.ndarray,
    places: OutputPlaces,
    status: Status,
    statistics: dict[str, Any],
) -> StructuralMotion:
    """The motion at output times."""
    e, states = march.equation, march.states(places)
    forces = [e.external_forces(motion_of(x), float(t)) for x, t in zip(states, times, strict=True)]
    u, v, a = (
        np.stack(column, axis=1) for column in zip(*(motion_of(x) for x in states), strict=True)
    )
    return StructuralMotion(
        model=e.model,
        analysis=analysis,
        parameters=e.p,
        time=times,
        displacements=u,
        velocities=v,
        accelerations=a,
        forces=np.stack(forces, axis=1),
        mass=e.mass,
        status=status,
        statistics=statistics,
        record=TransientRecord(march, march.steps, places),
    )


@dataclass(frozen=True)
class TransientRecord:
    """Data of a run for gradients.

    Attributes
    ----------
    march : equations, steps and states
    steps : accepted steps
    places : places of the outputs among the steps
    """

    march: March
    steps: Steps
    places: OutputPlaces
    adaptive: ClassVar[bool] = False

    def sampled(
        self, motion: StructuralMotion, times: np.ndarray, places: OutputPlaces
    ) -> StructuralMotion:
        """The motion of the run at other outputs."""
        return motion_at(
            self.march, motion.analysis, times, places, motion.status, motion.statistics
        )

    def repeated(self, motion: StructuralMotion, p: np.ndarray) -> StructuralMotion:
        """The motion with the same steps and outputs at other parameter values."""
        return TransientRun(motion.analysis, motion.model, p).execute().at(motion.time)
