"""What every synthesis ends with: mechanisms to choose from, the best first."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.synthesis.target import Target

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


class Candidate(ABC):
    """A mechanism and how it meets the target.

    Attributes
    ----------
    crank_angles : (n,) of the crank at the entries of the target
    error : sum of squares of what is in the target
    distances : (n,) of the points, or of the outputs
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
        """Of the dimensions that have one."""
        return {}

    @abstractmethod
    def told(self) -> dict[str, Any]:
        """It, as plain data."""

    @abstractmethod
    def curve(self) -> np.ndarray:
        """(m, 2) path of the point over a turn."""

    @abstractmethod
    def passed(self) -> np.ndarray:
        """(n, 2) places of the point at the entries."""

    @abstractmethod
    def reached(self) -> np.ndarray:
        """(n,) outputs at the entries, without jumps."""

    @abstractmethod
    def page(self) -> dict[str, Any] | None:
        """Its motion over a turn, None where it cannot be moved so."""

    @property
    @abstractmethod
    def watched(self) -> list[str]:
        """Measures that its page plots at first, where it has them."""

    def judged(self) -> dict[str, tuple[str, float]]:
        """Further numbers it is judged by: name → unit, value."""
        return {}


@dataclass(eq=False)
class Candidates(Decision):
    """What was found, best first; each differs from the others.

    Attributes
    ----------
    starts : mechanisms that were polished
    interrupted : by Ctrl-C; the solutions found until then are kept
    """

    word = "synthesis"
    page_functions = "synthesis:synthesis"
    noun: ClassVar[str] = "mechanisms"
    target: Target
    solutions: Sequence[Any]
    starts: int
    name: str = "synthesis"
    interrupted: bool = False

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether it went to its end."""
        return not self.interrupted

    @property
    def message(self) -> str:  # type: ignore[override]
        """How many, and the least error."""
        count = len(self.solutions)
        noun = self.noun if count != 1 else self.noun[:-1]
        text = f"{count} {noun}, least error {self.best.error:.3g}"
        return f"{text}; interrupted after {self.starts} starts" if self.interrupted else text

    @property
    def best(self) -> Any:
        return self.solutions[0]

    @property
    @abstractmethod
    def kind(self) -> str:
        """What they are."""

    def findings(self) -> dict[str, Any]:
        return {
            "linkage": self.kind,
            "starts": self.starts,
            "solutions": [
                {
                    "error": s.error,
                    "dimensions": s.numbers,
                    **s.told(),
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

        listed, each = self.solutions, ("solution", "entry")
        return xr.Dataset(
            {
                "dimensions": (
                    ("solution", "dimension"),
                    [list(s.numbers.values()) for s in listed],
                ),
                "error": ("solution", [s.error for s in listed]),
                "crank_angles": (each, [s.crank_angles for s in listed]),
                "distances": (each, [s.distances for s in listed]),
            },
            {"dimension": list(self.best.numbers), "solution": range(len(listed))},
            {"linkage": self.kind},
        )

    def to_dataframe(self) -> pd.DataFrame:
        """One row a solution: error, dimensions."""
        import pandas as pd

        return pd.DataFrame([{"error": s.error, **s.numbers} for s in self.solutions])

    def table_of_designs(self) -> dict[str, Any]:
        from dalembert.design.pages.synthesis import synthesis_designs

        return synthesis_designs(self)

    def __repr__(self) -> str:
        found, least = f"{len(self.solutions)} {self.noun}", self.best.error
        return f"<{type(self).__name__}: {found}, least error {least:.3g}>"
