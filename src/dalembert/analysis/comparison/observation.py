"""What two runs are compared by: a measure, its rate and the forces in the joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.coordinates import rate_of
from dalembert.elements.pair import Pair
from dalembert.errors import AnalysisError, ExpressionError
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import Expression, t

KINDS = ("position", "velocity", "reaction")


@dataclass(frozen=True)
class Observation:
    """Expressions of the bodies' states that runs are compared by.

    Attributes
    ----------
    name, unit : of the measure
    expressions : kind of ``KINDS`` → what is compared; a kind that has no meaning is missing
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
    """What is compared: a measure (name, formula or expression), or all coordinates.

    Raises
    ------
    AnalysisError
        There is no such measure.
    """
    e = model.all_equations
    if measure is None:
        found = {"position": Expression(e.y), "velocity": Expression(e.v)}
        name, unit = "all coordinates", "m or rad"
    else:
        try:
            chosen = model.expression(measure)
        except ExpressionError as error:
            raise AnalysisError(f"measure: {error}") from None
        found, name, unit = {"position": chosen}, chosen.name or "measure", chosen.unit
        if not ca.depends_on(chosen.sx, ca.vertcat(e.v, e.a, e.multiplier)):
            found["velocity"] = Expression(rate_of(chosen.sx, model.coordinates, t.sx))
    forces = [c.reaction()[0] for c in model.constraints if isinstance(c, Pair)]
    if forces and not model.diagnosis.redundancies:
        found["reaction"] = Expression(ca.vertcat(*forces))
    return Observation(name, unit, found)


def differences(
    found: Mapping[str, np.ndarray], exact: Mapping[str, np.ndarray]
) -> dict[str, tuple[float, float]]:
    """Largest difference over the outputs, and at the last one, by kind."""
    made = {}
    for kind, values in exact.items():
        size = np.max(abs(found[kind] - values), axis=1, initial=0.0)
        made[kind] = (float(size.max()), float(size[-1]))
    return made
