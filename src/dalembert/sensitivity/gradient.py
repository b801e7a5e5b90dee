"""The front door: gradients of responses with respect to parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, cast

import numpy as np

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.equilibrium import Equilibrium
from dalembert.analysis.kinematics import Kinematics
from dalembert.analysis.nonlinear_statics import NonlinearStatics
from dalembert.analysis.statics import Statics
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.responses.base import Response, as_responses
from dalembert.results.motion import Motion
from dalembert.results.status import Outcome
from dalembert.results.structural import StructuralResult
from dalembert.sensitivity.adjoint_march import AdjointMarch
from dalembert.sensitivity.direct_march import DirectMarch
from dalembert.sensitivity.finite_difference import FiniteDifference
from dalembert.sensitivity.pointwise import PointwiseGradient
from dalembert.sensitivity.samples import Sample, take_sample
from dalembert.sensitivity.statics import StaticsGradient

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Direct:
    """Direct differentiation: cost grows with the number of parameters."""

    def gradient(
        self, motion: Motion, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        samples = [take_sample(motion, r) for r in responses]
        if _marches(motion):
            marches = [DirectMarch(sample) for sample in samples]
            changes = marches[0].changes() if marches else []
            rows = [march.gradient(changes) for march in marches]
        else:
            rows = [_instants(sample).direct() for sample in samples]
        return np.array(rows)[:, list(columns)]


@dataclass(frozen=True)
class Adjoint:
    """Adjoint method: cost grows with the number of responses."""

    def gradient(
        self, motion: Motion, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        samples = [take_sample(motion, r) for r in responses]
        if _marches(motion):
            rows = [AdjointMarch(sample).gradient() for sample in samples]
        else:
            rows = [_instants(sample).adjoint() for sample in samples]
        return np.array(rows)[:, list(columns)]


@dataclass(frozen=True)
class Automatic:
    """Adjoint unless there are fewer parameters than responses."""

    def choose(self, responses: int, parameters: int) -> Direct | Adjoint:
        """The cheaper method for these numbers."""
        return Direct() if parameters < responses else Adjoint()


Strategy = Direct | Adjoint | Automatic | FiniteDifference
Method = str | Strategy

METHODS: dict[str, Strategy] = {
    "auto": Automatic(),
    "adjoint": Adjoint(),
    "direct": Direct(),
    "finite-difference": FiniteDifference(),
}


def _marches(motion: Motion) -> bool:
    """Whether the motion was integrated, so that its samples depend on all steps before them."""
    if isinstance(motion.analysis, (Dynamics, Kinematics, Equilibrium, Statics, NonlinearStatics)):
        return isinstance(motion.analysis, Dynamics)
    raise UnsupportedError(
        f"gradients of {type(motion.analysis).__name__} are not available; use "
        "method='finite-difference'"
    )


def _instants(sample: Sample) -> PointwiseGradient | StaticsGradient:
    """The engine of results whose samples stand for themselves."""
    if isinstance(sample.motion.analysis, (Statics, NonlinearStatics)):
        return StaticsGradient(sample)
    return PointwiseGradient(sample)


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
