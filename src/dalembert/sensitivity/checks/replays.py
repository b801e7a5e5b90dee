"""Responses of a run at other parameter values: same steps, same branch."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.responses.base import Response, evaluate
from dalembert.results.result import Result
from dalembert.sensitivity.marching.stable_steps import with_stable_steps


@dataclass
class Replays:
    """Responses as functions of the parameters of a run; each point is computed once.

    Parameters
    ----------
    motion : the run that is repeated
    responses : what is drawn from it
    """

    motion: Result
    responses: Sequence[Response]
    _known: dict[bytes, np.ndarray] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self.motion = with_stable_steps(self.motion)

    @property
    def parameters(self) -> np.ndarray:
        """(np,) of the run."""
        return self.motion.parameters

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """(responses,) values at parameters ``p``.

        Raises
        ------
        AnalysisError
            The run cannot be repeated there; names what changed.
        """
        p = self.motion.model.values(p)
        key = p.tobytes()
        if key not in self._known:
            self._known[key] = self._values(p)
        return self._known[key]

    def _values(self, p: np.ndarray) -> np.ndarray:
        if np.array_equal(p, self.parameters):
            return np.array([evaluate(self.motion, r) for r in self.responses])
        try:
            repeated = self.motion.analysis.replay(self.motion, p)
            values = np.array([evaluate(repeated, r) for r in self.responses])
        except AnalysisError as error:
            raise AnalysisError(f"{self._where(p)}: {error}; give a shorter step") from error
        if not repeated.status.success:
            raise AnalysisError(
                f"{self._where(p)}: the run does not succeed ({repeated.status}); "
                "give a shorter step"
            )
        wrong = [r.label for r, v in zip(self.responses, values, strict=True) if not np.isfinite(v)]
        if wrong:
            raise AnalysisError(
                f"{self._where(p)}: no finite value of {', '.join(wrong)}; give a shorter step"
            )
        return values

    def _where(self, p: np.ndarray) -> str:
        listed = zip(self.motion.model.parameters, p, self.parameters, strict=False)
        changed = [f"{name} = {new:.9g}" for name, new, old in listed if new != old]
        return f"the run repeated at {', '.join(changed[:4])}{', …' if changed[4:] else ''}"
