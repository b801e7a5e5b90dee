"""Verification of an optimum by feasibility and first-order optimality."""

from __future__ import annotations

import numpy as np

from dalembert.design.limit import Bounded
from dalembert.design.methods.base import OptimizerResult
from dalembert.design.optimize.optimality import OPTIMAL, Multipliers, multipliers, why_stuck
from dalembert.design.optimize.optimization_result import Iterate, OptimizationResult
from dalembert.design.optimize.problem import Evaluation
from dalembert.design.optimize.program import FEASIBLE, Point, Program


def verified_optimum(
    program: Program, outcome: OptimizerResult, interrupted: bool = False
) -> OptimizationResult:
    """Optimum, with feasibility and first-order optimality checked at its final design."""
    program.restore_scale()
    x, evaluation, note = _design(program, outcome)
    z = program.scaled(x)
    point = program.point(z, record=False)
    if point is None:  # its gradient fails: fall back to the last design with one
        x, evaluation = program.reached
        z, note = program.scaled(x), "; its gradient fails"
        point = program.point(z, record=False)
    assert point is not None
    evaluation = program.problem.evaluate(x) or evaluation
    program.record(x, evaluation)
    kkt = multipliers(program, z, point)
    failed = bool(note)
    objections = [] if interrupted else _objections(program, z, point, kkt, evaluation)
    if not (outcome.success or objections or failed or interrupted) and outcome.is_complete:
        note += "; first-order optimality holds"
    results = program.problem.results(x)
    initial_results = program.problem.results(program.origin)
    case = program.problem.quantities[0].terms[0].case
    unit = program.problem.unit(0, results)
    variables = _variables(program, x, kkt)
    limits = _limits(program, evaluation, kkt, results)
    return OptimizationResult(
        x=program.variables.parameters(x),
        fun=float(evaluation.values[0]),
        success=outcome.is_complete and not objections and not failed and not interrupted,
        message=outcome.message + note + "".join(f"; {text}" for text in objections),
        gradient=dict(
            zip(
                program.variables.names,
                map(float, program.problem.slope(evaluation, 0)),
                strict=True,
            )
        ),
        history=program.history,
        initial=initial_results[case],
        motion=results[case],
        at_bounds=[bounded.name for bounded in variables if bounded.active],
        active=[bounded.name for bounded in limits if bounded.active],
        runs=program.problem.runs,
        failed_runs=len(program.problem.failures),
        violation=program.violation(evaluation.values),
        interrupted=interrupted,
        label=program.problem.quantities[0].label,
        unit=unit,
        sense="minimize" if program.sign > 0 else "maximize",
        stationarity=kkt.stationarity,
        gradients=program.problem.gradients,
        variables=variables,
        limits=limits,
        optima=_optima(program, outcome),
        results=list(results.values()),
        quantities=program.problem.quantities,
    )


def _design(program: Program, outcome: OptimizerResult) -> tuple[np.ndarray, Evaluation, str]:
    """Final design of the optimiser, or its best iterate if that is better or the final one fails.

    Returns design, evaluation and a note for the message.
    """
    x = program.unscale(outcome.z)
    evaluation = program.problem.evaluate(x, gradient=False)
    if evaluation is None:
        why = program.problem.failures[-1]
        return *program.best, f"; the run fails at the final design: {why}"
    best_design, best_evaluation = program.best
    inside = np.all((best_design >= program.lower) & (best_design <= program.upper))
    is_better = program.is_better(best_evaluation.values, evaluation.values)
    if not outcome.success and inside and is_better:
        return best_design, best_evaluation, ""
    return x, evaluation, ""


def _objections(
    program: Program, z: np.ndarray, point: Point, kkt: Multipliers, evaluation: Evaluation
) -> list[str]:
    """Violated optimality conditions."""
    if program.violation(evaluation.values) > FEASIBLE:
        violated = violated_limits(program, evaluation.values)
        return [
            f"limits cannot all be satisfied from this start: {violated}; widen limits or bounds, "
            "or start elsewhere"
        ]
    if kkt.stationarity <= OPTIMAL:
        return _flat(program, z, point)
    text = f"not optimal: the relative residual of the gradient is {kkt.stationarity:.2g}"
    return [text + why_stuck(program, z, point, kkt.residual)]


