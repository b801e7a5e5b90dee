"""Design problem as functions of a vector, for SciPy, JAX, PyTorch and other packages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.optimize.optimization import design_problem
from dalembert.design.optimize.problem import Evaluation
from dalembert.design.quantity import Objective
from dalembert.design.variables import Vary
from dalembert.errors import AnalysisError
from dalembert.packages import optional_package
from dalembert.results.analysis import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import CheckedArguments

if TYPE_CHECKING:
    from scipy.optimize import NonlinearConstraint

Numbers = Callable[[np.ndarray], np.ndarray]


def jax_function(values: Numbers, jacobian: Numbers, count: int) -> Callable[[Any], Any]:
    """``x → (m,)`` for ``jax.grad``, ``jax.jit`` and ``jax.vmap``, one design after the other.

    Parameters
    ----------
    values, jacobian : (n,) → (m,) and (m, n)
    count : m

    Raises
    ------
    UnsupportedError
        JAX is not installed.
    """
    jax = optional_package("jax", "a JAX function")

    def call_on_host(host: Callable[..., np.ndarray], size: int, *arguments: Any) -> Any:
        dtype = arguments[0].dtype

        def evaluate(*arrays: Any) -> np.ndarray:
            return host(*(np.asarray(a, dtype=float) for a in arrays)).astype(dtype)

        shape = jax.ShapeDtypeStruct((size,), dtype)
        return jax.pure_callback(evaluate, shape, *arguments, vmap_method="sequential")

    @jax.custom_vjp
    def responses(x: Any) -> Any:
        return call_on_host(values, count, x)

    def forward(x: Any) -> tuple[Any, Any]:
        return responses(x), x

    def backward(x: Any, weights: Any) -> tuple[Any]:
        return (call_on_host(lambda x, w: w @ jacobian(x), x.size, x, weights),)

    responses.defvjp(forward, backward)
    return responses  # type: ignore[no-any-return]


def torch_function(values: Numbers, jacobian: Numbers) -> Callable[[Any], Any]:
    """``x → (m,)`` for tensors, in the graph of ``backward``.

    Parameters
    ----------
    values, jacobian : (n,) → (m,) and (m, n)

    Raises
    ------
    UnsupportedError
        PyTorch is not installed.
    """
    torch = optional_package("torch", "a PyTorch function")

    def to_numpy(x: Any) -> np.ndarray:
        array: np.ndarray = x.detach().cpu().double().numpy()
        return array

    class Values(torch.autograd.Function):  # type: ignore[misc, name-defined]
        @staticmethod
        def forward(ctx: Any, x: Any) -> Any:
            ctx.save_for_backward(x)
            return x.new_tensor(values(to_numpy(x)))

        @staticmethod
        def backward(ctx: Any, *weights: Any) -> Any:
            (x,) = ctx.saved_tensors
            return weights[0] @ x.new_tensor(jacobian(to_numpy(x)))

    return Values.apply  # type: ignore[no-any-return]


class DesignFunctions(CheckedArguments):
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
        responses: Objective | Sequence[Objective],
        *,
        analysis: Analysis | None = None,
        subject_to: Sequence[Limit] = (),
        vary: Vary = None,
        start: Mapping[str, float] | None = None,
        gradient: Method = "auto",
    ):
        response_list = (
            list(responses)
            if isinstance(responses, Sequence) and not isinstance(responses, str)
            else [responses]
        )
        quantities = [*response_list, *(limit.response for limit in subject_to)]
        self.problem = design_problem(model, analysis, quantities, vary, start)
        self.problem.gradient = gradient
        self.limits, self.count = list(subject_to), len(response_list)
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
