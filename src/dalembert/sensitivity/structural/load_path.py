"""Gradients along load paths, with points restricted to their arc-length planes.

At a point of prescribed load this is the gradient at that load; for the load factor at a limit
point it is the gradient of the limit load, independent of the plane, since the path is level there.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.path_equations import PathEquations
from dalembert.results.structural.load_path import LoadPathResult
from dalembert.sensitivity.samples import Sample
from dalembert.sensitivity.structural.statics import StaticsEngine, StaticsGradient


class LoadPathGradient(StaticsGradient):
    """Row of the gradient for one sampled response, with bordered factors."""

    def __init__(self, sample: Sample, shared: dict | None = None):
        super().__init__(sample, shared)
        self.path: LoadPathResult = sample.motion
        self.equations = PathEquations(self.model, self.p, self.path.cases[0])
        self.factors = cache(self._factors)

    def _point(self, case: int) -> np.ndarray:
        return np.append(self.path.displacements[self.free, case], self.path.load_factors[case])

    def _factors(self, case: int) -> tuple[Any, Any]:
        point = self._point(case)
        return self.equations.factor(point, self.path.planes[case]), self.equations.matrix(point)[2]

    def state(self, case: int) -> tuple:
        return *super().state(case), id(self.path.planes[case])

    def share(self, case: int) -> float:
        return float(self.path.load_factors[case])

    def stiffness(self, case: int) -> Any:
        return self.factors(case)[1]

    def response(self, case: int, forces: np.ndarray) -> tuple[np.ndarray, float]:
        change = self.factors(case)[0].solve(np.append(forces[self.free], 0.0))
        return self.equations.displacements_at(change), float(change[-1])

    def multiplier(self, case: int, u_bar: np.ndarray, factor_bar: np.ndarray) -> np.ndarray:
        weights = np.vstack([u_bar[self.free], factor_bar])
        multiplier = np.zeros_like(u_bar)
        multiplier[self.free] = self.factors(case)[0].solve(weights, trans="T")[:-1]
        return multiplier


class LoadPathEngine(StaticsEngine):
    """Gradient engine of load paths, with separate factors at every point."""

    row = LoadPathGradient
