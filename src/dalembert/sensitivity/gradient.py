"""Gradients of responses, and of time histories at all outputs, with respect to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, evaluate
from dalembert.responses.evaluation import as_responses, batch_response, expanded, representative
from dalembert.responses.values import At
from dalembert.results.batch.batch import Batch
from dalembert.results.result import Result
from dalembert.sensitivity.batch import batch_gradients
from dalembert.sensitivity.checks.certificate import certify
from dalembert.sensitivity.checks.diagnosis import Findings, diagnose
from dalembert.sensitivity.checks.event_notes import refuse_unlocated
from dalembert.sensitivity.checks.finite_difference import FiniteDifference
from dalembert.sensitivity.checks.kinks import refuse_kinks
from dalembert.sensitivity.marching.stable_steps import with_stable_steps
from dalembert.sensitivity.methods import METHODS, Adjoint, Automatic, Direct, Method, Strategy
from dalembert.sensitivity.registry import engine_for
from dalembert.sensitivity.samples import Sample
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr


@check_arguments
def sensitivity(
    motion: Result | Batch,
    responses: Response | Sequence[Response],
    wrt: Sequence[str] | None = None,
    method: Method = "auto",
    certificate: bool = False,
) -> xr.DataArray:
    """Gradient of responses with respect to parameters, ``response × parameter``.

    The gradient is the exact derivative of the steps taken. Where times of the run are formulas of
    parameters, outputs and the ends of fixed steps move with these; lengths of adaptive steps are
    frozen, and subdivided where products of their tangents would grow spuriously. The coordinates
    contain units, values and bounds; ``attrs["notes"]`` contains remarks on the gradient.

    Parameters
    ----------
    motion : result of ``solve_dynamics``, ``solve_kinematics``, ``solve_inverse_dynamics``,
        ``solve_equilibrium``, ``linearize`` or ``solve_statics``, or a batch of them: the gradient
        is then ``design × response × parameter``, NaN where a design failed, without notes
    responses : one response or several
    wrt : names of parameters; all by default
    method : ``"auto"``, ``"adjoint"``, ``"direct"``, ``"finite-difference"`` or a strategy object
    certificate : check every entry by all methods and by a Taylor test, about twenty runs per
        parameter; the ``Certificate`` is in ``attrs["certificate"]``

    Raises
    ------
    AnalysisError
        Unknown parameter or method; a run that failed; a response that has no derivative at these
        parameters, e.g. at a grazing event.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> a, b = system.parameter("a", 3.0, "m/s"), system.parameter("b", 10.0, "m/s")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(a, b)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> responses = [da.final("stone.x"), da.final("stone.y")]
    >>> da.sensitivity(motion, responses).values.round(6)  # t on the diagonal
    array([[2., 0.],
           [0., 2.]])
    """
    several = as_responses(responses)
    if isinstance(motion, Batch):
        return _of_batch(motion, several, wrt, method, certificate)
    refuse_unfinished(motion)
    columns = chosen_columns(motion, wrt)
    strategy = _strategy(method, len(expanded(several)[0]), len(columns))
    refuse_unknown_values(motion, several)
    terms, weights = expanded(several)
    refuse_kinks(motion, terms, columns)
    values = _values(motion, terms, columns, strategy)
    table = _labelled_array(motion, several, columns, weights @ values, strategy)
    table.attrs["notes"] = diagnose(Findings(motion, terms, columns, values))
    if isinstance(strategy, FiniteDifference):
        table.attrs["notes"] += strategy.notes(motion, columns)
    if certificate:
        table.attrs["certificate"] = certify(motion, several, columns)
    return table


def _of_batch(
    batch: Batch, responses: list[Response], wrt, method: Method, certificate: bool
) -> xr.DataArray:
    if certificate:
        raise AnalysisError("a certificate requires a single design; use batch[k]")
    columns = chosen_columns(batch, wrt)
    strategy = _strategy(method, len(responses), len(columns))
    terms, weights = expanded(responses)
    values = np.matmul(weights, batch_gradients(batch, terms, columns, strategy))
    return _labelled_array(batch, responses, columns, values, strategy)


def gradient_values(
    motion: Result,
    responses: Sequence[Response],
    wrt: Sequence[str] | None = None,
    method: Method = "auto",
) -> np.ndarray:
    """(responses, parameters) gradient without labels and notes, as used by optimisers.

    At a kink the derivatives are one-sided; see ``sensitivity`` for the parameters and exceptions.
    """
    refuse_unfinished(motion)
    columns = chosen_columns(motion, wrt)
    terms, weights = expanded(responses)
    strategy = _strategy(method, len(terms), len(columns))
    return np.asarray(weights @ _values(motion, terms, columns, strategy))


def chosen_columns(motion: Result | Batch, wrt: Sequence[str] | None) -> list[int]:
    """Numbers of the parameters with these names, without repetition; all if ``wrt`` is None.

    Raises
    ------
    AnalysisError
        Unknown parameter, or no parameter.
    """
    names = {name: k for k, name in enumerate(motion.model.parameters)}
    if not names:
        raise AnalysisError(f"{motion.model.name} has no parameters to differentiate by; add some")
    requested = [wrt] if isinstance(wrt, str) else names if wrt is None else wrt
    chosen = list(dict.fromkeys(requested))
    if not chosen:
        raise AnalysisError(f"no parameter is chosen; choose some of {', '.join(names)}")
    for name in chosen:
        if name not in names:
            raise AnalysisError(f"unknown parameter {name!r} (known: {', '.join(names)})")
    return [names[n] for n in chosen]


def _values(motion: Result, responses, columns: list[int], strategy) -> np.ndarray:
    values = strategy.gradient(motion, responses, columns).reshape(len(responses), len(columns))
    if not np.all(np.isfinite(values)):
        r, i = (int(k[0]) for k in np.nonzero(~np.isfinite(values)))
        name = list(motion.model.parameters)[columns[i]]
        raise AnalysisError(
            f"the derivative of {responses[r].label} by {name} is {values[r, i]}: the measure has "
            "no derivative at some state of the run, as a root has none at zero; use another "
            "measure or instant"
        )
    return values


def _labelled_array(
    motion: Result | Batch, responses, columns, values: np.ndarray, strategy
) -> xr.DataArray:
    """Gradient labelled with names, units and values; of a batch for every design."""
    import xarray as xr

    model, outer = motion.model, dict[str, Any]()
    every_parameter = list(model.parameters.values())
    parameters = [every_parameter[i] for i in columns]
    if isinstance(motion, Batch):
        example, outer = representative(motion), motion.designs.coords
        arrays = [batch_response(motion, response, example) for response in responses]
        units = [array.attrs["units"] for array in arrays]
        response_values = np.column_stack([array.values for array in arrays])
        parameter_values, dims = motion.designs.values[:, columns], ["design"]
    else:
        units = [_unit(motion, response) for response in responses]
        response_values = np.array([evaluate(motion, response) for response in responses])
        parameter_values, dims = motion.parameters[columns], []
    coordinates = outer | {
        "response": [r.label for r in responses],
        "parameter": [p.name for p in parameters],
        "response_unit": ("response", units),
        "response_value": ([*dims, "response"], response_values),
        "parameter_unit": ("parameter", [p.unit for p in parameters]),
        "parameter_value": ([*dims, "parameter"], parameter_values),
        "lower": ("parameter", [p.bounds[0] for p in parameters]),
        "upper": ("parameter", [p.bounds[1] for p in parameters]),
    }
    for name in ("response", "parameter"):
        if name in outer:  # a varied parameter of this name
            del coordinates[name]
    attrs = {"method": type(strategy).__name__, "model": model.name}
    return xr.DataArray(values, coordinates, [*dims, "response", "parameter"], "gradient", attrs)


def _strategy(
    method: Method, responses: int, parameters: int
) -> Direct | Adjoint | FiniteDifference:
    if isinstance(method, str):
        if method not in METHODS:
            raise AnalysisError(f"unknown method {method!r}; choose one of {', '.join(METHODS)}")
        method = METHODS[method]
    if not isinstance(method, Strategy):
        raise AnalysisError(f"method is {method!r}; give a name or an object such as da.Adjoint()")
    return method.choose(responses, parameters) if isinstance(method, Automatic) else method


def _unit(motion: Result, response: Response) -> str:
    return response.adapted_to(motion).unit_of(motion)


def refuse_unfinished(motion: Result) -> None:
    if not motion.status.success:
        raise AnalysisError(f"no gradient of a run that failed: {motion.status}")
    refuse_unlocated(motion)


def refuse_unknown_values(motion: Result, responses: Sequence[Response]) -> None:
    """Raise if the value of a response is not finite.

    Raises
    ------
    AnalysisError
        Names the response.
    """
    for response in responses:
        value = evaluate(motion, response)
        if not np.isfinite(value):
            raise AnalysisError(
                f"response {response.label} is {value} in this run and has no gradient; use a "
                "measure that this analysis computes at all instants (kinematics computes no "
                "forces, inverse dynamics does), or another instant"
            )


def history_gradients(
    motion: Result, measures: Sequence[str | Expression], wrt: Sequence[str]
) -> list[np.ndarray]:
    """(K, parameters) derivatives of each scalar measure at the outputs of a result.

    Raises
    ------
    AnalysisError
        A run that failed, or an unknown parameter.
    """
    refuse_unfinished(motion)
    columns, motion = chosen_columns(motion, wrt), with_stable_steps(motion)
    samples = [_history(motion, measure) for measure in measures]
    return engine_for(motion)(samples).of_samples(columns)


def history_rates(motion: Result, measure: str | Expression) -> np.ndarray:
    """(K,) ``ṁ`` at the outputs of a result."""
    motion = with_stable_steps(motion)
    sample = _history(motion, measure)
    engine = engine_for(motion)([sample])
    return np.array([engine.rate(sample, k) for k in range(motion.time.size)])


def _history(motion: Result, measure: str | Expression) -> Sample:
    """Sample with all outputs of a result, each with weight 1."""
    expression = motion.expression(measure)
    count = motion.time.size
    zeros = np.zeros(count)
    return Sample(At(measure), motion, expression, 0.0, np.ones(count), zeros, zeros)
