"""Responses of a run at other parameter values, and their finite differences.

Runs with fixed steps are computed anew if their times are formulas of parameters or if they locate
impacts. All other runs are repeated with the same steps and branches: for fixed steps this is
equivalent, for adaptive steps it is free of the noise of step size control.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.times import follow_parameters
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response, evaluate
from dalembert.results.result import Result
from dalembert.sensitivity.checks.stencils import (
    Quotient,
    best_step,
    checked_step,
    quotient_within_bounds,
)
from dalembert.sensitivity.marching.stable_steps import with_stable_steps
from dalembert.sensitivity.moving_times import of_moving_times

SAME = 1e-9
"""Relative difference below which responses of two runs are equal [-]."""


def _can_rerun(motion: Result) -> bool:
    """True if a new run differs from a repeated one and has no noise of step size control."""
    analysis, kernel = motion.analysis, getattr(getattr(motion, "record", None), "kernel", None)
    if getattr(getattr(analysis, "integrator", None), "controls_error", False):
        return False
    stops = isinstance(kernel, DynamicsKernel) and kernel.contacts is not None
    return stops or follow_parameters(analysis)


@dataclass
class Replays:
    """Responses as functions of the parameters of a run, with caching.

    Parameters
    ----------
    motion : the run to repeat
    responses : the responses to evaluate

    Attributes
    ----------
    reruns : whether each point is a new run, whose times follow parameters
    """

    motion: Result
    responses: Sequence[Response]
    reruns: bool = field(init=False, default=False)
    _cache: dict[bytes, np.ndarray] = field(default_factory=dict, repr=False)

    def __post_init__(self) -> None:
        self.motion = with_stable_steps(self.motion)
        self.reruns = _can_rerun(self.motion) and self._same_again()

    def _same_again(self) -> bool:
        """True if a new run has the same responses; a continued run has not."""
        motion = self.motion
        again = motion.analysis.run(motion.model, motion.parameters)
        if not again.status.success:
            return False
        first, other = ([evaluate(m, r) for r in self.responses] for m in (motion, again))
        return bool(np.allclose(other, first, rtol=SAME, atol=0))

    @property
    def parameters(self) -> np.ndarray:
        """(np,) parameters of the run."""
        return self.motion.parameters

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """(responses,) values at parameters ``p``.

        Raises
        ------
        AnalysisError
            The run cannot be repeated at ``p``; names the changed parameters.
        """
        p = self.motion.model.values(p)
        key = p.tobytes()
        if key not in self._cache:
            self._cache[key] = self._values(p)
        return self._cache[key]

    def _values(self, p: np.ndarray) -> np.ndarray:
        if np.array_equal(p, self.parameters):
            return np.array([evaluate(self.motion, r) for r in self.responses])
        try:
            repeated = self._at(p)
            values = np.array([evaluate(repeated, r) for r in self.responses])
        except AnalysisError as error:
            raise AnalysisError(f"{self._where(p)}: {error}; give a shorter step") from error
        if not repeated.status.success:
            raise AnalysisError(
                f"{self._where(p)}: the run does not succeed ({repeated.status}); "
                "give a shorter step"
            )
        invalid = [
            r.label for r, v in zip(self.responses, values, strict=True) if not np.isfinite(v)
        ]
        if invalid:
            raise AnalysisError(
                f"{self._where(p)}: no finite value of {', '.join(invalid)}; give a shorter step"
            )
        return values

    def _at(self, p: np.ndarray) -> Result:
        motion, analysis = self.motion, self.motion.analysis
        return analysis.run(motion.model, p) if self.reruns else analysis.replay(motion, p)

    def _where(self, p: np.ndarray) -> str:
        triples = zip(self.motion.model.parameters, p, self.parameters, strict=False)
        changed = [f"{name} = {new:.9g}" for name, new, old in triples if new != old]
        return f"the run repeated at {', '.join(changed[:4])}{', …' if changed[4:] else ''}"


@options
class FiniteDifference:
    """Difference quotients ``(R(p + h) − R(p))/h`` (8.24) and related schemes.

    A step that would leave the bounds of a parameter or a limit of the model is replaced by a
    one-sided scheme of the same order to the other side, with a note of the gradient.

    Parameters
    ----------
    scheme : forward, backward, central, or richardson (central, extrapolated to fourth order)
    step : relative to ``|p|`` (angles: to one radian at least; zeros: to the bounds or one unit);
        one for all, or name → step; by default 1e-8 for one-sided schemes, 2e-6 for central and
        1.6e-4 for richardson ones

    Raises
    ------
    UnsupportedError
        Unknown scheme, or a step that is not positive.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> speed = system.parameter("speed", 3.0, "m/s")
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(speed, 10)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> rough = da.FiniteDifference("forward", step=0.1)  # relative: 0.3 m/s
    >>> round(da.sensitivity(motion, da.final("stone.x**2"), method=rough).item(), 6)  # 6.3, not 6
    6.3
    """

    scheme: str = "richardson"
    step: float | Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        checked_step(self.scheme, self.step)

    def gradient(
        self, motion: Result, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) difference quotients.

        Raises
        ------
        AnalysisError
            A step for an unknown parameter, a step that fits on neither side, or a failed run.
        """
        values = Replays(motion, responses)
        rows = [q.evaluate(motion.parameters, values) for q in self.quotients(motion, columns)]
        gradient = np.array(rows).T.reshape(len(responses), len(columns))
        return gradient if values.reruns else gradient + of_moving_times(motion, responses, columns)

    def quotients(self, motion: Result, columns: Sequence[int]) -> list[Quotient]:
        """Difference quotients, one for each of these parameters."""
        names = list(motion.model.parameters)
        for name in self.step if isinstance(self.step, Mapping) else ():
            if name not in names:
                known = ", ".join(names) or "none"
                raise AnalysisError(f"a step for unknown parameter {name!r} (known: {known})")
        return [
            quotient_within_bounds(motion, i, self.scheme, self.relative(names[i])) for i in columns
        ]

    def relative(self, name: str) -> float:
        """Relative step of a parameter."""
        step = self.step.get(name) if isinstance(self.step, Mapping) else self.step
        return best_step(self.scheme) if step is None else float(step)

    def notes(self, motion: Result, columns: Sequence[int]) -> list[str]:
        """Notes on replaced stencils."""
        return [q.note for q in self.quotients(motion, columns) if q.note]
