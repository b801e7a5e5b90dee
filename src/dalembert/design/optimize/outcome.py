"""An optimum put together and judged by its own gradients."""

from __future__ import annotations

import numpy as np

from dalembert.design.bounded import Bounded
from dalembert.design.methods.base import Ended
from dalembert.design.optimize.optimality import OPTIMAL, Multipliers, multipliers, why_stuck
from dalembert.design.optimize.optimum import Iterate, Optimum
from dalembert.design.optimize.problem import Evaluation
from dalembert.design.optimize.program import FEASIBLE, Point, Program


def judged(program: Program, ended: Ended, interrupted: bool = False) -> Optimum:
    """The result: limits and first-order optimality are checked, whatever the optimiser says."""
    program.measure_by_start()
    x, found, note = _design(program, ended)
    z = program.scaled(x)
    point = program.point(z, record=False)
    if point is None:  # its gradient fails: that of the last design that had one
        x, found = program.reached
        z, note = program.scaled(x), "; its gradient fails"
        point = program.point(z, record=False)
    assert point is not None
    found = program.problem.evaluate(x) or found
    program.record(x, found)
    factors = multipliers(program, z, point)
    failed = bool(note)
    doubts = [] if interrupted else _doubts(program, z, point, factors, found)
    if not (ended.success or doubts or failed or interrupted) and ended.is_whole:
        note += "; first-order optimality holds"
    results = program.problem.results(x)
    first = program.problem.results(program.origin)
    case = program.problem.quantities[0].terms[0].case
    unit = program.problem.unit(0, results)
    variables = _variables(program, x, factors)
    limits = _limits(program, found, factors, results)
    return Optimum(
        x=program.variables.parameters(x),
        fun=float(found.values[0]),
        success=ended.is_whole and not doubts and not failed and not interrupted,
        message=ended.message + note + "".join(f"; {text}" for text in doubts),
        gradient=dict(
            zip(program.variables.names, map(float, program.problem.slope(found, 0)), strict=True)
        ),
        history=program.history,
        initial=first[case],
        motion=results[case],
        at_bounds=[one.name for one in variables if one.active],
        active=[one.name for one in limits if one.active],
        runs=program.problem.runs,
        failed_runs=len(program.problem.failures),
        violation=program.violation(found.values),
        interrupted=interrupted,
        label=program.problem.quantities[0].label,
        unit=unit,
        sense="minimize" if program.sign > 0 else "maximize",
        stationarity=factors.stationarity,
        gradients=program.problem.gradients,
        variables=variables,
        limits=limits,
        optima=_optima(program, ended),
        results=list(results.values()),
    )


def _design(program: Program, ended: Ended) -> tuple[np.ndarray, Evaluation, str]:
    """Where the optimiser ended, or the best on its way where that is better or the end fails."""
    x = program.unscale(ended.z)
    found = program.problem.evaluate(x, gradient=False)
    if found is None:
        why = program.problem.failures[-1]
        return *program.best, f"; it ended at a design that fails: {why}"
    best, known = program.best
    inside = np.all((best >= program.lower) & (best <= program.upper))
    if not ended.success and inside and program.is_better(known.values, found.values):
        return best, known, ""
    return x, found, ""


def _doubts(
    program: Program, z: np.ndarray, point: Point, factors: Multipliers, found: Evaluation
) -> list[str]:
    """What speaks against an optimum."""
    if program.violation(found.values) > FEASIBLE:
        return [
            f"limits cannot all be kept from here: {told_broken(program, found.values)}; "
            "widen limits or bounds, or start elsewhere"
        ]
    if factors.stationarity <= OPTIMAL:
        return _flat(program, z, point)
    text = f"no optimum: the gradient is left with {factors.stationarity:.2g} of its size"
    return [text + why_stuck(program, z, point, factors.residual)]


def told_broken(program: Program, values: np.ndarray) -> str:
    """The limits that are broken, what they are and what they should be."""
    c, told = values[1:] / program.sizes, []
    for k, limit in enumerate(program.limits):
        for bound, by, word in (
            (limit.lower, program.c_lower[k] - c[k], "below"),
            (limit.upper, c[k] - program.c_upper[k], "above"),
        ):
            if bound is not None and by > FEASIBLE:
                label = program.problem.quantities[k + 1].label
                told.append(f"{label} is {values[k + 1]:.6g}, {word} {bound:.6g}")
    return ", ".join(told)


def _flat(program: Program, z: np.ndarray, point: Point) -> list[str]:
    """What holds a search at its start where there is no gradient at all: nothing, or jumps."""
    if np.any(point.g) or np.any(z) or program.variables.sizes:
        return []
    tiny, near, far = (_change_within(program, z, point.f, share) for share in (1e-6, 1e-4, 0.3))
    if not far:
        return ["the objective does not change with what varies; vary what it depends on"]
    if near and tiny < 0.1 * near:  # it is flat here, but bends
        return []
    return [
        "the objective changes in jumps, of which its gradient knows nothing; smooth it, or take "
        "method='differential-evolution'"
    ]


def _change_within(program: Program, z: np.ndarray, f: float, share: float) -> float:
    """Of the objective, by steps of all variables at once, this share of their ranges."""
    ends = [np.clip(z + step, program.z_lower, program.z_upper) for step in (share, -share)]
    found = [program.value(end) for end in ends]
    return max((abs(one[0] - f) for one in found if one is not None), default=0.0)


def _variables(program: Program, x: np.ndarray, factors: Multipliers) -> list[Bounded]:
    made = []
    near = 1e-6 * program.width
    for i, name in enumerate(program.variables.names):
        lower, upper = program.variables.lower[i], program.variables.upper[i]
        price = max(factors.bound_lower[i], factors.bound_upper[i]) * program.scale
        side = "lower" if x[i] - lower <= near[i] else "upper" if upper - x[i] <= near[i] else ""
        held = i in program.variables.sizes
        made.append(
            Bounded(
                name,
                program.variables.units[i],
                float(program.origin[i]),
                float(x[i]),
                float(lower) if np.isfinite(lower) else None,
                float(upper) if np.isfinite(upper) else None,
                side,
                0.0 if held or not side else float(price / program.width[i]),
                program.variables.given_units[i],
            )
        )
    return made


def _limits(
    program: Program, found: Evaluation, factors: Multipliers, results: dict
) -> list[Bounded]:
    made = []
    for k, limit in enumerate(program.limits):
        value, start = found.values[k + 1], program.first.values[k + 1]
        gaps = {
            side: abs(value - bound)
            for side, bound in (("lower", limit.lower), ("upper", limit.upper))
            if bound is not None and abs(value - bound) <= FEASIBLE * program.sizes[k]
        }
        side = min(gaps, key=lambda name: gaps[name]) if gaps else ""
        if len(gaps) == 2 and limit.is_equation:
            side = "lower" if factors.lower[k] >= factors.upper[k] else "upper"
        price = {"lower": factors.lower[k], "upper": factors.upper[k], "": 0.0}[side]
        made.append(
            Bounded(
                program.problem.quantities[k + 1].label,
                program.problem.unit(k + 1, results),
                float(start),
                float(value),
                limit.lower,
                limit.upper,
                side,
                float(price * program.scale / program.sizes[k]),
            )
        )
    return made


def _optima(program: Program, ended: Ended) -> list[Iterate]:
    made = []
    for z in ended.optima:
        x = program.unscale(z)
        found = program.problem.evaluate(x, gradient=False)
        if found is not None:
            made.append(program.iterate(x, found))
    return made
