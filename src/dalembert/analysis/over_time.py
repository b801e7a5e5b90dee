"""Base of the analyses of a mechanism over a span of time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, ClassVar, Protocol

import numpy as np

from dalembert.analysis.timeline import check_times
from dalembert.analysis.times import retimed
from dalembert.model.model import Model
from dalembert.options import inherit_texts, options
from dalembert.results.result import Analysis, R


class Execution(Protocol):
    """One execution of an analysis."""

    def __init__(self, analysis: Any, model: Model, parameters: Any): ...

    def execute(self, progress: Any) -> Any:
        """The result."""


@options
class OverTime(Analysis[Model, R]):
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

    execution: ClassVar[type[Execution]]
    """Class whose objects execute one run."""

    duration: float | None = None
    step: float | None = None
    outputs: int | Sequence[float] | None = None
    t_span: tuple[float, float] | None = None

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        inherit_texts(cls)

    def checks(self, model: Model) -> dict[str, Callable[[], object]]:
        """Checks by the name of the option."""
        return {
            "duration": lambda: check_times(self.duration, self.t_span, self.step, self.outputs)
        }

    def run(
        self,
        model: Model,
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
        analysis = retimed(self, model, parameters)
        result: R = self.execution(analysis, model, parameters).execute(progress)
        return result
