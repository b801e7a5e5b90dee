"""Design problem (8.41): objective and constraints as functions of the variables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dalembert.design.case import evaluation_order
from dalembert.design.optimize.evaluation_log import LogPart
from dalembert.design.quantity import AnalysisCase, Quantity
from dalembert.design.variables import Variables
from dalembert.errors import AnalysisError, ModelError
from dalembert.interrupts import check_ctrl_c
from dalembert.responses.base import Response, evaluate
from dalembert.results.result import Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.gradient import gradient_values
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.formulas.parameter import Parameter

CACHE_SIZE = 64
"""Upper limit of the designs whose results are kept in memory."""
NOT_FINITE = "a response is not finite"


@dataclass
class Evaluation:
    """Quantities and their gradients at one design.

    Attributes
    ----------
    values : (quantities,)
    terms : (terms,) values of the responses that they depend on
    gradient : (terms, n) of these responses, once evaluated
    runs : case → its result; empty if the numbers were read from a log
    """

    terms: np.ndarray
    values: np.ndarray
    gradient: np.ndarray | None = None
    runs: dict[AnalysisCase, Result] = field(default_factory=dict)


@dataclass
class DesignProblem:
    """``x ↦ quantities, gradient``, cached and logged.

    Parameters
    ----------
    quantities : objective first, then constraints
    variables : design variables
    gradient : method of ``sensitivity``
    log : log of the evaluations
    source : problem with the same terms whose runs are shared
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
            self.terms: list[tuple[AnalysisCase, Response]] = self.source.terms
            self.cases = self.source.cases
            return
        needed = [q for case in self.cases for q in case.inputs.values()]
        self.terms = list(
            dict.fromkeys(
                (t.case, t.response) for q in (*self.quantities, *needed) for t in q.terms
            )
        )

    def with_quantities(self, quantities: Sequence[Quantity]) -> DesignProblem:
        """Problem with other quantities of the same responses, which shares the runs."""
        return DesignProblem(
            quantities,
            self.variables,
            self.gradient,
            failures=self.failures,
            source=self.source or self,
        )

    # values -----------------------------------------------------------------------------
    def term_indices(self, quantity: Quantity) -> list[int]:
        """Indices of the terms of a quantity."""
        return [self._index[t.case, t.response] for t in quantity.terms]

    @cached_property
    def _index(self) -> dict[tuple[AnalysisCase, Response], int]:
        """Term → its index."""
        return {term: k for k, term in enumerate(self.terms)}

    def responses(self, case: AnalysisCase) -> tuple[list[int], list[Response]]:
        """Indices of the terms of a case, and their responses."""
        rows = [k for k, (owner, _) in enumerate(self.terms) if owner is case]
        return rows, [self.terms[k][1] for k in rows]

    def evaluate(self, x: np.ndarray, gradient: bool = True) -> Evaluation | None:
        """Quantities (and gradient) at ``x``; None and an entry in ``failures`` if a run fails."""
        if self.source is not None:
            evaluation = self.source.evaluate(x, gradient)
            return evaluation and Evaluation(
                evaluation.terms,
                self._values(evaluation.terms),
                evaluation.gradient,
                evaluation.runs,
            )
        key = np.asarray(x, dtype=float).tobytes()
        if key not in self._cache:
            self._cache[key] = self._from_log(x) if self._is_logged(x) else self._run_and_log(x)
            if len(self._cache) > CACHE_SIZE:
                self._cache.pop(next(iter(self._cache)))
        evaluation = self._cache[key]
        if evaluation is not None and gradient and evaluation.gradient is None:
            try:
                self._differentiate(x, evaluation)
            except AnalysisError as error:
                self.failures.append(str(error))
                return None
        return evaluation

    def _is_logged(self, x: np.ndarray) -> bool:
        return self.log is not None and self.log.find(x) is not None

    def _from_log(self, x: np.ndarray) -> Evaluation | None:
        assert self.log is not None
        entry = self.log.find(x) or {}
        if "failure" in entry:
            self.failures.append(entry["failure"])
            return None
        terms = np.array(entry["terms"], dtype=float)
        gradient = np.array(entry["gradient"]) if "gradient" in entry else None
        return Evaluation(terms, self._values(terms), gradient)

    def _run_and_log(self, x: np.ndarray) -> Evaluation | None:
        count = len(self.failures)
        evaluation = self._run(x)
        if self.log is not None:
            entry = (
                {"failure": self.failures[count]}
                if evaluation is None
                else {"terms": evaluation.terms}
            )
            self.log.append(x, **entry)
        return evaluation

    def _values(self, terms: np.ndarray) -> np.ndarray:
        return np.array([q.value(terms[self.term_indices(q)]) for q in self.quantities])

    def parameters(self, case: AnalysisCase, x: np.ndarray, terms: np.ndarray) -> dict[str, float]:
        """Parameter values of a case: design variables and quantities of other cases."""
        varied = self.variables.parameters(x)
        values = {n: v for n, v in varied.items() if n in case.model.parameters}
        return values | {n: q.value(terms[self.term_indices(q)]) for n, q in case.inputs.items()}

    def _run(self, x: np.ndarray) -> Evaluation | None:
        """Run all cases at ``x``."""
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

    def results(self, x: np.ndarray) -> dict[AnalysisCase, Result]:
        """Case → its result at ``x``; runs again if only numbers are logged."""
        if self.source is not None:
            return self.source.results(x)
        evaluation = self.evaluate(x, gradient=False)
        if evaluation is not None and not evaluation.runs:
            rerun = self._run(x)
            evaluation.runs = rerun.runs if rerun is not None else {}
        return evaluation.runs if evaluation is not None else {}

    # gradients --------------------------------------------------------------------------
    def _differentiate(self, x: np.ndarray, evaluation: Evaluation) -> None:
        self.gradients += 1
        results, gradient = self.results(x), np.zeros((len(self.terms), len(self.variables.names)))
        slopes, varied = self.variables.slopes(x), self.variables.parameter_names
        for case in self.cases:
            own_columns = [k for k, n in enumerate(varied) if n in case.model.parameters]
            names = [varied[k] for k in own_columns if varied[k] not in case.inputs]
            columns = [k for k in own_columns if varied[k] not in case.inputs]
            rows, responses = self.responses(case)
            arguments = [*names, *case.inputs]
            if not arguments or not rows:
                continue
            slope = gradient_values(results[case], responses, arguments, self.gradient)
            gradient[rows] = slope[:, : len(names)] @ slopes[columns]
            for k, quantity in enumerate(case.inputs.values(), len(names)):
                indices = self.term_indices(quantity)
                inner = quantity.slope(evaluation.terms[indices]) @ gradient[indices]
                gradient[rows] += np.outer(slope[:, k], inner)
        evaluation.gradient = gradient
        if self.log is not None:
            self.log.append(x, terms=evaluation.terms, gradient=gradient)

    def slope(self, evaluation: Evaluation, row: int) -> np.ndarray:
        """(n,) gradient of a quantity at an evaluation with gradient."""
        assert evaluation.gradient is not None
        indices = self.term_indices(self.quantities[row])
        return self.quantities[row].slope(evaluation.terms[indices]) @ evaluation.gradient[indices]

    def unit(self, row: int, results: Mapping[AnalysisCase, Result]) -> str:
        """Unit of a quantity, from the results of its terms."""
        units = []
        for term in self.quantities[row].terms:
            result = results.get(term.case)
            unit = "" if result is None else term.response.adapted_to(result).unit_of(result)
            units.append(unit)
        return self.quantities[row].unit(units)


def common_parameters(cases: Sequence[AnalysisCase]) -> dict[str, Parameter]:
    """Parameters of all cases by name, without those set by other cases.

    Raises
    ------
    ModelError
        One name has different bounds in two cases.
    """
    parameters: dict[str, Parameter] = {}
    for case in evaluation_order(list(cases)):
        for name, parameter in case.model.parameters.items():
            if name in case.inputs:
                continue
            first = parameters.setdefault(name, parameter)
            if first.bounds != parameter.bounds:
                raise ModelError(
                    f"{case.model.name}: the parameter {name!r} has bounds {parameter.bounds} here "
                    f"and {first.bounds} in another case; give it the same"
                )
    return parameters
