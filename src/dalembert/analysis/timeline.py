"""Analyses over a span of time: checked spans, steps and outputs, and their base class."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, Protocol

import casadi as ca
import numpy as np

from dalembert.analysis.times import evaluate_times
from dalembert.budget import STEP, check_budget, numeral
from dalembert.elements.driver import Driver
from dalembert.errors import AnalysisError, BudgetError
from dalembert.model.graph.model import Model
from dalembert.options import inherit_texts, options
from dalembert.results.analysis import Analysis, R

OUTPUT = 400
"""Minimum memory of an output of any model [bytes]."""
GROWTH = 1000.0
"""Factor by which the steps of a run may grow later."""
MIN_STEPS = 2000
"""Threshold of the number of steps above which the rest of a run is estimated."""


def checked_span(duration: float | None, t_span: tuple[float, float] | None) -> tuple[float, float]:
    """Start and end of a run from ``duration`` or ``t_span``.

    Raises
    ------
    AnalysisError
        Neither or both given, not numbers, not finite, or the end not after the start.
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
        span = (
            f"duration is {duration}"
            if t_span is None
            else f"t_span ends at {end}, starts at {start}"
        )
        raise AnalysisError(f"{span}; the end must come after the start")
    return start, end


def checked_step(step: float | None, start: float, end: float) -> float:
    """Step length, a thousandth of the span if none is given."""
    if step is None:
        return (end - start) / 1000
    if not (math.isfinite(step) and step > 0):
        raise AnalysisError(f"step is {step}; it must be a positive number of seconds")
    return min(float(step), end - start)


