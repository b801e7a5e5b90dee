"""The design problem (8.41): quantities of runs as functions of the variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.design.case import Case, evaluation_order
from dalembert.design.optimize.evaluation_log import LogPart
from dalembert.design.quantity import Quantity
from dalembert.design.variables import Variables
from dalembert.errors import AnalysisError, ModelError
from dalembert.interrupts import check_ctrl_c
from dalembert.responses.base import Response, evaluate
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.gradient import gradient_values
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.formulas.parameter import Parameter

REMEMBERED = 64
"""Designs whose runs are kept in memory."""
NOT_FINITE = "a response is not finite"


@dataclass
class Evaluation:
    """Quantities and their gradients at one design.

    Attributes
    ----------
    values : (quantities,)
    terms : (terms,) values of the responses that they are made of
    gradient : (terms, n) of these responses, once it was asked for
    runs : case → its result; empty where the numbers come out of a file
    """

    terms: np.ndarray
    values: np.ndarray
    gradient: np.ndarray | None = None
    runs: dict[Case, Result] = field(default_factory=dict)


@dataclass
class DesignProblem:
    """``x ↦ quantities, gradient``: what every optimiser needs to know.

    Parameters
    ----------
    quantities : all that are needed, objective first
    variables : what varies
    gradient : method of ``sensitivity``
    log : where evaluations are kept
    source : a problem with the same terms, whose runs are used
    """

    quantities: Sequence[Quantity]
    variables: Variables
    gradient: Method = "auto"
    log: LogPart | None = None
    on_run: Callable[[], None] = lambda: None
    source: DesignProblem | None = None
    runs: int = 0
    gradients: int = 0
    failures: list[str] = field(default_factory=list)
    _cache: dict[bytes, Evaluation | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.cases = evaluation_order([t.case for q in self.quantities for t in q.terms])
        if self.source is not None:
            self.terms: list[tuple[Case, Response]] = self.source.terms
            self.cases = self.source.cases
            return
        needed = [q for case in self.cases for q in case.given.values()]
        self.terms = list(
            dict.fromkeys(
                (t.case, t.response) for q in (*self.quantities, *needed) for t in q.terms
            )
        )

    def judged_by(self, quantities: Sequence[Quantity]) -> DesignProblem:
        """The same runs with other quantities of the same responses."""
        return DesignProblem(
            quantities,
            self.variables,
            self.gradient,
            failures=self.failures,
            source=self.source or self,
        )

    # what runs give ---------------------------------------------------------------------
    def places(self, quantity: Quantity) -> list[int]:
        """Numbers of the terms of a quantity."""
        return [self.terms.index((t.case, t.response)) for t in quantity.terms]

    def responses(self, case: Case) -> tuple[list[int], list[Response]]:
        """Numbers of the terms that are drawn from a case, and their responses."""
        rows = [k for k, (owner, _) in enumerate(self.terms) if owner is case]
        return rows, [self.terms[k][1] for k in rows]

    def evaluate(self, x: np.ndarray, gradient: bool = True) -> Evaluation | None:
        """Quantities (and gradient) at ``x``; None where the run fails, with the reason kept."""
        if self.source is not None:
            made = self.source.evaluate(x, gradient)
            return made and Evaluation(
                made.terms, self._values(made.terms), made.gradient, made.runs
            )
        key = np.asarray(x, dtype=float).tobytes()
        if key not in self._cache:
            self._cache[key] = self._recalled(x) if self._is_known(x) else self._kept(x)
            if len(self._cache) > REMEMBERED:
                self._cache.pop(next(iter(self._cache)))
        found = self._cache[key]
        if found is not None and gradient and found.gradient is None:
            try:
                self._differentiate(x, found)
            except AnalysisError as error:
                self.failures.append(str(error))
                return None
        return found

    def _is_known(self, x: np.ndarray) -> bool:
        return self.log is not None and self.log.find(x) is not None

    def _recalled(self, x: np.ndarray) -> Evaluation | None:
        assert self.log is not None
        entry = self.log.find(x) or {}
        if "failure" in entry:
            self.failures.append(entry["failure"])
            return None
        terms = np.array(entry["terms"], dtype=float)
        gradient = np.array(entry["gradient"]) if "gradient" in entry else None
        return Evaluation(terms, self._values(terms), gradient)

    def _kept(self, x: np.ndarray) -> Evaluation | None:
        failed = len(self.failures)
        found = self._run(x)
        if self.log is not None:
            told = {"failure": self.failures[failed]} if found is None else {"terms": found.terms}
            self.log.keep(x, **told)
        return found

    def _values(self, terms: np.ndarray) -> np.ndarray:
        return np.array([q.value(terms[self.places(q)]) for q in self.quantities])

    def parameters(self, case: Case, x: np.ndarray, terms: np.ndarray) -> dict[str, float]:
        """Values of a case's parameters: those that vary and those that other cases set."""
        varied = self.variables.parameters(x)
        made = {n: v for n, v in varied.items() if n in case.model.parameters}
        return made | {n: q.value(terms[self.places(q)]) for n, q in case.given.items()}

    def _run(self, x: np.ndarray) -> Evaluation | None:
        """All cases at ``x``."""
        self.runs += 1
        self.on_run()
        terms, results = np.full(len(self.terms), np.nan), {}
        for case in self.cases:
            try:
                result = case.analysis.run(case.model, self.parameters(case, x, terms))
                if result.status.outcome is Outcome.INTERRUPTED:
                    raise KeyboardInterrupt
                if not result.status.success:
                    raise AnalysisError(str(result.status))
                check_ctrl_c()
                rows, responses = self.responses(case)
                terms[rows] = [evaluate(result, r) for r in responses]
                if not np.all(np.isfinite(terms[rows])):
                    raise AnalysisError(NOT_FINITE)
            except (AnalysisError, ModelError) as error:
                self.failures.append(str(error))
                return None
            results[case] = result
        return Evaluation(terms, self._values(terms), None, results)

    def results(self, x: np.ndarray) -> dict[Case, Result]:
        """Case → its result at ``x``, run again where only numbers are kept."""
        if self.source is not None:
            return self.source.results(x)
        found = self.evaluate(x, gradient=False)
        if found is not None and not found.runs:
            again = self._run(x)
            found.runs = again.runs if again is not None else {}
        return found.runs if found is not None else {}

    # their gradients --------------------------------------------------------------------
    def _differentiate(self, x: np.ndarray, found: Evaluation) -> None:
        self.gradients += 1
        results, made = self.results(x), np.zeros((len(self.terms), len(self.variables.names)))
        slopes, varied = self.variables.slopes(x), self.variables.parameter_names
        for case in self.cases:
            own = [k for k, n in enumerate(varied) if n in case.model.parameters]
            names = [varied[k] for k in own if varied[k] not in case.given]
            columns = [k for k in own if varied[k] not in case.given]
            rows, responses = self.responses(case)
            wanted = [*names, *case.given]
            if not wanted or not rows:
                continue
            slope = gradient_values(results[case], responses, wanted, self.gradient)
            made[rows] = slope[:, : len(names)] @ slopes[columns]
            for k, quantity in enumerate(case.given.values(), len(names)):
                places = self.places(quantity)
                inner = quantity.slope(found.terms[places]) @ made[places]
                made[rows] += np.outer(slope[:, k], inner)
        found.gradient = made
        if self.log is not None:
            self.log.keep(x, terms=found.terms, gradient=made)

    def slope(self, found: Evaluation, row: int) -> np.ndarray:
        """(n,) gradient of a quantity at an evaluation that was asked for it."""
        assert found.gradient is not None
        places = self.places(self.quantities[row])
        return self.quantities[row].slope(found.terms[places]) @ found.gradient[places]

    def unit(self, row: int, results: Mapping[Case, Result]) -> str:
        """Unit of a quantity, as the runs tell it."""
        units = []
        for term in self.quantities[row].terms:
            result: Any = results.get(term.case)
            known = result is not None
            units.append(term.response.over(result).unit_of(result) if known else "")
        return self.quantities[row].unit(units)


def common_parameters(cases: Sequence[Case]) -> dict[str, Parameter]:
    """Parameters of all cases by name, those set by other cases left out.

    Raises
    ------
    ModelError
        The same name with different bounds.
    """
    made: dict[str, Parameter] = {}
    for case in evaluation_order(list(cases)):
        for name, parameter in case.model.parameters.items():
            if name in case.given:
                continue
            first = made.setdefault(name, parameter)
            if first.bounds != parameter.bounds:
                raise ModelError(
                    f"{case.model.name}: the parameter {name!r} has bounds {parameter.bounds} here "
                    f"and {first.bounds} in another case; give it the same"
                )
    return made
