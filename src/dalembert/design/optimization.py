"""Optimisation: ``min f, g ≤ 0, bounds`` (8.41) with exact gradients, by SLSQP."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.design.optimum import Iterate, Limit, Optimum
from dalembert.design.problem import DesignProblem, Evaluation
from dalembert.errors import AnalysisError, ModelError
from dalembert.responses.base import Response, as_responses
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel


def optimize(
    model: ParametricModel,
    minimize: Response | None = None,
    *,
    maximize: Response | None = None,
    subject_to: Sequence[Limit] = (),
    vary: Sequence[str] | None = None,
    analysis: Analysis,
    start: Mapping[str, float] | None = None,
    method: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    progress: bool | Callable[[int, float], None] = False,
) -> Optimum:
    """Best parameters for a response of an analysis.

    Parameters
    ----------
    model : Model
    minimize, maximize : the objective, one of them
    subject_to : limits on other responses
    vary : names of the parameters to vary; default all with a bound; bounds are respected
    analysis : ``Dynamics(...)``, ``Kinematics(...)`` or ``InverseDynamics(...)``
    start : initial values; default the nominal ones
    method : of ``sensitivity``
    tolerance : on the relative change of the scaled objective
    progress : True prints each iteration, or a function of its number and objective

    Raises
    ------
    AnalysisError
        The run fails at the starting design, or a name is unknown.
    """
    if (minimize is None) == (maximize is None):
        raise AnalysisError("give one objective: minimize=... or maximize=...")
    return _Slsqp(model, minimize, maximize, list(subject_to), vary, analysis, start, method).solve(
        max_iterations, tolerance, progress
    )


class _Slsqp:
    """SLSQP on variables scaled to their bounds and an objective scaled to its start."""

    def __init__(
        self,
        model: ParametricModel,
        minimize: Response | None,
        maximize: Response | None,
        limits: Sequence[Limit],
        vary: Sequence[str] | None,
        analysis: Analysis,
        start: Mapping[str, float] | None,
        method: Method,
    ):
        self.model, self.limits = model, limits
        self.sign = 1.0 if minimize is not None else -1.0
        self.last = 0.0
        self.names = self._names(vary)
        objective = minimize if minimize is not None else maximize
        assert objective is not None
        unique = {id(r): r for r in (objective, *(limit.response for limit in limits))}
        self.responses = as_responses(list(unique.values()))
        self.rows = [list(unique).index(id(limit.response)) for limit in limits]
        self.problem = DesignProblem(model, analysis, self.responses, self.names, method)
        bounds = np.array([model.parameters[n].bounds for n in self.names])
        self.lower, self.upper = bounds[:, 0], bounds[:, 1]
        nominal = model.nominal[[list(model.parameters).index(n) for n in self.names]]
        given = dict(start or {})
        model.values(given)
        self.x0 = np.array([given.get(n, v) for n, v in zip(self.names, nominal, strict=True)])
        self.x0 = np.clip(self.x0, self.lower, self.upper)
        width = self.upper - self.lower
        self.width = np.where(
            np.isfinite(width) & (width > 0), width, np.maximum(abs(self.x0), 1.0)
        )

    def _names(self, vary: Sequence[str] | None) -> list[str]:
        parameters = self.model.parameters
        if vary is None:
            vary = [n for n, p in parameters.items() if np.all(np.isfinite(p.bounds))]
        for name in vary:
            if name not in parameters:
                known = ", ".join(parameters) or "none"
                raise ModelError(f"unknown parameter {name!r} to vary (known: {known})")
        twice = [name for k, name in enumerate(vary) if name in vary[:k]]
        if twice:
            raise ModelError(f"the parameter {twice[0]!r} is to vary twice; name it once")
        if not vary:
            raise AnalysisError("nothing to vary: name parameters, or give some of them bounds")
        return list(vary)

    # scaled functions ----------------------------------------------------------------
    def unscale(self, z: np.ndarray) -> np.ndarray:
        return np.clip(self.x0 + self.width * z, self.lower, self.upper)

    def objective(self, z: np.ndarray) -> float:
        found = self.problem.evaluate(self.unscale(z), gradient=False)
        if found is None:  # let the line search come back
            return self.last + 10.0 * (1.0 + abs(self.last))
        self.last = self.sign * found.values[0] / self.scale
        return self.last

    def slope(self, z: np.ndarray) -> np.ndarray:
        """Slope of the objective; SciPy asks for it once an iteration, at the design reached."""
        x = self.unscale(z)
        found = self.problem.evaluate(x)
        if found is not None:
            self.reached = x, found
            self.record(x, found)
        return self.sign * self.reached[1].slope(0) * self.width / self.scale

    def size(self, k: int, bound: float) -> float:
        """What one is for a limit: the bound, or the response at the start."""
        return max(abs(bound), abs(self.first.values[self.rows[k]]), 1e-12)

    def constraint(self, k: int, bound: float, sense: float) -> dict:
        """SciPy's form ``c(z) ≥ 0`` of one side of a limit, scaled."""
        row, size = self.rows[k], self.size(k, bound)

        def value(z: np.ndarray) -> float:
            found = self.problem.evaluate(self.unscale(z), gradient=False) or self.reached[1]
            return sense * (found.values[row] - bound) / size

        def slope(z: np.ndarray) -> np.ndarray:
            found = self.problem.evaluate(self.unscale(z)) or self.reached[1]
            return sense * found.slope(row) * self.width / size

        limit = self.limits[k]
        kind = "eq" if limit.lower == limit.upper else "ineq"
        return {"type": kind, "fun": value, "jac": slope}

    def constraints(self) -> list[dict]:
        made = []
        for k, limit in enumerate(self.limits):
            if limit.lower is not None:
                made.append(self.constraint(k, limit.lower, 1.0))
            if limit.upper is not None and limit.upper != limit.lower:
                made.append(self.constraint(k, limit.upper, -1.0))
        return made

    # solving -------------------------------------------------------------------------
    def solve(self, max_iterations: int, tolerance: float, progress: Any) -> Optimum:
        from scipy.optimize import minimize as scipy_minimize

        first = self.problem.evaluate(self.x0)
        if first is None:
            raise AnalysisError(f"the starting design fails: {self.problem.failures[-1]}")
        self.first, self.reached = first, (self.x0, first)
        self.scale = max(abs(first.values[0]), 1e-12)
        self.last = self.sign * first.values[0] / self.scale
        self.progress = progress
        self.history = [self.iterate(self.x0, first)]
        low = (self.lower - self.x0) / self.width
        high = (self.upper - self.x0) / self.width
        try:
            outcome = scipy_minimize(
                self.objective,
                np.zeros(len(self.names)),
                jac=self.slope,
                method="SLSQP",
                bounds=list(zip(low, high, strict=True)),
                constraints=self.constraints(),
                options={"maxiter": max_iterations, "ftol": tolerance},
            )
            x = self.unscale(outcome.x)
            found = self.problem.evaluate(x)
        except KeyboardInterrupt:
            message = f"interrupted after {len(self.history) - 1} iteration(s)"
            return self.optimum(*self.reached, False, message, interrupted=True)
        if found is None:
            message = f"ended at a design that fails: {self.problem.failures[-1]}"
            return self.optimum(*self.reached, False, message)
        return self.optimum(x, found, bool(outcome.success), str(outcome.message))

    def record(self, x: np.ndarray, found: Evaluation) -> None:
        """Keep and tell a design, unless it is the last one."""
        reached = self.iterate(x, found)
        if reached.parameters == self.history[-1].parameters:
            return
        self.history.append(reached)
        number = len(self.history) - 1
        if callable(self.progress):
            self.progress(number, reached.objective)
        elif self.progress:
            print(f"iteration {number}: {reached.objective:.8g}")

    def iterate(self, x: np.ndarray, found: Evaluation) -> Iterate:
        return Iterate(self.problem.parameters(x), float(found.values[0]), self.violation(found))

    def violation(self, found: Evaluation) -> float:
        worst = 0.0
        for k, limit in enumerate(self.limits):
            value = found.values[self.rows[k]]
            if limit.lower is not None:
                worst = max(worst, (limit.lower - value) / self.size(k, limit.lower))
            if limit.upper is not None:
                worst = max(worst, (value - limit.upper) / self.size(k, limit.upper))
        return float(worst)

    def optimum(
        self,
        x: np.ndarray,
        found: Evaluation,
        success: bool,
        message: str,
        interrupted: bool = False,
    ) -> Optimum:
        self.record(x, found)
        near = 1e-6 * self.width
        at_bounds = [
            n
            for n, v, lo, hi, e in zip(self.names, x, self.lower, self.upper, near, strict=True)
            if v - lo <= e or hi - v <= e
        ]
        active = [
            limit.response.label
            for row, limit in zip(self.rows, self.limits, strict=True)
            if any(
                b is not None and abs(found.values[row] - b) <= 1e-6 * max(abs(b), 1.0)
                for b in (limit.lower, limit.upper)
            )
        ]
        return Optimum(
            x=self.problem.parameters(x),
            fun=float(found.values[0]),
            success=success,
            message=message,
            gradient=dict(zip(self.names, found.slope(0), strict=True)),
            history=self.history,
            initial=self.first.motion,
            motion=found.motion,
            at_bounds=at_bounds,
            active=active,
            runs=self.problem.runs,
            failed_runs=len(self.problem.failures),
            violation=self.violation(found),
            interrupted=interrupted,
        )
