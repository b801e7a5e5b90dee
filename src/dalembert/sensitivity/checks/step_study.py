"""Step studies: error of difference quotients over their step (Tables 8.1 and 8.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.checks.finite_difference import Replays
from dalembert.sensitivity.checks.stencils import (
    SCHEMES,
    checked_step,
    parameter_scale,
    quotient_within_bounds,
)
from dalembert.sensitivity.gradient import sensitivity
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr

STEPS = tuple(float(f"1e-{k}") for k in range(1, 13))
"""Relative steps from truncation error to round-off [-]."""


@dataclass(frozen=True, eq=False, repr=False)
class StepStudy:
    """Difference quotients of one response by one parameter over their steps.

    ``data`` holds over ``scheme × step`` the ``value``, its ``error`` against the exact derivative
    (``exact``) and the ``relative_error``; NaN if a run failed or a step did not fit, with the
    reasons in ``attrs["notes"]``. ``step`` is relative, ``length`` in the unit of the parameter.

    Parameters
    ----------
    data : Dataset as described above

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 3.0, "m/s")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(speed, 10)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> study = da.step_study(motion, da.final("stone.x**2"), "speed", steps=[0.1, 0.01])
    >>> isinstance(study, da.StepStudy)
    True
    >>> study.data["value"].sel(scheme="forward").values.round(6)  # 2 v + h
    array([6.3 , 6.03])
    """

    data: xr.Dataset

    @property
    def exact(self) -> float:
        """Derivative by the adjoint or direct method."""
        return float(self.data["exact"])

    def best(self) -> dict[str, float]:
        """Scheme → the step with the smallest error."""
        error = self.data["error"].fillna(np.inf)
        steps = self.data["step"].values[error.argmin("step").values]
        return dict(zip(map(str, self.data["scheme"].values), map(float, steps), strict=True))

    def plot(self, ax: Any = None) -> Any:
        """Plot errors over steps with Matplotlib, log-log; returns the axes."""
        from dalembert.results.pictures.plot import plot_step_study

        return plot_step_study(self.data, ax)

    def __repr__(self) -> str:
        a = self.data.attrs
        best = ", ".join(f"{scheme} {step:.0e}" for scheme, step in self.best().items())
        return (
            f"<StepStudy of d {a['response']} / d {a['parameter']} = {self.exact:.9g}; "
            f"best relative steps: {best}>"
        )

    def _repr_html_(self) -> str:
        return self.data._repr_html_()


@check_arguments
def step_study(
    result: Result,
    response: Response,
    parameter: str,
    steps: Sequence[float] = STEPS,
    schemes: Sequence[str] = tuple(SCHEMES),
) -> StepStudy:
    """Finite differences over their steps, compared with the exact derivative of the same run.

    Parameters
    ----------
    result : result of an analysis with gradients
    response, parameter : the derivative to study
    steps : relative steps, as in ``FiniteDifference``
    schemes : names, see ``FiniteDifference``

    Raises
    ------
    AnalysisError, UnsupportedError
        Unknown parameter or scheme, a step that is not positive; see also ``sensitivity``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 2.0, "m/s")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(speed, 10)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> study = da.step_study(motion, da.final("stone.x**3"), "speed", steps=[0.1, 0.01])
    >>> errors = study.data["error"].sel(scheme="central").values
    >>> round(errors[0] / errors[1])  # order 2
    100
    """
    motion = result
    for scheme in schemes:
        for step in steps:
            checked_step(scheme, step)
    gradient = sensitivity(motion, response, [parameter])
    column = list(motion.model.parameters).index(parameter)
    quotients, notes = _quotients(Replays(motion, [response]), column, schemes, steps)
    scale = parameter_scale(motion.model.parameters[parameter], float(motion.parameters[column]))
    coordinates = {
        "scheme": list(schemes),
        "step": list(steps),
        "length": ("step", scale * np.asarray(steps, dtype=float)),
    }
    return StepStudy(_dataset(gradient, quotients, coordinates).assign_attrs(notes=notes))


def _quotients(
    values: Replays, column: int, schemes: Sequence[str], steps: Sequence[float]
) -> tuple[np.ndarray, list[str]]:
    """(schemes, steps) quotients, and notes on missing or one-sided quotients."""
    quotients, notes = np.full((len(schemes), len(steps)), np.nan), dict[str, None]()
    for i, scheme in enumerate(schemes):
        for k, step in enumerate(steps):
            try:
                quotient = quotient_within_bounds(values.motion, column, scheme, step)
                quotients[i, k] = quotient.evaluate(values.parameters, values)[0]
                notes |= {quotient.note: None} if quotient.note else {}
            except AnalysisError as error:
                notes[str(error)] = None
    return quotients, list(notes)


def _dataset(
    gradient: xr.DataArray, quotients: np.ndarray, coordinates: dict[str, Any]
) -> xr.Dataset:
    """Quotients and their errors against the exact derivative."""
    import xarray as xr

    exact, unit = float(gradient.values[0, 0]), {"units": _quotient_unit(gradient)}
    errors, dims = np.abs(quotients - exact), ("scheme", "step")
    data = {
        "value": (dims, quotients, unit),
        "error": (dims, errors, unit),
        "relative_error": (dims, errors / abs(exact) if exact else errors * np.nan),
        "exact": ((), exact, unit),
    }
    attrs = {name: str(gradient[name].values[0]) for name in ("response", "parameter")}
    return xr.Dataset(data, coordinates, attrs | {"model": gradient.attrs["model"]})


def _quotient_unit(gradient: xr.DataArray) -> str:
    numerator = str(gradient["response_unit"].values[0])
    denominator = str(gradient["parameter_unit"].values[0])
    if not denominator:
        return numerator
    if any(c in denominator for c in " /"):
        denominator = f"({denominator})"
    return f"{numerator or '1'}/{denominator}"
