"""What a synthesis ends with: linkages to choose from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.synthesis.linkage import Linkage
from dalembert.design.synthesis.target import Target

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@dataclass(frozen=True, eq=False)
class Solution:
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


@dataclass(eq=False)
class Synthesis(Decision):
    """What was found, best first; each differs from the others.

    Attributes
    ----------
    starts : linkages that were polished
    interrupted : by Ctrl-C; the solutions found until then are kept

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

    word = "synthesis"
    target: Target
    solutions: list[Solution]
    starts: int
    name: str = "synthesis"
    interrupted: bool = False

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether it went to its end."""
        return not self.interrupted

    @property
    def message(self) -> str:  # type: ignore[override]
        """How many linkages, and the least error."""
        text = f"{len(self.solutions)} linkages, least error {self.best.error:.3g}"
        return f"{text}; interrupted after {self.starts} starts" if self.interrupted else text

    @property
    def best(self) -> Solution:
        return self.solutions[0]

    def summary(self) -> dict[str, Any]:
        return {
            "ok": self.success,
            "message": self.message,
            "interrupted": self.interrupted,
            "linkage": type(self.best.linkage).__name__,
            "starts": self.starts,
            "solutions": [
                {
                    "error": s.error,
                    "dimensions": s.linkage.numbers,
                    "branch": s.linkage.branch,
                    "crank_turns": s.linkage.crank_turns,
                    "transmission": s.linkage.transmission(
                        None if s.linkage.crank_turns else s.crank_angles
                    ),
                    "crank_angles": s.crank_angles.tolist(),
                    "distances": s.distances.tolist(),
                }
                for s in self.solutions
            ],
        }

    @property
    def data(self) -> xr.Dataset:
        """Dimensions, errors and crank angles of every solution."""
        import xarray as xr

        listed = self.solutions
        return xr.Dataset(
            {
                "dimensions": (
                    ("solution", "dimension"),
                    [list(s.linkage.numbers.values()) for s in listed],
                ),
                "error": ("solution", [s.error for s in listed]),
                "branch": ("solution", [s.linkage.branch for s in listed]),
                "crank_angles": (("solution", "entry"), [s.crank_angles for s in listed]),
                "distances": (("solution", "entry"), [s.distances for s in listed]),
            },
            {"dimension": list(self.best.linkage.numbers), "solution": range(len(listed))},
            {"linkage": type(self.best.linkage).__name__},
        )

    def to_dataframe(self) -> pd.DataFrame:
        """One row a solution: error, dimensions, branch."""
        import pandas as pd

        return pd.DataFrame(
            [
                {"error": s.error, **s.linkage.numbers, "branch": s.linkage.branch}
                for s in self.solutions
            ]
        )

    def table_of_designs(self) -> dict[str, Any]:
        from dalembert.design.pages.synthesis import synthesis_designs

        return synthesis_designs(self)

    def page(self, **first_view: Any) -> dict[str, Any]:
        """The linkages to choose from, moving, with what they shall do."""
        from dalembert.design.pages.synthesis import synthesis_page

        return synthesis_page(self, **first_view)

    def views(self) -> list[dict[str, Any]]:
        from dalembert.design.pages.synthesis import synthesis_views

        return synthesis_views(self)

    def __repr__(self) -> str:
        return f"<Synthesis: {len(self.solutions)} linkages, least error {self.best.error:.3g}>"
