"""The front door: gradients of responses with respect to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, cast

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, as_responses
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome
from dalembert.results.structural import StructuralResult
from dalembert.sensitivity.finite_difference import FiniteDifference
from dalembert.sensitivity.methods import METHODS, Adjoint, Automatic, Direct, Method

if TYPE_CHECKING:
    import xarray as xr


def sensitivity(
    motion: Motion | StructuralResult,
    responses: Response | Sequence[Response],
    wrt: Sequence[str] | None = None,
    method: Method = "auto",
) -> xr.DataArray:
    """Gradient of responses with respect to parameters, ``response × parameter``.

    The gradient is the exact derivative of the steps taken (step lengths frozen).

    Parameters
    ----------
    motion : result of ``solve_dynamics``, ``solve_kinematics``, ``solve_inverse_dynamics``,
        ``solve_equilibrium`` or ``solve_statics``
    responses : one or several
    wrt : names of parameters; all by default
    method : ``"auto"``, ``"adjoint"``, ``"direct"``, ``"finite-difference"`` or a strategy object

    Raises
    ------
    AnalysisError
        Unknown parameter or method; a run that failed or ended by an event.
    """
    import xarray as xr

    motion = cast(Motion, motion)  # a structural result answers to the same names
    listed = as_responses(responses)
    names = list(motion.model.parameters)
    chosen = names if wrt is None else list(wrt)
    for name in chosen:
        if name not in names:
            raise AnalysisError(f"unknown parameter {name!r} (known: {', '.join(names) or 'none'})")
    strategy = _strategy(method, len(listed), len(chosen))
    _refuse_unfinished(motion)
    values = strategy.gradient(motion, listed, [names.index(n) for n in chosen])
    units = [_unit(motion, r) for r in listed]
    return xr.DataArray(
        values.reshape(len(listed), len(chosen)),
        dims=("response", "parameter"),
        coords={
            "response": [r.label for r in listed],
            "parameter": chosen,
            "response_unit": ("response", units),
            "parameter_unit": ("parameter", [motion.model.parameters[n].unit for n in chosen]),
        },
        name="gradient",
        attrs={"method": type(strategy).__name__, "model": motion.model.name},
    )


def _strategy(
    method: Method, responses: int, parameters: int
) -> Direct | Adjoint | FiniteDifference:
    if isinstance(method, str):
        if method not in METHODS:
            raise AnalysisError(f"unknown method {method!r}; choose one of {', '.join(METHODS)}")
        method = METHODS[method]
    return method.choose(responses, parameters) if isinstance(method, Automatic) else method


def _unit(motion: Motion, response: Response) -> str:
    return response.unit(motion.expression(response.measure).unit)


def _refuse_unfinished(motion: Motion) -> None:
    outcome = motion.status.outcome
    if outcome is Outcome.TERMINATED:
        raise AnalysisError(
            f"the run ended by an event ({motion.status.message}), whose time depends on the "
            "parameters; a gradient at fixed time does not exist there: drop the terminal event"
        )
    if not motion.status.success:
        raise AnalysisError(f"no gradient of a run that failed: {motion.status}")
