"""Scatter about a design: random parameters that are varied too, and runs at their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.case import Case
from dalembert.design.quantity import Combined, Constant, Quantity
from dalembert.design.reliability.distribution import Distribution
from dalembert.errors import ModelError
from dalembert.responses.values import Final
from dalembert.text.wording import unknown


@dataclass(frozen=True)
class Moved(Distribution):
    """``x + by``: the same scatter elsewhere."""

    of: Distribution
    by: float

    def from_normal(self, u: Any) -> Any:
        return self.of.from_normal(u) + self.by

    def to_normal(self, x: Any) -> Any:
        return self.of.to_normal(np.asarray(x) - self.by)

    def slope(self, u: Any) -> Any:
        return self.of.slope(u)


def about(random: Mapping[str, Distribution], design: Mapping[str, float]) -> dict[str, Any]:
    """The distributions with their means at a design, of those parameters that it has."""
    return {
        name: Moved(one, design[name] - one.moments[0]) if name in design else one
        for name, one in random.items()
    }


def case_at(
    base: Case, random: Mapping[str, Distribution], x: np.ndarray, varied: Sequence[str]
) -> Case:
    """The run at values of the random parameters, which move along with those that vary."""
    given: dict[str, Quantity] = {}
    for (name, one), value in zip(random.items(), x, strict=True):
        if name not in base.model.parameters:
            raise ModelError(unknown("random parameter", name, base.model.parameters))
        if name in varied:
            away = float(value - one.moments[0])
            design = base[Final(name, name=f"design of {name}")]
            given[name] = Combined(f"design + ({away!r})", {"design": design}, name)
        else:
            given[name] = Constant(float(value))
    return Case(base.model, base.analysis, given)
