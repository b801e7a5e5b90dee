"""Comparison of formulations, coordinates, stabilizations and integrators on one mechanism."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.analysis.comparison.combinations import (
    TOLERANCES,
    Combination,
    checked_values,
    combinations,
    usual_steps,
)
from dalembert.analysis.comparison.comparison_run import ComparisonRun
from dalembert.analysis.comparison.reference import (
    KINDS,
    Observation,
    Reference,
    find_reference,
    observe,
)
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import checked_span, output_times
from dalembert.errors import AnalysisError
from dalembert.model.graph.model import Model
from dalembert.options import options
from dalembert.results.comparison.result import Comparison, comparison_of
from dalembert.results.motion import Motion
from dalembert.text.arguments import check_arguments


@options
class Comparing:
    """Comparison as a strategy object with checked choices; parameters as in ``compare``."""

    duration: float | None = None
    formulations: Any = None
    integrators: Any = None
    stabilizations: Any = None
    coordinates: Any = None
    steps: Any = None
    tolerances: Any = TOLERANCES
    measure: Any = None
    reference: Dynamics | Motion | None = None
    repeat: int = 1
    t_span: tuple[float, float] | None = None
    outputs: int | Sequence[float] = 201

    def __post_init__(self) -> None:
        start, end = self.span
        output_times(self.outputs, start, end)
        if isinstance(self.repeat, bool) or not isinstance(self.repeat, int) or self.repeat < 1:
            raise AnalysisError(f"repeat is {self.repeat!r}; time each run at least once")
        if not (self.reference is None or isinstance(self.reference, (Dynamics, Motion))):
            raise AnalysisError(
                f"reference: expected Dynamics(...) or a motion, got {self.reference!r}"
            )
        checked_values(self.tolerances, "tolerances")
        longest = checked_values(self.steps, "steps")[0] if self.steps is not None else 0.0
        if longest > end - start:
            raise AnalysisError(f"step {longest:g} s is longer than the run of {end - start:g} s")
        self.grid((1.0,))

    @property
    def span(self) -> tuple[float, float]:
        """Start and end [s]."""
        return checked_span(self.duration, self.t_span)

    def grid(self, usual: Sequence[float]) -> list[Combination]:
        """All combinations to run; ``usual`` are the default steps."""
        return combinations(
            self.coordinates,
            self.formulations,
            self.stabilizations,
            self.integrators,
            usual if self.steps is None else checked_values(self.steps, "steps"),
            checked_values(self.tolerances, "tolerances"),
        )

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> Comparison:
        """Find the reference, then run every combination.

        Raises
        ------
        AnalysisError
            The reference run fails, or the measure is unknown.
        """
        p, observed = model.values(parameters), observe(model, self.measure)
        span = Dynamics(t_span=self.span, outputs=output_times(self.outputs, *self.span))  # type: ignore[arg-type]
        with progress_reporter(progress, f"comparing runs of {model.name}") as report:
            exact = find_reference(model, span, p, observed, self.reference)
            grid = self.grid(usual_steps(exact.step))
            runs = ComparisonRun(model, span, p, observed, exact, self.repeat)
            for k, combination in enumerate(grid):
                report((k + 2) / (len(grid) + 2))  # the reference and its check are runs too
                runs.add(combination)
                if runs.interrupted:
                    break
        about = self._about(model, observed, exact) | {"complete": int(not runs.interrupted)}
        return comparison_of(runs.rows, about)

    def _about(self, model: Model, observed: Observation, exact: Reference) -> dict[str, Any]:
        about: dict[str, Any] = {
            "model": model.name,
            "start": self.span[0],
            "end": self.span[1],
            "measure": observed.name,
            "measure_unit": observed.unit,
            "reference": exact.text,
            "kinetic_energy": exact.energy,
            "repeat": self.repeat,
        }
        for kind in KINDS:
            largest, last = exact.uncertainty.get(kind, (np.nan, np.nan))
            about |= {f"uncertainty_{kind}": largest, f"uncertainty_{kind}_final": last}
        return about


@check_arguments
def compare(
    model: Model,
    duration: float | None = None,
    *,
    formulations: Any = None,
    integrators: Any = None,
    stabilizations: Any = None,
    coordinates: Any = None,
    steps: float | Sequence[float] | None = None,
    tolerances: float | Sequence[float] = TOLERANCES,
    measure: Any = None,
    parameters: Mapping[str, float] | None = None,
    reference: Dynamics | Motion | None = None,
    repeat: int = 1,
    progress: bool | Callable[[float], None] = False,
    t_span: tuple[float, float] | None = None,
    outputs: int | Sequence[float] = 201,
) -> Comparison:
    """Run every combination of strategies and compare cost and accuracy.

    Errors are the largest difference from a reference over the outputs. The reference is checked
    by a second run with another formulation and tolerance; errors below the difference of the two
    are marked as insignificant. A combination that is not supported is listed with the reason.

    The default takes about ten seconds: RangeSpace, KKT, NullSpace and AugmentedLagrangian with
    RK4 and DormandPrince, RangeSpace in joint coordinates too, and DAE(index=3) with Radau. All
    choices that are named explicitly are combined.

    Parameters
    ----------
    model : Model
    duration : [s]; or ``t_span``, (start, end)
    formulations, integrators, stabilizations, coordinates : names or strategy objects, one or
        several
    steps : of integrators with fixed steps [s]; by default four suited to the motion
    tolerances : relative and absolute, of integrators with step size control
    measure : name, formula or expression whose error is reported; by default all coordinates
    parameters : new values of parameters, without rebuilding
    reference : ``Dynamics(...)`` or a motion that errors are measured against
    repeat : number of timed runs after the first one; the shortest time counts
    progress : True for a bar, or a function of the fraction done
    outputs : number of equally spaced times of comparison, or the times [s]
    t_span : (start, end) of the run [s]

    Returns
    -------
    Comparison with a row per combination: cost, violations, errors, outcome

    Raises
    ------
    UnsupportedError
        An unknown name.
    AnalysisError
        Invalid numbers, or a reference run that fails.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -9.81))
    >>> bob = system.add(planar.Bar("bob", length=1.0, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bob.start))
    >>> comparison = da.compare(system.build(), 1.0, formulations="RangeSpace", integrators="Heun",
    ...     steps=[0.02, 0.01], measure="bob.angle")
    >>> errors = comparison.data["error_position"].values
    >>> round(errors.max() / errors.min())  # order 2: half the step, a quarter of the error
    4
    """
    return Comparing(
        duration,
        formulations,
        integrators,
        stabilizations,
        coordinates,
        steps,
        tolerances,
        measure,
        reference,
        repeat,
        t_span,
        outputs,
    ).run(model, parameters, progress)
