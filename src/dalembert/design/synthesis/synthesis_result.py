"""Results of synthesis: linkages and mechanisms with their errors."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.design.synthesis.candidates import Candidate, Candidates
from dalembert.design.synthesis.linkage import Linkage
from dalembert.errors import DalembertError
from dalembert.results.motion import Motion

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

FRAMES = 121
"""Number of instants of a revolution on a page."""
REVOLUTION = np.linspace(0, 2 * math.pi, 361)


@dataclass(frozen=True, eq=False)
class Solution(Candidate):
    """A linkage with its error relative to the target.

    Attributes
    ----------
    linkage : FourBar or SliderCrank
    crank_angles : (n,) crank angles at the entries of the target [rad]
    error : sum of squared distances; for functions and motions also of angles [rad]
    distances : (n,) deviations of the points, or of the outputs

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> turn = np.linspace(0.5, 1.5, 4)
    >>> engine = da.SliderCrank(crank=0.1, coupler=0.3)
    >>> target = da.Target.function(turn, [engine.output(angle) for angle in turn])
    >>> best = da.synthesize(target, da.SliderCrank, starts=2).best
    >>> isinstance(best, da.Solution), best.error < 1e-10, len(best.crank_angles)
    (True, True, 4)
    """

    linkage: Linkage
    crank_angles: np.ndarray
    error: float
    distances: np.ndarray

    @property
    def numbers(self) -> dict[str, float]:
        return self.linkage.numbers

    @property
    def units(self) -> dict[str, str]:
        return {"angle": "rad"}

    @property
    def transmission(self) -> float:
        """Minimum transmission angle [rad] over a revolution, or at the entries if it rocks."""
        turns = self.linkage.crank_turns
        return float(self.linkage.transmission(None if turns else self.crank_angles))

    def properties(self) -> dict[str, Any]:
        return {
            "branch": self.linkage.branch,
            "crank_turns": self.linkage.crank_turns,
            "transmission": self.transmission,
        }

    def curve(self) -> np.ndarray:
        return self.linkage.path(
            REVOLUTION if self.linkage.crank_turns else np.sort(self.crank_angles)
        )

    def points(self) -> np.ndarray:
        return self.linkage.path(self.crank_angles)

    def outputs(self) -> np.ndarray:
        output = self.linkage.output(self.crank_angles)
        return np.unwrap(output) if self.linkage.output_is_angle else output

    def page(self) -> dict[str, Any] | None:
        try:
            model = self.linkage.system().build()
            motion = Kinematics(2 * math.pi, outputs=FRAMES).run(model)
        except DalembertError:
            return None
        return motion.page(trace=["coupler.P"])

    @property
    def plotted_measures(self) -> list[str]:
        return ["follower.angle"]

    def criteria(self) -> dict[str, tuple[str, float]]:
        return {"transmission": ("°", math.degrees(self.transmission))}


@dataclass(eq=False, repr=False)
class SynthesisResult(Candidates[Solution]):
    """Distinct single-loop linkages, sorted by error.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> turn = np.linspace(0.0, 1.0, 3)
    >>> half = da.Target.function(turn, 0.5 * turn)  # half the crank angle
    >>> result = da.synthesize(half, starts=4)
    >>> isinstance(result, da.SynthesisResult), result.best is result.solutions[0]
    (True, True)
    >>> errors = [solution.error for solution in result.solutions]
    >>> errors == sorted(errors)
    True
    """

    candidate_kind = "linkages"

    @property
    def kind(self) -> str:
        return type(self.best.linkage).__name__

    @property
    def data(self) -> xr.Dataset:
        branches = [s.linkage.branch for s in self.solutions]
        return super().data.assign(branch=("solution", branches))

    def to_dataframe(self) -> pd.DataFrame:
        """A row per solution: error, dimensions, branch."""
        return super().to_dataframe().assign(branch=[s.linkage.branch for s in self.solutions])


@dataclass(frozen=True, eq=False)
class MechanismSolution(Candidate):
    """A mechanism with its error relative to the target.

    Attributes
    ----------
    parameters : name → value
    crank_angles : (n,) rotation of the motor at the entries of the target [rad]
    error : sum of squared deviations from the target
    distances : (n,) deviations of the points, or of the outputs
    motion : a revolution of the motor
    entries : the same motion at the entries
    measures : ``"x"``, ``"y"``, ``"angle"``, ``"output"`` → measure, if the target contains it
    """

    parameters: dict[str, float]
    crank_angles: np.ndarray
    error: float
    distances: np.ndarray
    motion: Motion = field(repr=False)
    entries: Motion = field(repr=False)
    measures: Mapping[str, str] = field(repr=False)

    @property
    def numbers(self) -> dict[str, float]:
        return self.parameters

    @property
    def units(self) -> dict[str, str]:
        parameters = self.motion.model.parameters
        return {name: parameters[name].unit for name in self.parameters}

    def properties(self) -> dict[str, Any]:
        return {"crank_turns": True}

    def _path(self, motion: Motion) -> np.ndarray:
        return np.column_stack([motion.values(self.measures[axis]) for axis in "xy"])

    def curve(self) -> np.ndarray:
        return self._path(self.motion)

    def points(self) -> np.ndarray:
        return self._path(self.entries)

    def outputs(self) -> np.ndarray:
        return np.unwrap(self.entries.values(self.measures["output"]))

    @property
    def parametric_motion(self) -> Motion:
        return self.motion

    @property
    def plotted_measures(self) -> list[str]:
        return list(self.measures.values())

    def page(self) -> dict[str, Any]:
        trace = [self.measures["x"].removesuffix(".x")] if "x" in self.measures else []
        return self.motion.page(trace=trace)


@dataclass(eq=False, repr=False)
class MechanismSynthesisResult(Candidates[MechanismSolution]):
    """Distinct mechanisms of one topology, sorted by error."""

    @property
    def kind(self) -> str:
        return str(self.best.motion.model.name)
