"""What the synthesis of linkages with one loop ends with."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.design.synthesis.candidates import Candidate, Candidates
from dalembert.design.synthesis.linkage import Linkage
from dalembert.errors import DalembertError

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

FRAMES = 121
"""Instants of a turn that a page shows."""
TURN = np.linspace(0, 2 * math.pi, 361)


@dataclass(frozen=True, eq=False)
class Solution(Candidate):
    """A linkage and how it meets the target.

    Attributes
    ----------
    linkage : FourBar or SliderCrank
    crank_angles : (n,) of the crank at the entries of the target
    error : sum of squares of the distances; for functions and motions of the angles, too [rad]
    distances : (n,) of the points, or of the outputs

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
        """Least transmission angle [rad], of a turn, or at the entries where the crank rocks."""
        turns = self.linkage.crank_turns
        return float(self.linkage.transmission(None if turns else self.crank_angles))

    def told(self) -> dict[str, Any]:
        return {
            "branch": self.linkage.branch,
            "crank_turns": self.linkage.crank_turns,
            "transmission": self.transmission,
        }

    def curve(self) -> np.ndarray:
        return self.linkage.path(TURN if self.linkage.crank_turns else np.sort(self.crank_angles))

    def passed(self) -> np.ndarray:
        return self.linkage.path(self.crank_angles)

    def reached(self) -> np.ndarray:
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
    def watched(self) -> list[str]:
        return ["follower.angle"]

    def judged(self) -> dict[str, tuple[str, float]]:
        return {"transmission": ("°", math.degrees(self.transmission))}


@dataclass(eq=False, repr=False)
class Synthesis(Candidates):
    """Linkages with one loop, best first; each differs from the others.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> turn = np.linspace(0.0, 1.0, 3)
    >>> half = da.Target.function(turn, 0.5 * turn)  # the rocker goes half as far
    >>> found = da.synthesize(half, starts=4)
    >>> isinstance(found, da.Synthesis), found.best is found.solutions[0]
    (True, True)
    >>> errors = [one.error for one in found.solutions]
    >>> errors == sorted(errors)
    True
    """

    noun = "linkages"

    @property
    def kind(self) -> str:
        return type(self.best.linkage).__name__

    @property
    def data(self) -> xr.Dataset:
        branches = [s.linkage.branch for s in self.solutions]
        return super().data.assign(branch=("solution", branches))

    def to_dataframe(self) -> pd.DataFrame:
        """One row a solution: error, dimensions, branch."""
        return super().to_dataframe().assign(branch=[s.linkage.branch for s in self.solutions])
