"""Scatter about a design: random parameters that are also design variables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.design.case import Case
from dalembert.design.quantity import Combined, Constant, Quantity
from dalembert.design.reliability.distribution import Distribution, Values
from dalembert.errors import ModelError
from dalembert.responses.values import Final
from dalembert.text.wording import unknown


@dataclass(frozen=True)
class Shifted(Distribution):
    """Shifted distribution ``x + by``."""

    of: Distribution
    by: float

    def from_normal(self, u: Values) -> Values:
        return self.of.from_normal(u) + self.by

    def to_normal(self, x: Values) -> Values:
        return self.of.to_normal(np.asarray(x) - self.by)

    def slope(self, u: Values) -> Values:
        return self.of.slope(u)


def centred_at(
    random: Mapping[str, Distribution], design: Mapping[str, float]
) -> dict[str, Distribution]:
    """The distributions, with the means of design variables at the design."""
    return {
        name: Shifted(distribution, design[name] - distribution.moments[0])
        if name in design
        else distribution
        for name, distribution in random.items()
    }


def case_at(
    base: Case, random: Mapping[str, Distribution], x: np.ndarray, varied: Sequence[str]
) -> Case:
    """The case at values of the random parameters, relative to the design for design variables."""
    values: dict[str, Quantity] = {}
    for (name, distribution), value in zip(random.items(), x, strict=True):
        if name not in base.model.parameters:
            raise ModelError(unknown("random parameter", name, base.model.parameters))
        if name in varied:
            offset = float(value - distribution.moments[0])
            design = base[Final(name, name=f"design of {name}")]
            values[name] = Combined(f"design + ({offset!r})", {"design": design}, name)
        else:
            values[name] = Constant(float(value))
    return Case(base.model, base.analysis, values)
