"""Published problems of design, as formulas of parameters of the smallest model there is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import dalembert as da


def parametric(variables: Mapping[str, tuple[float, float, float]], name: str = "formulas"):
    """A bar at rest with these parameters: start, lower and upper bound."""
    structure = da.Structure(name)
    for symbol, (start, lower, upper) in variables.items():
        structure.parameter(symbol, start, bounds=(lower, upper))
    nodes = [structure.node("left_end", 0, 0), structure.node("right_end", 1, 0)]
    structure.add(da.structures.Truss("only_bar", *nodes, area=1.0, modulus=1.0))
    structure.support(nodes[0])
    structure.support(nodes[1], uy=0.0)
    return structure.build()


def solve(
    variables: Mapping[str, tuple[float, float, float]],
    objective: str,
    limits: Sequence[tuple[str, float | None, float | None]] = (),
    **options: Any,
) -> da.OptimizationResult:
    """The optimum of a formula within limits on others, through ``da.optimize``."""
    bounded = [
        da.Limit(da.final(formula, name=f"g{k}"), lower=lower, upper=upper)
        for k, (formula, lower, upper) in enumerate(limits, 1)
    ]
    return da.optimize(
        parametric(variables),
        da.final(objective, name="objective"),
        subject_to=bounded,
        vary=options.pop("vary", list(variables)),
        analysis=da.Statics(),
        **({"tolerance": 1e-12, "max_iterations": 300} | options),
    )
