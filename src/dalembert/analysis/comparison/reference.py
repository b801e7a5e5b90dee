"""Reference motion of a comparison, the quantities compared, and the uncertainty."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.comparison.combinations import label
from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.elements.coordinates import rate_of
from dalembert.elements.pair import Pair
from dalembert.errors import AnalysisError, ExpressionError
from dalembert.formulations.kkt import KKT
from dalembert.formulations.range_space import RangeSpace
from dalembert.formulations.stabilization import Projection
from dalembert.integrators.runge_kutta.explicit import DormandPrince853
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome
from dalembert.symbolic.formulas.expression import Expression, t

KINDS = ("position", "velocity", "reaction")
LONGEST = 1 / 200
"""Upper limit of the steps of the reference, as a share of the run; the error estimate of a fully
driven mechanism is zero."""

TIGHT = Dynamics(
    formulation=RangeSpace(),
    stabilization=Projection(),
    integrator=DormandPrince853(rtol=1e-12, atol=1e-12),
)
CHECK = replace(TIGHT, formulation=KKT(), integrator=DormandPrince853(rtol=5e-13, atol=5e-13))


@dataclass(frozen=True)
class Observation:
    """Expressions of the bodies' states that are compared between runs.

    Attributes
    ----------
    name, unit : of the measure
    expressions : kind of ``KINDS`` → compared quantity; kinds that do not apply are missing
    """

    name: str
    unit: str
    expressions: Mapping[str, Expression]

    def of(self, motion: Motion) -> dict[str, np.ndarray]:
        """(K, size) values at the outputs, by kind."""
        return {
            kind: motion.values(expression).reshape(motion.time.size, -1)
            for kind, expression in self.expressions.items()
        }


def observe(model: Model, measure: Any = None) -> Observation:
    """Compared quantities: a measure (name, formula or expression), or all coordinates.

    Raises
    ------
    AnalysisError
        The measure is unknown.
    """
    e = model.all_equations
    if measure is None:
        expressions = {"position": Expression(e.y), "velocity": Expression(e.v)}
        name, unit = "all coordinates", "m or rad"
    else:
        try:
            expression = model.expression(measure)
        except ExpressionError as error:
            raise AnalysisError(f"measure: {error}") from None
        expressions = {"position": expression}
        name, unit = expression.name or "measure", expression.unit
        if not ca.depends_on(expression.sx, ca.vertcat(e.v, e.a, e.multiplier)):
            expressions["velocity"] = Expression(rate_of(expression.sx, model.coordinates, t.sx))
    forces = [c.reaction()[0] for c in model.constraints if isinstance(c, Pair)]
    if forces and not model.diagnosis.redundancies:
        expressions["reaction"] = Expression(ca.vertcat(*forces))
    return Observation(name, unit, expressions)


def differences(
    values: Mapping[str, np.ndarray], exact: Mapping[str, np.ndarray]
) -> dict[str, tuple[float, float]]:
    """Largest difference over the outputs, and at the last one, by kind."""
    errors = {}
    for kind, expected in exact.items():
        size = np.max(abs(values[kind] - expected), axis=1, initial=0.0)
        errors[kind] = (float(size.max()), float(size[-1]))
    return errors


@dataclass(frozen=True)
class Reference:
    """Values of the reference at the outputs.

    Attributes
    ----------
    values : compared quantities by kind
    uncertainty : kind → largest difference from the check, and the difference at the end
    energy : largest kinetic energy [J], the scale of energy errors
    step : mean step of the check [s]
    text : description of the runs
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
    reference: Dynamics | Motion | None,
) -> Reference:
    """The reference over the times of ``span``, checked by a second run.

    Raises
    ------
    AnalysisError
        A run fails, or the motion passed as reference does not cover the times.
    """
    if isinstance(reference, Motion):
        exact = reference.at(np.asarray(span.outputs))
        text = "the given motion"
    else:
        analysis = reference or _capped(TIGHT, span)
        exact, text = _run(model, analysis, span, p), _describe(analysis)
    check = _run(model, _capped(CHECK, span), span, p)
    values = observed.of(exact)
    energy = float(np.max(check.data["kinetic_energy"].values, initial=0.0))
    return Reference(
        values,
        differences(observed.of(check), values),
        energy if energy > 0 else 1.0,
        float(check.time[-1] - check.time[0]) / max(check.statistics["steps"], 1),
        f"{text}, checked by {_describe(CHECK)}",
    )


def _capped(analysis: Dynamics, span: Dynamics) -> Dynamics:
    start, end = span.t_span or (0.0, 1.0)
    integrator: Any = analysis.integrator
    return replace(analysis, integrator=replace(integrator, max_step=LONGEST * (end - start)))


def _describe(analysis: Dynamics) -> str:
    formulation, stabilization = label(analysis.formulation), label(analysis.stabilization)
    return f"{label(analysis.integrator, {'max_step'})} with {formulation} and {stabilization}"


def _run(model: Model, analysis: Dynamics, span: Dynamics, p: np.ndarray) -> Motion:
    analysis_at_outputs = replace(analysis, duration=None, t_span=span.t_span, outputs=span.outputs)
    motion = analysis_at_outputs.run(model, p)
    if motion.status.outcome is Outcome.INTERRUPTED:
        raise KeyboardInterrupt
    if not motion.status.success or motion.time.size != np.asarray(span.outputs).size:
        raise AnalysisError(
            f"the reference run, {_describe(analysis)}, fails ({motion.status}); "
            "compare over a shorter time",
            motion.status.residual,
        )
    return motion
