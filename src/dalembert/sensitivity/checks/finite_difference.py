"""Finite differences of responses over repeated runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.sensitivity.checks.replays import Replays
from dalembert.sensitivity.checks.stencils import (
    Quotient,
    best_step,
    checked_step,
    quotient_within_bounds,
)
from dalembert.sensitivity.moving_times import of_moving_times


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
