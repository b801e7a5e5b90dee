"""The design problem (8.41): responses of an analysis as functions of scaled parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, evaluate
from dalembert.results.result import Analysis, Result
from dalembert.results.status import Outcome
from dalembert.sensitivity.gradient import gradient_values
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel


@dataclass
class Evaluation:
    """Responses and their gradients at one design."""

    values: np.ndarray
    gradient: np.ndarray | None
    motion: Result

    def slope(self, row: int) -> np.ndarray:
        """(vary,) gradient of one response, of an evaluation that was asked for it."""
        assert self.gradient is not None
        return self.gradient[row]


@dataclass
class DesignProblem:
    """``p ↦ responses, gradient``: what every optimiser needs to know.

    Parameters
    ----------
    model, analysis : what is run for every design
    responses : all responses needed, objective first
    vary : names of the parameters that vary
    method : of ``sensitivity``
    """

    model: ParametricModel
    analysis: Analysis
    responses: Sequence[Response]
    vary: Sequence[str]
    method: Method = "auto"
    on_run: Callable[[], None] = lambda: None
    runs: int = 0
    failures: list[str] = field(default_factory=list)
    _cache: dict[bytes, Evaluation | None] = field(default_factory=dict)

    def parameters(self, x: np.ndarray) -> dict[str, float]:
        """Parameter values of a design."""
        return dict(zip(self.vary, (float(v) for v in x), strict=True))

    def evaluate(self, x: np.ndarray, gradient: bool = True) -> Evaluation | None:
        """Responses (and gradient) at ``x``; None where the run fails, with the reason kept."""
        key = np.asarray(x, dtype=float).tobytes()
        if key not in self._cache:
            self._cache[key] = self._run(x)
            if len(self._cache) > 64:
                self._cache.pop(next(iter(self._cache)))
        found = self._cache[key]
        if found is not None and gradient and found.gradient is None:
            found.gradient = gradient_values(found.motion, self.responses, self.vary, self.method)
        return found

    def _run(self, x: np.ndarray) -> Evaluation | None:
        self.runs += 1
        self.on_run()
        try:
            motion = self.analysis.run(self.model, self.parameters(x))
        except AnalysisError as error:
            self.failures.append(str(error))
            return None
        if motion.status.outcome is Outcome.INTERRUPTED:
            raise KeyboardInterrupt
        if not motion.status.success:
            self.failures.append(str(motion.status))
            return None
        try:
            values = np.array([evaluate(motion, r) for r in self.responses])
        except AnalysisError as error:  # an event that does not happen with these parameters
            self.failures.append(str(error))
            return None
        if not np.all(np.isfinite(values)):
            self.failures.append("a response is not finite")
            return None
        return Evaluation(values, None, motion)
