"""Batches of equilibria, assembled and solved at once."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.batch_residuals import at_some
from dalembert.analysis.batch.individual_runs import completed_batch
from dalembert.analysis.batch.many_equilibria import ManyEquilibria, ManyForces, ManyStatics
from dalembert.analysis.batch.starts import Starts, backend_of
from dalembert.analysis.batch.states import States
from dalembert.analysis.equilibrium.growth import growth_rates
from dalembert.analysis.equilibrium.mechanism_equilibrium import (
    equilibrium_settings,
    indifferent_states,
)
from dalembert.analysis.equilibrium.stability import equilibrium_text
from dalembert.analysis.equilibrium.statics_kernel import statics_kernel
from dalembert.analysis.equilibrium.unsettled import endless
from dalembert.analysis.residual_check import EXACT, MOTION
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.once import once

BLOCK_ENTRIES = 1 << 22
"""Upper limit of the matrix entries of designs that are solved together."""


class EquilibriumBatch:
    """Execution of a batch of equilibria; designs that fail the checks run individually.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    model, designs : model and parameters of the runs
    workers : upper limit of threads
    """

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.time = workers, float(analysis.time)
        self.kernel, self.backend = statics_kernel(model), backend_of(model)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether all equations are independent, as assembly requires."""
        return not (model.closure.lost or model.equations.contacts)

    def execute(self, report: Callable[[float], None]) -> Batch:
        """Batch of all designs; after an interruption with the finished ones."""
        begin, model, count = clock.perf_counter(), self.model, len(self.designs)
        span = self.time, self.time
        starts = Starts(model, self.designs, self.backend, self.workers, span, False, _first(model))
        e, analysis = model.equations, self.analysis
        static = ManyStatics(self.kernel, self.time, starts.evaluate)
        settings = equilibrium_settings(analysis)
        started, statuses = starts.started, dict(starts.statuses)
        x = np.full((count, 1, e.coordinate_count + e.constraint_count), np.nan)
        texts: dict[int, str] = {}
        residuals = np.full(count, np.nan)
        size = self.kernel.equations.speed_count
        block, interrupted = max(1, BLOCK_ENTRIES // (size**2 + 1)), False
        try:
            for first in range(0, started.size, block):
                part = started[first : first + block]
                equilibria = ManyEquilibria(static, starts.p[part], settings)
                y = starts.x0[first : first + block]
                forces, steps, converged = equilibria.solve(y)
                idle = np.zeros((len(y), e.constraint_count))
                rates = static(y, idle, starts.p[part])[0][:, e.speed_count :]
                converged &= ~endless(self.kernel, rates).any(axis=1)
                x[part, 0] = np.hstack([forces.x, forces.multiplier])
                residuals[part] = np.where(converged, forces.size * analysis.tolerance, np.nan)
                worst = np.abs(forces.value).max(axis=1, initial=0.0) / model.scales.length
                stable = self._stable(starts, part, forces, converged)
                rows = zip(part, worst, steps, stable, strict=True)
                texts |= {
                    int(k): equilibrium_text(float(w), int(n), bool(s)) for k, w, n, s in rows
                }
                report(min(1.0, (first + block) / started.size))
        except KeyboardInterrupt:
            interrupted = True
        states = States(
            model,
            _bodies(model),
            self.backend,
            np.array([self.time]),
            starts.p,
            x,
            self.workers,
        )
        for k in self._verified(states, np.flatnonzero(np.isfinite(residuals))):
            text = texts[int(k)]
            statuses[int(k)] = Status(Outcome.COMPLETED, text, self.time, float(residuals[k]))
        task = analysis, model, self.designs, self.workers
        statistics = {"backend": "NumPy, all designs at once"}
        batch = completed_batch(task, states, statuses, interrupted, statistics, begin)
        if any(status.success for status in statuses.values()):
            batch.warnings = indifferent_states(model, self.kernel)
        return batch

    def _stable(
        self, starts: Starts, designs: np.ndarray, forces: ManyForces, converged: np.ndarray
    ) -> np.ndarray:
        """Whether no motion grows; without states, whether all directions have stiffness."""
        if not self.kernel.states:
            return np.all(forces.resistance > 0, axis=1)
        stable, numbers = np.zeros(designs.size, dtype=bool), np.flatnonzero(converged)
        if numbers.size:
            equilibria = forces.x[numbers], starts.p[designs[numbers]]
            rates = growth_rates(self.model, self.time, *equilibria, starts.evaluate)
            stable[numbers] = ~rates.any(axis=1)
        return stable

    def _verified(self, states: States, designs: np.ndarray) -> np.ndarray:
        """Designs that satisfy the model equations at rest."""
        if not designs.size:
            return designs
        function = at_some(self.model, states.bodies, True)
        shares = states.evaluate(function, designs, np.zeros(1, dtype=int))[0][:, 0]
        limits = np.array([EXACT[Level.POSITION], max(MOTION, self.analysis.tolerance)])
        return designs[np.all(shares[:, [Level.POSITION, -1]] <= limits, axis=1)]


@once
def _first(model: Model) -> ca.Function:
    """``(t, y, p) → y``."""
    e = model.equations
    t, p = ca.SX.sym("t"), ca.SX.sym("p", e.p.numel())
    y = ca.SX.sym("y", e.coordinate_count)
    return ca.Function("first", [t, y, p], [y])


@once
def _bodies(model: Model) -> ca.Function:
    """``(t, [y; λ], p) → y, v, v̇, λ`` of all equations, at rest."""
    e, closure = model.equations, model.closure
    n, m = e.coordinate_count, e.constraint_count
    t, p, x = ca.SX.sym("t"), ca.SX.sym("p", e.p.numel()), ca.SX.sym("x", n + m)
    multiplier, still = ca.SX.zeros(len(closure.owners), 1), ca.SX.zeros(e.speed_count, 1)
    multiplier[list(closure.rows)] = x[n:]
    return ca.Function("bodies", [t, x, p], [x[:n], still, still, multiplier])
