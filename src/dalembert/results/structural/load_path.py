"""The result of following a load path: equilibria one after the other, and their load factors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import cast

import numpy as np

from dalembert.results.files.contents import Contents
from dalembert.results.result import Instants
from dalembert.results.sampling import checked_numbers
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.measuring.measures import State


@dataclass(frozen=True)
class Plane:
    """Where a point was looked for: ``nᵀ(u_f − u₀)/s² + ν (λ − λ₀) = 0``.

    Attributes
    ----------
    origin, normal : (free + 1,) ``(u₀, λ₀)`` and ``(n, ν)``
    scale : (free,) ``s``, displacements that count as much as the whole load [m or rad]
    """

    origin: np.ndarray
    normal: np.ndarray
    scale: np.ndarray

    @property
    def row(self) -> np.ndarray:
        """(free + 1,) its coefficients."""
        return np.append(self.normal[:-1] / self.scale**2, self.normal[-1])

    def distance(self, point: np.ndarray) -> float:
        """How far a point is from it."""
        return float(self.row @ (point - self.origin))


@dataclass(eq=False, repr=False)
class LoadPathResult(StructuralResult):
    """Equilibria along a load path; what instants are to a motion, points are to it.

    Attributes
    ----------
    load_factors : (points,) shares of the load
    planes : where each point was looked for
    negative : (points,) negative eigenvalues of the stiffness; none where it is stable
    limits : numbers of the limit points, where the load factor is largest or smallest
    """

    load_factors: np.ndarray = field(default_factory=lambda: np.zeros(0))
    planes: list[Plane] = field(default_factory=list)
    negative: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    limits: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))

    kind_of_state = along = "point"
    in_sequence = True

    @property
    def state_names(self) -> list[str]:
        return [f"load factor {factor:.6g}" for factor in self.load_factors]

    @property
    def stable(self) -> np.ndarray:
        """(points,) whether an equilibrium is stable under its dead load."""
        return self.negative == 0

    def state(self, case: int) -> State:
        return replace(super().state(case), load_factor=float(self.load_factors[case]))

    def at(self, cases: Instants) -> LoadPathResult:
        """The result of some points, by number."""
        index = checked_numbers(cases, len(self.planes), "points of the path")
        found = cast(LoadPathResult, super().at(index))
        places = np.arange(len(self.planes))[index]
        kept = [int(np.flatnonzero(places == k)[0]) for k in self.limits if k in places]
        return replace(
            found,
            load_factors=self.load_factors[index],
            planes=[self.planes[k] for k in index],
            negative=self.negative[index],
            limits=np.array(kept, dtype=int),
        )

    def at_load(self, factor: float) -> LoadPathResult:
        """The first equilibrium on the path at this load factor.

        Raises
        ------
        AnalysisError
            The path does not get there.
        """
        return self.analysis.at_load(self, factor)  # type: ignore[attr-defined]

    @cached_property
    def contents(self) -> Contents:
        """Displacements, forces and load factors."""
        more = {
            "load_factor": ("point", self.load_factors, {"units": "1"}),
            "negative_eigenvalues": ("point", self.negative),
        }
        return super().contents.plus(more)

    @property
    def _labels(self) -> np.ndarray:
        return self.time.astype(int)
