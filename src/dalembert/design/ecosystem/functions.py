"""Design problem as plain functions of a vector, for SciPy and other optimisers."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.ecosystem.differentiable import jax_function, torch_function
from dalembert.design.limit import Limit
from dalembert.design.optimize.optimization import design_problem
from dalembert.design.optimize.problem import Evaluation
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import Spelled

if TYPE_CHECKING:
    from scipy.optimize import NonlinearConstraint


class DesignFunctions(Spelled):
    """``fun(x), jac(x)`` of the first response, ``values(x), jacobian(x)`` of all.

    Values and gradients of a design share one run. If the run fails, ``fun`` and ``values`` are
    infinite and gradients raise.

    Parameters
    ----------
    model, analysis : model and analysis
    responses : one or several, the objective first
    subject_to : limits, available as ``constraints`` for SciPy
    vary : names; default all with bounds
    start : initial values
    gradient : method of ``sensitivity``

    Attributes
    ----------
    names, labels : of the variables and of the responses
    x0 : (n,) start
    bounds : (n, 2)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> from scipy.optimize import minimize
    >>> rod = da.Structure("spring")
    >>> k = rod.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = rod.node("end", 0)
    >>> part = rod.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> rod.load(end, fx=100.0)
    >>> cost = da.final("k + 100*end.ux")
    >>> design = da.DesignFunctions(rod.build(), cost, analysis=da.Statics())
    >>> result = minimize(design.fun, design.x0, jac=design.jac, bounds=design.bounds)
    >>> result.x.round(3)  # of k + 1e4/k
    array([100.])
    """

    def __init__(
        self,
        model: ParametricModel | None,
        responses: Any,
        *,
        analysis: Analysis | None = None,
        subject_to: Sequence[Limit] = (),
        vary: Sequence[Any] | None = None,
        start: Mapping[str, float] | None = None,
        gradient: Method = "auto",
    ):
        several = isinstance(responses, Sequence) and not isinstance(responses, (str, Response))
        listed = list(responses) if several else [responses]
        quantities = [*listed, *(limit.response for limit in subject_to)]
        self.problem = design_problem(model, analysis, quantities, vary, start)
        self.problem.gradient = gradient
        self.limits, self.count = list(subject_to), len(listed)
        self.names = self.problem.variables.names
        self.labels = [q.label for q in self.problem.quantities[: self.count]]
        self.x0 = self.problem.variables.start.copy()
        self.bounds = np.stack([self.problem.variables.lower, self.problem.variables.upper], axis=1)

    def fun(self, x: np.ndarray) -> float:
        """First response."""
        return float(self.values(x)[0])

    def jac(self, x: np.ndarray) -> np.ndarray:
        """(n,) gradient of the first response."""
        return self.jacobian(x)[0]

    def values(self, x: np.ndarray) -> np.ndarray:
        """(m,) all responses."""
        return self._values(x)[: self.count]

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """(m, n) gradients of all responses."""
        return self._slopes(x, range(self.count))

    @property
    def jax(self) -> Callable[[Any], Any]:
        """``x → (m,)`` all responses as a function that JAX differentiates; ``pip install jax``.

        For double precision, set ``jax.config.update("jax_enable_x64", True)``.
        """
        return jax_function(self.values, self.jacobian, self.count)

    @property
    def torch(self) -> Callable[[Any], Any]:
        """``x → (m,)`` all responses as a function of a tensor that PyTorch differentiates."""
        return torch_function(self.values, self.jacobian)

    def limited(self, x: np.ndarray) -> np.ndarray:
        """Responses of the limits."""
        return self._values(x)[self.count :]

    @property
    def constraints(self) -> list[NonlinearConstraint]:
        """Limits as constraints of SciPy."""
        from scipy.optimize import NonlinearConstraint

        if not self.limits:
            return []
        lower = [-np.inf if limit.lower is None else limit.lower for limit in self.limits]
        upper = [np.inf if limit.upper is None else limit.upper for limit in self.limits]
        rows = range(self.count, self.count + len(self.limits))
        return [NonlinearConstraint(self.limited, lower, upper, lambda x: self._slopes(x, rows))]

    def _values(self, x: np.ndarray) -> np.ndarray:
        evaluation = self.problem.evaluate(x, gradient=False)
        return (
            np.full(len(self.problem.quantities), np.inf)
            if evaluation is None
            else evaluation.values
        )

    def _slopes(self, x: np.ndarray, rows: Sequence[int]) -> np.ndarray:
        evaluation = self.evaluate(x)
        return np.array([self.problem.slope(evaluation, k) for k in rows])

    def evaluate(self, x: np.ndarray) -> Evaluation:
        """Evaluation with gradient.

        Raises
        ------
        AnalysisError
            The run fails.
        """
        evaluation = self.problem.evaluate(np.asarray(x, dtype=float))
        if evaluation is None:
            raise AnalysisError(f"no gradient, as the run fails: {self.problem.failures[-1]}")
        return evaluation
