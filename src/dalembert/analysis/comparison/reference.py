"""The motion that errors are measured against, and how far it can be trusted."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.analysis.comparison.combinations import label
from dalembert.analysis.comparison.observation import Observation, differences
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.errors import AnalysisError
from dalembert.formulations.kkt import Kkt
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection
from dalembert.integrators.runge_kutta.explicit import DormandPrince853
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome

LONGEST = 1 / 200
"""Steps of the reference are no longer, as a share of the run: the error control of a mechanism
that is driven throughout sees no error at all."""

TIGHT = Dynamics(
    formulation=RangeSpace(),
    stabilization=Projection(),
    integrator=DormandPrince853(rtol=1e-12, atol=1e-12),
)
CHECK = replace(TIGHT, formulation=Kkt(), integrator=DormandPrince853(rtol=5e-13, atol=5e-13))


@dataclass(frozen=True)
class Reference:
    """Values of the reference at the outputs.

    Attributes
    ----------
    values : what is compared, by kind
    uncertainty : kind → largest difference from the check, and the one at the end
    energy : largest kinetic energy [J], to which energy errors are related
    step : mean step of the check [s]
    text : the runs, for people
    """

    values: dict[str, np.ndarray]
    uncertainty: dict[str, tuple[float, float]]
    energy: float
    step: float
    text: str


def find_reference(
    model: Model,
    span: Dynamics,
    p: np.ndarray,
    observed: Observation,
    given: Dynamics | Motion | None,
) -> Reference:
    """The reference over the times of ``span``, checked by a second run.

    Raises
    ------
    AnalysisError
        A run fails, or the given motion does not cover the times.
    """
    if isinstance(given, Motion):
        exact = given.at(np.asarray(span.outputs))
        text = "the given motion"
    else:
        chosen = given or _capped(TIGHT, span)
        exact, text = _run(model, chosen, span, p), _told(chosen)
    check = _run(model, _capped(CHECK, span), span, p)
    values = observed.of(exact)
    energy = float(np.max(check.data["kinetic_energy"].values, initial=0.0))
    return Reference(
        values,
        differences(observed.of(check), values),
        energy if energy > 0 else 1.0,
        float(check.time[-1] - check.time[0]) / max(check.statistics["steps"], 1),
        f"{text}, checked by {_told(CHECK)}",
    )


def _capped(analysis: Dynamics, span: Dynamics) -> Dynamics:
    start, end = span.t_span or (0.0, 1.0)
    integrator: Any = analysis.integrator
    return replace(analysis, integrator=replace(integrator, max_step=LONGEST * (end - start)))


def _told(analysis: Dynamics) -> str:
    formulation, stabilization = label(analysis.formulation), label(analysis.stabilization)
    return f"{label(analysis.integrator, {'max_step'})} with {formulation} and {stabilization}"


def _run(model: Model, analysis: Dynamics, span: Dynamics, p: np.ndarray) -> Motion:
    there = replace(analysis, duration=None, t_span=span.t_span, outputs=span.outputs)
    motion = there.run(model, p)
    if motion.status.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not motion.status.success or motion.time.size != np.asarray(span.outputs).size:
        raise AnalysisError(
            f"the reference run, {_told(analysis)}, fails ({motion.status}); "
            "compare over a shorter time",
            motion.status.residual,
        )
    return motion