def violated_limits(program: Program, values: np.ndarray) -> str:
    """Violated limits with their values and bounds."""
    c, texts = values[1:] / program.sizes, []
    for k, limit in enumerate(program.limits):
        for limit_value, excess, word in (
            (limit.lower, program.c_lower[k] - c[k], "below"),
            (limit.upper, c[k] - program.c_upper[k], "above"),
        ):
            if limit_value is not None and excess > FEASIBLE:
                label = program.problem.quantities[k + 1].label
                texts.append(f"{label} is {values[k + 1]:.6g}, {word} {limit_value:.6g}")
    return ", ".join(texts)


def _flat(program: Program, z: np.ndarray, point: Point) -> list[str]:
    """Objections to a start with zero gradient: the objective is constant or piecewise constant."""
    if np.any(point.g) or np.any(z) or program.variables.sizes:
        return []
    tiny, near, far = (_change_within(program, z, point.f, share) for share in (1e-6, 1e-4, 0.3))
    if not far:
        return [
            "the objective does not depend on the variables; vary parameters that it depends on"
        ]
    if near and tiny < 0.1 * near:  # stationary here, but curved
        return []
    return [
        "the objective changes in jumps that its gradient does not show; smooth it, or use "
        "method='differential-evolution'"
    ]


def _change_within(program: Program, z: np.ndarray, f: float, share: float) -> float:
    """Largest change of the objective for steps of all variables by this share of their ranges."""
    designs = [np.clip(z + step, program.z_lower, program.z_upper) for step in (share, -share)]
    values = [program.value(end) for end in designs]
    return max((abs(value[0] - f) for value in values if value is not None), default=0.0)


def _variables(program: Program, x: np.ndarray, kkt: Multipliers) -> list[Bounded]:
    variables = []
    near = 1e-6 * program.width
    for i, name in enumerate(program.variables.names):
        lower, upper = program.variables.lower[i], program.variables.upper[i]
        price = max(kkt.bound_lower[i], kkt.bound_upper[i]) * program.scale
        side = "lower" if x[i] - lower <= near[i] else "upper" if upper - x[i] <= near[i] else ""
        is_discrete = i in program.variables.sizes
        variables.append(
            Bounded(
                name,
                program.variables.units[i],
                float(program.origin[i]),
                float(x[i]),
                float(lower) if np.isfinite(lower) else None,
                float(upper) if np.isfinite(upper) else None,
                side,
                0.0 if is_discrete or not side else float(price / program.width[i]),
                program.variables.declared_units[i],
            )
        )
    return variables


def _limits(
    program: Program, evaluation: Evaluation, kkt: Multipliers, results: dict
) -> list[Bounded]:
    limits = []
    for k, limit in enumerate(program.limits):
        value, start = evaluation.values[k + 1], program.initial.values[k + 1]
        gaps = {
            side: abs(value - bound)
            for side, bound in (("lower", limit.lower), ("upper", limit.upper))
            if bound is not None and abs(value - bound) <= FEASIBLE * program.sizes[k]
        }
        side = min(gaps, key=lambda name: gaps[name]) if gaps else ""
        if len(gaps) == 2 and limit.is_equation:
            side = "lower" if kkt.lower[k] >= kkt.upper[k] else "upper"
        price = {"lower": kkt.lower[k], "upper": kkt.upper[k], "": 0.0}[side]
        limits.append(
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
    return limits


def _optima(program: Program, outcome: OptimizerResult) -> list[Iterate]:
    optima = []
    for z in outcome.optima:
        x = program.unscale(z)
        evaluation = program.problem.evaluate(x, gradient=False)
        if evaluation is not None:
            optima.append(program.iterate(x, evaluation))
    return optima
