"""Limit states ``g(x)``: safe above zero, failed below; from runs of a model or from a formula."""

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
from dalembert.results.result import Analysis
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown


class LimitStates(ABC):
    """Several limit states as functions of the random parameters.

    Attributes
    ----------
    labels : of the limit states
    names : of the random parameters
    others : of the parameters that are not random
    model : that is run; None of formulas
    cheap : whether thousands of evaluations cost little
    """

    labels: list[str]
    names: list[str]
    others: list[str]
    calls: int = 0
    cheap: bool = False
    model: ParametricModel | None = None

    @abstractmethod
    def values(self, x: np.ndarray) -> np.ndarray:
        """(m,) ``g``; NaN where a run fails."""

    @abstractmethod
    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(m, n) by the random and (m, others) by the other parameters."""

    def many(self, points: np.ndarray) -> np.ndarray:
        """(N, m) ``g`` at (N, n) points."""
        return np.array([self.values(x) for x in points]).reshape(len(points), len(self.labels))

    def result(self, x: np.ndarray) -> Any:
        """The run at ``x``; None where nothing is run, or it fails."""
        return None

    @property
    def failure(self) -> str:
        """Why the last run failed."""
        return ""


class RunLimits(LimitStates):
    """Limit states by an analysis of a model for every ``x``, with its exact gradients."""

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
        every = as_responses(unique)
        self.problem = design_problem(model, analysis, every, [*self.names, *self.others])
        listed = list(model.parameters)
        self.rest = np.array([model.nominal[listed.index(n)] for n in self.others])

    def values(self, x: np.ndarray) -> np.ndarray:
        self.calls += 1
        found = self.problem.evaluate(np.append(x, self.rest), gradient=False)
        if found is None:
            return np.full(len(self.sides), np.nan)
        return np.array([sign * (found.values[row] - bound) for row, sign, bound in self.sides])

    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = self.problem.evaluate(np.append(x, self.rest))
        if found is None:
            raise AnalysisError(f"a run fails: {self.failure}")
        rows = np.array([sign * self.problem.slope(found, row) for row, sign, _ in self.sides])
        return rows[:, : len(self.names)], rows[:, len(self.names) :]

    def result(self, x: np.ndarray) -> Any:
        return next(iter(self.problem.results(np.append(x, self.rest)).values()), None)

    @property
    def failure(self) -> str:
        return self.problem.failures[-1] if self.problem.failures else ""


class FormulaLimits(LimitStates):
    """Limit states by formulas of the random parameters alone; many points at once."""

    cheap = True

    def __init__(self, formulas: Sequence[str], names: Sequence[str]):
        self.labels, self.names, self.others = list(formulas), list(names), []
        symbols = {name: Expression(ca.SX.sym(name), name) for name in names}
        made = [parse_formula(text, symbols.get) for text in formulas]
        g = ca.vertcat(*(ca.SX(m.sx) for m in made))
        x = ca.vertcat(*(s.sx for s in symbols.values()))
        self._g = ca.Function("g", [x], [ca.densify(g)])
        self._slope = ca.Function("dg", [x], [ca.densify(ca.jacobian(g, x))])

    def values(self, x: np.ndarray) -> np.ndarray:
        self.calls += 1
        return self._g(x).full().ravel()

    def gradients(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = self._slope(x).full()
        return found, np.zeros((found.shape[0], 0))

    def many(self, points: np.ndarray) -> np.ndarray:
        self.calls += len(points)
        return self._g(points.T).full().T


def limit_states(
    model: ParametricModel | None, given: Any, names: Sequence[str], analysis: Analysis | None
) -> LimitStates:
    """The limit states that were given, one or several.

    Raises
    ------
    AnalysisError
        Neither formulas, nor responses of a model with an analysis.
    """
    listed = list(given) if isinstance(given, (list, tuple)) else [given]
    if not listed:
        raise AnalysisError("there is no limit state; give a response, a Limit or a formula")
    if model is None and all(isinstance(one, str) for one in listed):
        return FormulaLimits(listed, names)
    if model is None or analysis is None:
        raise AnalysisError(
            "limit states of a model need analysis=...; formulas of the random parameters alone "
            "need no model: reliability(None, 'r - s', ...)"
        )
    for one in listed:
        if not isinstance(one, (Response, Limit)):
            text = "give a response, safe above zero, or a Limit"
            raise AnalysisError(f"{one!r} is no limit state of a model; {text}")
    return RunLimits(model, listed, names, analysis)


def _sides(limit: Response | Limit) -> list[tuple[float, float, str]]:
    """Sign, bound and text of what must be above zero."""
    if not isinstance(limit, Limit):
        return [(1.0, 0.0, " > 0")]
    sides = []
    if limit.lower is not None:
        sides.append((1.0, limit.lower, f" > {limit.lower:g}"))
    if limit.upper is not None:
        sides.append((-1.0, limit.upper, f" < {limit.upper:g}"))
    return sides
