"""Step studies: how good difference quotients are, step by step (Tables 8.1 and 8.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.checks.replays import Replays
from dalembert.sensitivity.checks.scales import parameter_scale
from dalembert.sensitivity.checks.stencils import SCHEMES, checked_step, place
from dalembert.sensitivity.gradient import sensitivity
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    import xarray as xr

STEPS = tuple(float(f"1e-{k}") for k in range(1, 13))
"""Relative steps that show truncation, the best place and round-off."""


@dataclass(frozen=True, eq=False, repr=False)
class StepStudy:
    """Difference quotients of one response by one parameter over their steps.

    ``data`` holds over ``scheme × step`` the ``value``, its ``error`` against the exact derivative
    (``exact``) and the ``relative_error``; not a number where a run failed or a step did not fit,
    for the reasons in ``attrs["notes"]``. ``step`` is relative, ``length`` in the parameter's unit.

    Parameters
    ----------
    data : Dataset, see above

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
        """The derivative by the adjoint or direct method."""
        return float(self.data["exact"])

    def best(self) -> dict[str, float]:
        """Scheme → the step with the smallest error."""
        error = self.data["error"].fillna(np.inf)
        steps = self.data["step"].values[error.argmin("step").values]
        return dict(zip(map(str, self.data["scheme"].values), map(float, steps), strict=True))

    def plot(self, ax: Any = None) -> Any:
        """Errors over steps with Matplotlib, both logarithmic; returns the axes."""
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


@spelled
def step_study(
    result: Result,
    response: Response,
    parameter: str,
    steps: Sequence[float] = STEPS,
    schemes: Sequence[str] = tuple(SCHEMES),
) -> StepStudy:
    """Finite differences over their steps, against the exact derivative of the same run.

    Parameters
    ----------
    result : of any analysis that has gradients
    response, parameter : whose derivative
    steps : relative, as those of ``FiniteDifference``
    schemes : names, see ``FiniteDifference``

    Raises
    ------
    AnalysisError, UnsupportedError
        Unknown parameter or scheme, a step that is not positive; what ``sensitivity`` raises.

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
    found, notes = _quotients(Replays(motion, [response]), column, schemes, steps)
    scale = parameter_scale(motion.model.parameters[parameter], float(motion.parameters[column]))
    coordinates = {
        "scheme": list(schemes),
        "step": list(steps),
        "length": ("step", scale * np.asarray(steps, dtype=float)),
    }
    return StepStudy(_against(gradient, found, coordinates).assign_attrs(notes=notes))


def _quotients(
    values: Replays, column: int, schemes: Sequence[str], steps: Sequence[float]
) -> tuple[np.ndarray, list[str]]:
    """(schemes, steps) quotients, and why some are missing or look to one side."""
    found, notes = np.full((len(schemes), len(steps)), np.nan), dict[str, None]()
    for i, scheme in enumerate(schemes):
        for k, step in enumerate(steps):
            try:
                quotient = place(values.motion, column, scheme, step)
                found[i, k] = quotient.evaluate(values.parameters, values)[0]
                notes |= {quotient.note: None} if quotient.note else {}
            except AnalysisError as error:
                notes[str(error)] = None
    return found, list(notes)


def _against(gradient: xr.DataArray, found: np.ndarray, coordinates: dict[str, Any]) -> xr.Dataset:
    """Quotients and their errors against the exact derivative."""
    import xarray as xr

    exact, unit = float(gradient.values[0, 0]), {"units": _quotient_unit(gradient)}
    off, dims = np.abs(found - exact), ("scheme", "step")
    data = {
        "value": (dims, found, unit),
        "error": (dims, off, unit),
        "relative_error": (dims, off / abs(exact) if exact else off * np.nan),
        "exact": ((), exact, unit),
    }
    about = {name: str(gradient[name].values[0]) for name in ("response", "parameter")}
    return xr.Dataset(data, coordinates, about | {"model": gradient.attrs["model"]})


def _quotient_unit(gradient: xr.DataArray) -> str:
    above = str(gradient["response_unit"].values[0])
    below = str(gradient["parameter_unit"].values[0])
    if not below:
        return above
    below = f"({below})" if any(c in below for c in " /") else below
    return f"{above or '1'}/{below}"
