"""Base classes of synthesis results: candidate mechanisms, sorted by error."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, TypeVar

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.synthesis.target import Target
from dalembert.text.wording import counted

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from dalembert.design.pages.live import LiveTask
    from dalembert.results.motion import Motion


class Candidate(ABC):
    """A mechanism with its error relative to the target.

    Attributes
    ----------
    crank_angles : (n,) crank angles at the entries of the target [rad]
    error : sum of squared deviations from the target
    distances : (n,) deviations of the points, or of the outputs
    """

    crank_angles: np.ndarray
    error: float
    distances: np.ndarray

    @property
    @abstractmethod
    def numbers(self) -> dict[str, float]:
        """Dimension → value."""

    @property
    def units(self) -> dict[str, str]:
        """Units of the dimensions that are not lengths."""
        return {}

    @abstractmethod
    def properties(self) -> dict[str, Any]:
        """Further properties, as plain data."""

    @abstractmethod
    def curve(self) -> np.ndarray:
        """(m, 2) path of the point over one revolution."""

    @abstractmethod
    def points(self) -> np.ndarray:
        """(n, 2) positions of the point at the entries."""

    @abstractmethod
    def outputs(self) -> np.ndarray:
        """(n,) unwrapped outputs at the entries."""

    @abstractmethod
    def page(self) -> dict[str, Any] | None:
        """Page of its motion over one revolution; None if the motion cannot be computed."""

    @property
    def parametric_motion(self) -> Motion | None:
        """Motion of a model that has the dimensions as parameters; None if it has numbers."""
        return None

    @property
    @abstractmethod
    def plotted_measures(self) -> list[str]:
        """Measures plotted initially on its page, if available."""

    def criteria(self) -> dict[str, tuple[str, float]]:
        """Further criteria: name → unit, value."""
        return {}


CandidateT = TypeVar("CandidateT", bound=Candidate)


@dataclass(eq=False)
class Candidates(Decision, Generic[CandidateT]):
    """Distinct candidates, sorted by error.

    Attributes
    ----------
    starts : number of optimised starts
    interrupted : by Ctrl-C; the solutions computed so far are available
    planned : number of starts of the whole search; None if unknown
    """

    file_suffix = "synthesis"
    page_functions = "synthesis:synthesis"
    candidate_kind: ClassVar[str] = "mechanisms"
    target: Target
    solutions: Sequence[CandidateT]
    starts: int
    name: str = "synthesis"
    interrupted: bool = False
    planned: int | None = None

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether all starts were optimised."""
        return not self.interrupted

    @property
    def message(self) -> str:  # type: ignore[override]
        """Number of candidates, and the smallest error."""
        count = len(self.solutions)
        noun = self.candidate_kind if count != 1 else self.candidate_kind[:-1]
        text = f"{count} {noun}, least error {self.best.error:.3g}"
        ending = f"; interrupted after {counted(self.starts, 'start')}"
        if self.planned is not None:
            ending = f"; interrupted after {self.starts} of {counted(self.planned, 'start')}"
        return f"{text}{ending}" if self.interrupted else text

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    @property
    def best(self) -> CandidateT:
        return self.solutions[0]

    @property
    @abstractmethod
    def kind(self) -> str:
        """Kind of the candidates."""

    def findings(self) -> dict[str, Any]:
        return {
            "linkage": self.kind,
            "starts": self.starts,
            "solutions": [
                {
                    "error": s.error,
                    "dimensions": s.numbers,
                    **s.properties(),
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

        solutions, dimensions = self.solutions, ("solution", "entry")
        return xr.Dataset(
            {
                "dimensions": (
                    ("solution", "dimension"),
                    [list(s.numbers.values()) for s in solutions],
                ),
                "error": ("solution", [s.error for s in solutions]),
                "crank_angles": (dimensions, [s.crank_angles for s in solutions]),
                "distances": (dimensions, [s.distances for s in solutions]),
            },
            {"dimension": list(self.best.numbers), "solution": range(len(solutions))},
            {"linkage": self.kind},
        )

    def to_dataframe(self) -> pd.DataFrame:
        """A row per solution: error, dimensions."""
        import pandas as pd

        return pd.DataFrame([{"error": s.error, **s.numbers} for s in self.solutions])

    def table_of_designs(self) -> dict[str, Any]:
        designs: dict[str, Any] = self._page_function("designs")(self)
        return designs

    def __repr__(self) -> str:
        count, error = f"{len(self.solutions)} {self.candidate_kind}", self.best.error
        return f"<{type(self).__name__}: {count}, least error {error:.3g}>"
