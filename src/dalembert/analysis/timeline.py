"""Times of a run: checked spans, steps and outputs."""

from __future__ import annotations

import math
from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.elements.planar.drivers import Driver
from dalembert.errors import AnalysisError
from dalembert.model.model import Model


def checked_span(duration: float | None, t_span: tuple[float, float] | None) -> tuple[float, float]:
    """Start and end of a run from ``duration`` or ``t_span``.

    Raises
    ------
    AnalysisError
        Neither or both given, not finite, or the end not after the start.
    """
    if (duration is None) == (t_span is None):
        raise AnalysisError("give either duration or t_span")
    start, end = (0.0, float(duration)) if t_span is None else (float(t) for t in t_span)  # type: ignore[arg-type]
    if not (math.isfinite(start) and math.isfinite(end)):
        raise AnalysisError(f"the time span {start}…{end} s is not finite")
    if end <= start:
        what = (
            f"duration is {duration}"
            if t_span is None
            else f"t_span ends at {end}, starts at {start}"
        )
        raise AnalysisError(f"{what}; the end must come after the start")
    return start, end


def checked_step(step: float | None, start: float, end: float) -> float:
    """Step length, a thousandth of the span if none is given."""
    if step is None:
        return (end - start) / 1000
    if not (math.isfinite(step) and step > 0):
        raise AnalysisError(f"step is {step}; it must be a positive number of seconds")
    return min(float(step), end - start)


def uniform_grid(start: float, end: float, step: float) -> np.ndarray:
    """Times from start to end in steps of ``step``; the last one may be shorter."""
    count = max(1, math.ceil((end - start) / step - 1e-9))
    if count > 50_000_000:
        raise AnalysisError(f"{count:.3g} steps are too many; use a longer step than {step:g} s")
    times = start + step * np.arange(count + 1)
    times[-1] = end
    return times


def check_driver_laws(model: Model, times: np.ndarray, p: np.ndarray) -> None:
    """Drivers of a distance must never be asked for zero or less.

    Raises
    ------
    AnalysisError
        Names the driver, the value and the time.
    """
    for driver in model.constraints:
        if isinstance(driver, Driver) and driver.positive:
            e = model.equations
            law = ca.Function("law", [e.t, e.p], [ca.densify(driver.law.value(e.t))])
            looked = times[:: max(1, times.size // 2000)]
            values = np.array([float(law(t, p)) for t in looked])
            if np.any(~(values > 0)):
                k = int(np.argmin(values > 0))
                raise AnalysisError(
                    f"{driver.name}: its law asks for a distance of {values[k]:g} m at "
                    f"t = {looked[k]:g} s; a distance must stay above 0"
                )


def output_times(
    outputs: int | Sequence[float] | np.ndarray | None, start: float, end: float
) -> np.ndarray | None:
    """Requested times: a count, a list, or None for every step."""
    if outputs is None:
        return None
    if isinstance(outputs, (int, np.integer)) and not isinstance(outputs, bool):
        if outputs < 1:
            raise AnalysisError(f"outputs is {outputs}; ask for at least one")
        return np.linspace(start, end, int(outputs)) if outputs > 1 else np.array([end])
    times = np.asarray(outputs, dtype=float).ravel()
    if not times.size or not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0):
        raise AnalysisError("output times must be finite and increasing")
    slack = 1e-12 * max(abs(start), abs(end))
    if times[0] < start - slack or times[-1] > end + slack:
        raise AnalysisError(
            f"output times {times[0]:g}…{times[-1]:g} s leave the run {start:g}…{end:g} s"
        )
    return np.clip(times, start, end)


def check_times(
    duration: float | None,
    t_span: tuple[float, float] | None,
    step: float | None,
    outputs: int | Sequence[float] | None,
) -> None:
    """Span, step and outputs of an analysis over time fit each other.

    Raises
    ------
    AnalysisError
        They do not.
    """
    start, end = checked_span(duration, t_span)
    checked_step(step, start, end)
    output_times(outputs, start, end)
