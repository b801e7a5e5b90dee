"""Equilibria of many designs: assembled at once, balanced at once."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.batch.ending import ended_batch
from dalembert.analysis.batch.judgement import at_some
from dalembert.analysis.batch.many_balances import ManyBalances
from dalembert.analysis.batch.starts import Starts, backend_of
from dalembert.analysis.batch.states import States
from dalembert.analysis.equilibrium.static_balance import rest_text, statics_kernel
from dalembert.analysis.model_truth import EXACT, MOTION
from dalembert.formulations.base import Level
from dalembert.model.model import Model
from dalembert.results.batch.batch import Batch
from dalembert.results.batch.designs import Designs
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.once import once

ROOM = 1 << 22
"""Entries of matrices of several designs at once."""


class Rests:
    """One execution of a batch; what is not beyond doubt has a run of its own.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Equilibrium``
    model, designs : what comes to rest
    workers : threads at most
    """

    def __init__(self, analysis: Any, model: Model, designs: Designs, workers: int):
        self.analysis, self.model, self.designs = analysis, model, designs
        self.workers, self.time = workers, float(analysis.time)
        self.kernel, self.backend = statics_kernel(model), backend_of(model)

    @classmethod
    def serves(cls, analysis: Any, model: Model) -> bool:
        """Whether all equations are independent, so that designs are assembled at once."""
        return not (model.closure.lost or model.equations.contacts)

    def execute(self, report: Callable[[float], None]) -> Batch:
        """All designs; after an interruption those that were finished."""
        begin, model, count = clock.perf_counter(), self.model, len(self.designs)
        span = self.time, self.time
        starts = Starts(model, self.designs, self.backend, self.workers, span, False, _first(model))
        e, analysis = model.equations, self.analysis
        balances = ManyBalances(
            self.kernel, self.time, analysis.tolerance, analysis.max_iterations, starts.evaluate
        )
        known, statuses = starts.known, dict(starts.statuses)
        x = np.full((count, 1, e.coordinate_count + e.constraint_count), np.nan)
        texts: dict[int, str] = {}
        left = np.full(count, np.nan)
        block, interrupted = max(1, ROOM // (e.speed_count**2 + 1)), False
        try:
            for at in range(0, known.size, block):
                part = known[at : at + block]
                here, steps, found = balances.solve(starts.x0[at : at + block], starts.p[part])
                x[part, 0] = np.hstack([here.y, here.multiplier])
                left[part] = np.where(found, here.size * analysis.tolerance, np.nan)
                worst = np.abs(here.value).max(axis=1, initial=0.0) / model.scales.length
                stable = np.all(here.resistance > 0, axis=1)
                told = zip(part, worst, steps, stable, strict=True)
                texts |= {int(k): rest_text(float(w), int(n), bool(s)) for k, w, n, s in told}
                report(min(1.0, (at + block) / known.size))
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
        for k in self._beyond_doubt(states, np.flatnonzero(np.isfinite(left))):
            text = texts[int(k)]
            statuses[int(k)] = Status(Outcome.COMPLETED, text, self.time, float(left[k]))
        made_by = analysis, model, self.designs, self.workers
        about = {"backend": "NumPy, all designs at once"}
        return ended_batch(made_by, states, statuses, interrupted, about, begin)

    def _beyond_doubt(self, states: States, designs: np.ndarray) -> np.ndarray:
        """Those of some designs that satisfy the model's own equations at rest."""
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