def step_count(start: float, end: float, step: float) -> int:
    """Number of steps from start to end.

    Raises
    ------
    AnalysisError
        The step is below the rounding of the times.
    BudgetError
        More steps than the budget allows.
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
    """Memory estimate of a run with error control, updated as the run proceeds.

    Accepted steps count as they are. The remaining ones are estimated from the newer half of the
    accepted steps, once these are many: first steps may be short by any factor, at a contact or
    from a cautious first step length.

    Parameters
    ----------
    start, end : of the run [s]
    step_bytes : memory of a step
    """

    def __init__(self, start: float, end: float, step_bytes: float):
        self.end, self.step_bytes = end, step_bytes
        self.accepted = 0
        self.excess = ""
        self._marks = [(0, start), (0, start)]

    def exceeds(self, ends: np.ndarray) -> bool:
        """Whether the run will exceed the budget; ``ends`` are the ends of the latest steps."""
        self.accepted += ends.size - 1
        now = float(ends[-1])
        if self.accepted >= 2 * max(self._marks[1][0], MIN_STEPS // 2):
            self._marks = [self._marks[1], (self.accepted, now)]
        before, earlier = self._marks[0]
        cure = "use looser tolerances or a shorter run"
        try:
            check_budget(
                f"a run of {self.accepted} steps", memory=self.step_bytes * self.accepted, cure=cure
            )
            if self.accepted >= MIN_STEPS and now > earlier:
                recent = self.accepted - before
                expected = self.accepted + recent * (self.end - now) / (now - earlier)
                pace = f"at the pace of the last {recent} steps the run of {expected:.3g}"
                check_budget(pace, memory=self.step_bytes * expected, cure=cure, margin=GROWTH)
        except BudgetError as error:
            self.excess = str(error)
        return bool(self.excess)


def afford_states(count: int, numbers: int) -> None:
    """Raise if ``count`` outputs of ``numbers`` values exceed the budget."""
    cure = "request fewer, e.g. outputs=1001"
    check_budget(f"{count} outputs of {numbers} numbers", memory=8.0 * count * numbers, cure=cure)


def uniform_grid(start: float, end: float, step: float) -> np.ndarray:
    """Times from start to end in steps of ``step``; the last step may be shorter."""
    count = step_count(start, end, step)
    times = start + step * np.arange(count + 1)
    times[-1] = end
    return times


def check_driver_laws(model: Model, times: np.ndarray, p: np.ndarray) -> None:
    """Raise where the law of a distance driver is zero or negative.

    Raises
    ------
    AnalysisError
        Names the driver, the value and the time.
    """
    for driver in model.constraints:
        if isinstance(driver, Driver) and driver.positive:
            e = model.equations
            law = ca.Function("law", [e.t, e.p], [ca.densify(driver.law.value(e.t))])
            samples = times[:: max(1, times.size // 2000)]
            values = (
                law.map(samples.size)(samples, np.tile(p[:, None], samples.size)).full().ravel()
            )
            if np.any(~(values > 0)):
                k = int(np.argmin(values > 0))
                raise AnalysisError(
                    f"{driver.name}: its law gives a distance of {values[k]:g} m at "
                    f"t = {samples[k]:g} s; a distance must stay above 0"
                )


def output_times(
    outputs: int | Sequence[float] | np.ndarray | None, start: float, end: float
) -> np.ndarray | None:
    """Requested times: a count, a list, or None for every step."""
    if outputs is None:
        return None
    if isinstance(outputs, (int, np.integer)) and not isinstance(outputs, bool):
        if outputs < 1:
            raise AnalysisError(f"outputs is {numeral(outputs)}; request at least one")
        entity = f"outputs = {numeral(outputs)}"
        check_budget(entity, memory=OUTPUT * outputs, cure="request fewer outputs")
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


class RunTimes(NamedTuple):
    """Start and end of a run, length of its steps, and its output times, None for every step."""

    start: float
    end: float
    step: float
    outputs: np.ndarray | None


def run_times(analysis: Any) -> RunTimes:
    """The times of an analysis over time.

    Raises
    ------
    AnalysisError
        Span, step and outputs are not consistent.
    """
    start, end = checked_span(analysis.duration, analysis.t_span)
    step = checked_step(analysis.step, start, end)
    return RunTimes(start, end, step, output_times(analysis.outputs, start, end))


class Execution(Protocol):
    """One execution of an analysis."""

    def __init__(self, analysis: Any, model: Any, parameters: Any): ...

    def execute(self, progress: Any) -> Any:
        """The result."""


@options
class OverTime(Analysis[Any, R]):
    """An analysis from one time to another.

    Parameters
    ----------
    duration : length of the run from t = 0 [s]; this or ``t_span``. Times given as formulas follow
        the parameters of each run, and so do gradients
    t_span : (start, end) of the run [s]
    step : step length, by default a thousandth of the run [s]
    outputs : number of equally spaced times, or the times [s]; by default every step, under error
        control also instants inside steps, so that straight lines between outputs follow the motion
    """

    executions: ClassVar[dict[str, Callable[..., Execution]]]
    """Kind of model → executor of one run, from analysis, model and parameters."""

    duration: float | None = None
    step: float | None = None
    outputs: int | Sequence[float] | None = None
    t_span: tuple[float, float] | None = None

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        inherit_texts(cls)

    def checks(self, model: Any) -> dict[str, Callable[[], object]]:
        """Checks by the name of the option."""

        def span() -> tuple[float, float]:
            return checked_span(self.duration, self.t_span)

        return {
            **super().checks(model),
            "duration" if self.t_span is None else "t_span": span,
            "step": lambda: checked_step(self.step, *span()),
            "outputs": lambda: run_times(self),
        }

    def run(
        self,
        model: Any,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> R:
        """Run from start to end; a failed run keeps its states, and its status says when and why.

        Raises
        ------
        AnalysisError
            Wrong step, duration or outputs, or nothing to compute.
        AssemblyError, SingularityError, UnsupportedError
            The run cannot begin.
        """
        analysis = evaluate_times(self.for_model(model), model, parameters)
        result: R = analysis.executions[model.kind](analysis, model, parameters).execute(progress)
        return result
