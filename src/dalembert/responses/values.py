"""Values of a measure at an instant, load case or mode."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.modes import Numbered
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments

ALIKE = 1e-12
"""Threshold for values that are equal, relative to the largest."""
INSTANT = 1e-9
"""Largest distance of a time from an output, relative to the time span."""


@dataclass(frozen=True)
class Final(Response):
    """Value at the end of the run, or for the only load case or mode.

    Raises
    ------
    AnalysisError
        The result has several load cases or modes with different values, so that none is final.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> landed = da.Final("stone.x", name="width")
    >>> landed.label, round(da.evaluate(motion, landed), 6)
    ('width', 6.0)
    """

    def adapted_to(self, motion: Result) -> Response:
        if motion.in_sequence or motion.time.size <= 1:
            return self
        values = motion.values(self.measure)
        if np.ptp(values) <= ALIKE * np.abs(values).max(initial=0.0):  # constant, such as a mass
            return self
        names = getattr(motion, "cases", None)
        kind = "modes" if isinstance(motion, Numbered) else "load cases"
        first = f"{motion.time[0]:g}"
        listed = ", ".join(f"{k:g}" for k in motion.time[:8])
        labels = f" ({', '.join(repr(name) for name in names[:8])})" if names else ""
        raise AnalysisError(
            f"response {self.label}: the result has {motion.time.size} {kind}, {listed}{labels}, "
            f"and none of them is final; take one by its number, da.at({first}, …), or a mean or "
            "an extreme over all"
        )

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "final"}

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[-1])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.eye(1, samples.size, samples.size - 1).ravel()


@options
class At(Response):
    """Value at a time, or for a load case, mode or point of a path by number.

    Parameters
    ----------
    time : instant within the run [s], or number

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> top = da.At("stone.y", time=1.0)
    >>> top.label, round(da.evaluate(motion, top), 6)
    ('at(1, stone.y)', 5.0)
    """

    time: float = 0.0

    @property
    def label(self) -> str:
        return self.name or super().label.replace("at(", f"at({self.time:g}, ", 1)

    def sample_times(self, motion: Result) -> np.ndarray | None:
        return np.array([float(self.time)])

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        (matches,) = np.nonzero(np.abs(times - self.time) <= INSTANT * np.ptp(times))
        if not matches.size:
            raise UnsupportedError(
                f"response {self.label}: {self.time:g} is not an output of the page; take one of "
                "its outputs, or request this one by outputs=…"
            )
        return {"kind": "at", "instant": int(matches[0]), "time": float(self.time)}

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[0])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.ones(1)


@check_arguments
def final(measure: str | Expression, name: str = "") -> Final:
    """Value of a measure at the end of the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.final("kinetic_energy + potential_energy")), 6)  # initial
    54.5
    """
    return Final(measure, name)


@check_arguments
def at(time: float, measure: str | Expression, name: str = "") -> At:
    """Value of a measure at a time [s], or for a load case (from 0) or mode (from 1) by number.

    Parameters
    ----------
    time : instant within the run [s], or number of a load case, mode or point
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=10.0))
    >>> for name, force in (("light", 1.0), ("heavy", 5.0)):
    ...     spring.load(end, case=name, fx=force)
    >>> result = da.solve_statics(spring.build())
    >>> da.evaluate(result, da.at(1, "end.ux"))  # of the second load case
    0.5
    """
    return At(measure, name, time)
