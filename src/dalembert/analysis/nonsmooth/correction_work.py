"""Work of the corrections of positions after steps."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.once import once

MOST = 200
"""Upper limit of the steps of a model with joints whose gaps are examined, those with the largest
work."""


@dataclass(frozen=True, eq=False)
class CorrectionWork:
    """Work of the corrections of K steps.

    Attributes
    ----------
    step : ContactStep of the run
    t : (K,) ends of the steps [s]
    uncorrected : (n_y, K) positions there before the corrections
    work : (K,) positive where bodies are lifted [J]
    net : (K,) the same, less what the rule of the step dissipates [J]
    """

    step: ContactStep
    t: np.ndarray
    uncorrected: np.ndarray
    work: np.ndarray
    net: np.ndarray

    @classmethod
    def of(
        cls, step: ContactStep, t: np.ndarray, corrected: np.ndarray, uncorrected: np.ndarray
    ) -> CorrectionWork:
        """The differences of the potential energy of positions (n_y, K)."""
        potential, p = _potential(step.model, t.size), np.tile(step.p[:, None], t.size)
        after, before = (potential(t, y, p)[0].ravel() for y in (corrected, uncorrected))
        work = after - before
        return cls(step, t, uncorrected, work, work)

    @classmethod
    def none(cls, step: ContactStep) -> CorrectionWork:
        """No steps."""
        empty, count = np.zeros(0), step.model.equations.coordinate_count
        return cls(step, empty, np.zeros((count, 0)), empty, empty)

    @property
    def total(self) -> float:
        """Work of all corrections [J]."""
        return float(self.work.sum())

    def growth(self, loss: np.ndarray, least: float) -> np.ndarray:
        """(K,) growth of the energy by corrections that open gaps, beyond what the contacts
        dissipate in the same step; zero up to ``least`` [J].

        Parameters
        ----------
        loss : (K,) energy dissipated by the contacts [J]
        """
        grown = np.minimum(self.work, self.net) - np.maximum(loss, 0.0)
        grown[grown <= least] = 0.0
        if self.step.smooth.has_joints:  # whose positions are corrected in each step
            largest = np.argsort(-grown)
            grown[largest[MOST:]] = 0.0
            for k in largest[: min(MOST, np.count_nonzero(grown))]:
                at = self.step.at(float(self.t[k]), self.uncorrected[:, k])
                if not self.step.deepest(at) < -self.step.rounding:
                    grown[k] = 0.0
        return grown


@once
def _potential(model: Model, count: int) -> Kernel:
    """``(t, y, p) → V`` of ``count`` columns."""
    e = model.equations
    function = ca.Function("potential", [e.t, e.y, e.p], [ca.densify(e.potential)])
    return Kernel(function.map(count))
