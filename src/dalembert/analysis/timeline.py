"""Times of a run: checked spans, steps and outputs."""

from __future__ import annotations

import math
from collections.abc import Sequence

import casadi as ca
import numpy as np

from dalembert.budget import STEP, check_budget, numeral
from dalembert.elements.driver import Driver
from dalembert.errors import AnalysisError, BudgetError
from dalembert.model.model import Model

OUTPUT = 400
"""Bytes of an output at least, whatever the model."""
HASTE = 1000.0
"""Factor by which the steps of a run may grow beyond their present length."""
FEW = 2000
"""Steps of a run below which the rest is not estimated."""


def checked_span(duration: float | None, t_span: tuple[float, float] | None) -> tuple[float, float]:
    """Start and end of a run from ``duration`` or ``t_span``.

    Raises
    ------
    AnalysisError
        Neither or both given, no numbers, not finite, or the end not after the start.
    """
    if (duration is None) == (t_span is None):
        raise AnalysisError("give either duration or t_span")
    try:
        start, end = (0.0, float(duration)) if t_span is None else map(float, t_span)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise AnalysisError(f"t_span is {t_span!r:.60}; give (start, end) in seconds") from None
    if not math.isfinite(end - start):
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


def step_count(start: float, end: float, step: float) -> int:
    """Steps from start to end.

    Raises
    ------
    AnalysisError
        Steps that times do not resolve.
    BudgetError
        More than a task may take.
    """
    if start + step == start or end - step == end:
        raise AnalysisError(
            f"steps of {step:g} s are lost in the rounding of times from {start:g} to {end:g} s; "
            "use longer ones, or times nearer to 0"
        )
    ratio = (end - start) / step
    cure = "use a longer step or a shorter run"
    check_budget(f"{ratio:.3g} steps of {step:g} s", memory=STEP * ratio, cure=cure)
    return max(1, math.ceil(ratio - 1e-9))


class Pace:
    """Memory that a run with error control needs, which shows only as it goes on.

    The steps taken count as they are. The rest is estimated from the newer half of them, and only
    of many: first steps may be short by any factor, at a contact or from a cautious first guess.

    Parameters
    ----------
    start, end : of the run [s]
    each : bytes that a step takes
    """

    def __init__(self, start: float, end: float, each: float):
        self.end, self.each = end, each
        self.taken = 0
        self.excess = ""
        self._marks = [(0, start), (0, start)]

    def exceeds(self, ends: np.ndarray) -> bool:
        """Whether the steps, of which these are the last ends, lead to more than can be kept."""
        self.taken += ends.size - 1
        now = float(ends[-1])
        if self.taken >= 2 * max(self._marks[1][0], FEW // 2):
            self._marks = [self._marks[1], (self.taken, now)]
        before, then = self._marks[0]
        cure = "use looser tolerances or a shorter run"
        try:
            check_budget(f"a run of {self.taken} steps", memory=self.each * self.taken, cure=cure)
            if self.taken >= FEW and now > then:
                recent = self.taken - before
                expected = self.taken + recent * (self.end - now) / (now - then)
                pace = f"at the pace of the last {recent} steps the run of {expected:.3g}"
                check_budget(pace, memory=self.each * expected, cure=cure, margin=HASTE)
        except BudgetError as error:
            self.excess = str(error)
        return bool(self.excess)


def afford_states(count: int, numbers: int) -> None:
    """Refuse more outputs than can be kept, each with so many numbers."""
    cure = "ask for fewer, e.g. outputs=1001"
    check_budget(f"{count} outputs of {numbers} numbers", memory=8.0 * count * numbers, cure=cure)


def uniform_grid(start: float, end: float, step: float) -> np.ndarray:
    """Times from start to end in steps of ``step``; the last one may be shorter."""
    count = step_count(start, end, step)
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
            values = law.map(looked.size)(looked, np.tile(p[:, None], looked.size)).full().ravel()
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
            raise AnalysisError(f"outputs is {numeral(outputs)}; ask for at least one")
        what = f"outputs = {numeral(outputs)}"
        check_budget(what, memory=OUTPUT * outputs, cure="ask for fewer outputs")
        return np.linspace(start, end, int(outputs)) if outputs > 1 else np.array([end])
    try:
        times = np.asarray([] if isinstance(outputs, bool) else outputs, dtype=float).ravel()
    except (TypeError, ValueError, OverflowError):
        times = np.zeros(0)
    if not times.size or not np.all(np.isfinite(times)) or np.any(np.diff(times) <= 0):
        raise AnalysisError("outputs must be a count, or finite and increasing times")
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
