"""Limit states ``g(x)``, safe if positive, by runs of a model or by formulas."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.optimize.optimization import design_problem
from dalembert.errors import AnalysisError, ModelError
from dalembert.responses.base import Response
from dalembert.responses.evaluation import as_responses
from dalembert.results.analysis import Analysis
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown

MAX_SAMPLES = 1000
"""Upper limit of the samples that are kept for a page."""
LimitState = Response | Limit | str
"""A response or a limit of a model, or a formula of the random parameters; safe above zero."""


class LimitStates(ABC):
    """Several limit states as functions of the random parameters.

    Attributes
    ----------
    labels : labels of the limit states
    names : names of the random parameters
    others : names of the parameters that are not random
    model : model of the runs; None for formulas
    cheap : whether thousands of evaluations are fast
    """

    labels: list[str]
    names: list[str]
    others: list[str]
    calls: int = 0
    cheap: bool = False
    model: ParametricModel | None = None

    @abstractmethod
    def values(self, x: np.ndarray) -> np.ndarray:
        """(m,) ``g``; NaN if a run fails."""

    @abstractmethod
    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, n) by the random and (m, others) by the other parameters."""

    def values_at(self, points: np.ndarray) -> np.ndarray:
        """(N, m) ``g`` at (N, n) points."""
        return np.array([self.values(x) for x in points]).reshape(len(points), len(self.labels))

    def result(self, x: np.ndarray) -> Result | None:
        """The run at ``x``; None without a model, or if the run fails."""
        return None

    @property
    def failure(self) -> str:
        """Message of the last failed run."""
        return ""


class RunLimits(LimitStates):
    """Limit states by an analysis of a model, with exact gradients.

    Attributes
    ----------
    samples : random parameters and ``g`` of the first samples, at most ``MAX_SAMPLES``
    """

    def __init__(
        self,
        model: ParametricModel,
        limits: Sequence[Response | Limit],
        names: Sequence[str],
        analysis: Analysis,
    ):
        self.names, self.model = list(names), model
        for name in names:
            if name not in model.parameters:
                raise ModelError(unknown("random parameter", name, model.parameters))
        self.others = [n for n in model.parameters if n not in names]
        responses = [limit.response if isinstance(limit, Limit) else limit for limit in limits]
        unique = list({id(r): r for r in responses}.values())
        self.sides: list[tuple[int, float, float]] = []  # response, sign and offset of ``g``
        self.labels = []
        for limit, response in zip(limits, responses, strict=True):
            row = [id(r) for r in unique].index(id(response))
            for sign, bound, text in _sides(limit):
                self.sides.append((row, sign, bound))
                self.labels.append(f"{response.label}{text}")
        unique_responses = as_responses(unique)
        self.problem = design_problem(
            model, analysis, unique_responses, [*self.names, *self.others]
        )
        parameters = list(model.parameters)
        self.samples = list[tuple[np.ndarray, np.ndarray]]()
        self.other_values = np.array([model.nominal[parameters.index(n)] for n in self.others])

    def values(self, x: np.ndarray) -> np.ndarray:
        self.calls += 1
        evaluation = self.problem.evaluate(np.append(x, self.other_values), gradient=False)
        if evaluation is None:
            return np.full(len(self.sides), np.nan)
        return np.array(
            [sign * (evaluation.values[row] - bound) for row, sign, bound in self.sides]
        )

    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        evaluation = self.problem.evaluate(np.append(x, self.other_values))
        if evaluation is None:
            raise AnalysisError(f"a run fails: {self.failure}")
        rows = np.array([sign * self.problem.slope(evaluation, row) for row, sign, _ in self.sides])
        return rows[:, : len(self.names)], rows[:, len(self.names) :]

    def values_at(self, points: np.ndarray) -> np.ndarray:
        values = super().values_at(points)
        free = MAX_SAMPLES - len(self.samples)
        self.samples += zip(points[:free], values[:free], strict=True)
        return values

    def responses(self, x: np.ndarray) -> np.ndarray:
        """(responses,) values of the responses; NaN if the run fails."""
        evaluation = self.problem.evaluate(np.append(x, self.other_values), gradient=False)
        return (
            np.full(len(self.problem.quantities), np.nan)
            if evaluation is None
            else evaluation.values
        )

    def responses_of(self, g: np.ndarray) -> np.ndarray:
        """(responses,) values of the responses from ``g`` of all limit states."""
        values = np.full(len(self.problem.quantities), np.nan)
        for g_side, (row, sign, bound) in zip(g, self.sides, strict=True):
            values[row] = bound + sign * g_side
        return values

    def result(self, x: np.ndarray) -> Result | None:
        return next(iter(self.problem.results(np.append(x, self.other_values)).values()), None)

    @property
    def failure(self) -> str:
        return self.problem.failures[-1] if self.problem.failures else ""


class FormulaLimits(LimitStates):
    """Limit states by formulas of the random parameters, vectorised over points."""

    cheap = True

    def __init__(self, formulas: Sequence[str], names: Sequence[str]):
        self.labels, self.names, self.others = list(formulas), list(names), []
        symbols = {name: Expression(ca.SX.sym(name), name) for name in names}
        expressions = [parse_formula(text, symbols.get) for text in formulas]
        g = ca.vertcat(*(ca.SX(m.sx) for m in expressions))
        x = ca.vertcat(*(s.sx for s in symbols.values()))
        self._g = ca.Function("g", [x], [ca.densify(g)])
        self._slope = ca.Function("dg", [x], [ca.densify(ca.jacobian(g, x))])

    def values(self, x: np.ndarray) -> np.ndarray:
        self.calls += 1
        return self._g(x).full().ravel()

    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        gradients = self._slope(x).full()
        return gradients, np.zeros((gradients.shape[0], 0))

    def values_at(self, points: np.ndarray) -> np.ndarray:
        self.calls += len(points)
        return self._g(points.T).full().T


def limit_states(
    model: ParametricModel | None,
    limits: Any,
    names: Sequence[str],
    analysis: Analysis | None,
) -> LimitStates:
    """Limit states from responses, limits or formulas, one or several.

    Raises
    ------
    AnalysisError
        The limit states are neither formulas nor responses of a model with an analysis.
    """
    limit_list = list(limits) if isinstance(limits, (list, tuple)) else [limits]
    if not limit_list:
        raise AnalysisError("there is no limit state; give a response, a Limit or a formula")
    if model is None and all(isinstance(limit, str) for limit in limit_list):
        return FormulaLimits(limit_list, names)
    if model is None or analysis is None:
        raise AnalysisError(
            "limit states of a model need analysis=...; formulas of the random parameters alone "
            "need no model: reliability(None, 'r - s', ...)"
        )
    for limit in limit_list:
        if not isinstance(limit, (Response, Limit)):
            text = "give a response, safe above zero, or a Limit"
            raise AnalysisError(f"{limit!r} is not a limit state of a model; {text}")
    return RunLimits(model, limit_list, names, analysis)


def _sides(limit: Response | Limit) -> list[tuple[float, float, str]]:
    """Sign, bound and label of each side of a limit; ``sign (response − bound) > 0`` is safe."""
    if not isinstance(limit, Limit):
        return [(1.0, 0.0, " > 0")]
    sides = []
    if limit.lower is not None:
        sides.append((1.0, limit.lower, f" > {limit.lower:g}"))
    if limit.upper is not None:
        sides.append((-1.0, limit.upper, f" < {limit.upper:g}"))
    return sides
