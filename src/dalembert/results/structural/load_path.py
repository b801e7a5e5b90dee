"""Result of path following: successive equilibria and their load factors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import cast

import numpy as np

from dalembert.model.assembled.measures import State
from dalembert.results.files.contents import Contents
from dalembert.results.result import Instants
from dalembert.results.sampling import checked_numbers
from dalembert.results.structural.result import StructuralResult


@dataclass(frozen=True)
class Plane:
    """Constraint plane of a path point: ``nᵀ(u_f − u₀)/s² + ν (λ − λ₀) = 0``.

    Attributes
    ----------
    origin, normal : (free + 1,) ``(u₀, λ₀)`` and ``(n, ν)``
    scale : (free,) ``s``, displacements weighted like the whole load [m or rad]
    """

    origin: np.ndarray
    normal: np.ndarray
    scale: np.ndarray

    @property
    def row(self) -> np.ndarray:
        """(free + 1,) coefficients of the plane."""
        return np.append(self.normal[:-1] / self.scale**2, self.normal[-1])

    def distance(self, point: np.ndarray) -> float:
        """Residual of the plane equation at a point."""
        return float(self.row @ (point - self.origin))


@dataclass(eq=False, repr=False)
class LoadPathResult(StructuralResult):
    """Equilibria along a load path; its points are the instants of the result.

    Attributes
    ----------
    load_factors : (points,) shares of the load
    planes : constraint plane of each point
    negative : (points,) numbers of negative eigenvalues of the stiffness; zero if stable
    limits : numbers of the limit points, where the load factor has an extremum
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
        """(points,) whether each equilibrium is stable under its dead load."""
        return self.negative == 0

    def state(self, case: int) -> State:
        return replace(super().state(case), load_factor=float(self.load_factors[case]))

    def at(self, cases: Instants) -> LoadPathResult:
        """The result at some points, by number."""
        index = checked_numbers(cases, len(self.planes), "points of the path")
        result = cast(LoadPathResult, super().at(index))
        original = np.arange(len(self.planes))[index]
        limits = [int(np.flatnonzero(original == k)[0]) for k in self.limits if k in original]
        return replace(
            result,
            load_factors=self.load_factors[index],
            planes=[self.planes[k] for k in index],
            negative=self.negative[index],
            limits=np.array(limits, dtype=int),
        )

    def at_load(self, factor: float) -> LoadPathResult:
        """First equilibrium on the path at this load factor.

        Raises
        ------
        AnalysisError
            The path does not reach the load factor.
        """
        return self.analysis.at_load(self, factor)  # type: ignore[attr-defined]

    @cached_property
    def contents(self) -> Contents:
        """Displacements, forces and load factors."""
        variables = {
            "load_factor": ("point", self.load_factors, {"units": "1"}),
            "negative_eigenvalues": ("point", self.negative),
        }
        return super().contents.plus(variables)

    @property
    def _labels(self) -> np.ndarray:
        return self.time.astype(int)
